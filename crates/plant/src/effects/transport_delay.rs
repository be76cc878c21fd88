//! Transport delay: the duty acts later, unchanged.
//!
//! ```text
//! duty in force at t = duty written by t − delay      delay in s
//! ```
//!
//! Leaves out that the air column smears a change while it carries it. From a log alone it is the same as
//! a delay of the sensor, but for the rows at the very ends of the record.
//! Source: PWM period, driver and the way of the air from fan to ball, as one dead time.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, values_in_order};
use serde::{Deserialize, Serialize};

/// The duty acts a fixed time after it was written.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransportDelay {
    /// Dead time, seconds.
    pub delay_s: f64,
}

impl Effect for TransportDelay {
    const ENTRY: Entry = Entry {
        name: "transport_delay",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param { name: "delay_s", min: 0.0, max: 1.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[0.03], &[0.1]],
        twins: &["sensor_delay"],
        represents_its_stage: Some(1),
        in_a_log: "nothing happens for a fixed time after every change of duty, then the answer is as it should be",
        mend: "write the duty right after the reading, raise the PWM frequency, shorten the way from fan to ball; or less gain",
        similar: &[
            Similar {
                name: "sensor_delay",
                distinguished_by: "duty and position alone cannot tell: a second sensor shows the ball late as well here, and on time there",
            },
            Similar {
                name: "fan_lag",
                distinguished_by: "the answer to a step of duty begins after a pause and is whole at once; a lag begins at once and grows: fly steps",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        delays_duty: Some(|delay| delay.delay_s),
        linearise: Some(|delay, plant| plant.delay_s += delay.delay_s),
        ..Acts::NONE
    };

    values_in_order!(delay_s);
}

impl TransportDelay {
    /// When a duty that is written at `written_s` begins to act, seconds.
    #[must_use]
    pub fn acts_at(&self, written_s: f64) -> f64 {
        written_s + self.delay_s
    }
}
