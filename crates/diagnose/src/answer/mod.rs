//! The answer: the verdict, where the gap lies, and what a report draws.

pub(crate) mod closed_loop;
pub(crate) mod diagnosis;
pub(crate) mod document;
pub(crate) mod intervals;
pub(crate) mod patch;
pub(crate) mod sentences;
pub(crate) mod series;
pub(crate) mod stages;
