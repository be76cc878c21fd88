//! A flight in a few numbers, and as a picture.

pub mod plot;
pub mod signals;
pub mod summary;
