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
        in_a_log: "the mean duty of a held ball climbs or falls over the log, and an open-loop flight bends away",
        mend: "let the rig warm up first, regulate the fan's supply, and give the controller an integral term",
        similar: &[
            Similar {
                name: "gain_drift",
                distinguished_by: "the duty that holds the ball moves, its steps about that duty do what they did: fly the same steps early and late",
            },
            Similar {
                name: "height_dependent_flow",
                distinguished_by: "the duty that holds the ball differs between two visits to one height: come back to the first height at the end",
            },
            Similar {
                name: "turbulence",
                distinguished_by: "it goes one way at one pace through the whole log; turbulence comes back: hold one height for minutes",
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
