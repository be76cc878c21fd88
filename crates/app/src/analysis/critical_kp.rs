//! The critical K_p of a config's PID around its model, for other numbers as well.

use control::design::Linear;
use control::design::critical::critical_gain;
use control::numbers::{Numbers, Values};
use control::predistortion::Predistortion;
use plant::Model;

/// The loop of a config.
#[derive(Clone, Debug)]
pub struct CriticalKp {
    /// The model, whose gain is per percent of duty.
    plant: Linear,
    period_s: f64,
    numbers: Numbers,
}

impl CriticalKp {
    /// The loop of `model`, sampled with `period_s` and closed by the PID of `numbers`.
    #[must_use]
    pub fn new(model: &Model, period_s: f64, numbers: Numbers) -> Self {
        Self { plant: model.linear(), period_s, numbers }
    }

    /// The K_p at which the loop loses stability where the others are `values`. `None`: at none, or there is no PID.
    #[must_use]
    pub fn with(&self, values: &Values) -> Option<f64> {
        let numbers = self.numbers.with(values).ok()?;
        let curve = numbers.compensation.predistortion.as_ref().map(Predistortion::curve);
        let percent_per_control = curve.map_or(1.0, |curve| curve.percent_per_mm_per_s2());
        let plant = Linear { gain: self.plant.gain * percent_per_control, ..self.plant };
        let pid = numbers.controllers.pid.as_ref()?;
        critical_gain(&pid.into(), &plant.sampled(self.period_s).ok()?).value()
    }
}

#[cfg(test)]
mod tests {
    use super::CriticalKp;
    use crate::analysis::loop_margins::{Closing, Loop};
    use config::Tables;
    use control::numbers::{Numbers, Parameter};

    #[test]
    fn it_is_the_one_of_the_design_and_falls_with_a_faster_integral() {
        let tables: Tables = toml::from_str(include_str!("../../../../config.toml")).unwrap();
        let (model, pid) = (tables.plant.unwrap(), tables.controller.as_ref().unwrap().pid.unwrap());
        let numbers = Numbers {
            controllers: tables.controller.unwrap(),
            observer: tables.observer,
            compensation: tables.compensation.unwrap(),
        };
        let mut values = numbers.values();
        let critical = CriticalKp::new(&model, 0.02, numbers);
        let of =
            Loop { plant: model.linear(), closing: Closing::Pid((&pid).into(), (&pid).into()), period_s: Some(0.02) };
        let own = critical.with(&values);
        assert_eq!(own, of.sampled().unwrap().unwrap().critical_kp_per_mm);
        assert!(own > Some(2.0 * pid.kp_per_mm), "{own:?}");
        values[Parameter::named("pid.ti_s").unwrap()] = Some(0.2);
        assert!(critical.with(&values) < own, "{own:?}");
    }
}
