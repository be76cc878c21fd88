//! Transfer functions of the loop, in s or in δ = z − 1.
//!
//! ```text
//! H = numerator / denominator          continuous: s = jω          sampled: δ = e^(jωT) − 1, stable where |1 + δ| < 1
//! ```
//!
//! Slow poles of a sampled loop crowd at z = 1, where polynomials in z lose their digits; in δ they crowd at 0 and keep
//! them.
//! Source: Middleton & Goodwin, *Digital Control and Estimation*, for δ.

use super::polynomial::{Polynomial, Roots};
use libm::{log1p, sin};
use nalgebra::Complex;

/// Where a transfer function lives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plane {
    /// s.
    Continuous,
    /// δ = z − 1, with the time between samples in seconds.
    Sampled(f64),
}

/// A ratio of two polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    /// Its zeros.
    pub numerator: Polynomial,
    /// Its poles.
    pub denominator: Polynomial,
    /// In s or in z.
    pub plane: Plane,
}

impl Plane {
    /// The point of the stability boundary at `omega`, rad/s.
    #[must_use]
    pub fn boundary(self, omega: f64) -> Complex<f64> {
        match self {
            Self::Continuous => Complex::new(0.0, omega),
            Self::Sampled(period_s) => {
                let half = sin(omega * period_s / 2.0);
                Complex::new(-2.0 * half * half, sin(omega * period_s))
            }
        }
    }

    /// How far inside the stable region a pole is: its decay, 1/s. Negative: unstable.
    #[must_use]
    pub fn decay_per_s(self, pole: Complex<f64>) -> f64 {
        match self {
            Self::Continuous => -pole.re,
            // ln|1 + δ|, exact for small δ.
            Self::Sampled(period_s) => -0.5 * log1p(2.0 * pole.re + pole.norm_sqr()) / period_s,
        }
    }
}

impl Transfer {
    /// Its value at a point of the plane.
    #[must_use]
    pub fn at(&self, point: Complex<f64>) -> Complex<f64> {
        self.numerator.at(point) / self.denominator.at(point)
    }

    /// Its frequency response at `omega`, rad/s.
    #[must_use]
    pub fn response(&self, omega: f64) -> Complex<f64> {
        self.at(self.plane.boundary(omega))
    }

    /// Where a constant input ends: the value at s = 0 or δ = 0.
    #[must_use]
    pub fn rest_gain(&self) -> f64 {
        self.numerator.ascending()[0] / self.denominator.ascending()[0]
    }

    /// One after the other.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            numerator: self.numerator.times(&next.numerator),
            denominator: self.denominator.times(&next.denominator),
            plane: self.plane,
        }
    }

    /// Multiplied by a gain.
    #[must_use]
    pub fn scaled(&self, gain: f64) -> Self {
        Self { numerator: self.numerator.scaled(gain), ..*self }
    }

    /// The denominator of 1/(1 + gain·H): its roots are the closed loop's poles.
    #[must_use]
    pub fn closed_denominator(&self, gain: f64) -> Polynomial {
        self.denominator.plus(&self.numerator.scaled(gain))
    }

    /// The closed loop's poles.
    #[must_use]
    pub fn closed_poles(&self, gain: f64) -> Roots {
        self.closed_denominator(gain).roots()
    }

    /// Whether every pole of the loop closed with `gain` decays.
    #[must_use]
    pub fn is_stable_closed(&self, gain: f64) -> bool {
        self.closed_poles(gain).iter().all(|pole| self.plane.decay_per_s(*pole) > 0.0)
    }
}
