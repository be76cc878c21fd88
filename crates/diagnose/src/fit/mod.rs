//! Maximum a posteriori estimates of parameters from innovations, and their intervals.

pub(crate) mod bounds;
pub(crate) mod derivatives;
pub(crate) mod estimate;
pub(crate) mod held_out;
pub(crate) mod intervals;
pub(crate) mod lag_form;
pub(crate) mod log_likelihood;
pub(crate) mod parameter;
pub(crate) mod profile;
