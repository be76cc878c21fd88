//! What a formula can do with numbers, for plain numbers and for dual numbers alike.

use crate::number::Number;

/// An operation on up to three numbers: a, b and c.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    Neg,
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    /// a², a³ and a⁴ by multiplication.
    Square,
    Cube,
    Fourth,
    /// The smaller one, a where they are equal, NaN if one is NaN.
    Min,
    /// The larger one, a where they are equal, NaN if one is NaN.
    Max,
    Abs,
    /// −1, 0 or 1.
    Sign,
    /// a, at least b, and then at most c.
    Clamp,
    Sqrt,
    Exp,
    Ln,
    Tanh,
    Sin,
    Cos,
    /// 1 where a < b, else 0.
    Less,
    /// 1 where a ≤ b, else 0.
    LessEqual,
    /// b where a is not 0, else c.
    If,
}

impl Op {
    pub(crate) fn apply<N: Number>(self, a: N, b: N, c: N) -> N {
        match self {
            Self::Neg => a.neg(),
            Self::Add => a.add(b),
            Self::Sub => a.sub(b),
            Self::Mul => a.mul(b),
            Self::Div => a.div(b),
            Self::Pow => a.pow(b),
            Self::Square => a.mul(a),
            Self::Cube => a.mul(a).mul(a),
            Self::Fourth => a.mul(a).mul(a.mul(a)),
            Self::Min => min(a, b),
            Self::Max => max(a, b),
            Self::Abs => abs(a),
            Self::Sign => N::constant(sign(a.value())),
            Self::Clamp => min(max(a, b), c),
            Self::Sqrt => sqrt(a),
            Self::Exp => exp(a),
            Self::Ln => a.chain(libm::log(a.value()), || 1.0 / a.value()),
            Self::Tanh => tanh(a),
            Self::Sin => a.chain(libm::sin(a.value()), || libm::cos(a.value())),
            Self::Cos => a.chain(libm::cos(a.value()), || -libm::sin(a.value())),
            Self::Less => less(a, b),
            Self::LessEqual => less_equal(a, b),
            Self::If => choice(a, b, c),
        }
    }
}

/// The larger one.
#[inline(always)]
pub(crate) fn max<N: Number>(a: N, b: N) -> N {
    if b.value() > a.value() || b.value().is_nan() { b } else { a }
}

/// The smaller one.
#[inline(always)]
pub(crate) fn min<N: Number>(a: N, b: N) -> N {
    if b.value() < a.value() || b.value().is_nan() { b } else { a }
}

/// Of zero, the side of the positive numbers.
#[inline(always)]
pub(crate) fn abs<N: Number>(a: N) -> N {
    a.chain(a.value().abs(), || if a.value() < 0.0 { -1.0 } else { 1.0 })
}

/// Of zero, zero; of NaN, NaN.
pub(crate) fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        value
    }
}

#[inline(always)]
pub(crate) fn less<N: Number>(a: N, b: N) -> N {
    N::constant(f64::from(u8::from(a.value() < b.value())))
}

#[inline(always)]
pub(crate) fn less_equal<N: Number>(a: N, b: N) -> N {
    N::constant(f64::from(u8::from(a.value() <= b.value())))
}

/// b where a is not 0, else c.
#[inline(always)]
pub(crate) fn choice<N: Number>(a: N, b: N, c: N) -> N {
    if a.value() == 0.0 { c } else { b }
}

fn sqrt<N: Number>(a: N) -> N {
    let root = libm::sqrt(a.value());
    a.chain(root, || 0.5 / root)
}

fn exp<N: Number>(a: N) -> N {
    let power = libm::exp(a.value());
    a.chain(power, || power)
}

fn tanh<N: Number>(a: N) -> N {
    let tanh = libm::tanh(a.value());
    a.chain(tanh, || 1.0 - tanh * tanh)
}
