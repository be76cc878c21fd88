//! Held-out log-likelihood by cross-validation: each fold is scored under the model that was fitted without it.
//!
//! A fit without a fold is one scoring step from the fit to all folds, from gradient and information kept by fold.
//! Source: Stone, "Cross-validatory choice and assessment of statistical predictions", JRSS B 36 (1974).

use crate::filter::innovation::Innovation;
use crate::fit::estimate::{Fit, GAIN_ENOUGH, Problem, SHORTER};
use crate::record::folds::Folds;
use plant::Model;

/// Log-likelihood by fold, nats.
pub(crate) type LogLikByFold = [f64; Folds::COUNT];

/// A log-likelihood, or −∞ for one that is no number, as of a model that is unstable over a gap: where NaN ranks among
/// numbers depends on its sign, which differs between processors.
pub(super) fn or_impossible(nats: f64) -> f64 {
    if nats.is_nan() { f64::NEG_INFINITY } else { nats }
}

impl Problem<'_> {
    /// The models fitted without each fold in turn: one scoring step from the fit to all folds.
    #[must_use]
    pub fn without_each_fold(&self, fit: &Fit) -> Vec<Model> {
        self.cross_validated(fit).0
    }

    /// The held-out log-likelihood of each fold, under the model that was fitted without it, nats.
    #[must_use]
    pub fn held_out(&self, fit: &Fit) -> LogLikByFold {
        self.cross_validated(fit).1
    }

    /// The models fitted without each fold in turn, and the held-out log-likelihood of each fold under its own, nats.
    pub(crate) fn cross_validated(&self, fit: &Fit) -> (Vec<Model>, LogLikByFold) {
        let mut held_out = LogLikByFold::default();
        let models = (0..Folds::COUNT).map(|fold| {
            let (model, by_fold) = self.without(fit, fold);
            held_out[fold] = by_fold[fold];
            model
        });
        (models.collect(), held_out)
    }

    /// The model fitted without a fold, and the log-likelihood of each fold under it. A parameter of an added effect
    /// that the other folds do not determine returns to its neutral value; otherwise the fold that alone determines it
    /// would not be held out.
    fn without(&self, fit: &Fit, fold: usize) -> (Model, LogLikByFold) {
        let kept = |by_fold: &LogLikByFold| by_fold.iter().sum::<f64>() - by_fold[fold];
        let here = self.of_each_fold(&fit.innovations);
        let before = kept(&here) + fit.log_prior;
        let (mut gradient, mut information) = fit.slope.total(Some(fold));
        let mut slack = GAIN_ENOUGH;
        for (i, parameter) in fit.parameters.iter().enumerate() {
            let Some(off) = parameter.distance_from_neutral(&fit.model, self.belief) else { continue };
            gradient[i] -= off;
            information[(i, i)] += 1.0;
            slack += 0.5 * off * off;
        }
        let Some(mut direction) = information.cholesky().map(|factor| factor.solve(&gradient)) else {
            return (fit.model.clone(), here);
        };
        for _ in 0..SHORTER {
            let model = self.moved(&fit.model, &fit.parameters, &direction);
            let there = self.by_fold(&model);
            if kept(&there) + self.log_prior(&fit.parameters, &model) > before - slack {
                return (model, there);
            }
            direction /= 4.0;
        }
        (fit.model.clone(), here)
    }

    /// The log-likelihood of each fold under `model`, without a fit, nats.
    #[must_use]
    pub fn by_fold(&self, model: &Model) -> LogLikByFold {
        self.of_each_fold(&self.innovations(model))
    }

    fn of_each_fold(&self, innovations: &[Innovation]) -> LogLikByFold {
        let mut sums = LogLikByFold::default();
        for s in innovations {
            if let Some(fold) = self.folds.of(s.row) {
                sums[fold] += s.log_density;
            }
        }
        sums.map(or_impossible)
    }
}
