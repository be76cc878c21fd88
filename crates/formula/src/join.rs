//! Joins an operation with the one whose result it takes, so that evaluation has fewer steps. The bits stay the same.

use crate::number::Number;
use crate::operation::{Op, abs, max};
use crate::tree::{NONE, Operand};

/// One step of evaluation: an operation, or two or three joined ones, on a, b and c.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    Plain(Op),
    /// −(a·b)
    NegMul,
    /// −(a·b)·c
    NegMulMul,
    /// a·b·c
    MulMul,
    /// a·|b|
    MulAbs,
    /// a·b + c, rounded twice
    MulAdd,
    /// (a − b)·c
    SubMul,
    /// max(a − b, c)
    SubMax,
    /// max(c, a − b)
    MaxSub,
}

impl Code {
    #[inline(always)]
    pub(crate) fn apply<N: Number>(self, a: N, b: N, c: N) -> N {
        match self {
            Self::Plain(op) => op.apply(a, b, c),
            Self::NegMul => a.mul(b).neg(),
            Self::NegMulMul => a.mul(b).neg().mul(c),
            Self::MulMul => a.mul(b).mul(c),
            Self::MulAbs => a.mul(abs(b)),
            Self::MulAdd => a.mul(b).add(c),
            Self::SubMul => a.sub(b).mul(c),
            Self::SubMax => max(a.sub(b), c),
            Self::MaxSub => max(c, a.sub(b)),
        }
    }
}

/// A step and what it works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) code: Code,
    pub(crate) operands: [Operand; 3],
}

/// The step of an operation; takes the one out of `steps`, one for each earlier operation, that it makes superfluous.
///
/// Every result is used once. Products and sums may change the order of two operands, a sign may move within a product.
pub(crate) fn join(op: Op, operands: [Operand; 3], steps: &mut [Option<Step>]) -> Step {
    let [left, right, _] = operands;
    let joined = absorb(steps, right, |inner| with_right(op, left, inner));
    let joined = joined.or_else(|| absorb(steps, left, |inner| with_left(op, inner, right)));
    joined.unwrap_or(Step { code: Code::Plain(op), operands })
}

/// Takes out the step whose result is the operand, if it can be joined.
fn absorb(steps: &mut [Option<Step>], operand: Operand, join: impl FnOnce(Step) -> Option<Step>) -> Option<Step> {
    let Operand::Result(place) = operand else { return None };
    let step = steps.get_mut(place)?;
    let joined = join((*step)?)?;
    *step = None;
    Some(joined)
}

fn with_left(op: Op, inner: Step, other: Operand) -> Option<Step> {
    let [a, b, _] = inner.operands;
    let (code, operands) = match (op, inner.code) {
        (Op::Neg, Code::Plain(Op::Mul)) => (Code::NegMul, [a, b, NONE]),
        (Op::Mul, Code::Plain(Op::Neg)) => (Code::NegMul, [a, other, NONE]),
        (Op::Mul, Code::Plain(Op::Abs)) => (Code::MulAbs, [other, a, NONE]),
        (Op::Mul, Code::Plain(Op::Mul)) => (Code::MulMul, [a, b, other]),
        (Op::Mul, Code::Plain(Op::Sub)) => (Code::SubMul, [a, b, other]),
        (Op::Mul, Code::NegMul) => (Code::NegMulMul, [a, b, other]),
        (Op::Add, Code::Plain(Op::Mul)) => (Code::MulAdd, [a, b, other]),
        (Op::Max, Code::Plain(Op::Sub)) => (Code::SubMax, [a, b, other]),
        _ => return None,
    };
    Some(Step { code, operands })
}

fn with_right(op: Op, other: Operand, inner: Step) -> Option<Step> {
    let [a, b, _] = inner.operands;
    match (op, inner.code) {
        // Of two equal ones, the left one.
        (Op::Max, Code::Plain(Op::Sub)) => Some(Step { code: Code::MaxSub, operands: [a, b, other] }),
        (Op::Mul | Op::Add, _) => with_left(op, inner, other),
        _ => None,
    }
}
