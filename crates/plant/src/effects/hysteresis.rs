//! Hysteresis: there is play between the duty and the force.
//!
//! ```text
//! p ← u + h    p > u + h             u: duty about hover, p: what the force follows, both in percent
//! p ← u − h    p < u − h             h: half the width of the play, percent
//! p            in between
//! ```
//!
//! Starts centred, p = u. Leaves out minor loops of any other shape: everything inside the play is lost.
//! Source: the play operator, Krasnosel'skii and Pokrovskii, *Systems with Hysteresis*, chapter 1.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Form, InColumn, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The force follows the duty only when it has pushed through the play.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hysteresis {
    /// Half the width of the play, percent of duty.
    pub half_width_percent: f64,
}

impl Effect for Hysteresis {
    const ENTRY: Entry = Entry {
        name: "hysteresis",
        stage: Stage::Actuator,
        params: &[Param {
            name: "half_width_percent",
            min: 0.0,
            max: 100.0,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.1], &[0.3]],
        start: Start::Values(&[&[0.1], &[0.2], &[0.4], &[0.8]]),
        form: Form::Approximate,
        in_columns: &[InColumn::InputDifference],
        in_a_log: "the same duty holds or lifts the ball, depending on whether it was reached from below or above; \
             small reversals of duty have no effect",
        mend_elsewhere: "remove the play between actuator and load; dither wider than the hysteresis",
        mend: "a fan driver that controls the speed by the tachometer; dither wider than the hysteresis",
        similar: &[
            Similar {
                name: "dead_zone",
                distinguished_by: "hysteresis is flat after every reversal of the duty, a dead zone only at hover. \
                     Ramp the duty slowly up and down, and compare the two curves",
            },
            Similar {
                name: "wall_friction",
                distinguished_by: "hysteresis depends on the path of the duty: reverse the duty while the ball moves \
                     on, and at first the force does not change; with friction it does",
            },
            Similar {
                name: "fan_lag",
                distinguished_by: "hysteresis is the same however slowly the duty moves; a lag vanishes in a slow ramp",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { plays: Some(Self::follow), ..Acts::NONE };

    values_in_order!(half_width_percent);
}

impl Hysteresis {
    /// Where the play is once the duty about hover has gone straight to `about_hover_percent`.
    #[must_use]
    pub fn follow(&self, play_percent: f64, about_hover_percent: f64) -> f64 {
        let (low, high) =
            (about_hover_percent - self.half_width_percent, about_hover_percent + self.half_width_percent);
        play_percent.max(low).min(high)
    }
}

#[cfg(test)]
mod tests {
    use super::Hysteresis;

    #[test]
    fn a_reversal_is_lost_until_it_has_crossed_the_play() {
        let hysteresis = Hysteresis { half_width_percent: 0.5 };
        let mut play = 0.0;
        for (u, exact) in [(0.4, 0.0), (2.0, 1.5), (1.2, 1.5), (1.0, 1.5), (0.0, 0.5), (0.9, 0.5), (1.5, 1.0)] {
            play = hysteresis.follow(play, u);
            assert!((play - exact).abs() < 1e-12, "{u} % gave {play}, exact {exact}");
        }
    }
}
