//! The range of a formula's value, or where it can be undefined.

use crate::interval::{Interval, apply};
use crate::mistake::{Mistake, MistakeKind};
use crate::operation::Op;
use crate::tree::{Operand, Operation, Tree, Variable};
use crate::undefined::Undefined;
use alloc::vec::Vec;

type Ranged = Result<Interval, Mistake>;

/// Of all values while each variable lies within its bounds.
pub(crate) fn range(tree: &Tree, bounds: &[(f64, f64)]) -> Result<(f64, f64), Mistake> {
    let variables: Vec<Interval> =
        tree.variables.iter().map(|variable| bounded(variable, bounds)).collect::<Result<_, _>>()?;
    let mut results: Vec<Ranged> = Vec::with_capacity(tree.operations.len());
    let of = |operand: Operand, results: &[Ranged]| match operand {
        Operand::Constant(value) => Ok(Interval::point(value)),
        Operand::Variable(k) => Ok(variables.get(k).copied().unwrap_or(Interval::point(0.0))),
        Operand::Result(k) => results.get(k).cloned().unwrap_or(Ok(Interval::point(0.0))),
    };
    for operation in &tree.operations {
        let operands = operation.operands.map(|operand| of(operand, &results));
        results.push(result(operation, operands));
    }
    of(tree.root, &results).map(|Interval(low, high)| (low, high))
}

/// What is undefined stays so, unless it is in the branch of an `if` that is never taken.
fn result(operation: &Operation, [a, b, c]: [Ranged; 3]) -> Ranged {
    let a = a?;
    if operation.op == Op::If && !a.contains(0.0) {
        return b;
    }
    if operation.op == Op::If && a == Interval::point(0.0) {
        return c;
    }
    let mistake = |undefined| Mistake { column: operation.column, kind: MistakeKind::Undefined(undefined) };
    apply(operation.op, [a, b?, c?]).map_err(mistake)
}

fn bounded(variable: &Variable, bounds: &[(f64, f64)]) -> Ranged {
    match bounds.get(variable.index) {
        Some((low, high)) if low.is_finite() && high.is_finite() && low <= high => Ok(Interval(*low, *high)),
        _ => {
            let unbounded = Undefined::Unbounded(variable.name.clone());
            Err(Mistake { column: variable.column, kind: MistakeKind::Undefined(unbounded) })
        }
    }
}
