//! Interval arithmetic: from the ranges of the operands, a range that holds every result as it is computed.
//!
//! Sums, products, quotients and roots are rounded correctly and therefore monotonically, so that the results at the ends hold
//! those between. What `libm` approximates is widened by more than its error, which is below one unit in the last place.
//! Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis*, chapters 2 and 5.

use crate::operation::{Op, sign};
use crate::power::power;
use crate::undefined::Undefined;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// From the first to the second, both finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval(pub(crate) f64, pub(crate) f64);

/// What an approximated result is widened by, relative to it: eight units in the last place.
const WIDENING: f64 = 8.0 * f64::EPSILON;
/// Beyond it a sine counts as any sine: its argument is not known well enough to place its crests.
const MAX_ANGLE: f64 = 1e6;
/// So near to a crest, an angle counts as on it.
const NEAR: f64 = 1e-6;

impl Interval {
    pub(crate) const fn point(value: f64) -> Self {
        Self(value, value)
    }

    pub(crate) fn contains(self, value: f64) -> bool {
        self.0 <= value && value <= self.1
    }

    /// The smallest that holds all of these.
    pub(crate) fn around(values: &[f64]) -> Self {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self(values.iter().copied().fold(low, f64::min), values.iter().copied().fold(high, f64::max))
    }

    /// Of a function of one number that only rises.
    fn rising(self, of: impl Fn(f64) -> f64) -> Self {
        Self(of(self.0), of(self.1))
    }

    /// A little more, for results that are approximated.
    pub(crate) fn widened(self) -> Self {
        let by = |value: f64| value.abs() * WIDENING + f64::MIN_POSITIVE;
        Self(self.0 - by(self.0), self.1 + by(self.1))
    }

    fn limited(self, low: f64, high: f64) -> Self {
        Self(self.0.max(low), self.1.min(high))
    }

    fn mul(self, other: Self) -> Self {
        Self::around(&[self.0 * other.0, self.0 * other.1, self.1 * other.0, self.1 * other.1])
    }

    fn div(self, divisor: Self) -> Result<Self, Undefined> {
        if divisor.contains(0.0) {
            return Err(Undefined::DivisorMayBeZero(divisor.0, divisor.1));
        }
        let (d0, d1) = (divisor.0, divisor.1);
        Ok(Self::around(&[self.0 / d0, self.0 / d1, self.1 / d0, self.1 / d1]))
    }

    fn abs(self) -> Self {
        let ends = Self::around(&[self.0.abs(), self.1.abs()]);
        if self.contains(0.0) { Self(0.0, ends.1) } else { ends }
    }

    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }

    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    fn sqrt(self) -> Result<Self, Undefined> {
        if self.0 < 0.0 {
            return Err(Undefined::RootOfNegative(self.0, self.1));
        }
        Ok(self.rising(libm::sqrt))
    }

    fn ln(self) -> Result<Self, Undefined> {
        if self.0 <= 0.0 {
            return Err(Undefined::LogarithmOfNonPositive(self.0, self.1));
        }
        Ok(self.rising(libm::log).widened())
    }

    /// Of `wave`, which has its crests (+1) at `crest` + 2πk and its troughs (−1) half a turn from them.
    fn wave(self, wave: impl Fn(f64) -> f64, crest: f64) -> Self {
        if self.0 < -MAX_ANGLE || self.1 > MAX_ANGLE {
            return Self(-1.0, 1.0);
        }
        let ends = Self::around(&[wave(self.0), wave(self.1)]).widened().limited(-1.0, 1.0);
        let passes = |peak: f64| {
            let next = peak + TAU * libm::ceil((self.0 - NEAR - peak) / TAU);
            next <= self.1 + NEAR
        };
        Self(if passes(crest + PI) { -1.0 } else { ends.0 }, if passes(crest) { 1.0 } else { ends.1 })
    }

    /// 1 where the comparison holds for all, 0 where it holds for none, else both.
    fn truth(always: bool, never: bool) -> Self {
        Self(f64::from(u8::from(always)), f64::from(u8::from(!never)))
    }
}

/// The range of an operation's results.
pub(crate) fn apply(op: Op, [a, b, c]: [Interval; 3]) -> Result<Interval, Undefined> {
    let result = match op {
        Op::Neg => Interval(-a.1, -a.0),
        Op::Add => Interval(a.0 + b.0, a.1 + b.1),
        Op::Sub => Interval(a.0 - b.1, a.1 - b.0),
        Op::Mul => a.mul(b),
        Op::Div => a.div(b)?,
        Op::Pow => power(a, b)?,
        Op::Square => a.abs().rising(|x| x * x),
        Op::Cube => a.rising(|x| x * x * x),
        Op::Fourth => a.abs().rising(|x| x * x * (x * x)),
        Op::Min => a.min(b),
        Op::Max => a.max(b),
        Op::Abs => a.abs(),
        Op::Sign => a.rising(sign),
        Op::Clamp => a.max(b).min(c),
        Op::Sqrt => a.sqrt()?,
        Op::Exp => a.rising(libm::exp).widened().limited(0.0, f64::INFINITY),
        Op::Ln => a.ln()?,
        Op::Tanh => a.rising(libm::tanh).widened().limited(-1.0, 1.0),
        Op::Sin => a.wave(libm::sin, FRAC_PI_2),
        Op::Cos => a.wave(libm::cos, 0.0),
        Op::Less => Interval::truth(a.1 < b.0, a.0 >= b.1),
        Op::LessEqual => Interval::truth(a.1 <= b.0, a.0 > b.1),
        // `range` has chosen already where the condition is decided.
        Op::If => Interval::around(&[b.0, b.1, c.0, c.1]),
    };
    let finite = result.0.is_finite() && result.1.is_finite();
    if finite { Ok(result) } else { Err(Undefined::Overflow) }
}
