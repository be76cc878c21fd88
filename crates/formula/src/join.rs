//! Joins an operation with the one whose result it takes, so that evaluation has fewer steps. The bits stay the same.

use crate::number::Number;
use crate::operation::{Op, abs, choice, less, less_equal, max, min};
use crate::tree::{NONE, Operand};

/// One step of evaluation on a, b and c: an operation, or two or three joined ones.
///
/// What a formula of a force is mostly made of stands here by itself, so that a single jump leads to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    Add,
    Sub,
    Mul,
    Div,
    Square,
    Max,
    Min,
    Abs,
    Neg,
    Less,
    LessEqual,
    If,
    /// −(a·b)
    NegMul,
    /// −(a·b)·c
    NegMulMul,
    /// a·b·c
    MulMul,
    /// a·|b|
    MulAbs,
    /// −(a·b)·|c|
    NegMulMulAbs,
    /// a·b + c, rounded twice
    MulAdd,
    /// (a − b)·c
    SubMul,
    /// max(a − b, c)
    SubMax,
    /// max(c, a − b)
    MaxSub,
    /// a·max(b − c, 0)
    Ramp,
    /// −(a·max(b − c, 0))
    NegRamp,
    Other(Op),
}

impl Code {
    const fn of(op: Op) -> Self {
        match op {
            Op::Add => Self::Add,
            Op::Sub => Self::Sub,
            Op::Mul => Self::Mul,
            Op::Div => Self::Div,
            Op::Square => Self::Square,
            Op::Max => Self::Max,
            Op::Min => Self::Min,
            Op::Abs => Self::Abs,
            Op::Neg => Self::Neg,
            Op::Less => Self::Less,
            Op::LessEqual => Self::LessEqual,
            Op::If => Self::If,
            _ => Self::Other(op),
        }
    }

    #[inline(always)]
    pub(crate) fn apply<N: Number>(self, a: N, b: N, c: N) -> N {
        match self {
            Self::Add => a.add(b),
            Self::Sub => a.sub(b),
            Self::Mul => a.mul(b),
            Self::Div => a.div(b),
            Self::Square => a.mul(a),
            Self::Max => max(a, b),
            Self::Min => min(a, b),
            Self::Abs => abs(a),
            Self::Neg => a.neg(),
            Self::Less => less(a, b),
            Self::LessEqual => less_equal(a, b),
            Self::If => choice(a, b, c),
            Self::NegMul => a.mul(b).neg(),
            Self::NegMulMul => a.mul(b).neg().mul(c),
            Self::MulMul => a.mul(b).mul(c),
            Self::MulAbs => a.mul(abs(b)),
            Self::NegMulMulAbs => a.mul(b).neg().mul(abs(c)),
            Self::MulAdd => a.mul(b).add(c),
            Self::SubMul => a.sub(b).mul(c),
            Self::SubMax => max(a.sub(b), c),
            Self::MaxSub => max(c, a.sub(b)),
            Self::Ramp => a.mul(max(b.sub(c), N::constant(0.0))),
            Self::NegRamp => a.mul(max(b.sub(c), N::constant(0.0))).neg(),
            Self::Other(op) => other(op, a, b, c),
        }
    }
}

/// By a call, so that the loop of evaluation needs few registers.
#[inline(never)]
fn other<N: Number>(op: Op, a: N, b: N, c: N) -> N {
    op.apply(a, b, c)
}

/// A step and what it works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) code: Code,
    pub(crate) operands: [Operand; 3],
}

/// The step of an operation; takes the one out of `steps`, one for each earlier operation, that it makes superfluous.
/// `uses`: how often each of their results is used; one that is used twice stays a step.
///
/// Products and sums may change the order of two operands, a sign may move within a product.
pub(crate) fn join(op: Op, operands: [Operand; 3], steps: &mut [Option<Step>], uses: &[usize]) -> Step {
    let [left, right, _] = operands;
    let mut absorb = |operand, join: &dyn Fn(Step) -> Option<Step>| absorb(steps, uses, operand, join);
    let joined = absorb(right, &|inner| with_right(op, left, inner));
    let joined = joined.or_else(|| absorb(left, &|inner| with_left(op, inner, right)));
    let step = joined.unwrap_or(Step { code: Code::of(op), operands });
    absorb(step.operands[0], &|inner| with_first(step, inner)).unwrap_or(step)
}

/// Takes out the step whose result is the operand, if nothing else uses that and it can be joined.
fn absorb(
    steps: &mut [Option<Step>],
    uses: &[usize],
    operand: Operand,
    join: &dyn Fn(Step) -> Option<Step>,
) -> Option<Step> {
    let Operand::Result(place) = operand else { return None };
    if uses.get(place) != Some(&1) {
        return None;
    }
    let step = steps.get_mut(place)?;
    let joined = join((*step)?)?;
    *step = None;
    Some(joined)
}

fn with_left(op: Op, inner: Step, other: Operand) -> Option<Step> {
    let [a, b, c] = inner.operands;
    let (code, operands) = match (op, inner.code) {
        (Op::Neg, Code::Mul) => (Code::NegMul, [a, b, NONE]),
        (Op::Mul, Code::Neg) => (Code::NegMul, [a, other, NONE]),
        (Op::Mul, Code::Abs) => (Code::MulAbs, [other, a, NONE]),
        (Op::Mul, Code::Mul) => (Code::MulMul, [a, b, other]),
        (Op::Mul, Code::Sub) => (Code::SubMul, [a, b, other]),
        // Not −0: the zero would lose its sign.
        (Op::Mul, Code::SubMax) if matches!(c, Operand::Constant(zero) if zero.to_bits() == 0) => {
            (Code::Ramp, [other, a, b])
        }
        (Op::Mul, Code::NegMul) => (Code::NegMulMul, [a, b, other]),
        (Op::Add, Code::Mul) => (Code::MulAdd, [a, b, other]),
        (Op::Max, Code::Sub) => (Code::SubMax, [a, b, other]),
        _ => return None,
    };
    Some(Step { code, operands })
}

/// Joins a joined step once more.
fn with_first(Step { code, operands: [_, b, c] }: Step, inner: Step) -> Option<Step> {
    let [first, second, _] = inner.operands;
    match (code, inner.code) {
        (Code::MulAbs, Code::NegMul) => Some(Step { code: Code::NegMulMulAbs, operands: [first, second, b] }),
        (Code::Ramp, Code::Neg) => Some(Step { code: Code::NegRamp, operands: [first, b, c] }),
        _ => None,
    }
}

fn with_right(op: Op, other: Operand, inner: Step) -> Option<Step> {
    let [a, b, _] = inner.operands;
    match (op, inner.code) {
        // Of two equal ones, the left one.
        (Op::Max, Code::Sub) => Some(Step { code: Code::MaxSub, operands: [a, b, other] }),
        (Op::Mul | Op::Add, _) => with_left(op, inner, other),
        _ => None,
    }
}
