//! Sensor delay: the reading is old.
//!
//! ```text
//! reading at t = position at t − delay      delay in s
//! ```
//!
//! From a log alone it is the same as a delay of the duty, but for the rows at the very ends of the record.
//! Source: a VL53L0X gives the mean over its timing budget, 20 ms at least, after the budget has passed.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, values_in_order};
use serde::{Deserialize, Serialize};

/// The reading is where the ball was a fixed time ago.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorDelay {
    /// Age of a reading, seconds.
    pub delay_s: f64,
}

impl Effect for SensorDelay {
    const ENTRY: Entry = Entry {
        name: "sensor_delay",
        stage: Stage::Sensor,
        article: "a ",
        params: &[Param { name: "delay_s", min: 0.0, max: 1.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[0.03], &[0.1]],
        twins: &["transport_delay"],
        in_a_log: "the reading follows the duty late by a fixed time, and the loop oscillates at gains at which the \
             simulator is stable",
        mend_elsewhere: "read right after the measurement is ready; a predictor for the delay",
        mend: "a shorter timing budget; read right after the measurement is ready; a predictor for the delay",
        similar: &[
            Similar {
                name: "transport_delay",
                distinguished_by: "duty and position cannot separate them. A second sensor is earlier than a delayed \
                     sensor; a transport delay is the same in both",
            },
            Similar {
                name: "sensor_lag",
                distinguished_by: "a delay shifts fast reversals; a lag makes them smaller and rounder. Move the ball \
                     back and forth fast",
            },
            Similar {
                name: "stale_samples",
                distinguished_by: "delayed readings do not repeat while the ball moves; stale ones do. Look at \
                     successive readings of a fast ball",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        delays_reading: Some(|delay| delay.delay_s),
        linearise: Some(|delay, plant| plant.delay_s += delay.delay_s),
        ..Acts::NONE
    };

    values_in_order!(delay_s);
}

impl SensorDelay {
    /// The instant that a reading at `time_s` shows, seconds.
    #[must_use]
    pub fn seen_at(&self, time_s: f64) -> f64 {
        time_s - self.delay_s
    }
}
