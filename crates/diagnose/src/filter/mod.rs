//! Innovations of a model on a recording: the extended Kalman filter with the recorded duty as its input.

pub(crate) mod censored;
pub(crate) mod ekf;
pub(crate) mod innovation;
pub(crate) mod missing_force;
pub(crate) mod refresh;
pub(crate) mod run;
pub(crate) mod tachometer;
pub(crate) mod track;
#[cfg(test)]
mod written_support;
