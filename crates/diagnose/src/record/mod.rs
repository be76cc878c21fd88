//! Recorded rows of a rig, checked and prepared for a comparison with a model.

pub(crate) mod airborne;
pub(crate) mod check;
pub(crate) mod checks;
pub(crate) mod commanded;
mod corrections;
pub(crate) mod decimate;
mod error;
mod finding;
pub(crate) mod folds;
pub(crate) mod free_flight;
pub(crate) mod implausible;
pub(crate) mod known;
pub(crate) mod prepare;
pub(crate) mod quantisation;
pub(crate) mod read_off;
pub(crate) mod reading_variance;
pub(crate) mod recording;
pub(crate) mod sample_hold;
pub(crate) mod second_sensor;
pub(crate) mod source_columns;
pub(crate) mod stretches;
pub(crate) mod units;
pub(crate) mod usual_speed;
