//! Score test of omitted terms: whether a missing force, shift of the readings or noise level explains the innovations.
//!
//! ```text
//! force θ·φ        δ ← Φ·δ + g·φ,  s = ∂ŷ/∂θ = H·δ,  δ ← (I − K·H)·δ        s: effect on each expected reading
//! shift θ·φ        s = H·δ + φ, and the filter takes it for motion
//! z                Σ e·r/√Σ r²      r: s/√S, orthogonal to the effects of the fitted parameters and of the lag forms
//! form             dead time at the stage of a lag, normal with a standard deviation of a twentieth of that lag
//! spread           the same for ∛e², which is nearly normal, against φ
//! noise            Λ = max over c of L(c) + ½·Σ z²(c) − max L        L: ln p with c times the air's noise
//! moments          a step of the readings or a force pulse at a single moment: see `moments`
//! bursts           forces that come and go: see `bursts`
//! ```
//!
//! This is the score (Lagrange multiplier) test. Under a right model z is normal with variance 1, in closed loop too,
//! because φ is known before the reading. A force moves many later readings through the filter; s includes that. An
//! omitted term makes the fitted noise of the air too large, which hides the term. So the likelihood ratio Λ chooses
//! that noise anew.
//! Sources: Engle, "Wald, likelihood ratio, and Lagrange multiplier tests in econometrics", Handbook of Econometrics 2
//! (1984); Wilson and Hilferty, "The distribution of chi-square", Proc. Natl. Acad. Sci. 17 (1931).

mod binned;
mod bursts;
mod conditions;
mod moments;
mod projection;
mod scores;
mod sensitivities;
mod terms;

pub(crate) use binned::{BinnedForces, Pushes};
pub(crate) use conditions::{Before, share_after};
pub(crate) use projection::{Joint, ProjectedInnovations};
pub(crate) use sensitivities::FilterRun;

use crate::fit::estimate::{Fit, Problem};
use crate::thresholds::UNEVEN_SPREAD;
use moments::Moments;
use plant::Stage;
use rayon::prelude::*;
use scores::{Scores, SelectedTerm};
use serde::Serialize;
use terms::Term;

/// Factors on the air's noise, or on its turbulence, at which the terms are tested as well.
const QUIETER: [f64; 2] = [0.5, 0.2];

/// An omitted term.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Omitted {
    /// The term in words.
    pub words: String,
    /// Its score given the terms before it, standard deviations.
    pub z: f64,
    /// The stage of the signal path where it would act, if it is known.
    #[serde(skip)]
    pub stage: Option<Stage>,
}

/// The words between the kind of a term and its form.
const DEPENDS: [&str; 2] = [" that goes with ", " that changes with "];

impl Omitted {
    /// What it is, and the form of its dependence; that is empty for an event.
    #[must_use]
    pub fn kind_and_form(&self) -> (&str, &str) {
        let parts = DEPENDS.iter().find_map(|words| self.words.split_once(words));
        parts.unwrap_or((&self.words, ""))
    }
}

/// The terms with the largest joint score, largest first.
pub(crate) struct JointScore {
    /// −ln of the probability of so large a score, corrected for the choice among all terms.
    pub(crate) nats: f64,
    /// The terms.
    pub(crate) terms: Vec<Omitted>,
}

/// The result of the score test.
pub(crate) struct Found {
    /// Omitted terms.
    pub(crate) terms: JointScore,
    /// Events at single moments.
    pub(crate) moments: JointScore,
    /// How much the residual force comes in bursts, standard deviations.
    pub(crate) bursts: f64,
}

/// Tests the innovations for omitted terms and events. `weight`: weight of each reading, at most 1.
pub(crate) fn omitted(problem: &Problem<'_>, fit: &Fit, judged: &(dyn Fn(usize) -> bool + Sync), weight: f64) -> Found {
    let (forces, shifts, spreads) = (terms::forces(), terms::shifts(), terms::spreads());
    let run = |share: f64| FilterRun::of(problem, quieter(fit, share), judged);
    let as_fitted = run(1.0);
    let mut levels = vec![Level::of(&as_fitted, &forces, &shifts)];
    let (spread, variance) = as_fitted.spreads(&spreads);
    // The steps of a coarse sensor make the innovations' variance uneven, because the filter assumes normal states.
    let coarse = fit.model.effects.reading_step_mm().is_some();
    let spread = if coarse { Vec::new() } else { spread.selected(variance, weight, 0.0) };
    let pushed = Moments::of(&as_fitted.steps);
    let (moments, bursts) = (pushed.events_found(&as_fitted.steps, weight), pushed.bursts(weight));
    drop(as_fitted);
    levels.par_extend(QUIETER.par_iter().map(|share| Level::of(&run(*share), &forces, &shifts)));
    let best = levels.iter().map(|level| level.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
    let said = |kind: &str, term: &Term| (format!("{kind} {}", term.words), term.stage);
    let in_motion = |at: usize| match forces.get(at) {
        Some(term) => said("a force that goes with", term),
        None => said("a shift of the readings that goes with", &shifts[at - forces.len()]),
    };
    let in_spread = |at: usize| said("noise that changes with", &spreads[at]);
    let of_level = |level: Level| {
        let behind = best - level.log_likelihood;
        joint_score(&level.motions.selected(1.0, weight, behind), in_motion)
    };
    let mut spread = joint_score(&spread, in_spread);
    spread.nats -= UNEVEN_SPREAD;
    let all = levels.into_iter().map(of_level).chain([spread]);
    let nothing = JointScore { nats: 0.0, terms: Vec::new() };
    let terms = all.fold(nothing, |most, other| if other.nats > most.nats { other } else { most });
    Found { terms, moments, bursts }
}

/// `fit` with the air's noise times `share`: its coloured part if there is one.
fn quieter(fit: &Fit, share: f64) -> Fit {
    let mut fit = fit.clone();
    if !fit.model.effects.scale_coloured_force(share) {
        fit.model.noise.acceleration_psd_mm2_per_s3 *= share;
    }
    fit
}

/// The first terms, as many as maximise the nats together, each with its words and stage.
fn joint_score(selected: &[SelectedTerm], said: impl Fn(usize) -> (String, Option<Stage>)) -> JointScore {
    let most = (0..selected.len()).max_by(|a, b| selected[*a].nats.total_cmp(&selected[*b].nats));
    let Some(most) = most else { return JointScore { nats: 0.0, terms: Vec::new() } };
    let omitted = |selected: &SelectedTerm| {
        let (words, stage) = said(selected.term);
        Omitted { words, z: selected.z, stage }
    };
    JointScore { nats: selected[most].nats, terms: selected[..=most].iter().map(omitted).collect() }
}

/// A filter run with a factor on the air's noise: its scores, and ln p of the readings with the effect of the fitted
/// parameters.
struct Level {
    motions: Scores,
    log_likelihood: f64,
}

impl Level {
    fn of(run: &FilterRun, forces: &[Term], shifts: &[Term]) -> Self {
        let mut motions = run.motions(forces, shifts);
        let judged = run.steps.iter().filter(|step| step.judged);
        let log_likelihood = judged.map(|step| step.innovation.log_density).sum::<f64>() + motions.settle();
        Self { motions, log_likelihood }
    }
}

#[cfg(test)]
mod tests {
    use super::{Found, JointScore, omitted};
    use crate::filter::ekf::Sensitivity;
    use crate::filter::track::segments;
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Parameter, Prior};
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::tests_support::{model, record, shaken};
    use crate::{Recording, Sample};
    use plant::{Effects, Model, Simulator, Stage};

    #[test]
    fn a_constant_push_moves_what_is_expected_as_another_hover_does() {
        let own = Model { effects: Effects::default(), ..model() };
        let recording = record(&own, 3, 20);
        let (here, there) =
            (segments(&own, &recording), segments(&Parameter::Hover.stepped(&own, Parameter::DIFFERENCE), &recording));
        let push = -own.gain_mm_per_s2_per_percent * 0.1 * Parameter::DIFFERENCE;
        let (mut nudged, mut before_s) = (Sensitivity::zero(), 0.0);
        let (mut product, mut square) = (0.0, 0.0);
        for ((taken, leg), (moved, _)) in here.iter().zip(&there).skip(1) {
            let by_push = nudged.go(leg, (leg.time_s - before_s, push, 0.0), taken);
            before_s = leg.time_s;
            let by_hover = moved.expected_mm - taken.expected_mm;
            // The ball takes off from the bottom, where a force has no effect; the filter forgets that later.
            if leg.time_s > 10.0 {
                product += by_push * by_hover;
                square += by_hover * by_hover;
            }
        }
        // The sensitivity neglects that outliers have less weight.
        assert!((product / square - 1.0).abs() < 0.03, "{}", product / square);
    }

    /// A flight with a force of height and time, mm/s², that is not in the catalogue, as a duty that is not logged.
    fn with_force(force: impl Fn(f64, f64) -> f64, seed: u64) -> Recording {
        let rig = model();
        let mut simulator = Simulator::new(rig.clone(), seed);
        let rows = (0..4000).map(|k| {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            let reading = simulator.reading_mm();
            let target = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
            let duty_percent = rig.hover_duty_percent + 0.01 * (target - reading);
            simulator.drive(duty_percent + force(reading, time_s) / rig.gain_mm_per_s2_per_percent);
            Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    /// A flight of a rig whose gain oscillates with 10 periods per flight.
    fn with_swing_of_gain() -> Recording {
        let mut rows = with_force(|_, _| 0.0, 5).samples().to_vec();
        let hover = model().hover_duty_percent;
        // The logged duty is the true duty over the gain.
        for row in &mut rows {
            let swing = 1.0 + 0.5 * (std::f64::consts::TAU * row.time_s / 8.0).sin();
            row.duty_percent = hover + (row.duty_percent - hover) / swing;
        }
        Recording::new(rows).unwrap()
    }

    /// A flight with a step of the readings at 50 s.
    fn with_slip() -> Recording {
        let mut rows = with_force(|_, _| 0.0, 4).samples().to_vec();
        rows.iter_mut()
            .filter(|row| row.time_s > 50.0)
            .for_each(|row| row.position_mm = row.position_mm.map(|mm| mm + 12.0));
        Recording::new(rows).unwrap()
    }

    fn found(recording: &Recording) -> Found {
        let folds = Folds::new(&model(), recording);
        let problem = Problem { recording, belief: &model(), folds: &folds, prior: Prior::Belief };
        let fit = problem.fit(&model(), &BASE);
        omitted(&problem, &fit, &|row| folds.counts(row), 1.0)
    }

    /// Nats and words of the terms and of the events.
    fn joint_scores(recording: &Recording) -> [(f64, Vec<String>); 2] {
        let Found { terms, moments, .. } = found(recording);
        let words = |joint_score: &JointScore| joint_score.terms.iter().map(|term| term.words.clone()).collect();
        [(terms.nats, words(&terms)), (moments.nats, words(&moments))]
    }

    #[test]
    fn a_ripple_of_height_is_found_and_nothing_where_there_is_none() {
        let [(nats, words), _] = joint_scores(&with_force(|mm, _| 60.0 * (mm / 14.0).sin(), 1));
        let of_height = words.iter().any(|words| words.contains("wave of height"));
        assert!(nats > 10.0 && of_height, "{nats} nats for {words:?}");
        for seed in 0..10 {
            for (nats, words) in joint_scores(&with_force(|_, _| 0.0, seed)) {
                assert!(nats < 6.5, "seed {seed}: {nats} nats for {words:?}");
            }
        }
    }

    #[test]
    fn a_gain_that_swings_is_found_by_its_period() {
        let [(nats, words), _] = joint_scores(&with_swing_of_gain());
        let by_period = words.iter().any(|words| words.contains("u times") && words.contains(" 10 periods"));
        assert!(nats > 12.0 && by_period, "{nats} nats for {words:?}");
    }

    #[test]
    fn most_of_what_is_found_acts_at_the_stage_that_is_wrong() {
        let most = |joint_score: &JointScore, stage: Stage| {
            let nats = |own: bool| -> f64 {
                let terms = joint_score.terms.iter().filter(|term| !own || term.stage == Some(stage));
                terms.map(|term| term.z * term.z).sum()
            };
            assert!(nats(true) > 0.5 * nats(false), "{stage:?}: {:?}", joint_score.terms);
        };
        most(&found(&with_force(|mm, _| 60.0 * (mm / 14.0).sin(), 1)).terms, Stage::Air);
        most(&found(&with_swing_of_gain()).terms, Stage::Actuator);
        most(&found(&with_slip()).moments, Stage::Sensor);
    }

    #[test]
    fn gusts_come_in_bursts_and_what_blows_all_the_time_does_not() {
        let gust =
            |_, time_s: f64| if time_s % 7.0 < 0.5 { 250.0 * (time_s / 7.0).floor().sin().signum() } else { 0.0 };
        let bursts = found(&with_force(gust, 6)).bursts;
        assert!(bursts > 4.0, "{bursts}");
        for seed in 0..10 {
            let bursts = found(&with_force(|_, _| 0.0, seed)).bursts;
            assert!(bursts < 3.3, "seed {seed}: {bursts}");
        }
    }

    #[test]
    fn what_has_made_the_air_seem_turbulent_is_found_all_the_same() {
        // With the air's noise as fitted the score is 32 nats.
        let [(nats, words), _] = joint_scores(&with_force(|mm, _| 90.0 * (mm / 14.0).sin(), 1));
        assert!(nats > 45.0, "{nats} nats for {words:?}");
    }

    #[test]
    fn pushes_and_slips_are_found_when_they_happen() {
        let push = |_, time_s: f64| if (40.0..40.4).contains(&time_s) { 400.0 } else { 0.0 };
        let [_, (nats, words)] = joint_scores(&with_force(push, 3));
        let when = |words: &[String], at: &str| words.iter().any(|words| words.contains(at));
        assert!(nats > 8.0 && (when(&words, "push") && when(&words, "at 40.")), "{nats} nats for {words:?}");
        let [_, (nats, words)] = joint_scores(&with_slip());
        assert!(nats > 8.0 && when(&words, "shift of the readings from 50."), "{nats} nats for {words:?}");
    }

    /// Nats of the terms for a rig with two lags in series and a model with one.
    fn of_two_lags(small_s: f64, seed: u64) -> f64 {
        let mut rig = model();
        rig.effects.set("fan_lag", &[0.2 - small_s]);
        rig.effects.set("sensor_lag", &[small_s]);
        let (belief, recording) = (model(), shaken(&rig, seed, 120));
        let folds = Folds::new(&belief, &recording);
        let search =
            Search::of(Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief });
        omitted(&search.problem, &refitted(&search), &|row| folds.counts(row), 1.0).terms.nats
    }

    #[test]
    fn the_small_one_of_two_lags_is_not_found_as_it_is_the_form_of_the_other() {
        for seed in 0..3 {
            let nats = of_two_lags(0.02, seed);
            assert!(nats < 6.5, "seed {seed}: {nats} nats for the form");
        }
    }
}
