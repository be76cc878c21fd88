//! Gain drift: the gain of the fan changes over the log.
//!
//! ```text
//! gain' = gain·(1 + rate·t)      rate in fractions per s, t in s from the start of the record
//! ```
//!
//! A straight line: warming up, which levels off, is one only over a short record.
//! Source: supply voltage and air density enter the gain as factors; a battery falls about linearly.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The gain grows or falls linearly with time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainDrift {
    /// Change of the gain per second, as a fraction of the gain at the start.
    pub fraction_per_s: f64,
}

impl Effect for GainDrift {
    const ENTRY: Entry = Entry {
        name: "gain_drift",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param {
            name: "fraction_per_s",
            min: -0.1,
            max: 0.1,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.002], &[-0.002]],
        start: Start::OverRecord(&[0.2, -0.2]),
        shown_at: Some(&[-0.006]),
        in_a_log: "the same step of duty moves the ball further or less far late in the log than early",
        mend: "use a regulated supply for the fan, let the rig warm up first, or identify the gain before each flight; \
             leave the drift out of a model for other records, which drift by other amounts",
        similar: &[Similar {
            name: "hover_drift",
            distinguished_by: "with gain drift the hover duty stays and the response to steps changes. Fly the same \
                 steps about hover early and late",
        }],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { gain_by_time: Some(Self::gain_factor), ..Acts::NONE };

    values_in_order!(fraction_per_s);
}

impl GainDrift {
    /// What the gain is multiplied by at `time_s`.
    #[must_use]
    pub fn gain_factor(&self, time_s: f64) -> f64 {
        1.0 + self.fraction_per_s * time_s
    }
}
