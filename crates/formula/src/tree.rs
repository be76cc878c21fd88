//! A formula as operations in the order in which they can be computed. What the text repeats is computed once.

use crate::MAX_OPERATIONS;
use crate::mistake::{Mistake, MistakeKind};
use crate::operation::Op;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

/// What an operation works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Operand {
    Constant(f64),
    /// The place in [`Tree::variables`].
    Variable(usize),
    /// The place in [`Tree::operations`].
    Result(usize),
}

/// An operation, what it works on, and where it stands in the text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Operation {
    pub(crate) op: Op,
    /// Those that the operation does not take are zeros.
    pub(crate) operands: [Operand; 3],
    pub(crate) column: usize,
}

impl Operand {
    /// Whether both are the same in every bit.
    fn is(self, other: Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a.to_bits() == b.to_bits(),
            _ => self == other,
        }
    }
}

impl Operation {
    /// Whether this is the operation on these operands.
    fn is(&self, op: Op, operands: [Operand; 3]) -> bool {
        self.op == op && self.operands.into_iter().zip(operands).all(|(own, other)| own.is(other))
    }
}

/// A variable that occurs in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variable {
    /// Its place among the values.
    pub(crate) index: usize,
    pub(crate) name: String,
    /// Where it occurs first.
    pub(crate) column: usize,
}

/// The operations of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tree {
    pub(crate) variables: Vec<Variable>,
    pub(crate) operations: Vec<Operation>,
    /// What the formula is the value of, and where that stands.
    pub(crate) root: Operand,
    /// How many operations the text has, also those that are computed already.
    written: usize,
}

/// In the place of an operand that an operation does not take.
pub(crate) const NONE: Operand = Operand::Constant(0.0);

impl Tree {
    pub(crate) const fn new() -> Self {
        Self { variables: Vec::new(), operations: Vec::new(), root: NONE, written: 0 }
    }

    /// The variable at this place among the values.
    pub(crate) fn variable(&mut self, index: usize, name: &str, column: usize) -> Operand {
        let known = self.variables.iter().position(|variable| variable.index == index);
        Operand::Variable(known.unwrap_or_else(|| {
            self.variables.push(Variable { index, name: name.into(), column });
            self.variables.len() - 1
        }))
    }

    /// Adds an operation, or its result where that is a constant.
    pub(crate) fn push(&mut self, op: Op, operands: [Operand; 3], column: usize) -> Result<Operand, Mistake> {
        self.written += 1;
        if self.written > MAX_OPERATIONS {
            return Err(Mistake { column, kind: MistakeKind::TooManyOperations });
        }
        let (op, operands) = by_multiplication(op, operands);
        if let [Operand::Constant(a), Operand::Constant(b), Operand::Constant(c)] = operands {
            let result = op.apply(a, b, c);
            // What is not finite stays an operation: `range` says where it is.
            if result.is_finite() {
                return Ok(Operand::Constant(result));
            }
        }
        let known = self.operations.iter().position(|known| known.is(op, operands));
        Ok(Operand::Result(known.unwrap_or_else(|| {
            self.operations.push(Operation { op, operands, column });
            self.operations.len() - 1
        })))
    }

    /// How often each result is used.
    pub(crate) fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.operations.len()];
        for operand in self.operations.iter().flat_map(|operation| operation.operands).chain([self.root]) {
            if let Operand::Result(place) = operand
                && let Some(count) = uses.get_mut(place)
            {
                *count += 1;
            }
        }
        uses
    }
}

/// Small powers are products.
fn by_multiplication(op: Op, operands: [Operand; 3]) -> (Op, [Operand; 3]) {
    let [base, Operand::Constant(exponent), _] = operands else { return (op, operands) };
    match op {
        Op::Pow if exponent == 2.0 => (Op::Square, [base, NONE, NONE]),
        Op::Pow if exponent == 3.0 => (Op::Cube, [base, NONE, NONE]),
        Op::Pow if exponent == 4.0 => (Op::Fourth, [base, NONE, NONE]),
        _ => (op, operands),
    }
}
