//! The force that a model leaves in bins of a signal, all bins fitted together.
//!
//! ```text
//! e = Σ θ_b·f_b + noise        f_b: sensitivity of the expected readings, standard deviations, to a force in bin b
//! θ = G⁻¹·fᵀe                  G = fᵀf;  var θ = G⁻¹·max(1, Σ(e − f·θ)²/n)
//! ```
//!
//! The parameters of the model are fixed, so that the bins alone take what is left.

use super::conditions::share_after;
use super::sensitivities::{FilterRun, Step};
use crate::filter::ekf::Sensitivity;
use nalgebra::{DMatrix, DVector};

/// Added to the diagonal of the scaled G: bins that no reading tells apart get a wide interval instead of none.
const RIDGE: f64 = 1e-6;

/// The force in one bin before a reading: the number of the bin, and mm/s² for a unit of its size.
pub(crate) type Pushes = Vec<(usize, f64)>;

/// The sizes of bins with their standard deviations.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BinnedForces {
    pub(crate) sizes: Vec<f64>,
    pub(crate) deviations: Vec<f64>,
}

impl BinnedForces {
    /// The forces in `bins` bins that explain the innovations of `run` best. `pushes`: for each reading, the forces
    /// before it; they act behind a lag of `lag_s`. `None`: the record does not determine them.
    pub(crate) fn of(run: &FilterRun, bins: usize, pushes: &[Pushes], lag_s: f64) -> Option<Self> {
        let mut sums = Sums { gram: DMatrix::zeros(bins, bins), by: DVector::zeros(bins), square: 0.0, readings: 0 };
        let (mut moved, mut late) = (vec![Sensitivity::zero(); bins], vec![0.0; bins]);
        for (step, pushes) in run.steps.iter().zip(pushes) {
            let Some(dt_s) = step.dt else {
                moved.fill(Sensitivity::zero());
                late.fill(0.0);
                continue;
            };
            let share = share_after(dt_s, lag_s);
            let mut now = vec![0.0; bins];
            pushes.iter().for_each(|(bin, push)| now[*bin] += push);
            let row = DVector::from_fn(bins, |bin, _| {
                late[bin] += (now[bin] - late[bin]) * share;
                moved[bin].go(&step.leg, (dt_s, late[bin], 0.0), &step.innovation)
            });
            sums.add(step, &row);
        }
        sums.solved()
    }
}

struct Sums {
    gram: DMatrix<f64>,
    by: DVector<f64>,
    square: f64,
    readings: u32,
}

impl Sums {
    /// Adds a reading that counts; `moved_mm`: by how much each bin moves it.
    fn add(&mut self, step: &Step, moved_mm: &DVector<f64>) {
        if !(step.judged && step.has_weight()) || moved_mm.iter().any(|mm| !mm.is_finite()) {
            return;
        }
        let (root_weight, innovation) = (step.root_weight(), &step.innovation);
        let row = moved_mm * (root_weight / innovation.variance_mm2.sqrt());
        let residual = innovation.standardised / root_weight;
        self.gram.syger(1.0, &row, &row, 1.0);
        self.by.axpy(residual, &row, 1.0);
        self.square += residual * residual;
        self.readings += 1;
    }

    fn solved(mut self) -> Option<BinnedForces> {
        self.gram.fill_upper_triangle_with_lower_triangle();
        // A bin that no reading sees has no size, and tells nothing about the others.
        let seen = self.gram.diagonal().map(|square| square > 0.0 && square.is_finite());
        let scale = DVector::from_fn(seen.len(), |bin, _| if seen[bin] { self.gram[(bin, bin)].sqrt() } else { 1.0 });
        let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            self.gram[(i, j)] / (scale[i] * scale[j])
                + if i != j {
                    0.0
                } else if seen[i] {
                    RIDGE
                } else {
                    1.0
                }
        });
        let inverse = scaled.cholesky()?.inverse();
        let sizes = (&inverse * self.by.component_div(&scale)).component_div(&scale);
        let left = (self.square - sizes.dot(&self.by)) / f64::from(self.readings.max(1));
        let deviation = |bin: usize| match seen[bin] {
            true => (inverse[(bin, bin)] * left.max(1.0)).sqrt() / scale[bin],
            false => f64::INFINITY,
        };
        let deviations: Vec<f64> = (0..scale.len()).map(deviation).collect();
        let all_finite = sizes.iter().all(|value| value.is_finite());
        all_finite.then(|| BinnedForces { sizes: sizes.iter().copied().collect(), deviations })
    }
}
