//! What a person reads and looks at: [`summary`] of a flight, [`gap`] of a replay, and the [`plot`] of both.

pub mod diagnosis;
pub mod gap;
pub mod plot;
pub mod steps;
pub mod summary;
