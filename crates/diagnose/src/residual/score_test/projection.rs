//! Scores of single forces, orthogonal to the effects of a model's fitted parameters.
//!
//! ```text
//! q_i           orthonormal columns of the sensitivities of the expected readings to the parameters: Gram–Schmidt
//! e' = e − Σ q_i·(q_i·e)
//! z² = (f·e')²/(f·f − Σ (q_i·f)²)             f: sensitivity of the expected readings to the force
//! θ = G⁻¹·b, z² = bᵀ·θ                         of several: b_i = f_i·e', G_ij = f_i·f_j − Σ (q_k·f_i)(q_k·f_j)
//! ```

use super::sensitivities::{FilterRun, Step};
use crate::filter::ekf::Sensitivity;
use crate::residual::orthogonal::{Basis, LEAST_INDEPENDENT, dot};
use nalgebra::{DMatrix, DVector};

/// The score of several forces or shifts together.
pub(crate) struct Joint {
    /// z², which under a right model is chi-square with a degree of freedom for each.
    pub(crate) square: f64,
    /// The sizes that explain the innovations best.
    pub(crate) sizes: Vec<f64>,
}

/// The innovations of a filter run without the part that the fitted parameters explain.
pub(crate) struct ProjectedInnovations<'a> {
    run: &'a FilterRun,
    own: Basis,
    innovations: Vec<f64>,
}

impl<'a> ProjectedInnovations<'a> {
    pub(crate) fn of(run: &'a FilterRun) -> Self {
        let column = |of: &dyn Fn(usize, &Step) -> f64| -> Vec<f64> {
            let values = run.steps.iter().enumerate();
            values.map(|(k, step)| if counts(step) { of(k, step) } else { 0.0 }).collect()
        };
        let own = Basis::of(run.own.iter().map(|numbers| column(&|k, step| step.root_weight() * numbers[k])));
        let innovations = own.without_projection(column(&|_, step| step.innovation.standardised / step.root_weight()));
        Self { run, own, innovations }
    }

    /// z² of a force. `push` gives its value before each reading, mm/s², from the number of the reading and the seconds
    /// since the previous one.
    pub(crate) fn score(&self, mut push: impl FnMut(usize, f64) -> f64) -> f64 {
        let column = self.moved(|k, dt| (push(k, dt), 0.0));
        let whole = dot(&column, &column);
        let square = whole - self.own.products(&column).map(|product| product.powi(2)).sum::<f64>();
        // NaN compares as false: a score that is undefined counts as 0.
        if square > LEAST_INDEPENDENT * whole { dot(&column, &self.innovations).powi(2) / square } else { 0.0 }
    }

    /// The joint score of `count` forces or shifts. `of` gives the mm/s² before each reading and the mm in it, from the
    /// number of the force and that of the reading. `None` where they cannot be told from the fitted parameters or from
    /// each other.
    pub(crate) fn joint(&self, count: usize, mut of: impl FnMut(usize, usize) -> (f64, f64)) -> Option<Joint> {
        let columns: Vec<Vec<f64>> = (0..count).map(|force| self.moved(|k, _| of(force, k))).collect();
        let by_own: Vec<Vec<f64>> = columns.iter().map(|column| self.own.products(column).collect()).collect();
        let whole: Vec<f64> = columns.iter().map(|column| dot(column, column)).collect();
        // In units of each column's length, so that the sizes of the numbers do not matter.
        let unit = |i: usize| whole[i].sqrt();
        if whole.iter().any(|whole| !(whole.is_finite() && *whole > 0.0)) {
            return None;
        }
        let gram = DMatrix::from_fn(count, count, |i, j| {
            (dot(&columns[i], &columns[j]) - dot(&by_own[i], &by_own[j])) / (unit(i) * unit(j))
        });
        if (0..count).any(|i| gram[(i, i)] < LEAST_INDEPENDENT) || gram.determinant() < LEAST_INDEPENDENT.powi(2) {
            return None;
        }
        let scores = DVector::from_fn(count, |i, _| dot(&columns[i], &self.innovations) / unit(i));
        let sizes = gram.cholesky()?.solve(&scores);
        let square = scores.dot(&sizes);
        let sizes = sizes.iter().enumerate().map(|(i, size)| size / unit(i)).collect();
        square.is_finite().then_some(Joint { square, sizes })
    }

    /// By how much each reading that counts is expected to move, standard deviations, with a force in mm/s² before it
    /// and a shift of it in mm; both are given by its number and the seconds since the previous one.
    fn moved(&self, mut of: impl FnMut(usize, f64) -> (f64, f64)) -> Vec<f64> {
        let mut nudged = Sensitivity::zero();
        let column = self.run.steps.iter().enumerate().map(|(k, step)| {
            let Some(dt) = step.dt else {
                nudged = Sensitivity::zero();
                return 0.0;
            };
            let (push, shift_mm) = of(k, dt);
            let moved_mm = nudged.go(&step.leg, (dt, push, shift_mm), &step.innovation);
            if counts(step) { step.root_weight() * moved_mm / step.innovation.variance_mm2.sqrt() } else { 0.0 }
        });
        column.collect()
    }
}

fn counts(step: &Step) -> bool {
    step.judged && step.has_weight()
}
