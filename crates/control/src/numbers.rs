//! The numbers that can be changed in flight: all of controllers, observer and compensation, by name, with their units
//! and bounds.
//!
//! ```text
//! values(t) = from + λ·(to − from)        λ = t/T, 0 to 1: the control value does not jump, whatever changes
//! ```
//!
//! What a config does not have cannot be changed: a table that is absent is off. Words and switches stay as they are,
//! and so do the points of a predistortion and the number of rows of a schedule. Bounds are those of the checks of the
//! tables, found by asking them.

use crate::check::OutOfRange;
use crate::compensation::Compensation;
use crate::controller::Controllers;
use crate::observer::Observer;
use crate::pid::AntiWindup;
use crate::state_feedback::Integral;

/// Controllers, observer and compensation of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// `[controller]`
    pub controllers: Controllers,
    /// `[observer]`
    pub observer: Option<Observer>,
    /// `[compensation]`
    pub compensation: Compensation,
}

/// A number that can be changed in flight.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Table and key.
    pub name: &'static str,
    /// Its unit; `u` stands for that of the control value: %, or mm/s² behind a predistortion. Empty: none.
    pub unit: &'static str,
    place: fn(&mut Numbers) -> Option<&mut f64>,
}

/// How many there are.
pub const COUNT: usize = 70;

/// Values of parameters, in the order of [`Parameter::ALL`]; `None` where one is absent or is not meant.
pub type Values = [Option<f64>; COUNT];

const fn parameter(name: &'static str, unit: &'static str, place: fn(&mut Numbers) -> Option<&mut f64>) -> Parameter {
    Parameter { name, unit, place }
}

/// A number of a row of the gain schedule.
macro_rules! row {
    ($name:literal, $unit:literal, $column:ident, $row:literal) => {
        parameter($name, $unit, |n| n.controllers.gain_schedule.as_mut()?.$column.get_mut($row))
    };
}

impl Parameter {
    /// All of them, in the order of the config.
    pub const ALL: [Self; COUNT] = [
        parameter("pid.kp_per_mm", "u/mm", |n| Some(&mut n.controllers.pid.as_mut()?.kp_per_mm)),
        parameter("pid.ti_s", "s", |n| Some(&mut n.controllers.pid.as_mut()?.ti_s)),
        parameter("pid.td_s", "s", |n| Some(&mut n.controllers.pid.as_mut()?.td_s)),
        parameter("pid.derivative_n", "", |n| Some(&mut n.controllers.pid.as_mut()?.derivative_n)),
        parameter("pid.setpoint_weight", "", |n| Some(&mut n.controllers.pid.as_mut()?.setpoint_weight)),
        parameter("pid.rate_limit_per_s", "u/s", |n| n.controllers.pid.as_mut()?.rate_limit_per_s.as_mut()),
        parameter("pid.anti_windup.back_calculation.tracking_s", "s", |n| {
            match &mut n.controllers.pid.as_mut()?.anti_windup {
                AntiWindup::BackCalculation { tracking_s } => Some(tracking_s),
                AntiWindup::Clamping => None,
            }
        }),
        parameter("cascade.position_per_s", "1/s", |n| Some(&mut n.controllers.cascade.as_mut()?.position_per_s)),
        parameter("cascade.fastest_mm_per_s", "mm/s", |n| Some(&mut n.controllers.cascade.as_mut()?.fastest_mm_per_s)),
        parameter("cascade.velocity_s_per_mm", "u·s/mm", |n| {
            Some(&mut n.controllers.cascade.as_mut()?.velocity_s_per_mm)
        }),
        parameter("cascade.ti_s", "s", |n| Some(&mut n.controllers.cascade.as_mut()?.ti_s)),
        parameter("state_feedback.position_per_mm", "u/mm", |n| {
            Some(&mut n.controllers.state_feedback.as_mut()?.position_per_mm)
        }),
        parameter("state_feedback.velocity_s_per_mm", "u·s/mm", |n| {
            Some(&mut n.controllers.state_feedback.as_mut()?.velocity_s_per_mm)
        }),
        parameter("state_feedback.setpoint_per_mm", "u/mm", |n| {
            n.controllers.state_feedback.as_mut()?.setpoint_per_mm.as_mut()
        }),
        parameter("state_feedback.integral.ti_s", "s", |n| {
            match n.controllers.state_feedback.as_mut()?.integral.as_mut()? {
                Integral::Added { ti_s } | Integral::InPlace { ti_s } => Some(ti_s),
            }
        }),
        parameter("lqg.position_per_mm", "u/mm", |n| Some(&mut n.controllers.lqg.as_mut()?.position_per_mm)),
        parameter("lqg.velocity_s_per_mm", "u·s/mm", |n| Some(&mut n.controllers.lqg.as_mut()?.velocity_s_per_mm)),
        parameter("lqg.fan", "", |n| Some(&mut n.controllers.lqg.as_mut()?.fan)),
        parameter("mpc.move_s", "s", |n| Some(&mut n.controllers.mpc.as_mut()?.move_s)),
        parameter("mpc.position_mm", "mm", |n| Some(&mut n.controllers.mpc.as_mut()?.position_mm)),
        parameter("mpc.velocity_mm_per_s", "mm/s", |n| Some(&mut n.controllers.mpc.as_mut()?.velocity_mm_per_s)),
        parameter("mpc.control", "u", |n| Some(&mut n.controllers.mpc.as_mut()?.control)),
        parameter("open_loop.control", "u", |n| Some(&mut n.controllers.open_loop.as_mut()?.control)),
        row!("gain_schedule.height_mm.1", "mm", height_mm, 0),
        row!("gain_schedule.factor.1", "", factor, 0),
        row!("gain_schedule.height_mm.2", "mm", height_mm, 1),
        row!("gain_schedule.factor.2", "", factor, 1),
        row!("gain_schedule.height_mm.3", "mm", height_mm, 2),
        row!("gain_schedule.factor.3", "", factor, 2),
        row!("gain_schedule.height_mm.4", "mm", height_mm, 3),
        row!("gain_schedule.factor.4", "", factor, 3),
        row!("gain_schedule.height_mm.5", "mm", height_mm, 4),
        row!("gain_schedule.factor.5", "", factor, 4),
        row!("gain_schedule.height_mm.6", "mm", height_mm, 5),
        row!("gain_schedule.factor.6", "", factor, 5),
        row!("gain_schedule.height_mm.7", "mm", height_mm, 6),
        row!("gain_schedule.factor.7", "", factor, 6),
        row!("gain_schedule.height_mm.8", "mm", height_mm, 7),
        row!("gain_schedule.factor.8", "", factor, 7),
        row!("gain_schedule.height_mm.9", "mm", height_mm, 8),
        row!("gain_schedule.factor.9", "", factor, 8),
        row!("gain_schedule.height_mm.10", "mm", height_mm, 9),
        row!("gain_schedule.factor.10", "", factor, 9),
        row!("gain_schedule.height_mm.11", "mm", height_mm, 10),
        row!("gain_schedule.factor.11", "", factor, 10),
        row!("gain_schedule.height_mm.12", "mm", height_mm, 11),
        row!("gain_schedule.factor.12", "", factor, 11),
        row!("gain_schedule.height_mm.13", "mm", height_mm, 12),
        row!("gain_schedule.factor.13", "", factor, 12),
        row!("gain_schedule.height_mm.14", "mm", height_mm, 13),
        row!("gain_schedule.factor.14", "", factor, 13),
        row!("gain_schedule.height_mm.15", "mm", height_mm, 14),
        row!("gain_schedule.factor.15", "", factor, 14),
        row!("gain_schedule.height_mm.16", "mm", height_mm, 15),
        row!("gain_schedule.factor.16", "", factor, 15),
        parameter("feed_forward.time_constant_s", "s", |n| {
            Some(&mut n.controllers.feed_forward.as_mut()?.time_constant_s)
        }),
        parameter("compensation.hover_duty_percent", "%", |n| Some(&mut n.compensation.hover_duty_percent)),
        parameter("compensation.dead_zone.lower_percent", "%", |n| {
            Some(&mut n.compensation.dead_zone.as_mut()?.lower_percent)
        }),
        parameter("compensation.dead_zone.upper_percent", "%", |n| {
            Some(&mut n.compensation.dead_zone.as_mut()?.upper_percent)
        }),
        parameter("compensation.dither.step_percent", "%", |n| Some(&mut n.compensation.dither.as_mut()?.step_percent)),
        parameter("observer.sensor_mm", "mm", |n| Some(&mut n.observer.as_mut()?.sensor_mm)),
        parameter("observer.acceleration_psd_mm2_per_s3", "mm²/s³", |n| {
            Some(&mut n.observer.as_mut()?.acceleration_psd_mm2_per_s3)
        }),
        parameter("observer.disturbance_psd_per_s", "u²/s", |n| n.observer.as_mut()?.disturbance_psd_per_s.as_mut()),
        parameter("observer.gate_sigma", "", |n| Some(&mut n.observer.as_mut()?.gate_sigma)),
        parameter("observer.second_sensor_mm", "mm", |n| n.observer.as_mut()?.second_sensor_mm.as_mut()),
        parameter("observer.tachometer.control", "u", |n| Some(&mut n.observer.as_mut()?.tachometer.as_mut()?.control)),
        parameter("observer.tachometer.psd_per_s", "u²/s", |n| {
            Some(&mut n.observer.as_mut()?.tachometer.as_mut()?.psd_per_s)
        }),
        parameter("observer.believed.gain_mm_per_s2_per_control", "mm/s² per u", |n| {
            Some(&mut n.observer.as_mut()?.believed.gain_mm_per_s2_per_control)
        }),
        parameter("observer.believed.drag_per_s", "1/s", |n| Some(&mut n.observer.as_mut()?.believed.drag_per_s)),
        parameter("observer.believed.fan_lag_s", "s", |n| n.observer.as_mut()?.believed.fan_lag_s.as_mut()),
    ];

    /// Its place in [`Parameter::ALL`] by its name.
    #[must_use]
    pub fn named(name: &str) -> Option<usize> {
        Self::ALL.iter().position(|parameter| parameter.name == name)
    }

    /// The smallest and the largest value that these tables accept. `None`: it is absent there.
    #[must_use]
    pub fn bounds(&self, numbers: &Numbers) -> Option<(f64, f64)> {
        let mut probe = numbers.clone();
        // No bound accepts it, so that the check says which ones there are.
        *(self.place)(&mut probe)? = f64::NAN;
        let (_, OutOfRange { min, max, .. }) = probe.check().err()?;
        Some((min, max))
    }
}

impl Numbers {
    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// The table and the first number outside its bounds there.
    pub fn check(&self) -> Result<(), (&'static str, OutOfRange)> {
        let at = |table: &'static str| move |error| (table, error);
        self.controllers.check()?;
        self.compensation.check().map_err(at("compensation"))?;
        let Some(observer) = &self.observer else { return Ok(()) };
        observer.check().map_err(at("observer"))?;
        observer.believed.check().map_err(at("observer.believed"))
    }

    /// All values.
    #[must_use]
    pub fn values(&self) -> Values {
        let mut all = self.clone();
        Parameter::ALL.map(|parameter| (parameter.place)(&mut all).copied())
    }

    /// The same with the values that are given.
    ///
    /// # Errors
    /// The name of a parameter that is absent here.
    pub fn with(&self, values: &Values) -> Result<Self, &'static str> {
        let mut changed = self.clone();
        for (parameter, value) in Parameter::ALL.iter().zip(values) {
            if let Some(value) = value {
                *(parameter.place)(&mut changed).ok_or(parameter.name)? = *value;
            }
        }
        Ok(changed)
    }

    /// The numbers at `share`, 0 to 1, of the way from `from` to these. What is not finite on the way is as here.
    #[must_use]
    pub fn on_the_way(&self, from: &Values, share: f64) -> Self {
        let mut between = self.clone();
        for (parameter, from) in Parameter::ALL.iter().zip(from) {
            if let (Some(to), Some(from)) = ((parameter.place)(&mut between), from) {
                let value = from + share * (*to - from);
                if value.is_finite() {
                    *to = value;
                }
            }
        }
        between
    }
}

#[cfg(test)]
mod tests;
