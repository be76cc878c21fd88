//! Relative airflow: the force goes with the square of the air's speed past the ball.
//!
//! ```text
//! dv/dt = a/(2q)·( (r − q·v)·|r − q·v| − 1 )      r = v_f/v_eq = √(1 + 2·q·A/a), 0 where the root has none
//!       = A − a·r·v + a·q/2·v²                    while the air is faster than the ball
//! ```
//!
//! q = 1/v_eq in s/mm: v_eq is the speed of the air that holds the ball. A: the acceleration that the fan's air gives to
//! a ball at rest, about hover; a: linear drag. At q = 0 this is A − a·v, the linear part of the model, of which a ball
//! at rest feels the same: the air's speed follows from A by the same equation. What is new: the drag grows with the
//! lift, and a fall brakes more than a rise. An air whose speed goes with the duty bends the static force as well: that
//! part is `thrust_curve`.
//! Where it shows: the drag differs from a by the factor r, and a ball of speed v is braked by the share q·v/2 more on
//! its way down than in proportion, and less on its way up. A ping-pong ball has v_eq of 5 to 10 m/s: at 0.5 m/s that
//! share is 2.5 to 5 %. If the air alone carries the ball, a = 2·g/v_eq, and r = √(1 + A/g): fly steps of duty whose A is
//! a large part of g.
//! Source: the thesis, equation 3.1.1.8, which 3.1.1.10 linearises.

use crate::acts::{Acts, Conditions};
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, values_in_order};
use libm::sqrt;
use serde::{Deserialize, Serialize};

/// The force of air that streams past the ball.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelativeAirflow {
    /// q: the inverse of the air's speed that holds the ball, s/mm.
    pub inverse_speed_s_per_mm: f64,
}

impl Effect for RelativeAirflow {
    const ENTRY: Entry = Entry {
        name: "relative_airflow",
        stage: Stage::Air,
        params: &[Param {
            name: "inverse_speed_s_per_mm",
            min: 0.0,
            max: 0.02,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[5e-4], &[2e-3]],
        in_a_log: "the drag is larger than in the simulator at large duties, and smaller at small ones",
        mend_elsewhere: "none, it is physics. Put it into the simulator, or schedule the derivative gain over the \
            input",
        mend: "none, it is the physics of the pipe. Put it into the simulator, or schedule the derivative gain over \
             the duty",
        similar: &[
            Similar {
                name: "thrust_curve",
                distinguished_by: "here the drag changes with the duty and the force on a ball at rest does not; with \
                     a thrust curve it is the reverse. Fly large steps of duty, with fast motion at small and at large \
                     duties",
            },
            Similar {
                name: "quadratic_drag",
                distinguished_by: "here the drag depends on the duty and differs between rise and fall; quadratic drag \
                     depends on the speed alone. Fly fast motion at small and at large duties",
            },
            Similar {
                name: "force_asymmetry",
                distinguished_by: "right after a step of duty the forces up and down are equal; they differ when the \
                     ball moves. Fly pairs of large steps",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> =
        Acts { force: Some(Self::beyond_linear), force_slopes: Some(Self::slopes_beyond_linear), ..Acts::NONE };

    values_in_order!(inverse_speed_s_per_mm);
}

impl RelativeAirflow {
    /// The acceleration beyond A − a·v, mm/s².
    #[must_use]
    pub fn beyond_linear(&self, now: &Conditions) -> f64 {
        let (a, q) = (now.drag_per_s, self.inverse_speed_s_per_mm);
        let (lift, v) = (now.fan_mm_per_s2, now.velocity_mm_per_s);
        let ratio = a * q;
        if ratio <= 0.0 {
            return 0.0;
        }
        let [air, past] = self.air_speeds(now);
        if air > 0.0 && past >= 0.0 {
            // Without a division by a small number.
            return v * (a - air + 0.5 * ratio * v);
        }
        (past * past.abs() - a * a) / (2.0 * ratio) - (lift - a * v)
    }

    /// The derivatives of [`Self::beyond_linear`] by position, velocity and the fan's acceleration.
    fn slopes_beyond_linear(&self, now: &Conditions) -> [f64; 3] {
        if now.drag_per_s * self.inverse_speed_s_per_mm <= 0.0 {
            return [0.0; 3];
        }
        let [air, past] = self.air_speeds(now);
        // Without air there is none that a little more of the fan changes: it has no slope at that kink.
        let by_fan = if air > 0.0 { past.abs() / air } else { 0.0 };
        [0.0, now.drag_per_s - past.abs(), by_fan - 1.0]
    }

    /// The speed of the air, and that past the ball, over v_eq and times the drag, 1/s.
    fn air_speeds(&self, now: &Conditions) -> [f64; 2] {
        let (a, ratio) = (now.drag_per_s, now.drag_per_s * self.inverse_speed_s_per_mm);
        let air = sqrt((a * a + 2.0 * ratio * now.fan_mm_per_s2).max(0.0));
        [air, air - ratio * now.velocity_mm_per_s]
    }
}

#[cfg(test)]
mod tests {
    use super::RelativeAirflow;
    use crate::acts::Conditions;
    use crate::model::tests::thesis;

    /// Equation 3.1.1.8 as it stands.
    fn equation(a: f64, v_eq: f64, v_f: f64, v: f64) -> f64 {
        let past = (v_f - v) / v_eq;
        0.5 * a * v_eq * (past * past.abs() - 1.0)
    }

    #[test]
    fn it_is_the_equation_of_the_thesis_at_every_speed_of_air_and_ball() {
        let (a, v_eq) = (3.9, 1200.0);
        let effect = RelativeAirflow { inverse_speed_s_per_mm: 1.0 / v_eq };
        for v_f in [0.0, 300.0, 1200.0, 2500.0] {
            // The lift is what that air does to a ball at rest.
            let lift = equation(a, v_eq, v_f, 0.0);
            for v in [-900.0, -1.0, 0.0, 1.0, 400.0, 3000.0] {
                let conditions =
                    Conditions { fan_mm_per_s2: lift, velocity_mm_per_s: v, drag_per_s: a, ..thesis().conditions() };
                let (sum, exact) = (lift - a * v + effect.beyond_linear(&conditions), equation(a, v_eq, v_f, v));
                assert!((sum - exact).abs() < 1e-8, "v_f {v_f}, v {v}: {sum}, exact {exact}");
            }
        }
    }

    #[test]
    fn air_cannot_suck_however_little_the_duty() {
        let (a, v_eq) = (3.9, 1200.0);
        let effect = RelativeAirflow { inverse_speed_s_per_mm: 1.0 / v_eq };
        let conditions = Conditions { fan_mm_per_s2: -1e5, drag_per_s: a, ..thesis().conditions() };
        let sum = -1e5 + effect.beyond_linear(&conditions);
        assert!((sum + 0.5 * a * v_eq).abs() < 1e-8, "{sum}");
    }
}
