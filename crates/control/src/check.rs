//! Numbers that come from people are checked where they enter, once, against bounds that stand beside them.

/// A number outside its bounds. The reader of the config file adds file and line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// The key of the number within its table, with its unit.
    pub key: &'static str,
    /// What was given.
    pub value: f64,
    /// Smallest value accepted.
    pub min: f64,
    /// Largest value accepted.
    pub max: f64,
}

impl core::fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { key, value, min, max } = self;
        write!(f, "{key} = {value} is outside {min} to {max}")
    }
}

/// Accepts `value` within `min` to `max`; NaN is outside every range.
///
/// # Errors
/// [`OutOfRange`] with the key and the bounds.
pub const fn within(key: &'static str, value: f64, min: f64, max: f64) -> Result<(), OutOfRange> {
    if value >= min && value <= max { Ok(()) } else { Err(OutOfRange { key, value, min, max }) }
}

#[cfg(test)]
mod tests {
    use super::within;

    #[test]
    fn nan_is_outside_every_range_and_bounds_are_inside() {
        assert!(within("x", f64::NAN, f64::NEG_INFINITY, f64::INFINITY).is_err());
        assert!(within("x", 1.0, 1.0, 2.0).is_ok() && within("x", 2.0, 1.0, 2.0).is_ok());
        assert!(within("x", 2.000_001, 1.0, 2.0).is_err());
    }
}
