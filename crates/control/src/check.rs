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
        let (shown, low, high) = (Short(*value), Short(*min), Short(*max));
        if min == max {
            write!(f, "{key} = {shown}, expected {low}")
        } else {
            write!(f, "{key} = {shown} is outside {low} to {high}")
        }
    }
}

/// A number; a very large or very small one by its power of ten, not by three hundred digits.
struct Short(f64);

impl core::fmt::Display for Short {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self(value) = self;
        let size = value.abs();
        if size.is_finite() && size != 0.0 && !(1e-9..1e9).contains(&size) {
            write!(f, "{value:e}")
        } else {
            write!(f, "{value}")
        }
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
    extern crate std;

    use super::within;
    use std::string::ToString;

    #[test]
    fn a_huge_number_is_said_by_its_power_of_ten_and_a_single_possible_value_as_expected() {
        let said = |value, min, max| within("x", value, min, max).unwrap_err().to_string();
        assert_eq!(said(1e308, 0.0, 1e6), "x = 1e308 is outside 0 to 1000000");
        assert_eq!(said(-1e-300, 0.0, 1e300), "x = -1e-300 is outside 0 to 1e300");
        assert_eq!(said(f64::INFINITY, 0.5, 2.0), "x = inf is outside 0.5 to 2");
        assert_eq!(said(0.0, 1.0, 1.0), "x = 0, expected 1");
    }

    #[test]
    fn nan_is_outside_every_range_and_bounds_are_inside() {
        assert!(within("x", f64::NAN, f64::NEG_INFINITY, f64::INFINITY).is_err());
        assert!(within("x", 1.0, 1.0, 2.0).is_ok() && within("x", 2.0, 1.0, 2.0).is_ok());
        assert!(within("x", 2.000_001, 1.0, 2.0).is_err());
    }
}
