//! What evaluation needs of a number, so that the value alone and the value with its derivative are computed by the
//! same code, and agree in every bit.

/// A number that formulas are evaluated with.
pub(crate) trait Number: Copy {
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    fn neg(self) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn pow(self, exponent: Self) -> Self;
    /// A function of this number: its value, and its derivative where that is needed.
    fn chain(self, value: f64, derivative: impl FnOnce() -> f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn neg(self) -> Self {
        -self
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self / other
    }

    fn pow(self, exponent: Self) -> Self {
        libm::pow(self, exponent)
    }

    #[inline(always)]
    fn chain(self, value: f64, _: impl FnOnce() -> f64) -> Self {
        value
    }
}
