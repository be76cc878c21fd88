//! The functions and constants that a formula may name.

use crate::operation::Op;

/// A function and how many arguments it takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Function {
    name: &'static str,
    pub(crate) op: Op,
    pub(crate) arguments: usize,
    pub(crate) or_more: bool,
}

/// All of them, in the order in which a message lists them.
pub(crate) const FUNCTIONS: [Function; 12] = [
    Function { or_more: true, ..function("min", Op::Min, 2) },
    Function { or_more: true, ..function("max", Op::Max, 2) },
    function("abs", Op::Abs, 1),
    function("sign", Op::Sign, 1),
    function("clamp", Op::Clamp, 3),
    function("sqrt", Op::Sqrt, 1),
    function("exp", Op::Exp, 1),
    function("ln", Op::Ln, 1),
    function("tanh", Op::Tanh, 1),
    function("sin", Op::Sin, 1),
    function("cos", Op::Cos, 1),
    function("if", Op::If, 3),
];

/// What other languages call what there is.
const ELSEWHERE: [(&str, &str); 3] = [("pow", "^"), ("power", "^"), ("log", "ln")];

impl Function {
    pub(crate) const fn name(&self) -> &'static str {
        self.name
    }

    pub(crate) fn named(name: &str) -> Option<Self> {
        FUNCTIONS.into_iter().find(|function| function.name == name)
    }

    /// What may be meant by a function that there is not.
    pub(crate) fn nearest(name: &str) -> Option<&'static str> {
        let elsewhere = ELSEWHERE.iter().find(|(other, _)| *other == name).map(|(_, here)| *here);
        elsewhere.or_else(|| crate::nearest::nearest(name, FUNCTIONS.iter().map(|function| function.name)))
    }
}

/// The constant of this name.
pub(crate) fn constant(name: &str) -> Option<f64> {
    (name == "pi").then_some(core::f64::consts::PI)
}

/// Whether a variable may have this name: letters, digits and underscores, no digit first, and neither a function nor `pi`.
#[must_use]
pub fn is_free_name(name: &str) -> bool {
    let spelled = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    let begins = name.bytes().next().is_some_and(|byte| !byte.is_ascii_digit());
    spelled && begins && Function::named(name).is_none() && constant(name).is_none()
}

const fn function(name: &'static str, op: Op, arguments: usize) -> Function {
    Function { name, op, arguments, or_more: false }
}
