//! Kalman filter with one measured quantity, over irregular samples.
//!
//! ```text
//! predict   x ← f(x)        P ← Φ·P·Φᵀ + Q
//! update    ν = z − H·x     S = H·P·Hᵀ + R     K = P·Hᵀ/S     x ← x + K·ν     P ← (I − K·H)·P·(I − K·H)ᵀ + K·R·Kᵀ
//! ```
//!
//! The caller moves the state itself, so that the same filter serves a linear model and a linearised one.
//! The covariance uses Joseph's form, which stays positive when R is tiny.
//! Source: Gelb, *Applied Optimal Estimation*, chapter 4.

use nalgebra::{RowSVector, SMatrix, SVector};

/// State and its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kalman<const N: usize> {
    /// The estimate x.
    pub state: SVector<f64, N>,
    /// Its covariance P.
    pub covariance: SMatrix<f64, N, N>,
}

/// The innovation of one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// ν: reading minus expectation.
    pub residual: f64,
    /// S: the variance that the filter expected of ν.
    pub variance: f64,
}

impl<const N: usize> Kalman<N> {
    /// Moves to the time of the next reading: `state` is the model's prediction, `transition` its derivative Φ with
    /// respect to the state, `noise` the covariance Q of the step.
    pub fn predict(&mut self, state: SVector<f64, N>, transition: &SMatrix<f64, N, N>, noise: &SMatrix<f64, N, N>) {
        self.state = state;
        self.covariance = transition * self.covariance * transition.transpose() + noise;
    }

    /// What a reading would be, and its variance including the reading's own, without taking one.
    #[must_use]
    pub fn expect(&self, row: &RowSVector<f64, N>, reading_variance: f64) -> (f64, f64) {
        ((row * self.state)[0], (row * self.covariance * row.transpose())[0] + reading_variance)
    }

    /// Takes the reading `measured` of H·x, `row` being H, with noise variance `reading_variance` (R > 0).
    pub fn update(&mut self, measured: f64, row: &RowSVector<f64, N>, reading_variance: f64) -> Innovation {
        let (expected, variance) = self.expect(row, reading_variance);
        let residual = measured - expected;
        let gain = self.covariance * row.transpose() / variance;
        self.state += gain * residual;
        let keep = SMatrix::<f64, N, N>::identity() - gain * row;
        self.covariance = keep * self.covariance * keep.transpose() + gain * reading_variance * gain.transpose();
        Innovation { residual, variance }
    }
}

#[cfg(test)]
mod tests {
    use super::Kalman;
    use nalgebra::{matrix, vector};

    #[test]
    fn a_constant_read_k_times_has_the_variance_of_the_mean() {
        let prior = 1e12;
        let mut filter = Kalman { state: vector![0.0], covariance: matrix![prior] };
        let readings = [4.0, 6.0, 5.0, 9.0];
        for z in readings {
            filter.update(z, &matrix![1.0], 2.0);
        }
        assert!((filter.state[0] - 6.0).abs() < 1e-6, "mean of the readings, got {}", filter.state[0]);
        assert!((filter.covariance[0] - 2.0 / 4.0).abs() < 1e-6, "R/k, got {}", filter.covariance[0]);
    }

    #[test]
    fn a_random_walk_reaches_the_steady_state_of_the_riccati_equation() {
        let (q, r) = (0.5, 2.0);
        let mut filter = Kalman { state: vector![0.0], covariance: matrix![10.0] };
        for _ in 0..200 {
            let stays = filter.state;
            filter.predict(stays, &matrix![1.0], &matrix![q]);
            filter.update(0.0, &matrix![1.0], r);
        }
        // p² + q·p − q·r = 0 for the covariance after the update.
        let exact = (-q + libm::sqrt(q * q + 4.0 * q * r)) / 2.0;
        assert!((filter.covariance[0] - exact).abs() < 1e-12, "{}, exact {exact}", filter.covariance[0]);
    }

    #[test]
    fn the_covariance_stays_symmetric_and_positive_with_almost_no_noise() {
        let transition = matrix![1.0, 0.02; 0.0, 0.98];
        let mut filter = Kalman { state: vector![0.0, 0.0], covariance: matrix![1.0, 0.0; 0.0, 1e6] };
        for _ in 0..10_000 {
            let next = transition * filter.state;
            filter.predict(next, &transition, &matrix![0.0, 0.0; 0.0, 1e-9]);
            filter.update(1.0, &matrix![1.0, 0.0], 1e-9);
            let p = filter.covariance;
            assert!((p[(0, 1)] - p[(1, 0)]).abs() <= 1e-12 * p[(1, 1)].max(1e-30));
            assert!(p[(0, 0)] > 0.0 && p.determinant() >= 0.0, "{p}");
        }
    }
}
