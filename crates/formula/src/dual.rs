//! Dual numbers: forward-mode automatic differentiation.
//!
//! ```text
//! (a, a′)·(b, b′) = (a·b, a′·b + a·b′)      f((a, a′)) = (f(a), f′(a)·a′)
//! ```
//!
//! What does not move has no derivative to take: where a′ = 0, so is f(a)′, also at an a where f has none, such as
//! the root of zero.
//! Source: Griewank & Walther, *Evaluating Derivatives*, chapter 3.

use crate::number::Number;

/// A value and its derivative in the direction of interest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

impl Number for Dual {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }

    fn pow(self, exponent: Self) -> Self {
        let value = libm::pow(self.value, exponent.value);
        // The logarithm and the power less one may be infinite where the factor before them is zero: the limit is zero.
        let of_base = times(exponent.value, || times(self.slope, || libm::pow(self.value, exponent.value - 1.0)));
        let of_exponent = times(exponent.slope, || times(value, || libm::log(self.value)));
        Self { value, slope: of_base + of_exponent }
    }

    #[inline(always)]
    fn chain(self, value: f64, derivative: impl FnOnce() -> f64) -> Self {
        Self { value, slope: times(self.slope, derivative) }
    }
}

/// A product that is zero where the first factor is, whatever the second one.
#[inline(always)]
fn times(factor: f64, other: impl FnOnce() -> f64) -> f64 {
    if factor == 0.0 { 0.0 } else { factor * other() }
}
