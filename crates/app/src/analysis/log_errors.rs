//! The forecast error of each of several logs, before and after the correction: a log that the correction does not help
//! is not of the same rig, or has something of its own.

use diagnose::{Gap, Recording};
use plant::Model;
use rayon::prelude::*;

/// The place of the horizon in [`Gap::horizons_s`]: 1 s.
const HORIZON: usize = 2;

/// The rms error 1 s ahead of one log, mm; `None`: it is too short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogErrors {
    /// Of the belief.
    pub believed_mm: Option<f64>,
    /// Of the mended model.
    pub mended_mm: Option<f64>,
    /// Of the mended model's noise alone.
    pub floor_mm: Option<f64>,
}

/// The errors of each of several logs; of a single one, none: they are those of the diagnosis.
#[must_use]
pub fn log_errors(belief: &Model, mended: &Model, recordings: &[Recording]) -> Vec<LogErrors> {
    if recordings.len() < 2 {
        return Vec::new();
    }
    let one = |recording: &Recording| {
        let (before, after) = (Gap::measure(belief, recording), Gap::measure(mended, recording));
        LogErrors {
            believed_mm: before.error_mm[HORIZON],
            mended_mm: after.error_mm[HORIZON],
            floor_mm: after.floor_mm[HORIZON],
        }
    };
    recordings.par_iter().map(one).collect()
}
