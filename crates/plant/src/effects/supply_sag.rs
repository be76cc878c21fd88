//! Supply sag: the supply gives way under load, and recovers.
//!
//! ```text
//! a = −share·s      ds/dt = (A − s)/τ      a, s in mm/s², τ in s
//! ```
//!
//! A: the acceleration that the fan's air would give, about hover. A step of the duty acts in full at first and loses
//! `share` of itself over τ; below hover the supply rises likewise. Linear: leaves out that the thrust goes with a power
//! of the voltage.
//! Source: a battery as a source behind a resistor in series with a resistor and a capacitor in parallel (its first-order
//! Thévenin model), of which the slow part is kept: the fast part is a gain.
//!
//! Bounds: cells recover over seconds and over minutes (Chen and Rincón-Mora, IEEE Trans. Energy Conversion 21, 2006);
//! what is faster than 1 s is part of the gain or of the fan's lag. A resistance R gives the voltage V = V₀/(1 + k·D²)
//! at the duty D of a chopper, and the force goes with D·V. A voltage that sags by s at hover therefore loses the share
//! 2·s of a small step. A lithium cell is empty at 3.0 of 3.7 V, s = 0.19, and a Raspberry Pi warns at 4.63 of 5 V,
//! s = 0.07; more than s = 1/4 is no supply.

use crate::acts::{Acts, OwnStates};
use crate::effect::{Effect, Entry, Form, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The fan loses a share of its force some time after a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupplySag {
    /// The share of a step of force that is lost in the end.
    pub share: f64,
    /// τ: time constant of the loss and of the recovery, seconds.
    pub recovery_s: f64,
}

impl Effect for SupplySag {
    const ENTRY: Entry = Entry {
        name: "supply_sag",
        stage: Stage::Actuator,
        article: "a ",
        params: &[
            Param { name: "share", min: 0.0, max: 0.5, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "recovery_s", min: 1.0, max: 100.0, neutral: Neutral::Any(2.0), scale: Scale::Value },
        ],
        sizes: &[&[0.2, 2.0], &[0.4, 2.0]],
        start: Start::Values(&[&[0.2, 2.0], &[0.2, 8.0]]),
        form: Form::Approximate,
        in_a_log: "after a step up the ball rises as it should and then sinks without a change of duty; after a step down it creeps up again",
        mend: "a stiffer supply, a larger capacitor at the fan, thicker wires; an integral term in the controller",
        similar: &[
            Similar {
                name: "hover_drift",
                distinguished_by: "the duty that holds the ball moves after every large step and returns; a drift goes one way: fly large steps, each held for some seconds",
            },
            Similar {
                name: "fan_lag",
                distinguished_by: "a step acts at once and in full, and is lost slowly; behind a lag it comes slowly and stays: fly steps of duty",
            },
            Similar {
                name: "gain_drift",
                distinguished_by: "the first moments after a step have the same gain throughout the flight: compare equal steps early and late",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        own_states: Some(OwnStates {
            count: 1,
            rates: |sag, now| [(now.fan_mm_per_s2 - now.own[0]) / sag.recovery_s, 0.0],
            settled: |_, now| [now.fan_mm_per_s2, 0.0],
            spread: |_, now| [now.gain_mm_per_s2_per_percent * now.hover_duty_percent.abs().max(1.0), 0.0],
        }),
        force: Some(|sag, now| -sag.share * now.own[0]),
        is_linear: true,
        ..Acts::NONE
    };

    values_in_order!(share, recovery_s);
}

#[cfg(test)]
mod tests {
    use super::SupplySag;
    use crate::effects::Effects;
    use crate::model::{Model, tests::thesis};
    use crate::motion::{Input, Motion};

    #[test]
    fn a_step_loses_its_share_along_an_exponential_and_the_ball_moves_as_the_closed_form_says() {
        let sag = SupplySag { share: 0.5, recovery_s: 1.5 };
        let effects = Effects { supply_sag: Some(sag), ..Effects::default() };
        let model = Model { effects, drag_per_s: 0.0, ..thesis() };
        let (step, t) = (100.0, 3.0);
        let end = (0..300)
            .fold(Motion::at_rest(1e5, 0.0), |motion, _| motion.step_in_endless_pipe(&model, Input::of(step), 0.01));
        let tau = sag.recovery_s;
        let decay = (-t / tau).exp();
        let (state, speed) = (step * (1.0 - decay), step * (t - sag.share * (t - tau * (1.0 - decay))));
        assert!((end.own[0] - state).abs() < 1e-6, "{}, exact {state}", end.own[0]);
        assert!((end.velocity_mm_per_s - speed).abs() < 1e-6, "{}, exact {speed}", end.velocity_mm_per_s);
    }

    #[test]
    fn a_ball_at_rest_under_a_settled_supply_stays_there_at_an_end() {
        let effects = Effects { supply_sag: Some(SupplySag { share: 0.5, recovery_s: 1.0 }), ..Effects::default() };
        let model = Model { effects, ..thesis() };
        let rest = model.at_rest(0.0, -80.0);
        assert_eq!(rest.own[0], -80.0);
        let held = (0..100).fold(rest, |motion, _| motion.step(&model, Input::of(-100.0), 0.01));
        assert_eq!(held.position_mm, 0.0);
        let exact = -100.0 + 20.0 * (-1.0_f64).exp();
        assert!((held.own[0] - exact).abs() < 1e-6, "{}, exact {exact}", held.own[0]);
    }
}
