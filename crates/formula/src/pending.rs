//! What is not complete yet while a formula is read: operators without their right operand, and open brackets.

use crate::functions::Function;
use crate::operation::Op;
use crate::token::{Token, Word};

/// What waits for its right operand, or for its closing bracket.
#[derive(Clone, Copy)]
pub(crate) enum Pending {
    Operator(Operator),
    Bracket(Bracket),
}

#[derive(Clone, Copy)]
pub(crate) struct Operator {
    pub(crate) op: Op,
    pub(crate) precedence: Precedence,
    /// `a > b` is computed as `b < a`.
    pub(crate) swapped: bool,
    pub(crate) column: usize,
}

/// From the loosest to the tightest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Precedence {
    Comparison,
    Sum,
    Product,
    Sign,
    Power,
}

#[derive(Clone, Copy)]
pub(crate) struct Bracket {
    /// Whose arguments it holds.
    pub(crate) function: Option<Function>,
    /// Of the function, or of the bracket where it has none.
    pub(crate) column: usize,
    /// How many arguments are complete.
    pub(crate) arguments: usize,
    /// Whether something was compared in it.
    pub(crate) compares: bool,
}

impl Operator {
    /// The minus before a value.
    pub(crate) const fn sign(column: usize) -> Self {
        Self { op: Op::Neg, precedence: Precedence::Sign, swapped: false, column }
    }

    /// The operator between two values that this word is.
    pub(crate) const fn between(word: Word<'_>) -> Option<Self> {
        let (op, precedence, swapped) = match word.token {
            Token::Plus => (Op::Add, Precedence::Sum, false),
            Token::Minus => (Op::Sub, Precedence::Sum, false),
            Token::Times => (Op::Mul, Precedence::Product, false),
            Token::Over => (Op::Div, Precedence::Product, false),
            Token::Power => (Op::Pow, Precedence::Power, false),
            Token::Less => (Op::Less, Precedence::Comparison, false),
            Token::LessEqual => (Op::LessEqual, Precedence::Comparison, false),
            Token::Greater => (Op::Less, Precedence::Comparison, true),
            Token::GreaterEqual => (Op::LessEqual, Precedence::Comparison, true),
            _ => return None,
        };
        Some(Self { op, precedence, swapped, column: word.column })
    }
}

impl Bracket {
    /// Whether a comparison may begin: once, in the first argument of `if`.
    pub(crate) fn may_compare(&self) -> bool {
        self.is_condition(0) && !self.compares
    }

    /// Whether the first argument of `if` has just ended without one.
    pub(crate) fn lacks_comparison(&self) -> bool {
        self.is_condition(1) && !self.compares
    }

    /// Whether it is that of `if`, with so many complete arguments.
    fn is_condition(&self, arguments: usize) -> bool {
        self.arguments == arguments && self.function.is_some_and(|function| function.op == Op::If)
    }
}
