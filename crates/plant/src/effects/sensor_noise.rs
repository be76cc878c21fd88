//! Sensor noise: the readings scatter more than is believed.
//!
//! ```text
//! σ = √(believed² + extra²)      all in mm
//! ```
//!
//! White and normal, one number a reading. Leaves out that the scatter of a time-of-flight sensor grows with the
//! distance and with ambient light.
//! Source: independent errors add in quadrature; a VL53L0X on a public rig has 2.5 to 3.5 mm.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, InColumn, Neutral, Param, Scale, Similar, Stage, values_in_order};
use libm::hypot;
use serde::{Deserialize, Serialize};

/// Noise of the readings beyond the model's own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of the extra noise of one reading, mm.
    pub sigma_mm: f64,
}

impl Effect for SensorNoise {
    const ENTRY: Entry = Entry {
        name: "sensor_noise",
        stage: Stage::Sensor,
        params: &[Param { name: "sigma_mm", min: 0.0, max: 100.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[1.5], &[4.0]],
        in_columns: &[InColumn::PositionDifference],
        in_a_log: "readings of a ball at rest scatter more than configured, from one reading to the next",
        mend_elsewhere: "more averaging in the sensor, shielded cables; a slower filter in the controller",
        mend: "a longer timing budget, a white ball, less ambient light; a slower filter in the controller",
        similar: &[
            Similar {
                name: "turbulence",
                distinguished_by: "sensor noise is there with the ball at rest and the fan off, and successive \
                     readings are uncorrelated. Fly `airball measure noise-floor`",
            },
            Similar {
                name: "sensor_quantisation",
                distinguished_by: "a ball at rest gives many values instead of one or two. Fly `airball measure \
                     noise-floor`",
            },
            Similar {
                name: "sensor_outliers",
                distinguished_by: "noise scatters every reading; outliers are a few readings far from the others. Look \
                     at a ball at rest",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { spreads: Some(Self::total_mm), ..Acts::NONE };

    values_in_order!(sigma_mm);
}

impl SensorNoise {
    /// Standard deviation of one reading in all, mm, where `believed_mm` is the model's.
    #[must_use]
    pub fn total_mm(&self, believed_mm: f64) -> f64 {
        hypot(believed_mm, self.sigma_mm)
    }
}
