//! The residual of a fitted model: whether it is significant, and where it lies.

pub(crate) mod constancy;
pub(crate) mod location;
pub(crate) mod misfit;
pub(crate) mod orthogonal;
pub(crate) mod plots;
pub(crate) mod score_test;
pub(crate) mod significance;
pub(crate) mod spectrum;
