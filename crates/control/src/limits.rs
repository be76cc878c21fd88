//! Limits of the control value: what the fan can still follow.

/// Smallest and largest control value that the fan can still follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest control value.
    pub lower: f64,
    /// Largest control value.
    pub upper: f64,
}

impl Limits {
    /// Holds `value` within the limits. NaN becomes the lower limit: less air is the safe side.
    #[must_use]
    pub const fn hold(self, value: f64) -> f64 {
        if value.is_nan() { self.lower } else { value.max(self.lower).min(self.upper) }
    }

    /// The part of these limits that lies within `reach` of `middle`; where there is none, the nearest end.
    #[must_use]
    pub const fn within(self, middle: f64, reach: f64) -> Self {
        Self { lower: self.hold(middle - reach), upper: self.hold(middle + reach) }
    }

    /// The limits moved by `by`.
    #[must_use]
    pub const fn shifted(self, by: f64) -> Self {
        Self { lower: self.lower + by, upper: self.upper + by }
    }

    /// Whether `wanted` is beyond the limit that a positive (negative) `error` pushes towards.
    #[must_use]
    pub const fn blocks(self, wanted: f64, error: f64) -> bool {
        (wanted > self.upper && error > 0.0) || (wanted < self.lower && error < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Limits;

    #[test]
    fn nan_is_held_at_the_safe_side_and_a_reach_stays_within() {
        let limits = Limits { lower: -2.0, upper: 3.0 };
        assert_eq!([f64::NAN, f64::INFINITY, 1.0].map(|value| limits.hold(value)), [-2.0, 3.0, 1.0]);
        assert_eq!(limits.within(2.5, 1.0), Limits { lower: 1.5, upper: 3.0 });
        // From beyond the limits the way leads back inside at once.
        assert_eq!(limits.within(9.0, 1.0), Limits { lower: 3.0, upper: 3.0 });
    }
}
