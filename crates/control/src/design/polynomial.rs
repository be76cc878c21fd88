//! Polynomials with real coefficients, on the stack, and their roots.
//!
//! ```text
//! p(x) = c₀ + c₁·x + … + c_n·xⁿ
//! Aberth:  x_i ← x_i − 1 / ( p'(x_i)/p(x_i) − Σ_{j≠i} 1/(x_i − x_j) )       all roots at once
//! ```
//!
//! Roots at 0 are split off exactly. A root of multiplicity m is found to about the m-th root of 1e-16.
//! Source: Aberth, "Iteration methods for finding all zeros of a polynomial simultaneously", *Math. Comp.* 27, 1973.

use libm::{cos, hypot, pow, sin};
use nalgebra::Complex;

/// Coefficients at most: the plant's four poles, its delay in whole periods, and the controller's two.
pub const CAPACITY: usize = 48;
/// Steps of the iteration at most; simple roots need about 15, multiple ones a few dozen.
const MOST_STEPS: usize = 200;

/// The roots of a polynomial.
pub type Roots = heapless::Vec<Complex<f64>, CAPACITY>;

/// A polynomial with real coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial {
    coefficients: [f64; CAPACITY],
    degree: usize,
}

impl Polynomial {
    /// From its coefficients, the constant first. Those beyond [`CAPACITY`] are left out.
    #[must_use]
    pub fn new(ascending: &[f64]) -> Self {
        let mut coefficients = [0.0; CAPACITY];
        for (into, from) in coefficients.iter_mut().zip(ascending) {
            *into = *from;
        }
        Self { coefficients, degree: CAPACITY - 1 }.trimmed()
    }

    /// xⁿ.
    #[must_use]
    pub fn power(n: usize) -> Self {
        let mut coefficients = [0.0; CAPACITY];
        coefficients[n.min(CAPACITY - 1)] = 1.0;
        Self { coefficients, degree: n.min(CAPACITY - 1) }
    }

    /// The polynomial with leading coefficient 1 and these roots, which must be real or conjugate pairs. `None`: they
    /// are not.
    #[must_use]
    pub fn with_roots(roots: &[Complex<f64>]) -> Option<Self> {
        let mut product = [Complex::new(0.0, 0.0); CAPACITY];
        product[0] = Complex::new(1.0, 0.0);
        let mut size = 1.0;
        for root in roots {
            for k in (0..CAPACITY).rev() {
                let below = if k > 0 { product[k - 1] } else { Complex::new(0.0, 0.0) };
                product[k] = below - root * product[k];
            }
            size *= 1.0 + magnitude(*root);
        }
        let real = product.iter().all(|c| c.im.abs() <= 1e-9 * size);
        real.then(|| Self { coefficients: product.map(|c| c.re), degree: roots.len().min(CAPACITY - 1) })
    }

    /// The highest power.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.degree
    }

    /// The coefficients, the constant first.
    #[must_use]
    pub fn ascending(&self) -> &[f64] {
        &self.coefficients[..=self.degree]
    }

    /// The coefficient of the highest power.
    #[must_use]
    pub const fn leading(&self) -> f64 {
        self.coefficients[self.degree]
    }

    /// The product.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut coefficients = [0.0; CAPACITY];
        for (i, a) in self.ascending().iter().enumerate() {
            for (into, b) in coefficients[i..].iter_mut().zip(other.ascending()) {
                *into += a * b;
            }
        }
        Self { coefficients, degree: (self.degree + other.degree).min(CAPACITY - 1) }.trimmed()
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for (into, b) in sum.coefficients.iter_mut().zip(other.ascending()) {
            *into += b;
        }
        sum.degree = self.degree.max(other.degree);
        sum.trimmed()
    }

    /// Every coefficient multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { coefficients: self.coefficients.map(|c| c * factor), ..*self }.trimmed()
    }

    /// The same with a root at 0 exactly, where there is one (`is`) that rounding has moved.
    #[must_use]
    pub const fn with_root_at_0(mut self, is: bool) -> Self {
        if is {
            self.coefficients[0] = 0.0;
        }
        self
    }

    /// p(x + by), by Horner's scheme.
    #[must_use]
    pub fn shifted(&self, by: f64) -> Self {
        let mut moved = *self;
        for start in 0..self.degree {
            for k in (start..self.degree).rev() {
                moved.coefficients[k] += by * moved.coefficients[k + 1];
            }
        }
        moved
    }

    /// Its value.
    #[must_use]
    pub fn at(&self, x: Complex<f64>) -> Complex<f64> {
        self.ascending().iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * x + c)
    }

    /// Value and derivative.
    fn with_slope(&self, x: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
        let zero = Complex::new(0.0, 0.0);
        self.ascending().iter().rev().fold((zero, zero), |(sum, slope), c| (sum * x + c, slope * x + sum))
    }

    /// All roots, those at 0 first.
    #[must_use]
    pub fn roots(&self) -> Roots {
        let at_zero = self.ascending().iter().take_while(|c| **c == 0.0).count().min(self.degree);
        let mut roots = Roots::new();
        for _ in 0..at_zero {
            let _ = roots.push(Complex::new(0.0, 0.0));
        }
        let rest = Self::new(&self.coefficients[at_zero..=self.degree]);
        let _ = roots.extend_from_slice(&rest.nonzero_roots());
        roots
    }

    fn nonzero_roots(&self) -> Roots {
        let mut roots = self.first_guess();
        for _ in 0..MOST_STEPS {
            let mut moved = 0.0_f64;
            for i in 0..roots.len() {
                let x = roots[i];
                let (value, slope) = self.with_slope(x);
                if magnitude(value) == 0.0 {
                    continue;
                }
                let away = (0..roots.len()).filter(|j| *j != i && roots[*j] != x);
                let repulsion: Complex<f64> = away.map(|j| (x - roots[j]).inv()).sum();
                let step = (slope / value - repulsion).inv();
                if step.re.is_finite() && step.im.is_finite() {
                    roots[i] = x - step;
                    moved = moved.max(magnitude(step) / magnitude(roots[i]).max(f64::MIN_POSITIVE));
                }
            }
            if moved < 1e-15 {
                break;
            }
        }
        roots
    }

    /// Points on a circle of the roots' geometric mean, turned so that none is a mirror image of another.
    fn first_guess(&self) -> Roots {
        let degree = self.degree as f64;
        let radius = pow((self.coefficients[0] / self.leading()).abs(), 1.0 / degree.max(1.0));
        let angle = |k: usize| (core::f64::consts::TAU * k as f64 + 0.7) / degree;
        (0..self.degree).map(|k| Complex::new(radius * cos(angle(k)), radius * sin(angle(k)))).collect()
    }

    /// Without leading zeros.
    fn trimmed(mut self) -> Self {
        while self.degree > 0 && self.coefficients[self.degree] == 0.0 {
            self.degree -= 1;
        }
        self
    }
}

/// |x|, without overflow.
#[must_use]
pub fn magnitude(x: Complex<f64>) -> f64 {
    hypot(x.re, x.im)
}

#[cfg(test)]
mod tests {
    use super::{Complex, Polynomial, magnitude};

    fn c(re: f64, im: f64) -> Complex<f64> {
        Complex::new(re, im)
    }

    #[test]
    fn the_roots_are_those_that_it_was_made_of() {
        let made_of = [c(0.0, 0.0), c(0.0, 0.0), c(-0.05, 0.0), c(-0.8, 1.2), c(-0.8, -1.2), c(-400.0, 0.0)];
        let roots = Polynomial::with_roots(&made_of).unwrap().roots();
        assert_eq!(roots.len(), made_of.len());
        for root in made_of {
            let near = roots.iter().map(|r| magnitude(r - root)).fold(f64::INFINITY, f64::min);
            assert!(near <= 1e-12 * magnitude(root), "{root} is {near} away from {roots:?}");
        }
    }

    #[test]
    fn a_double_root_is_found_to_the_root_of_the_precision() {
        let roots = Polynomial::new(&[3.896 * 3.896, 2.0 * 3.896, 1.0]).roots();
        assert!(roots.iter().all(|r| magnitude(r + 3.896) < 1e-6), "{roots:?}");
    }

    #[test]
    fn thirty_roots_of_unity_lie_on_the_unit_circle() {
        let mut coefficients = [0.0; 31];
        (coefficients[0], coefficients[30]) = (-1.0, 1.0);
        let roots = Polynomial::new(&coefficients).roots();
        assert_eq!(roots.len(), 30);
        assert!(roots.iter().all(|r| (magnitude(*r) - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_complex_root_without_its_conjugate_makes_no_real_polynomial() {
        assert!(Polynomial::with_roots(&[c(-1.0, 2.0)]).is_none());
        assert!(Polynomial::with_roots(&[c(-1.0, 2.0), c(-1.0, -2.0)]).is_some());
    }

    #[test]
    fn sums_and_products_are_those_of_their_values() {
        let (p, q, x) = (Polynomial::new(&[1.0, 2.0, 3.0]), Polynomial::new(&[4.0, -3.0, -3.0]), c(0.3, -1.7));
        assert!(magnitude(p.times(&q).at(x) - p.at(x) * q.at(x)) < 1e-12);
        assert!(magnitude(p.plus(&q).at(x) - p.at(x) - q.at(x)) < 1e-12);
        assert!(magnitude(p.shifted(0.7).at(x) - p.at(x + 0.7)) < 1e-12);
        assert_eq!(p.plus(&q).degree(), 1, "the squares cancel");
    }
}
