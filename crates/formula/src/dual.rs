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

/// A value and its derivatives along `N` directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<const N: usize> {
    pub(crate) value: f64,
    pub(crate) slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The derivatives of a result, from those of its two operands.
    #[inline(always)]
    fn slopes(self, other: Self, of: impl Fn(f64, f64) -> f64) -> [f64; N] {
        // A loop: a closure for `from_fn` is a call of its own here.
        let mut slopes = [0.0; N];
        for (slope, (a, b)) in slopes.iter_mut().zip(self.slopes.iter().zip(&other.slopes)) {
            *slope = of(*a, *b);
        }
        slopes
    }
}

impl<const N: usize> Number for Dual<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slopes: self.slopes.map(|slope| -slope) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slopes: self.slopes(other, |a, b| a + b) }
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slopes: self.slopes(other, |a, b| a - b) }
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let slopes = self.slopes(other, |a, b| a * other.value + self.value * b);
        Self { value: self.value * other.value, slopes }
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slopes: self.slopes(other, |a, b| (a - value * b) / other.value) }
    }

    fn pow(self, exponent: Self) -> Self {
        let value = libm::pow(self.value, exponent.value);
        // The logarithm and the power less one may be infinite where the factor before them is zero: the limit is zero.
        let of_base =
            |slope: f64| times(exponent.value, || times(slope, || libm::pow(self.value, exponent.value - 1.0)));
        let of_exponent = |slope: f64| times(slope, || times(value, || libm::log(self.value)));
        Self { value, slopes: self.slopes(exponent, |a, b| of_base(a) + of_exponent(b)) }
    }

    #[inline(always)]
    fn chain(self, value: f64, derivative: impl FnOnce() -> f64) -> Self {
        if self.slopes == [0.0; N] {
            return Self::constant(value);
        }
        let derivative = derivative();
        Self { value, slopes: self.slopes.map(|slope| times(slope, || derivative)) }
    }
}

/// A product that is zero where the first factor is, whatever the second one.
#[inline(always)]
fn times(factor: f64, other: impl FnOnce() -> f64) -> f64 {
    if factor == 0.0 { 0.0 } else { factor * other() }
}
