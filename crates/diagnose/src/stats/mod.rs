//! Statistics without physics.

pub(crate) mod chi_square;
pub(crate) mod line;
pub(crate) mod log_sum;
pub(crate) mod median;
pub(crate) mod quantile;
pub(crate) mod spread;
pub(crate) mod student;
