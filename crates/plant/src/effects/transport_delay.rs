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
        in_a_log: "after every change of duty nothing happens for a fixed time, then the response is as modelled",
        mend_elsewhere: "write the input right after the reading, and send it with less buffering; or reduce the gain",
        mend: "write the duty right after the reading, raise the PWM frequency, shorten the distance from fan to ball; \
             or reduce the gain",
        similar: &[
            Similar {
                name: "sensor_delay",
                distinguished_by: "duty and position cannot separate them. A second sensor is late as well with a \
                     transport delay, and on time with a sensor delay",
            },
            Similar {
                name: "fan_lag",
                distinguished_by: "after a step of duty the force of a delayed fan begins late and at its full size; \
                     with a lag it begins at once and grows. Fly steps",
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
