//! Data for the plots of a report: free runs before and after the correction of the model, and the missing force.
//!
//! As in the errors of the report, the free runs of the mended model use the fit without the fold in which they start.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::effect_curves::{EffectCurve, effect_curves};
use crate::filter::missing_force::{MissingForce, missing_force};
use crate::fit::estimate::Problem;
use crate::fit::parameter::Prior;
use crate::gap::forecast_error::{FreeRun, free_runs};
use crate::record::decimate::Purpose;
use crate::record::folds::Folds;
use crate::record::prepare::Prepared;
use crate::record::recording::Recording;
use crate::residual::plots::ResidualPlots;
use plant::Model;
use rayon::prelude::*;

/// Data for plots. The air's noise is the smallest of the believed and the fitted values, so that it does not hide the
/// missing force. Row numbers refer to the recording here.
#[derive(Clone, Debug)]
pub struct Series {
    /// The rows that the diagnosis used.
    pub recording: Recording,
    /// Free runs of the belief.
    pub nominal: Vec<FreeRun>,
    /// Free runs of the mended model, each from the fit without the fold in which it starts.
    pub mended: Vec<FreeRun>,
    /// The force that the refitted belief lacks; empty if the ball was never in free flight.
    pub missing: Vec<MissingForce>,
    /// Residual plots of the refitted belief and of the mended model.
    pub left: [ResidualPlots; 2],
    /// The found effects over the signals that they depend on.
    pub effects: Vec<EffectCurve>,
}

impl Series {
    /// The data for the diagnosis `found` of these recordings and `belief`.
    #[must_use]
    pub fn of(found: &Diagnosis, belief: &Model, recordings: &(impl AsRef<[Recording]> + ?Sized)) -> Self {
        let recording = Prepared::of(recordings.as_ref(), belief, Purpose::Diagnosis).recording.into_owned();
        let folds = Folds::new(belief, &recording);
        let problem = Problem { recording: &recording, belief, folds: &folds, prior: Prior::Belief };
        let runs = found.without_each_fold.par_iter().enumerate().flat_map_iter(|(fold, model)| {
            let runs = free_runs(model, &recording).into_iter();
            runs.filter(|run| folds.of(run.row) == Some(fold)).collect::<Vec<_>>()
        });
        let mut mended: Vec<FreeRun> = runs.collect();
        mended.sort_by_key(|run| run.row);
        let mut nominal = free_runs(belief, &recording);
        nominal.retain(|run| folds.counts(run.row));
        let mut lacking = found.refitted.model.clone();
        for model in [belief, &found.mended.model] {
            let noise = &mut lacking.noise.acceleration_psd_mm2_per_s3;
            *noise = noise.min(model.noise.acceleration_psd_mm2_per_s3);
        }
        let missing = missing_force(&lacking, &recording);
        let left = [&found.refitted, &found.mended].map(|fit| ResidualPlots::of(&fit.model, &recording, &folds));
        let effects = effect_curves(found, &problem);
        Self { recording, nominal, mended, missing, left, effects }
    }
}

#[cfg(test)]
mod tests {
    use super::Series;
    use crate::tests_support::{model, record};
    use crate::{Options, diagnose};
    use plant::{Effects, Model};

    #[test]
    fn mended_runs_start_where_the_believed_do_and_keep_nearer_to_the_record() {
        let belief = Model { effects: Effects::default(), ..model() };
        let recording = record(&model(), 4, 80);
        let picture = Series::of(&diagnose(&belief, &recording, &Options::default()), &belief, &recording);
        let starts = |runs: &[crate::FreeRun]| runs.iter().map(|run| run.row).collect::<Vec<_>>();
        assert_eq!(starts(&picture.nominal), starts(&picture.mended));
        let off = |runs: &[crate::FreeRun]| {
            let squares = runs.iter().flat_map(|run| &run.forecasts).map(|forecast| {
                let real = picture.recording.samples()[forecast.row].position_mm.unwrap();
                (forecast.position_mm - real).powi(2)
            });
            squares.sum::<f64>()
        };
        assert!(off(&picture.mended) < 0.5 * off(&picture.nominal));
        assert!(picture.missing.len() > 3500, "{}", picture.missing.len());
    }
}
