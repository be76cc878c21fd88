//! Hover drift: the duty that holds the ball ramps.
//!
//! ```text
//! u = duty − hover − rate·t      u, duty, hover in percent; rate in percent per s; t in s from the start of the record
//! ```
//!
//! A straight line: warming up, which levels off, is one only over a short record.
//! Source: motor temperature and supply voltage shift the speed at a given duty.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The duty at hover grows or falls linearly with time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoverDrift {
    /// Rise of the hover duty, percent per second.
    pub percent_per_s: f64,
}

impl Effect for HoverDrift {
    const ENTRY: Entry = Entry {
        name: "hover_drift",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param { name: "percent_per_s", min: -1.0, max: 1.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[0.002], &[-0.002]],
        start: Start::OverRecord(&[0.2, -0.2]),
        shown_at: Some(&[0.006]),
        in_a_log: "the mean duty that holds the ball rises or falls over the log",
        mend: "let the rig warm up first, use a regulated supply for the fan, and give the controller an integral \
             term; leave the drift out of a model for other records, which drift by other amounts",
        similar: &[
            Similar {
                name: "gain_drift",
                distinguished_by: "with hover drift the hover duty changes and the response to steps stays. Fly the \
                     same steps early and late",
            },
            Similar {
                name: "height_dependent_flow",
                distinguished_by: "the hover duty differs between two visits to the same height. Return to the first \
                     height at the end",
            },
            Similar {
                name: "turbulence",
                distinguished_by: "drift goes in one direction through the whole log; turbulence averages out. Hold \
                     one height for minutes",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { shifts_hover: Some(Self::shift_percent), ..Acts::NONE };

    values_in_order!(percent_per_s);
}

impl HoverDrift {
    /// How far the hover duty has moved by `time_s`, percent.
    #[must_use]
    pub fn shift_percent(&self, time_s: f64) -> f64 {
        self.percent_per_s * time_s
    }
}
