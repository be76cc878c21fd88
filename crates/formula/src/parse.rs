//! From words to operations, by precedence, with an explicit stack of what is not complete yet.
//!
//! Source: Dijkstra's shunting-yard algorithm (Mathematisch Centrum, report MR 35), with functions and signs.

use crate::functions::{Function, constant};
use crate::mistake::{Mistake, MistakeKind};
use crate::nearest::nearest;
use crate::operation::Op;
use crate::pending::{Bracket, Operator, Pending, Precedence};
use crate::token::{Token, Word, Words};
use crate::tree::{NONE, Operand, Tree};
use crate::{MAX_CHARACTERS, MAX_DEPTH};
use alloc::string::ToString;
use alloc::vec::Vec;

type Parsed<T> = Result<T, Mistake>;

/// The operations of a text.
pub(crate) fn parse(text: &str, names: &[&str]) -> Parsed<Tree> {
    if text.chars().nth(MAX_CHARACTERS).is_some() {
        return mistake(MAX_CHARACTERS + 1, MistakeKind::TooLong);
    }
    let (mut parser, mut words) = (Parser::new(names), Words::new(text));
    let mut value_follows = true;
    while let Some(word) = words.next()? {
        value_follows =
            if value_follows { parser.instead_of_value(word, &mut words)? } else { parser.after_value(word)? };
    }
    if value_follows {
        let empty = parser.values.is_empty() && parser.pending.is_empty();
        return mistake(words.column(), if empty { MistakeKind::Empty } else { MistakeKind::ValueExpected(None) });
    }
    parser.complete()
}

struct Parser<'a> {
    names: &'a [&'a str],
    tree: Tree,
    values: Vec<Operand>,
    pending: Vec<Pending>,
    depth: usize,
}

impl<'a> Parser<'a> {
    const fn new(names: &'a [&'a str]) -> Self {
        Self { names, tree: Tree::new(), values: Vec::new(), pending: Vec::new(), depth: 0 }
    }

    /// Takes a word where a value must begin; whether a value must still follow.
    fn instead_of_value(&mut self, word: Word<'_>, words: &mut Words<'_>) -> Parsed<bool> {
        let column = word.column;
        match word.token {
            Token::Number(number) => self.values.push(Operand::Constant(number)),
            Token::Name if words.open() => return self.function(word),
            Token::Name => {
                let value = self.named(word)?;
                self.values.push(value);
            }
            Token::Minus => {
                self.pending.push(Pending::Operator(Operator::sign(column)));
                return Ok(true);
            }
            Token::Open => {
                self.open(None, column)?;
                return Ok(true);
            }
            Token::Close
                if matches!(
                    self.pending.last(),
                    Some(Pending::Bracket(Bracket { arguments: 0, function: Some(_), .. }))
                ) =>
            {
                return self.close(column, 0).map(|()| false);
            }
            _ => return mistake(column, MistakeKind::ValueExpected(Some(word.text.to_string()))),
        }
        Ok(false)
    }

    /// Takes a word after a value; whether a value must follow it.
    fn after_value(&mut self, word: Word<'_>) -> Parsed<bool> {
        let Some(operator) = Operator::between(word) else {
            return match word.token {
                Token::Comma => self.comma(word.column).map(|()| true),
                Token::Close => self.close(word.column, 1).map(|()| false),
                _ => mistake(word.column, MistakeKind::OperatorExpected(word.text.to_string())),
            };
        };
        self.reduce(operator.precedence)?;
        if operator.precedence == Precedence::Comparison {
            self.compares(operator.column)?;
        }
        self.pending.push(Pending::Operator(operator));
        Ok(true)
    }

    /// The variable or constant of this name.
    fn named(&mut self, word: Word<'_>) -> Parsed<Operand> {
        let Word { text: name, column, .. } = word;
        if let Some(index) = self.names.iter().position(|known| *known == name) {
            return Ok(self.tree.variable(index, name, column));
        }
        if let Some(value) = constant(name) {
            return Ok(Operand::Constant(value));
        }
        if let Some(function) = Function::named(name) {
            return mistake(column, MistakeKind::FunctionWithoutBracket(function.name()));
        }
        let kind = MistakeKind::UnknownVariable {
            name: name.to_string(),
            names: self.names.iter().filter(|name| !name.is_empty()).map(ToString::to_string).collect(),
            nearest: nearest(name, self.names.iter().copied()).map(ToString::to_string),
        };
        mistake(column, kind)
    }

    /// Takes the name of a function, whose bracket is open.
    fn function(&mut self, word: Word<'_>) -> Parsed<bool> {
        let Word { text: name, column, .. } = word;
        let Some(function) = Function::named(name) else {
            let variable = self.names.contains(&name) || constant(name).is_some();
            let (name, nearest) = (name.to_string(), Function::nearest(name));
            let unknown = MistakeKind::UnknownFunction { name: name.clone(), nearest };
            return mistake(column, if variable { MistakeKind::NotAFunction(name) } else { unknown });
        };
        self.open(Some(function), column)?;
        Ok(true)
    }

    fn open(&mut self, function: Option<Function>, column: usize) -> Parsed<()> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return mistake(column, MistakeKind::TooDeep);
        }
        self.pending.push(Pending::Bracket(Bracket { function, column, arguments: 0, compares: false }));
        Ok(())
    }

    /// The innermost bracket, once no operator is pending within it.
    fn bracket(&mut self) -> Option<&mut Bracket> {
        match self.pending.last_mut() {
            Some(Pending::Bracket(bracket)) => Some(bracket),
            _ => None,
        }
    }

    /// A comparison begins: it may only in the first argument of `if`, once.
    fn compares(&mut self, column: usize) -> Parsed<()> {
        match self.bracket() {
            Some(bracket) if bracket.may_compare() => {
                bracket.compares = true;
                Ok(())
            }
            _ => mistake(column, MistakeKind::ComparisonOutsideIf),
        }
    }

    fn comma(&mut self, column: usize) -> Parsed<()> {
        self.reduce(Precedence::Comparison)?;
        match self.bracket() {
            Some(bracket) if bracket.function.is_some() => {
                bracket.arguments += 1;
                if bracket.lacks_comparison() {
                    return mistake(bracket.column, MistakeKind::ComparisonMissing);
                }
                Ok(())
            }
            _ => mistake(column, MistakeKind::CommaOutsideFunction),
        }
    }

    /// Closes the innermost bracket, whose last argument is complete, or there is none.
    fn close(&mut self, column: usize, last: usize) -> Parsed<()> {
        self.reduce(Precedence::Comparison)?;
        let Some(Pending::Bracket(mut bracket)) = self.pending.pop() else {
            return mistake(column, MistakeKind::UnopenedBracket);
        };
        self.depth -= 1;
        bracket.arguments += last;
        let Some(function) = bracket.function else { return Ok(()) };
        let (wanted, given) = (function.arguments, bracket.arguments);
        if given < wanted || (given > wanted && !function.or_more) {
            let (function, or_more) = (function.name(), function.or_more);
            let kind = MistakeKind::WrongArgumentCount { function, wanted, or_more, given };
            return mistake(bracket.column, kind);
        }
        let arguments = self.values.split_off(self.values.len().saturating_sub(given));
        let value = self.call(function, &arguments, bracket.column)?;
        self.values.push(value);
        Ok(())
    }

    /// A function's value; of more arguments than it takes, it is taken of two at a time.
    fn call(&mut self, function: Function, arguments: &[Operand], column: usize) -> Parsed<Operand> {
        match *arguments {
            [a] => self.tree.push(function.op, [a, NONE, NONE], column),
            [a, b, c] if !function.or_more => self.tree.push(function.op, [a, b, c], column),
            [first, ref others @ ..] => {
                others.iter().try_fold(first, |value, other| self.tree.push(function.op, [value, *other, NONE], column))
            }
            [] => Ok(NONE),
        }
    }

    /// Completes the pending operators that bind as tightly as this; powers are completed from the right.
    fn reduce(&mut self, precedence: Precedence) -> Parsed<()> {
        while let Some(&Pending::Operator(operator)) = self.pending.last() {
            if operator.precedence < precedence || precedence == Precedence::Power {
                break;
            }
            self.pending.pop();
            let b = self.values.pop().unwrap_or(NONE);
            let operands = match operator.op {
                Op::Neg => [b, NONE, NONE],
                _ => {
                    let a = self.values.pop().unwrap_or(NONE);
                    if operator.swapped { [b, a, NONE] } else { [a, b, NONE] }
                }
            };
            let value = self.tree.push(operator.op, operands, operator.column)?;
            self.values.push(value);
        }
        Ok(())
    }

    /// The end of the text, after a value.
    fn complete(mut self) -> Parsed<Tree> {
        self.reduce(Precedence::Comparison)?;
        if let Some(bracket) = self.bracket() {
            return mistake(bracket.column, MistakeKind::UnclosedBracket);
        }
        self.tree.root = self.values.pop().unwrap_or(NONE);
        Ok(self.tree)
    }
}

const fn mistake<T>(column: usize, kind: MistakeKind) -> Parsed<T> {
    Err(Mistake { column, kind })
}
