//! Compensation: from the control value to the commanded duty, in the order of the signal path.
//!
//! ```text
//! control → predistortion → + excitation → dead zone → hover → dither → duty
//!
//! about = curve(control)                   with predistortion the control value is an acceleration, without it percent
//! duty  = hover + upper + about              about > 0
//! duty  = hover + lower + about              about < 0
//! duty  = hover                              about = 0
//! ```
//!
//! Without the dead-zone table lower = upper = 0. Source: the thesis, listing 3.1, which has
//! hover 21.4, lower −0.3 and upper +0.3 percent.

use crate::check::{OutOfRange, within};
use crate::dither::{Dither, DitherState};
use crate::predistortion::{Curve, Predistortion};
use crate::{Duty, Limits};

/// Jumps over the duties about hover at which the ball does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DeadZoneCorrection {
    /// Where the force begins below hover, percent of duty relative to hover, at most 0.
    pub lower_percent: f64,
    /// Where the force begins above hover, percent of duty relative to hover, at least 0.
    pub upper_percent: f64,
}

impl DeadZoneCorrection {
    /// Of a fan without a dead zone.
    pub const NONE: Self = Self { lower_percent: 0.0, upper_percent: 0.0 };
}

/// The stage between controller and fan. Absent corrections are off.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Compensation {
    /// The duty at which the ball is believed to hover, percent.
    pub hover_duty_percent: f64,
    /// Makes the fan linear: the control value becomes an acceleration.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub predistortion: Option<Predistortion>,
    /// The dead-zone correction.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub dead_zone: Option<DeadZoneCorrection>,
    /// Rounding at random for a fan that answers in steps.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub dither: Option<Dither>,
}

/// The compensation at work.
#[derive(Clone, Debug, PartialEq)]
pub struct Compensator {
    hover_percent: f64,
    curve: Option<Curve>,
    lower_percent: f64,
    upper_percent: f64,
    dither: Option<(Dither, DitherState)>,
}

impl Compensation {
    /// The stage with hover alone.
    #[must_use]
    pub const fn bare(hover_duty_percent: f64) -> Self {
        Self { hover_duty_percent, predistortion: None, dead_zone: None, dither: None }
    }

    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("hover_duty_percent", self.hover_duty_percent, 0.0, 100.0)?;
        self.predistortion.as_ref().map_or(Ok(()), Predistortion::check)?;
        if let Some(zone) = self.dead_zone {
            within("dead_zone.lower_percent", zone.lower_percent, -20.0, 0.0)?;
            within("dead_zone.upper_percent", zone.upper_percent, 0.0, 20.0)?;
        }
        self.dither.as_ref().map_or(Ok(()), Dither::check)
    }

    /// The stage, ready for a flight.
    #[must_use]
    pub fn start(&self) -> Compensator {
        let (lower_percent, upper_percent) =
            self.dead_zone.map_or((0.0, 0.0), |zone| (zone.lower_percent, zone.upper_percent));
        Compensator {
            hover_percent: self.hover_duty_percent,
            curve: self.predistortion.as_ref().map(Predistortion::curve),
            lower_percent,
            upper_percent,
            dither: self.dither.map(|dither| (dither, dither.start())),
        }
    }
}

impl Compensator {
    /// The duty for a control value, with `excitation_percent` added after the predistortion. Random with dither.
    pub fn duty(&mut self, control: f64, excitation_percent: f64) -> Duty {
        let about = self.about_hover(control) + excitation_percent;
        let edge = if about > 0.0 {
            self.upper_percent
        } else if about < 0.0 {
            self.lower_percent
        } else {
            0.0
        };
        let percent = self.hover_percent + edge + about;
        Duty::clamped(self.dither.as_mut().map_or(percent, |(dither, state)| dither.round(state, percent)))
    }

    /// Continues with other numbers, where `control` is the control value. Returns by how much larger the one is that
    /// gives the same duty.
    pub fn adopt(&mut self, numbers: &Compensation, control: f64) -> f64 {
        let lower = self.hover_percent - numbers.hover_duty_percent;
        let DeadZoneCorrection { lower_percent, upper_percent } = numbers.dead_zone.unwrap_or(DeadZoneCorrection::NONE);
        (self.lower_percent, self.upper_percent) = (lower_percent, upper_percent);
        self.hover_percent = numbers.hover_duty_percent;
        let state = self.dither.take().map(|(_, state)| state);
        self.dither = numbers.dither.map(|dither| (dither, state.unwrap_or_else(|| dither.start())));
        let (Some(old), Some(law)) = (&self.curve, &numbers.predistortion) else { return lower };
        let curve = law.curve();
        if lower == 0.0 && curve == *old {
            return 0.0;
        }
        // Beyond its reach a curve gives its end.
        let (weakest, strongest) = old.reach();
        let control = control.clamp(weakest, strongest);
        let by = curve.mm_per_s2(old.duty_about_hover(control) + lower) - control;
        self.curve = Some(curve);
        by
    }

    /// The duty at which the ball is believed to hover.
    #[must_use]
    pub const fn hover(&self) -> Duty {
        Duty::clamped(self.hover_percent)
    }

    /// What the control value means in percent of duty about hover, before the dead zone.
    #[must_use]
    pub fn about_hover(&self, control: f64) -> f64 {
        self.curve.as_ref().map_or(control, |curve| curve.duty_about_hover(control))
    }

    /// What acts where `excitation_percent` is added to `control`, as a control value.
    #[must_use]
    pub fn acting(&self, control: f64, excitation_percent: f64) -> f64 {
        match &self.curve {
            Some(curve) if excitation_percent != 0.0 => {
                curve.mm_per_s2(curve.duty_about_hover(control) + excitation_percent)
            }
            Some(_) => control,
            None => control + excitation_percent,
        }
    }

    /// The control value that would have given `duty`: the observer's input for a duty without a controller.
    #[must_use]
    pub fn control(&self, duty: Duty) -> f64 {
        let about = duty.percent() - self.hover_percent;
        let about = if about > self.upper_percent {
            about - self.upper_percent
        } else if about < self.lower_percent {
            about - self.lower_percent
        } else {
            0.0
        };
        self.curve.as_ref().map_or(about, |curve| curve.mm_per_s2(about))
    }

    /// The control values whose duties stay within `lowest` to `highest` with `excitation_percent` added.
    #[must_use]
    pub fn control_limits(&self, lowest: Duty, highest: Duty, excitation_percent: f64) -> Limits {
        let room = Limits {
            lower: (lowest.percent() - self.hover_percent - self.lower_percent).min(0.0) - excitation_percent,
            upper: (highest.percent() - self.hover_percent - self.upper_percent).max(0.0) - excitation_percent,
        };
        self.curve
            .as_ref()
            .map_or(room, |curve| Limits { lower: curve.mm_per_s2(room.lower), upper: curve.mm_per_s2(room.upper) })
    }
}

#[cfg(test)]
mod tests {
    use super::{Compensation, DeadZoneCorrection, Duty};
    use crate::dither::Dither;
    use crate::predistortion::Predistortion;

    fn original() -> Compensation {
        let zone = DeadZoneCorrection { lower_percent: -0.3, upper_percent: 0.3 };
        Compensation { dead_zone: Some(zone), ..Compensation::bare(21.4) }
    }

    #[test]
    fn the_dead_zone_correction_is_the_one_of_the_thesis() {
        let mut stage = original().start();
        for (control, duty) in [(1.0, 22.7), (-1.0, 20.1), (0.0, 21.4), (1e-9, 21.7), (-1e-9, 21.1)] {
            let got = stage.duty(control, 0.0).percent();
            assert!((got - duty).abs() < 1e-8, "control {control} gave {got}, not {duty}");
        }
    }

    #[test]
    fn without_corrections_the_duty_is_hover_plus_control() {
        assert_eq!(Compensation::bare(21.4).start().duty(1.5, 0.0).percent(), 21.4 + 1.5);
    }

    #[test]
    fn the_control_limits_reach_exactly_the_duty_limits() {
        for excitation in [0.0, 0.7] {
            let mut stage = original().start();
            let limits = stage.control_limits(Duty::clamped(5.0), Duty::clamped(60.0), excitation);
            assert!((stage.duty(limits.lower, excitation).percent() - 5.0).abs() < 1e-12);
            assert!((stage.duty(limits.upper, excitation).percent() - 60.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_stages_stand_in_the_order_of_the_signal_path() {
        let all = Compensation {
            predistortion: Some(Predistortion { points: None }),
            dither: Some(Dither { step_percent: 0.8, seed: 1 }),
            ..original()
        };
        let mut stage = all.start();
        // 156.07 mm/s² lies 0.2 % above hover in the table; 0.1 % of excitation, 0.3 % of dead zone: 22.0 %.
        let mut mean = 0.0;
        for _ in 0..20_000 {
            let duty = stage.duty(156.07, 0.1).percent();
            assert!((duty / 0.8 - (duty / 0.8).round()).abs() < 1e-9, "{duty} is not on the grid");
            mean += duty / 20_000.0;
        }
        assert!((mean - 22.0).abs() < 0.02, "{mean}");
    }

    proptest::proptest! {
        #[test]
        fn whatever_is_asked_for_the_duty_is_a_duty(
            control in proptest::num::f64::ANY, excitation in proptest::num::f64::ANY,
            curved in proptest::bool::ANY, dithered in proptest::bool::ANY,
        ) {
            let all = Compensation {
                predistortion: curved.then_some(Predistortion { points: None }),
                dither: dithered.then_some(Dither { step_percent: 0.8, seed: 1 }),
                ..original()
            };
            let duty = all.start().duty(control, excitation).percent();
            proptest::prop_assert!((0.0..=100.0).contains(&duty), "{duty}");
        }
    }

    #[test]
    fn the_control_of_a_duty_is_the_inverse() {
        for predistortion in [None, Some(Predistortion { points: None })] {
            let mut stage = Compensation { predistortion, ..original() }.start();
            for control in [-2.0, -0.5, 0.4, 3.0] {
                let back = stage.control(stage.clone().duty(control, 0.0));
                assert!((back - control).abs() < 1e-9, "{control} came back as {back}");
            }
            assert_eq!(stage.control(Duty::clamped(21.5)), 0.0, "inside the dead zone nothing acts");
            let _ = stage.duty(0.0, 0.0);
        }
    }
}
