//! Derivatives of innovations and log-likelihood by the parameters: differences of whole filter runs.
//!
//! ```text
//! g = Σ w·( ν·∂ŷ/S + ½·(ν²/S − 1)·∂lnS )        see `estimate` for the symbols
//! H = Σ w·( ∂ŷ·∂ŷᵀ/S + ½·∂lnS·∂lnSᵀ )
//! ```

use crate::filter::innovation::Innovation;
use crate::fit::estimate::{Fit, Point, Problem};
use crate::fit::parameter::{Parameter, Prior};
use crate::record::folds::Folds;
use nalgebra::{DMatrix, DVector};
use plant::Model;
use rayon::prelude::*;

/// Gradient and information of the likelihood fold by fold, and of the prior.
#[derive(Clone, Debug)]
pub(crate) struct Derivatives {
    folds: Vec<(DVector<f64>, DMatrix<f64>)>,
    prior: (DVector<f64>, DMatrix<f64>),
}

impl Derivatives {
    /// Sums over all folds but `left_out`.
    pub(crate) fn total(&self, left_out: Option<usize>) -> (DVector<f64>, DMatrix<f64>) {
        let kept = self.folds.iter().enumerate().filter(|(fold, _)| Some(*fold) != left_out);
        kept.fold(self.prior.clone(), |(g, h), (_, (gradient, information))| (g + gradient, h + information))
    }
}

/// The derivatives of the innovations by each parameter: of the expectation, mm, and of the logarithm of the variance;
/// or of ln p alone.
pub(super) struct Sensitivities {
    by_parameter: Vec<Vec<[f64; 2]>>,
}

/// The derivatives of the innovations by some parameters at a fit, which stand for those nearby in a brief fit.
pub(crate) struct KnownSensitivities {
    parameters: Vec<Parameter>,
    sensitivities: Sensitivities,
}

/// No derivative is known.
pub(crate) static NONE_KNOWN: KnownSensitivities =
    KnownSensitivities { parameters: Vec::new(), sensitivities: Sensitivities { by_parameter: Vec::new() } };

impl KnownSensitivities {
    /// ∂ŷ of an innovation by a parameter, mm for a step of it.
    pub(crate) fn shift_mm(&self, parameter: usize, innovation: usize) -> f64 {
        let one = self.sensitivities.by_parameter.get(parameter).and_then(|all| all.get(innovation));
        one.map_or(0.0, |[shift_mm, _]| *shift_mm)
    }

    fn by(&self, parameter: &Parameter) -> Option<&Vec<[f64; 2]>> {
        let at = self.parameters.iter().position(|known| known == parameter)?;
        self.sensitivities.by_parameter.get(at)
    }
}

/// The derivatives of an innovation by a parameter from a run with this parameter moved.
fn derivative(here: &Innovation, there: &Innovation, of_density: bool) -> [f64; 2] {
    // A reading that changes between new and repeated has no derivative.
    if here.repeat || there.repeat {
        return [0.0; 2];
    }
    let derivatives = if of_density {
        [there.log_density - here.log_density, 0.0]
    } else {
        [there.expected_mm - here.expected_mm, (there.variance_mm2 / here.variance_mm2).ln()]
    };
    derivatives.map(|change| change / Parameter::DIFFERENCE)
}

impl Problem<'_> {
    /// Gradient and information of log-likelihood and log-prior at `point`.
    pub(super) fn slope(&self, point: &Point, parameters: &[Parameter]) -> Derivatives {
        let sensitivities = self.sensitivities(&point.model, &point.innovations, parameters, &NONE_KNOWN);
        self.derivatives(point, parameters, &sensitivities)
    }

    /// The derivatives of the innovations by `parameters` at a fit.
    pub(crate) fn sensitivities_of(&self, fit: &Fit, parameters: &[Parameter]) -> KnownSensitivities {
        let sensitivities = self.sensitivities(&fit.model, &fit.innovations, parameters, &NONE_KNOWN);
        KnownSensitivities { parameters: parameters.to_vec(), sensitivities }
    }

    /// The derivatives of `here`, the innovations under `model`: those that are known, and the others by a run each.
    pub(super) fn sensitivities(
        &self,
        model: &Model,
        here: &[Innovation],
        parameters: &[Parameter],
        known: &KnownSensitivities,
    ) -> Sensitivities {
        let of_one = |parameter: &Parameter| -> Vec<[f64; 2]> {
            if let Some(known) = known.by(parameter) {
                return known.clone();
            }
            let nudged = self.innovations(&parameter.stepped(model, Parameter::DIFFERENCE));
            let of_density = parameter.is_of_the_density();
            let both = here.iter().zip(&nudged);
            both.map(|(here, there)| derivative(here, there, of_density)).collect()
        };
        Sensitivities { by_parameter: parameters.par_iter().map(of_one).collect() }
    }

    /// Gradient and information at `point` from the derivatives of the innovations.
    pub(super) fn derivatives(&self, point: &Point, parameters: &[Parameter], known: &Sensitivities) -> Derivatives {
        let n = parameters.len();
        let zero = (DVector::zeros(n), DMatrix::zeros(n, n));
        let mut folds = vec![zero.clone(); Folds::COUNT];
        let of_density: Vec<bool> = parameters.iter().map(|parameter| parameter.is_of_the_density()).collect();
        let (mut shift, mut spread, mut density) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for (k, s) in point.innovations.iter().enumerate() {
            let Some(fold) = self.folds.of(s.row).filter(|_| !s.repeat) else { continue };
            let deviation = s.variance_mm2.sqrt();
            for i in 0..n {
                // A step of a parameter can add innovations, such as those of a fan speed that was constant before.
                let [first, second] = known.by_parameter[i].get(k).copied().unwrap_or_default();
                (shift[i], spread[i], density[i]) =
                    if of_density[i] { (0.0, 0.0, first) } else { (first / deviation, second, 0.0) };
            }
            let (gradient, information) = &mut folds[fold];
            for i in 0..n {
                gradient[i] += s.standardised * shift[i] + 0.5 * s.variance_score * spread[i] + density[i];
                for j in 0..=i {
                    let normal = s.weight * (shift[i] * shift[j] + 0.5 * spread[i] * spread[j]);
                    information[(i, j)] += normal + density[i] * density[j];
                }
            }
        }
        for (_, information) in &mut folds {
            information.fill_upper_triangle_with_lower_triangle();
        }
        let mut prior = zero;
        for (i, parameter) in parameters.iter().enumerate().filter(|_| self.prior == Prior::Belief) {
            let (_, slope, curvature) = parameter.prior(&point.model, self.belief);
            prior.0[i] = slope;
            prior.1[(i, i)] = curvature;
        }
        Derivatives { folds, prior }
    }
}
