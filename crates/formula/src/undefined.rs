//! Where a value is not defined although the text of the formula is right.

use alloc::format;
use alloc::string::String;
use core::fmt::{Display, Formatter, Result};

/// Why the value of a formula can be undefined within the bounds of its variables.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Undefined {
    /// A variable has no bounds, or none that are finite and in order.
    Unbounded(String),
    /// A divisor can be zero: it lies between these two.
    DivisorMayBeZero(f64, f64),
    /// `sqrt` of what can be negative: it lies between these two.
    RootOfNegative(f64, f64),
    /// `ln` of what can be zero or negative: it lies between these two.
    LogarithmOfNonPositive(f64, f64),
    /// A power with an exponent that need not be whole, of what can be negative: it lies between these two.
    PowerOfNegative(f64, f64),
    /// A power with an exponent that can be negative, of what can be zero: it lies between these two.
    PowerOfZero(f64, f64),
    /// A result that can be larger than all floating-point numbers.
    Overflow,
}

impl Display for Undefined {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let mut ranged = |what: &str, low: f64, high: f64, then: &str| {
            write!(f, "{what}, it lies within {} to {}{then}", Short(low), Short(high))
        };
        match *self {
            Self::DivisorMayBeZero(low, high) => ranged(
                "the divisor can be zero",
                low,
                high,
                "; keep it away from zero, as in `max(…, 0.1)` or `abs(…) + 0.1`",
            ),
            Self::RootOfNegative(low, high) => ranged(
                "the argument of `sqrt` can be negative",
                low,
                high,
                "; keep it from that, as in `sqrt(max(…, 0))`",
            ),
            Self::LogarithmOfNonPositive(low, high) => ranged(
                "the argument of `ln` can be zero or negative",
                low,
                high,
                "; keep it positive, as in `ln(max(…, 0.1))`",
            ),
            Self::PowerOfNegative(low, high) => ranged(
                "the base can be negative",
                low,
                high,
                ", and the exponent is no whole number; take `abs(…)` or `max(…, 0)` of the base",
            ),
            Self::PowerOfZero(low, high) => ranged(
                "the base can be zero",
                low,
                high,
                ", and the exponent negative; keep the base away from zero, as in `max(…, 0.1)`",
            ),
            Self::Unbounded(ref name) => write!(f, "the variable `{name}` has no finite bounds; give it some"),
            Self::Overflow => f.write_str(
                "the result can be too large for a number; narrow the bounds, or limit it with `clamp` before",
            ),
        }
    }
}

/// A number for a sentence: six significant digits.
struct Short(f64);

impl Display for Short {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let rounded = format!("{:.5e}", self.0).parse().unwrap_or(self.0);
        let everyday = rounded == 0.0 || (1e-4..1e7).contains(&f64::abs(rounded));
        if everyday { write!(f, "{rounded}") } else { write!(f, "{rounded:e}") }
    }
}
