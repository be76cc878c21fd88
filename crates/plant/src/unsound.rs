//! What can be wrong with the numbers of a model. The reader of the config file adds file and line.

use control::OutOfRange;

/// Why a model cannot be flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsound {
    /// A number is outside its bounds.
    Range(OutOfRange),
    /// Two numbers or two effects exclude each other.
    Contradiction {
        /// One of the keys, empty when it is the whole table.
        key: &'static str,
        /// What excludes what, and what to do.
        message: &'static str,
    },
    /// Two effects fill the same place of the signal path.
    Exclusive {
        /// The other effect.
        other: &'static str,
    },
}

impl Unsound {
    /// The key of the number within its table, empty when it is the whole table.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::Range(error) => error.key,
            Self::Contradiction { key, .. } => key,
            Self::Exclusive { .. } => "",
        }
    }
}

impl From<OutOfRange> for Unsound {
    fn from(error: OutOfRange) -> Self {
        Self::Range(error)
    }
}

impl std::fmt::Display for Unsound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Range(error) => error.fmt(f),
            Self::Contradiction { message, .. } => f.write_str(message),
            Self::Exclusive { other } => {
                write!(f, "fills the same place of the signal path as {other}; delete one of the two tables")
            }
        }
    }
}
