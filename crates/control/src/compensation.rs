//! Compensation: from the control value to the duty that the fan is asked for.
//!
//! ```text
//! duty = hover + upper + control      control > 0
//! duty = hover + lower + control      control < 0
//! duty = hover                        control = 0
//! ```
//!
//! Without the dead-zone table lower = upper = 0. Source: the thesis, listing 3.1, which has
//! hover 21.4, lower −0.3 and upper +0.3 percent.

use crate::Duty;
use crate::check::{OutOfRange, within};
use crate::pid::Limits;

/// Jumps over the duties about hover at which the ball does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DeadZoneCorrection {
    /// Where the force begins below hover, percent of duty relative to hover, at most 0.
    pub lower_percent: f64,
    /// Where the force begins above hover, percent of duty relative to hover, at least 0.
    pub upper_percent: f64,
}

/// The stage between controller and fan. Absent corrections are off.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Compensation {
    /// The duty at which the ball is believed to hover, percent.
    pub hover_duty_percent: f64,
    /// The dead-zone correction.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub dead_zone: Option<DeadZoneCorrection>,
}

impl Compensation {
    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("hover_duty_percent", self.hover_duty_percent, 0.0, 100.0)?;
        if let Some(zone) = self.dead_zone {
            within("dead_zone.lower_percent", zone.lower_percent, -20.0, 0.0)?;
            within("dead_zone.upper_percent", zone.upper_percent, 0.0, 20.0)?;
        }
        Ok(())
    }

    /// The duty for a control value in percent about hover.
    #[must_use]
    pub fn duty(&self, control_percent: f64) -> Duty {
        let (lower, upper) = self.edges();
        let edge = if control_percent > 0.0 {
            upper
        } else if control_percent < 0.0 {
            lower
        } else {
            0.0
        };
        Duty::clamped(self.hover_duty_percent + edge + control_percent)
    }

    /// The control values whose duties stay within `lowest` to `highest`.
    #[must_use]
    pub fn control_limits(&self, lowest: Duty, highest: Duty) -> Limits {
        let (lower, upper) = self.edges();
        Limits {
            lower: (lowest.percent() - self.hover_duty_percent - lower).min(0.0),
            upper: (highest.percent() - self.hover_duty_percent - upper).max(0.0),
        }
    }

    fn edges(&self) -> (f64, f64) {
        self.dead_zone.map_or((0.0, 0.0), |zone| (zone.lower_percent, zone.upper_percent))
    }
}

#[cfg(test)]
mod tests {
    use super::{Compensation, DeadZoneCorrection, Duty};

    const ORIGINAL: Compensation = Compensation {
        hover_duty_percent: 21.4,
        dead_zone: Some(DeadZoneCorrection { lower_percent: -0.3, upper_percent: 0.3 }),
    };

    #[test]
    fn the_dead_zone_correction_is_the_one_of_the_thesis() {
        for (control, duty) in [(1.0, 22.7), (-1.0, 20.1), (0.0, 21.4), (1e-9, 21.7), (-1e-9, 21.1)] {
            let got = ORIGINAL.duty(control).percent();
            assert!((got - duty).abs() < 1e-8, "control {control} gave {got}, not {duty}");
        }
    }

    #[test]
    fn without_corrections_the_duty_is_hover_plus_control() {
        let bare = Compensation { dead_zone: None, ..ORIGINAL };
        assert_eq!(bare.duty(1.5).percent(), 21.4 + 1.5);
    }

    #[test]
    fn the_control_limits_reach_exactly_the_duty_limits() {
        let limits = ORIGINAL.control_limits(Duty::clamped(5.0), Duty::clamped(60.0));
        assert!((ORIGINAL.duty(limits.lower).percent() - 5.0).abs() < 1e-12);
        assert!((ORIGINAL.duty(limits.upper).percent() - 60.0).abs() < 1e-12);
    }
}
