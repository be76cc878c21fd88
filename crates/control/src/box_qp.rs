//! A quadratic programme with bounds, in a fixed number of steps and without allocation.
//!
//! ```text
//! minimise ½·uᵀHu + fᵀu      lower ≤ u ≤ upper                  H symmetric, eigenvalues within µ to L
//! u⁺ = hold(v − (Hv + f)/L)      v⁺ = u⁺ + β·(u⁺ − u)           β = (√L − √µ)/(√L + √µ)
//! ```
//!
//! Every step shrinks the bound of the error by 1 − √(µ/L), so that the number of steps can be fixed beforehand.
//! Source: Nesterov, *Introductory Lectures on Convex Optimization*, section 2.2 (constant step scheme, simple sets).

use crate::Limits;
use libm::sqrt;
use nalgebra::{SMatrix, SVector};

/// Products with the matrix that find its largest eigenvalue.
const POWERS: u32 = 200;
/// They may miss it by this share.
const MISSED: f64 = 1.01;

/// The part of the programme that does not change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoxQp<const N: usize> {
    pub(crate) hessian: SMatrix<f64, N, N>,
    /// 1/L.
    stride: f64,
    /// β.
    momentum: f64,
}

impl<const N: usize> BoxQp<N> {
    /// A programme with the matrix `hessian`, symmetric, all of whose eigenvalues are at least `smallest` > 0.
    #[must_use]
    pub(crate) fn new(hessian: SMatrix<f64, N, N>, smallest: f64) -> Self {
        let mut direction = SVector::<f64, N>::repeat(1.0);
        let mut largest = smallest;
        for _ in 0..POWERS {
            let next = hessian * direction;
            largest = next.norm() / direction.norm();
            direction = next / next.norm();
        }
        let largest = (MISSED * largest).max(smallest);
        let momentum = (sqrt(largest) - sqrt(smallest)) / (sqrt(largest) + sqrt(smallest));
        Self { hessian, stride: largest.recip(), momentum }
    }

    /// The solution after `steps` steps from `start`, for the linear part `linear` and the same bounds for all entries.
    #[must_use]
    pub(crate) fn solve(
        &self,
        start: &SVector<f64, N>,
        linear: &SVector<f64, N>,
        limits: Limits,
        steps: u32,
    ) -> SVector<f64, N> {
        let mut best = start.map(|value| limits.hold(value));
        let mut ahead = best;
        for _ in 0..steps {
            let downhill = ahead - (self.hessian * ahead + linear) * self.stride;
            let next = downhill.map(|value| limits.hold(value));
            ahead = next + (next - best) * self.momentum;
            best = next;
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::BoxQp;
    use crate::Limits;
    use nalgebra::{matrix, vector};

    #[test]
    fn without_active_bounds_it_solves_the_linear_equations() {
        let hessian = matrix![4.0, 1.0; 1.0, 3.0];
        let free = Limits { lower: -10.0, upper: 10.0 };
        let got = BoxQp::new(hessian, 2.0).solve(&vector![9.0, -9.0], &vector![1.0, 2.0], free, 100);
        assert!((hessian * got + vector![1.0, 2.0]).norm() < 1e-9, "{got}");
    }

    #[test]
    fn at_a_bound_the_gradient_points_out_of_the_box() {
        let hessian = matrix![4.0, 1.0; 1.0, 3.0];
        let tight = Limits { lower: -0.1, upper: 0.1 };
        let got = BoxQp::new(hessian, 2.0).solve(&vector![0.0, 0.0], &vector![-1.0, -0.2], tight, 100);
        // u₁ at its upper bound leaves u₂ = (0.2 − 0.1)/3.
        assert!((got - vector![0.1, 0.1 / 3.0]).norm() < 1e-9, "{got}");
    }
}
