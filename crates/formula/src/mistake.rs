//! What can be wrong with a formula, and where. The reader of the config file adds file and line.

use crate::functions::{FUNCTIONS, Function};
use crate::undefined::Undefined;
use crate::{MAX_CHARACTERS, MAX_DEPTH, MAX_OPERATIONS};
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::{Display, Formatter, Result};

/// What is wrong with a formula, and at which character.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// The column, in characters, from 1.
    pub column: usize,
    /// What is wrong there.
    pub kind: MistakeKind,
}

/// What is wrong with a formula.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MistakeKind {
    /// There is no text.
    Empty,
    /// More than [`MAX_CHARACTERS`].
    TooLong,
    /// More than [`MAX_DEPTH`] brackets within each other.
    TooDeep,
    /// More than [`MAX_OPERATIONS`].
    TooManyOperations,
    /// A character that no formula has.
    UnknownCharacter(char),
    /// Digits that are no number.
    BadNumber(String),
    /// A number that is larger than all floating-point numbers.
    NumberTooLarge(String),
    /// A name that is neither a variable's nor a constant's.
    UnknownVariable {
        /// What is written.
        name: String,
        /// The names that there are.
        names: Vec<String>,
        /// The one of them that is spelled much like it.
        nearest: Option<String>,
    },
    /// A name before a bracket that is no function's.
    UnknownFunction {
        /// What is written.
        name: String,
        /// What may be meant instead.
        nearest: Option<&'static str>,
    },
    /// A variable before a bracket.
    NotAFunction(String),
    /// A function's name without a bracket after it.
    FunctionWithoutBracket(&'static str),
    /// Too many or too few arguments.
    WrongArgumentCount {
        /// The function's name.
        function: &'static str,
        /// How many it takes.
        wanted: usize,
        /// Whether it takes more, too.
        or_more: bool,
        /// How many are written.
        given: usize,
    },
    /// Something else than a value where one must follow; nothing is the end of the text.
    ValueExpected(Option<String>),
    /// Something else than an operator after a value.
    OperatorExpected(String),
    /// A closing bracket that nothing opened.
    UnopenedBracket,
    /// An opening bracket that nothing closes.
    UnclosedBracket,
    /// A comma that is not between the arguments of a function.
    CommaOutsideFunction,
    /// A comparison that is not the first argument of `if`.
    ComparisonOutsideIf,
    /// The first argument of `if` compares nothing.
    ComparisonMissing,
    /// The value can be undefined within the bounds of the variables.
    Undefined(Undefined),
}

impl core::error::Error for Mistake {}

impl Display for Mistake {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "column {}: {}", self.column, self.kind)
    }
}

impl Display for MistakeKind {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Empty => f.write_str("the formula is empty; write one, such as `-k * x`"),
            Self::TooLong => write!(f, "the formula has more than {MAX_CHARACTERS} characters; shorten it"),
            Self::TooDeep => {
                write!(f, "brackets are nested deeper than {MAX_DEPTH}; leave out those that change nothing")
            }
            Self::TooManyOperations => write!(f, "the formula has more than {MAX_OPERATIONS} operations; shorten it"),
            Self::UnknownCharacter(character) => unknown_character(f, *character),
            Self::BadNumber(text) => write!(f, "`{text}` is no number; write one as `12`, `0.5` or `1e-3`"),
            Self::NumberTooLarge(text) => write!(f, "`{text}` is too large; the largest number is about 1.8e308"),
            Self::UnknownVariable { name, names, nearest } => unknown_variable(f, name, names, nearest.as_deref()),
            Self::UnknownFunction { name, nearest } => unknown_function(f, name, *nearest),
            Self::NotAFunction(name) => write!(f, "`{name}` is no function; a product is written `{name} * (…)`"),
            Self::FunctionWithoutBracket(name) => write!(f, "`{name}` is a function; write its arguments, `{name}(…)`"),
            Self::WrongArgumentCount { function, wanted, or_more, given } => {
                let (s, or_more) = (plural(*wanted), if *or_more { " or more" } else { "" });
                let is = if *given == 1 { "is" } else { "are" };
                write!(f, "`{function}` takes {wanted} argument{s}{or_more}, {given} {is} given")
            }
            Self::ValueExpected(Some(found)) => {
                write!(
                    f,
                    "`{found}` stands where a value is missing; write a number, a variable, a function or a bracket"
                )
            }
            Self::ValueExpected(None) => f.write_str("the formula ends where a value is missing; complete it"),
            Self::OperatorExpected(found) => {
                write!(f, "an operator is missing before `{found}`; a product is written with `*`")
            }
            Self::UnopenedBracket => f.write_str("nothing opened this bracket; delete it, or add a `(` before it"),
            Self::UnclosedBracket => f.write_str("nothing closes this bracket; add a `)`"),
            Self::CommaOutsideFunction => {
                f.write_str("a comma stands only between the arguments of a function; the decimal mark is a point")
            }
            Self::ComparisonOutsideIf => {
                f.write_str("a comparison stands only as the first argument of `if`, once, as in `if(x < 0, a, b)`")
            }
            Self::ComparisonMissing => f.write_str("`if` compares first, as in `if(x < 0, a, b)`"),
            Self::Undefined(undefined) => undefined.fmt(f),
        }
    }
}

const fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

fn unknown_character(f: &mut Formatter<'_>, character: char) -> Result {
    let meant = match character {
        '\u{2212}' | '\u{2013}' => "a minus is written `-`",
        '×' | '·' => "a product is written with `*`",
        '÷' | ':' => "a quotient is written with `/`",
        '²' | '³' => "a power is written with `^`, as in `x^2`",
        '[' | ']' | '{' | '}' => "brackets are `(` and `)`",
        '=' | '!' => "the comparisons are `<`, `<=`, `>` and `>=`, within `if`",
        'π' => "it is written `pi`",
        _ => "there are numbers, names, `+ - * / ^`, brackets, commas, and comparisons within `if`",
    };
    write!(f, "`{}` means nothing in a formula; {meant}", character.escape_debug())
}

fn unknown_variable(f: &mut Formatter<'_>, name: &str, names: &[String], nearest: Option<&str>) -> Result {
    write!(f, "there is no variable `{name}`; ")?;
    if let Some(nearest) = nearest {
        write!(f, "did you mean `{nearest}`? ")?;
    }
    let there = if nearest.is_some() { "There" } else { "there" };
    match names {
        [] => write!(f, "{there} are none, only the constant pi"),
        [only] => write!(f, "{there} is {only}"),
        _ => write!(f, "{there} are {}", names.join(", ")),
    }
}

fn unknown_function(f: &mut Formatter<'_>, name: &str, nearest: Option<&str>) -> Result {
    write!(f, "there is no function `{name}`; ")?;
    match nearest {
        Some(nearest) => write!(f, "did you mean `{nearest}`?"),
        None => write!(f, "there are {}", FUNCTIONS.each_ref().map(Function::name).join(", ")),
    }
}
