//! Parameters that are read directly off the readings, so that no fit moves them.

use crate::record::quantisation::coarse_step;
use crate::record::recording::Recording;
use crate::record::sample_hold::hold;
use plant::{Entry, Model, Start};

/// A value that was read off the readings, and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReadOff {
    pub(crate) value: f64,
    pub(crate) sigma: f64,
}

/// The value of an effect's parameter, read off the readings of a rig that is believed to be `model`. `None`: the
/// readings do not show it.
pub(crate) fn read_off(entry: &Entry, recording: &Recording, model: &Model) -> Option<ReadOff> {
    match entry.start {
        Start::ReadingStep => {
            coarse_step(recording, model).map(|step| ReadOff { value: step.mm, sigma: step.sigma_mm })
        }
        Start::ReadingHold => hold(recording).map(|hold| ReadOff { value: hold.seconds, sigma: hold.sigma_s }),
        _ => None,
    }
}
