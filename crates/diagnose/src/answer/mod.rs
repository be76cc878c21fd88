//! The answer: the verdict, where the gap lies, and what a report draws.

pub(crate) mod diagnosis;
pub(crate) mod intervals;
pub(crate) mod series;
pub(crate) mod stages;
