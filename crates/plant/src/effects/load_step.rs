//! Load step: the duty that holds the ball changes at one moment, and stays.
//!
//! ```text
//! u = duty − hover − percent·min(1, max(0, t − at)/0.2 s)     u, duty, hover, percent in percent; t, at in s from the start
//! ```
//!
//! A jump would have no derivative by its time. A load that also adds inertia lowers the gain from then on; that is not
//! modelled.
//! Source: a constant load torque that is switched on, the usual disturbance in tests of a drive.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// Time in which the load comes on, seconds. Chosen by hand: as fast as a hand puts a weight down.
const RAMP_S: f64 = 0.2;

/// The duty at hover changes once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadStep {
    /// When the load begins to act, seconds from the start of the record.
    pub at_s: f64,
    /// Rise of the hover duty, percent.
    pub percent: f64,
}

impl Effect for LoadStep {
    const ENTRY: Entry = Entry {
        name: "load_step",
        stage: Stage::Actuator,
        article: "a ",
        params: &[
            Param { name: "at_s", min: 0.0, max: 1e6, neutral: Neutral::Any(10.0), scale: Scale::Moment(RAMP_S) },
            Param { name: "percent", min: -100.0, max: 100.0, neutral: Neutral::At(0.0), scale: Scale::Value },
        ],
        sizes: &[&[20.0, 1.0], &[20.0, -1.0]],
        start: Start::Jump,
        shown_at: Some(&[20.0, 2.0]),
        in_a_log: "the duty that holds the ball changes at one moment, and does not change back",
        mend: "take the load off, or fix what came loose; give the controller an integral term; leave the step out of a \
             model for other records, which have it at other times",
        similar: &[
            Similar {
                name: "hover_drift",
                distinguished_by: "a drift goes on through the whole log; a step is over in a second. Hold one height \
                     for minutes",
            },
            Similar {
                name: "turbulence",
                distinguished_by: "turbulence averages out; after a step the hover duty stays where it is. Hold one \
                     height for minutes",
            },
            Similar {
                name: "height_dependent_flow",
                distinguished_by: "the hover duty differs between two visits to the same height. Return to the first \
                     height after the step",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { shifts_hover: Some(Self::shift_percent), ..Acts::NONE };

    values_in_order!(at_s, percent);
}

impl LoadStep {
    /// How far the hover duty has moved by `time_s`, percent.
    #[must_use]
    pub fn shift_percent(&self, time_s: f64) -> f64 {
        self.percent * ((time_s - self.at_s) / RAMP_S).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::LoadStep;

    #[test]
    fn the_hover_duty_stays_where_the_load_moved_it() {
        let load = LoadStep { at_s: 5.0, percent: -2.0 };
        let by = |time_s: f64| load.shift_percent(time_s);
        assert_eq!([by(0.0), by(5.0), by(5.2 + 1e-9), by(1e4)], [0.0, 0.0, -2.0, -2.0]);
        assert!((by(5.1) + 1.0).abs() < 1e-9);
    }
}
