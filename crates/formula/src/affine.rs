//! Whether a formula is affine in some of its variables: f(x) = a + b·x, where a and b do not depend on x.

use crate::operation::Op;
use crate::tree::{Operand, Operation, Tree};
use alloc::vec::Vec;

/// How a result depends on the variables in question, from the simplest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Dependence {
    None,
    Affine,
    Other,
}

use Dependence::{Affine, None, Other};

pub(crate) fn is_affine_in(tree: &Tree, variables: &[usize]) -> bool {
    let mut results: Vec<Dependence> = Vec::with_capacity(tree.operations.len());
    let of = |operand: Operand, results: &[Dependence]| match operand {
        Operand::Constant(_) => None,
        Operand::Variable(k) => match tree.variables.get(k) {
            Some(variable) if variables.contains(&variable.index) => Affine,
            _ => None,
        },
        Operand::Result(k) => results.get(k).copied().unwrap_or(Other),
    };
    for operation in &tree.operations {
        let operands = operation.operands.map(|operand| of(operand, &results));
        results.push(dependence(operation, operands));
    }
    of(tree.root, &results) <= Affine
}

fn dependence(operation: &Operation, [a, b, c]: [Dependence; 3]) -> Dependence {
    let exponent = operation.operands[1];
    match operation.op {
        _ if a.max(b).max(c) == None => None,
        Op::Neg => a,
        Op::Add | Op::Sub => a.max(b),
        Op::Mul if a == None || b == None => a.max(b),
        Op::Div if b == None => a,
        Op::Pow if exponent == Operand::Constant(1.0) => a,
        Op::If if a == None => b.max(c),
        _ => Other,
    }
}
