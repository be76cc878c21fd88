//! The words of a formula: numbers, names, operators, brackets, each with its column.

use crate::mistake::{Mistake, MistakeKind};
use alloc::string::ToString;

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    Name,
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Open,
    Close,
    Comma,
}

/// A word and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<'a> {
    pub(crate) token: Token,
    pub(crate) text: &'a str,
    pub(crate) column: usize,
}

/// What is left of the text. All before it is ASCII, so that bytes count characters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words<'a> {
    rest: &'a str,
    column: usize,
}

impl<'a> Words<'a> {
    pub(crate) const fn new(text: &'a str) -> Self {
        Self { rest: text, column: 1 }
    }

    /// The column of what comes next, or the one after the last character.
    pub(crate) fn column(&mut self) -> usize {
        let text = self.rest.trim_ascii_start();
        self.column += self.rest.len() - text.len();
        self.rest = text;
        self.column
    }

    /// Whether a bracket opens next; goes past it.
    pub(crate) fn open(&mut self) -> bool {
        self.column();
        let opens = self.rest.starts_with('(');
        if opens {
            self.take(1);
        }
        opens
    }

    /// The next word, none at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Word<'a>>, Mistake> {
        let column = self.column();
        let Some(first) = self.rest.chars().next() else { return Ok(None) };
        if first.is_ascii_digit() || first == '.' {
            return self.number().map(Some);
        }
        if first.is_ascii_alphabetic() || first == '_' {
            let text = self.take(count(self.rest, |byte| byte.is_ascii_alphanumeric() || *byte == b'_'));
            return Ok(Some(Word { token: Token::Name, text, column }));
        }
        let (token, length) = match (first, self.rest.as_bytes().get(1)) {
            ('<', Some(b'=')) => (Token::LessEqual, 2),
            ('>', Some(b'=')) => (Token::GreaterEqual, 2),
            ('<', _) => (Token::Less, 1),
            ('>', _) => (Token::Greater, 1),
            ('+', _) => (Token::Plus, 1),
            ('-', _) => (Token::Minus, 1),
            ('*', _) => (Token::Times, 1),
            ('/', _) => (Token::Over, 1),
            ('^', _) => (Token::Power, 1),
            ('(', _) => (Token::Open, 1),
            (')', _) => (Token::Close, 1),
            (',', _) => (Token::Comma, 1),
            _ => return Err(Mistake { column, kind: MistakeKind::UnknownCharacter(first) }),
        };
        Ok(Some(Word { token, text: self.take(length), column }))
    }

    /// Digits, points, and an exponent with its sign: all that looks like a number, so that a mistake shows all of it.
    fn number(&mut self) -> Result<Word<'a>, Mistake> {
        let column = self.column;
        let mut length = count(self.rest, |byte| byte.is_ascii_digit() || *byte == b'.');
        if let Some(exponent) = self.rest.get(length..).and_then(|rest| rest.strip_prefix(['e', 'E'])) {
            let sign = usize::from(exponent.starts_with(['+', '-']));
            length += 1 + sign + exponent.get(sign..).map_or(0, |digits| count(digits, u8::is_ascii_digit));
        }
        let text = self.take(length);
        let kind = match text.parse::<f64>() {
            Ok(number) if number.is_finite() => return Ok(Word { token: Token::Number(number), text, column }),
            Ok(_) => MistakeKind::NumberTooLarge(text.to_string()),
            Err(_) => MistakeKind::BadNumber(text.to_string()),
        };
        Err(Mistake { column, kind })
    }

    /// Goes past so many ASCII characters.
    fn take(&mut self, length: usize) -> &'a str {
        let (text, rest) = self.rest.split_at_checked(length).unwrap_or((self.rest, ""));
        self.rest = rest;
        self.column += text.len();
        text
    }
}

/// How many bytes at the beginning of `text` are like this.
fn count(text: &str, like: impl Fn(&u8) -> bool) -> usize {
    text.bytes().take_while(like).count()
}
