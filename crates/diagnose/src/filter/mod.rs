//! From a model and a recording to innovations: the extended Kalman filter along the recorded duty.

pub(crate) mod censored;
pub(crate) mod ekf;
pub(crate) mod innovation;
pub(crate) mod missing_force;
pub(crate) mod refresh;
pub(crate) mod run;
pub(crate) mod tachometer;
pub(crate) mod track;
