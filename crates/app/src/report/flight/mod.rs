//! A flight in a few numbers.

pub mod signals;
pub mod summary;
