//! The third pole from the critical gain: the fan lag at which the model's loop has the measured critical gain.
//!
//! ```text
//! K_u(τ) = the measured K_u        PI controller with T_i, model with lag τ; K_u falls as τ rises
//! ```
//!
//! In continuous time, or sampled as in the firmware, with the dead times of the model. Without dead times the
//! continuous lag has a closed form, [`control::design::critical::third_pole`].
//! Source: the conclusion of the thesis, which proposes the method but does not use it.

use control::design::critical::{Limit, critical_gain};
use control::design::law::Gains;
use control::design::{DesignError, Linear};

/// Range of the search for the lag, seconds.
const SHORTEST_S: f64 = 1e-4;
const LONGEST_S: f64 = 10.0;
/// Bisections of the logarithm between them: far below a digit.
const HALVINGS: usize = 60;

/// The fan lag, seconds, at which `plant` with a PI controller of `ti_s` has the critical gain `measured`, control
/// value per mm. The plant's own fan lag is ignored. `period_s`: sampling period; `None` for continuous time.
///
/// # Errors
/// [`DesignError::NoThirdPole`]: no lag fits. [`DesignError::DelayTooLong`] for a sampled loop.
pub fn fan_lag_s(plant: &Linear, ti_s: f64, measured: f64, period_s: Option<f64>) -> Result<f64, DesignError> {
    let none = DesignError::NoThirdPole { critical_gain: measured };
    let (mut short, mut long) = (SHORTEST_S, LONGEST_S);
    if !(measured > 0.0 && ti_s > 0.0) || is_below(plant, ti_s, measured, period_s, short)? {
        return Err(none);
    }
    if !is_below(plant, ti_s, measured, period_s, long)? {
        return Err(none);
    }
    for _ in 0..HALVINGS {
        let middle = (short * long).sqrt();
        if is_below(plant, ti_s, measured, period_s, middle)? { long = middle } else { short = middle }
    }
    Ok((short * long).sqrt())
}

/// Whether the loop with a lag of `lag_s` is unstable at the gain `measured`.
fn is_below(plant: &Linear, ti_s: f64, measured: f64, period_s: Option<f64>, lag_s: f64) -> Result<bool, DesignError> {
    let plant = Linear { fan_lag_s: lag_s, ..*plant };
    let transfer = period_s.map_or_else(|| Ok(plant.continuous()), |period_s| plant.sampled(period_s))?;
    Ok(match critical_gain(&Gains::pi(1.0, ti_s), &transfer) {
        Limit::Never => false,
        Limit::At(gain) => gain < measured,
        Limit::Always => true,
    })
}

#[cfg(test)]
mod tests {
    use super::fan_lag_s;
    use control::design::Linear;
    use control::design::critical::{critical_gain, third_pole};
    use control::design::law::Gains;

    /// The thesis: G_a, G_b and G_c without the fan's pole, and its rig's critical gain at T_i = 15 s.
    const MODELS: [(f64, f64); 3] = [(254.598, 1.889), (423.4, 1.595), (3222.8 / 3.896, 3.896)];

    #[test]
    fn in_continuous_time_the_lag_is_that_of_the_closed_form() {
        for (gain, drag) in MODELS {
            let plant = Linear::two_poles(gain, drag);
            let lag_s = fan_lag_s(&plant, 15.0, 0.038, None).unwrap();
            let exact = 1.0 / third_pole(&plant, 15.0, 0.038).unwrap();
            assert!((lag_s / exact - 1.0).abs() < 1e-9, "{lag_s} s, exact {exact} s");
        }
    }

    #[test]
    fn the_sampled_loop_with_the_lag_is_critical_at_the_measured_gain() {
        for (gain, drag) in MODELS {
            let lag_s = fan_lag_s(&Linear::two_poles(gain, drag), 15.0, 0.038, Some(0.018)).unwrap();
            let with = Linear::three_poles(gain, drag, 1.0 / lag_s).sampled(0.018).unwrap();
            let critical = critical_gain(&Gains::pi(1.0, 15.0), &with).value().unwrap();
            assert!((critical / 0.038 - 1.0).abs() < 1e-6, "{critical}");
        }
    }

    #[test]
    fn a_gain_that_sampling_alone_does_not_bear_has_no_lag() {
        // The sampled G_a without a fan's pole has a critical gain of 0.800.
        let plant = Linear::two_poles(254.598, 1.889);
        assert!(fan_lag_s(&plant, 15.0, 0.81, Some(0.018)).is_err());
        assert!(fan_lag_s(&plant, 15.0, 0.79, Some(0.018)).is_ok());
        assert!(fan_lag_s(&plant, 15.0, -1.0, None).is_err() && fan_lag_s(&plant, 15.0, f64::NAN, None).is_err());
    }
}
