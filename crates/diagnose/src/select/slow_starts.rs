//! Initial values of effects from a slow filter, where the believed noise hides what the model lacks.
//!
//! A belief that was fitted to a record takes what it lacks for noise of the air. With so much noise the filter
//! corrects the model within a few readings, and the likelihood has two maxima: one where an effect explains a little
//! beside that noise, and a far higher one where it explains the record and the noise is small. No step of a fit leads
//! from the first to the second. A fit by forecasts does (see [`crate::select::by_forecasts`]), because its filter does
//! not correct the model. So the effects with the largest gains by forecasts are also fitted by likelihood from there.
//!
//! The noise hides the model where the belief is known to be fitted to a record of the rig, or where both hold:
//!
//! ```text
//! 1/ω = (r·Δt/q)^(1/4) < 0.05 s     of the belief: by the shortest forecast its filter has forgotten the model
//! q of the refit < 2·q believed     the refit hardly raises the noise of the air: the belief has enough of it
//! ```

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::gap::forecast_error::HORIZONS_S;
use crate::record::recording::Recording;
use crate::select::by_forecasts::{self, memory_s, slow_fit, slow_noise};
use crate::select::screening::{STEPS, Screened, first, promising_gain, screen};
use crate::select::search::Search;
use crate::select::stepwise::is_of_path;
use plant::{Entry, Model};
use rayon::prelude::*;

/// Most effects that are fitted from a slow filter in a round. Chosen for the time that they take.
const SLOW_FITS: usize = 6;
/// A filter whose memory is this share of the shortest horizon has corrected 1 − e^(−2) of an error by then. Chosen: the
/// filter of the usual rig, with 2.5 mm and 360 mm²/s³, remembers 0.06 s at 1 kHz.
const FORGOTTEN: f64 = 0.5;
/// The refit of a belief that was fitted to the same record raises the noise of the air by less than this factor; a
/// belief of measured noise needs far more for a missing effect. Chosen, not fitted.
const RAISED: f64 = 2.0;

/// Whether the noise of the belief, of which `refitted` is the refit, hides what it lacks.
pub(crate) fn noise_hides(recording: &Recording, belief: &Model, refitted: &Model) -> bool {
    let psd = |model: &Model| model.noise.acceleration_psd_mm2_per_s3;
    forgets(recording, belief) && psd(refitted) < RAISED * psd(belief)
}

/// Whether the filter of the model has forgotten what the model says by the shortest horizon of a forecast.
fn forgets(recording: &Recording, model: &Model) -> bool {
    memory_s(recording, model.noise) < FORGOTTEN * HORIZONS_S[0]
}

/// The effects on the path with the largest gains by forecasts, each with the model from which it is fitted in full by
/// likelihood; none where the noise does not hide them, or the filter of the fit remembers the model beyond the
/// shortest horizon. `enough`: the gain by likelihood that a full fit needs, nats.
pub(crate) fn slow_starts(search: &Search<'_>, so_far: &Fit, entries: &[&'static Entry], enough: f64) -> Vec<Screened> {
    let remembers = memory_s(search.problem.recording, so_far.model.noise) > HORIZONS_S[0];
    if search.is_by_forecasts() || !search.noise_hides || remembers {
        return Vec::new();
    }
    let noise = slow_noise(search, so_far, by_forecasts::HORIZONS_S[0]);
    let slow = search.by_forecasts(search.problem.folds, noise);
    let base = slow_fit(&slow, so_far, noise);
    let known = slow.problem.sensitivities_of(&base, &first(&slow));
    let path: Vec<&'static Entry> = entries.iter().filter(|entry| is_of_path(entry)).copied().collect();
    let mut screened: Vec<Screened> = path.par_iter().filter_map(|entry| screen(&slow, &base, &known, entry)).collect();
    screened.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let enough_by_forecasts = promising_gain(&screened);
    screened.retain(|one| one.gain > enough_by_forecasts);
    screened.truncate(SLOW_FITS);
    let fitted = screened.par_iter().map(|one| {
        let model = slow.problem.fit(&one.model, &one.parameters).model;
        let parameters = by_likelihood(so_far, &one.parameters);
        let (model, total) = search.problem.fit_briefly(&model, &parameters, STEPS);
        let gain = total - search.problem.total_of(so_far);
        Screened { model, parameters, gain, rivals: Vec::new(), ..one.clone() }
    });
    fitted.filter(|one| one.gain > enough).collect()
}

/// The parameters of a fit by likelihood: both noises in place of their level.
fn by_likelihood(so_far: &Fit, slow: &[Parameter]) -> Vec<Parameter> {
    let base = so_far.parameters.iter().filter(|one| one.entry().is_none());
    base.chain(slow.iter().filter(|one| one.entry().is_some())).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::slow_starts;
    use crate::fit::estimate::Fit;
    use crate::identify::initial;
    use crate::options::Options;
    use crate::random_for_tests::uniform;
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::{Check, Recording, Sample, diagnose};
    use plant::Effects;

    /// A cart, ẍ = 1333·u − 1.67·ẋ mm/s², that sticks below 833 mm/s² of dry friction, held by a PD controller with a
    /// random setpoint; 0.8 mm of noise. Its own simulator, with twenty steps a row.
    fn cart() -> Recording {
        let (mut x, mut v, mut setpoint, mut last, mut slope) = (0.0, 0.0_f64, 0.0, 0.0, 0.0);
        let mut uniform = uniform(7);
        let rows = (0..4000).map(|k| {
            if k % 250 == 0 {
                setpoint = 800.0 * uniform();
            }
            let reading = x + 0.8 * (0..12).map(|_| uniform()).sum::<f64>();
            slope += 0.25 * ((reading - last) / 0.01 - slope);
            last = reading;
            let duty_percent: f64 = (0.018 * (setpoint - reading) - 0.0022 * slope).clamp(-12.0, 12.0);
            for _ in 0..20 {
                let force = 1333.0 * duty_percent - 1.67 * v;
                let before = v;
                let sticks = v == 0.0 && force.abs() <= 833.0;
                v += if sticks { 0.0 } else { 5e-4 * (force - 833.0 * if v == 0.0 { force } else { v }.signum()) };
                v = if before * v < 0.0 { 0.0 } else { v };
                x += 5e-4 * v;
            }
            let position_mm = Some(1200.0 + reading);
            Sample { time_s: 0.01 * f64::from(k), duty_percent, position_mm, ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    #[test]
    fn an_effect_that_the_belief_took_for_noise_is_found_with_its_size() {
        let recording = cart();
        let belief = initial(std::slice::from_ref(&recording), 0.0, 2400.0, None, None).unwrap().model;
        assert!(belief.noise.acceleration_psd_mm2_per_s3 > 1000.0, "{belief:?}");
        let options = Options { without_formula: true, ..Options::default() };
        let found = diagnose(&belief, &[recording], &options);
        let names: Vec<&str> = found.effects.iter().map(|named| named.candidate.entry.name).collect();
        let mended = &found.mended.model;
        assert_eq!(names, ["wall_friction"], "{mended:?}");
        let close = |value: f64, truth: f64| (value / truth - 1.0).abs() < 0.03;
        let friction = mended.effects.values("wall_friction").unwrap()[0];
        assert!(close(friction, 833.0) && close(mended.gain_mm_per_s2_per_percent, 1333.0), "{mended:?}");
        // A drag far from the belief says nothing here of another rig.
        assert!(!found.was_checked(Check::Model) && found.was_checked(Check::Bounds));
        // It forecasts with its own noise, which the patch brings.
        assert!(found.gaps[2].error_mm[2].unwrap() < 1.0, "{:?}", found.gaps[2]);
        assert!(found.patch_toml().contains("[plant.noise]"), "{}", found.patch_toml());
    }

    #[test]
    fn a_slow_start_needs_a_gain_by_likelihood_and_a_filter_that_forgets_the_model() {
        let recording = cart();
        let belief = initial(std::slice::from_ref(&recording), 0.0, 2400.0, None, None).unwrap().model;
        let folds = Folds::new(&belief, &recording);
        let mut search = Search::new(&belief, &recording, &folds, &Options::default());
        search.noise_hides = true;
        let so_far = refitted(&search);
        let friction = Effects::built_in("wall_friction").unwrap();
        let gain =
            |so_far: &Fit, enough: f64| slow_starts(&search, so_far, &[friction], enough).first().map(|one| one.gain);
        let most = gain(&so_far, 0.0).unwrap();
        assert!(most > 100.0, "{most}");
        assert_eq!(gain(&so_far, most), None);
        // With so little noise of the air the filter remembers the model for 0.16 s.
        let mut quiet = so_far.clone();
        quiet.model.noise.acceleration_psd_mm2_per_s3 = 10.0;
        assert_eq!(gain(&quiet, f64::NEG_INFINITY), None);
    }

    #[test]
    fn a_belief_that_was_fitted_to_the_record_is_no_other_place_to_start_from() {
        let recording = cart();
        let belief = initial(std::slice::from_ref(&recording), 0.0, 2400.0, None, None).unwrap().model;
        let folds = Folds::new(&belief, &recording);
        let mut search = Search::new(&belief, &recording, &folds, &Options::default());
        let mut far = refitted(&search);
        far.model.gain_mm_per_s2_per_percent *= 4.0;
        assert!(search.is_far(&far));
        search.noise_hides = true;
        assert!(!search.is_far(&far));
    }
}
