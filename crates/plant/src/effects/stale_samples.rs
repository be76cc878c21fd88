//! Stale samples: the sensor refreshes slower than the loop reads it.
//!
//! ```text
//! reading at t = reading at hold·⌊t / hold⌋      hold, t in s
//! ```
//!
//! The sensor's clock starts with the record. Leaves out that it runs a little off the loop's.
//! Source: a VL53L0X keeps its last range until the next timing budget has passed.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use libm::floor;
use serde::{Deserialize, Serialize};

/// A time counts as a refresh this close to it, in holds: 0.06 s is three holds of 0.02 s, in spite of rounding errors.
const ROUNDING: f64 = 1e-9;

/// The reading changes only at the sensor's own instants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StaleSamples {
    /// Time between refreshes, seconds.
    pub hold_s: f64,
}

impl Effect for StaleSamples {
    const ENTRY: Entry = Entry {
        name: "stale_samples",
        stage: Stage::Sensor,
        params: &[Param { name: "hold_s", min: 0.0, max: 2.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[0.04], &[0.1]],
        start: Start::ReadingHold,
        in_a_log: "several successive readings are equal while the ball moves",
        mend: "a shorter timing budget, or a longer period of the loop; use only readings that are marked as fresh",
        similar: &[
            Similar {
                name: "sensor_lag",
                distinguished_by: "a stale reading is constant and then jumps; a lag is smooth. Look at successive \
                     readings of a fast ball",
            },
            Similar {
                name: "sensor_quantisation",
                distinguished_by: "stale values repeat for a fixed time, also with a fast ball; quantised ones repeat \
                     as long as the ball is within a step. Move the ball fast and slowly",
            },
            Similar { name: "sensor_delay", distinguished_by: "stale readings repeat; delayed readings do not" },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        holds: Some(|stale| *stale),
        linearise: Some(|stale, plant| plant.delay_s += stale.hold_s / 2.0),
        ..Acts::NONE
    };

    values_in_order!(hold_s);
}

impl StaleSamples {
    /// When the reading that stands at `time_s` was taken, seconds.
    #[must_use]
    pub fn refreshed_at(&self, time_s: f64) -> f64 {
        let exact = self.hold_s * floor(time_s / self.hold_s + ROUNDING);
        if self.hold_s > 0.0 { exact.min(time_s) } else { time_s }
    }
}

#[cfg(test)]
mod tests {
    use super::StaleSamples;

    #[test]
    fn a_refresh_is_not_missed_by_rounding() {
        let stale = StaleSamples { hold_s: 0.02 };
        for k in 0..1000 {
            let t = 0.02 * f64::from(k);
            assert!((stale.refreshed_at(t) - t).abs() < 1e-12, "{t} s");
            assert!((stale.refreshed_at(t + 0.019) - t).abs() < 1e-12, "{t} s");
        }
    }
}
