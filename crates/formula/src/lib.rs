//! Expressions that a user writes for an effect, such as `-k * max(x - start, 0)`: text in, numbers out.
//!
//! ```text
//! text ─ token ─→ tokens ─ parse ─→ Tree ─ program ─→ Program ─→ value, dual, duals
//!                                     ├─ range ─→ interval of the value, or where it is not defined
//!                                     └─ affine ─→ whether it is affine in some variables
//! ```
//!
//! | precedence, loosest first | |
//! |---|---|
//! | comparison, only as the first argument of `if` | `<` `<=` `>` `>=` |
//! | sum | `+` `-` |
//! | product | `*` `/` |
//! | sign | `-`, so that `-x^2` is −(x²) |
//! | power, right-associative | `^`, also `2^-1` |
//! | value | number, variable, `pi`, `( )`, `min max abs sign clamp sqrt exp ln tanh sin cos if` |
//!
//! `no_std`, and nothing panics, recurses, or allocates during evaluation. Mathematics comes from `libm` only and every
//! NaN is the same NaN, so that every target computes the same bits.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod affine;
mod dual;
mod formula;
mod functions;
mod interval;
mod join;
mod mistake;
mod nearest;
mod number;
mod operation;
mod parse;
mod pending;
mod power;
mod program;
mod range;
mod token;
mod tree;
mod undefined;

pub use formula::Formula;
pub use functions::is_free_name;
pub use mistake::{Mistake, MistakeKind};
pub use undefined::Undefined;

/// The most characters that a formula may have.
pub const MAX_CHARACTERS: usize = 500;
/// The most operators and function calls that a formula may have.
pub const MAX_OPERATIONS: usize = 200;
/// How deeply brackets may be nested.
pub const MAX_DEPTH: usize = 64;
