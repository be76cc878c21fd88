//! Feed-forward of setpoint changes: from the setpoint to a smooth trajectory, and to the control value for it.
//!
//! ```text
//! r = setpoint/(1 + s·T)³                     three lags, exact over any step of a constant setpoint
//! w_r = (r̈ + a·ṙ)/K                           what the fan must give
//! u_r = w_r + τ·ẇ_r                           the command for it, with ẇ_r = (r⃛ + a·r̈)/K
//! ```
//!
//! The feedback then has only to correct the errors of the belief. A PID works best with the derivative on the error:
//! on the measurement it brakes the wanted motion too. Source: Åström & Murray, *Feedback Systems*, "State Feedback",
//! feedforward design.

use crate::believed::Believed;
use crate::check::{OutOfRange, within};
use crate::inputs::Reference;
use libm::exp;

/// How setpoint changes are smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct FeedForward {
    /// T: each of the three lags, seconds. A jump is done to 95 % after 6.3·T.
    pub time_constant_s: f64,
}

/// The state of the trajectory. `None` before the first step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Way {
    lags_mm: Option<[f64; 3]>,
}

impl FeedForward {
    /// Checks the time constant against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names it with its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("time_constant_s", self.time_constant_s, 0.01, 100.0)
    }

    /// The reference `dt_s` after the last one, on the trajectory to `setpoint_mm`, which begins at `here_mm`.
    pub fn step(&self, way: &mut Way, believed: &Believed, setpoint_mm: f64, here_mm: f64, dt_s: f64) -> Reference {
        let t = self.time_constant_s;
        let mut lags = way.lags_mm.unwrap_or([here_mm; 3]);
        // Φ of three equal lags: 1, z, z²/2 with z = t/T, times e^−z, for the remaining differences.
        let z = dt_s / t;
        let faded = exp(-z);
        let [first, second, third] = lags.map(|lag| lag - setpoint_mm);
        lags = [
            setpoint_mm + faded * first,
            setpoint_mm + faded * (second + z * first),
            setpoint_mm + faded * (third + z * second + z * z / 2.0 * first),
        ];
        way.lags_mm = Some(lags);

        let slopes = [(setpoint_mm - lags[0]) / t, (lags[0] - lags[1]) / t, (lags[1] - lags[2]) / t];
        let bends = [(slopes[0] - slopes[1]) / t, (slopes[1] - slopes[2]) / t];
        let jerk = (bends[0] - bends[1]) / t;
        let fan = believed.control_for(bends[1], slopes[2]);
        let rising = believed.fan_lag_s.unwrap_or(0.0) * believed.control_for(jerk, bends[1]);
        Reference { position_mm: lags[2], velocity_mm_per_s: slopes[2], fan, control: fan + rising }
    }
}

#[cfg(test)]
mod tests {
    use super::{FeedForward, Way};
    use crate::believed::{Believed, tests::G_C};
    use nalgebra::vector;

    const SMOOTH: FeedForward = FeedForward { time_constant_s: 0.15 };

    #[test]
    fn the_way_of_a_jump_is_the_closed_form_whatever_the_steps() {
        let mut way = Way::default();
        let mut t = 0.0;
        for dt in [0.02, 0.05, 0.011, 0.3, 0.02] {
            let reference = SMOOTH.step(&mut way, &G_C, 300.0, 200.0, dt);
            t += dt;
            let z = t / 0.15;
            let exact = 300.0 - 100.0 * libm::exp(-z) * (1.0 + z + z * z / 2.0);
            assert!((reference.position_mm - exact).abs() < 1e-9, "{t} s: {reference:?}, exact {exact}");
            let slope = 100.0 * libm::exp(-z) * z * z / 2.0 / 0.15;
            assert!((reference.velocity_mm_per_s - slope).abs() < 1e-9, "{t} s: {reference:?}, exact {slope}");
        }
    }

    #[test]
    fn the_believed_plant_flies_the_way_without_feedback() {
        for model in [G_C, Believed { fan_lag_s: None, ..G_C }] {
            let dt = 1e-4;
            let (mut way, over) = (Way::default(), model.over(dt));
            let mut state = vector![200.0, 0.0, 0.0, 0.0];
            let mut worst: f64 = 0.0;
            for _ in 0..20_000 {
                let reference = SMOOTH.step(&mut way, &model, 300.0, 200.0, dt);
                state = over.apply(&state, reference.control);
                worst = worst.max((state[0] - reference.position_mm).abs());
            }
            assert!(worst < 0.2, "{worst} mm off the way");
        }
    }
}
