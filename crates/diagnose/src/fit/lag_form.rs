//! The lags of a model, and what stands for the form of each.
//!
//! No rig's lag is quite of first order: of two lags in series, the small one comes to something else that is late on the same side of the ball.

use plant::Effects;

/// Effects that are a lag, and what else is late on their side of the ball.
pub(crate) const LAGS: [(&str, &str); 3] =
    [("fan_lag", "transport_delay"), ("spin_asymmetry", "transport_delay"), ("sensor_lag", "sensor_delay")];

/// How late an effect makes things, seconds: the mean of its numbers; 0 where it is off.
pub(crate) fn late_s(effects: &Effects, name: &str) -> f64 {
    effects.values(name).map_or(0.0, |numbers| numbers.iter().sum::<f64>() / numbers.len().max(1) as f64)
}

/// The share of a lag that its form is known to within: rotor and column of air are two lags in series, and the small one is late by its length.
const FORM_OF_A_LAG: f64 = 0.05;

/// How far the form of lag `name` may make things late beyond its first order, seconds: a standard deviation.
pub(crate) fn form_s(effects: &Effects, name: &str) -> f64 {
    FORM_OF_A_LAG * late_s(effects, name)
}

/// How far a delay may stand for the forms of the lags beside it, seconds: a standard deviation; 0 of what is no delay.
pub(crate) fn forms_beside_s(effects: &Effects, name: &str) -> f64 {
    let is_delay = LAGS.iter().any(|(_, late)| *late == name);
    if is_delay { LAGS.iter().map(|(lag, _)| form_s(effects, lag).powi(2)).sum::<f64>().sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::forms_beside_s;
    use plant::Effects;

    #[test]
    fn a_delay_may_stand_for_the_form_of_any_lag_and_nothing_else_does() {
        let mut effects = Effects::default();
        effects.set("fan_lag", &[0.2]);
        effects.set("sensor_lag", &[0.1]);
        let both_s = 0.05 * 0.2_f64.hypot(0.1);
        for delay in ["transport_delay", "sensor_delay"] {
            assert!((forms_beside_s(&effects, delay) - both_s).abs() < 1e-12, "{delay}");
            assert_eq!(forms_beside_s(&Effects::default(), delay), 0.0);
        }
        assert_eq!(forms_beside_s(&effects, "dead_zone"), 0.0);
    }
}
