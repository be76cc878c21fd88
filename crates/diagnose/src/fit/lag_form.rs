//! The lags of a model, and the error of their first-order form.
//!
//! The lag of a rig is never exactly of first order. Of two lags in series, the smaller one acts like a dead time in
//! the same stage.

use plant::{Effects, Entry, Late};

/// The effects of the catalogue that are lags.
pub(crate) fn lags() -> impl Iterator<Item = &'static Entry> {
    Effects::CATALOGUE.iter().filter(|entry| entry.acts.late == Some(Late::Lag))
}

/// The effect that stands for the error of a lag's form: the dead time of the same stage.
pub(crate) fn dead_time_beside(lag: &Entry) -> Option<&'static Entry> {
    Effects::CATALOGUE.iter().find(|entry| entry.acts.late == Some(Late::DeadTime) && entry.stage == lag.stage)
}

/// Standard deviation of the form of a lag, as a share of its time constant: rotor and air column are two lags in
/// series, and the smaller one delays by its time constant.
const FORM_OF_A_LAG: f64 = 0.05;

/// Standard deviation of the delay by the unknown form of a lag, beyond its first order, seconds.
pub(crate) fn form_s(effects: &Effects, lag: &Entry) -> f64 {
    FORM_OF_A_LAG * effects.late_s(lag.name)
}

/// Standard deviation of the delays by the unknown forms of all lags, which a dead time may stand for, seconds; 0 if
/// `entry` is no dead time.
pub(crate) fn forms_beside_s(effects: &Effects, entry: &Entry) -> f64 {
    let is_dead_time = entry.acts.late == Some(Late::DeadTime);
    if is_dead_time { lags().map(|lag| form_s(effects, lag).powi(2)).sum::<f64>().sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::forms_beside_s;
    use plant::{Effects, Entry};

    fn entry(name: &str) -> &'static Entry {
        Effects::built_in(name).unwrap()
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
