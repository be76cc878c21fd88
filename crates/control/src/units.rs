//! Units are types between crates: a wrong value cannot be built.

/// The position of the ball above the bottom of the pipe, in millimetres. Up is positive everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Millimetres(pub f64);

/// A fan command in percent, always within 0 (stopped) to 100 (full).
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Duty(f64);

impl Duty {
    /// Fan stopped: what every fault path writes.
    pub const OFF: Self = Self(0.0);
    /// Fan at full speed.
    pub const FULL: Self = Self(100.0);

    /// Clamps into range. NaN stops the fan.
    #[must_use]
    pub const fn clamped(percent: f64) -> Self {
        if percent.is_nan() { Self::OFF } else { Self(percent.clamp(0.0, 100.0)) }
    }

    /// The command in percent, 0 to 100.
    #[must_use]
    pub const fn percent(self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::Duty;

    #[test]
    fn a_duty_is_always_within_its_range_and_nan_stops_the_fan() {
        for (asked, held) in [(-1.0, 0.0), (101.0, 100.0), (f64::INFINITY, 100.0), (f64::NAN, 0.0), (21.4, 21.4)] {
            assert_eq!(Duty::clamped(asked).percent(), held, "asked for {asked} %");
        }
    }
}
