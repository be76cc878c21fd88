//! The lags of a model, and what stands for the form of each.
//!
//! No rig's lag is quite of first order: of two lags in series, the small one comes to a dead time on the same side of the ball.

use plant::{Effects, Entry, Late};

/// The effects of the catalogue that are a lag.
pub(crate) fn lags() -> impl Iterator<Item = &'static Entry> {
    Effects::CATALOGUE.iter().filter(|entry| entry.acts.late == Some(Late::Lag))
}

/// The effect that stands for what a lag lacks of its form: the dead time of the same stage.
pub(crate) fn dead_time_beside(lag: &Entry) -> Option<&'static Entry> {
    Effects::CATALOGUE.iter().find(|entry| entry.acts.late == Some(Late::DeadTime) && entry.stage == lag.stage)
}

/// The share of a lag that its form is known to within: rotor and column of air are two lags in series, and the small one is late by
/// its length.
const FORM_OF_A_LAG: f64 = 0.05;

/// How far the form of a lag may make things late beyond its first order, seconds: a standard deviation.
pub(crate) fn form_s(effects: &Effects, lag: &Entry) -> f64 {
    FORM_OF_A_LAG * effects.late_s(lag.name)
}

/// How far a dead time may stand for the forms of the lags beside it, seconds: a standard deviation; 0 of what is no dead time.
pub(crate) fn forms_beside_s(effects: &Effects, entry: &Entry) -> f64 {
    let is_dead_time = entry.acts.late == Some(Late::DeadTime);
    if is_dead_time { lags().map(|lag| form_s(effects, lag).powi(2)).sum::<f64>().sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::forms_beside_s;
    use plant::{Effects, Entry};

    fn entry(name: &str) -> &'static Entry {
        Effects::entry(name).unwrap()
    }

    #[test]
    fn a_delay_may_stand_for_the_form_of_any_lag_and_nothing_else_does() {
        let mut effects = Effects::default();
        effects.set("fan_lag", &[0.2]);
        effects.set("sensor_lag", &[0.1]);
        let both_s = 0.05 * 0.2_f64.hypot(0.1);
        for delay in ["transport_delay", "sensor_delay"] {
            assert!((forms_beside_s(&effects, entry(delay)) - both_s).abs() < 1e-12, "{delay}");
            assert_eq!(forms_beside_s(&Effects::default(), entry(delay)), 0.0);
        }
        assert_eq!(forms_beside_s(&effects, entry("dead_zone")), 0.0);
    }
}
