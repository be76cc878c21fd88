//! Sensor outliers: now and then a reading is wild.
//!
//! ```text
//! reading' = reading + size      with probability p/2        sizes in mm
//! reading' = reading − size      with probability p/2
//! ```
//!
//! Independent from reading to reading, and all of one size; real ones come in runs and sizes.
//! Source: a time-of-flight sensor sees the wall or a second path instead of the ball.

use crate::acts::{Acts, Readings, is_beyond_the_noise};
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// Some readings are off by a fixed amount, up or down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorOutliers {
    /// p: the chance that a reading is wild.
    pub probability: f64,
    /// How far a wild reading is off, mm.
    pub size_mm: f64,
}

impl Effect for SensorOutliers {
    const ENTRY: Entry = Entry {
        name: "sensor_outliers",
        stage: Stage::Sensor,
        params: &[
            Param { name: "probability", min: 0.0, max: 1.0, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "size_mm", min: 0.0, max: 2000.0, neutral: Neutral::Any(0.0), scale: Scale::Value },
        ],
        sizes: &[&[0.01, 30.0]],
        start: Start::Values(&[&[0.015, 20.0], &[0.015, 40.0], &[0.015, 80.0], &[0.015, 160.0]]),
        shown_at: Some(&[0.02, 60.0]),
        in_a_log: "single readings jump away and back faster than a ball can move, and the duty has spikes",
        mend_elsewhere: "shield sensor and cable; reject implausible readings (gate of the observer)",
        mend: "narrow the field of view of the sensor, darken the pipe; reject implausible readings (gate of the \
             observer)",
        similar: &[
            Similar {
                name: "sensor_noise",
                distinguished_by: "most readings have the modelled noise and a few are far off. Look at a ball at rest",
            },
            Similar {
                name: "turbulence",
                distinguished_by: "after an outlier the next reading is back at the path of the ball; a force on the \
                     ball acts for longer",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> =
        Acts { outliers: Some(|wild| *wild), can_show: Some(Self::is_beyond_the_noise), ..Acts::NONE };

    values_in_order!(probability, size_mm);
}

impl SensorOutliers {
    /// Whether the wild readings are no tails of the noise.
    #[must_use]
    pub fn is_beyond_the_noise(&self, readings: &Readings) -> bool {
        is_beyond_the_noise(self.size_mm, readings.sigma_mm)
    }

    /// What is added to a reading, mm, by a number `uniform` in [0, 1).
    #[must_use]
    pub fn offset_mm(&self, uniform: f64) -> f64 {
        if uniform < self.probability / 2.0 {
            -self.size_mm
        } else if uniform < self.probability {
            self.size_mm
        } else {
            0.0
        }
    }
}
