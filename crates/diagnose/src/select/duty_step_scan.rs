//! Initial values for a duty quantisation: a scan over step sizes by their scores.
//!
//! ```text
//! e = a(step·round(duty/step)) − a(duty), through the fan lag       force that the quantisation adds
//! z²(step)                                                          its score: see `score_test::ProjectedInnovations`
//! next step = step + step²/(16·ū)              moves an edge at the usual duty ū by a sixteenth of a step
//! ```
//!
//! Every edge of a quantised duty lies at a multiple of the step. So the likelihood has a narrow maximum for each step,
//! a thousandth of it wide. A filter run for each would take minutes; a score is one linear pass.

use crate::fit::estimate::{Fit, Problem};
use crate::record::commanded::commanded;
use crate::record::implausible::NO_PERCENT;
use crate::residual::score_test::{FilterRun, ProjectedInnovations, share_after};
use plant::{Entry, Model};
use rayon::prelude::*;

/// Range of step sizes, percent.
const FINEST_PERCENT: f64 = 0.3;
const COARSEST_PERCENT: f64 = 2.5;
/// Neighbouring steps move an edge at the usual duty by one part of a step in so many.
const PARTS: f64 = 16.0;
/// Number of best steps that are refined, and at which shares of the spacing.
const BEST: usize = 12;
const CLOSER: [f64; 5] = [-0.4, -0.2, 0.0, 0.2, 0.4];

/// The steps with the highest scores given `fit`, percent of duty, and the number of steps that were tested.
pub(crate) fn steps(problem: &Problem<'_>, fit: &Fit, effect: &Entry) -> (Vec<f64>, usize) {
    let samples = problem.recording.samples();
    let run = FilterRun::of(problem, fit.clone(), &|row| problem.folds.counts(row));
    let (projected, rows) = (ProjectedInnovations::of(&run), run.rows_on_the_way(problem.recording));
    let lag_s = fit.model.linear().fan_lag_s;
    // The rows before each reading include the delay of the duty already.
    let model = Model { effects: fit.model.effects.without_duty_delay(), ..fit.model.clone() };
    let fine = commanded(&model, problem.recording);
    let score = |step_percent: f64| {
        let mut coarse = model.clone();
        coarse.effects.set(effect.name, &[step_percent]);
        let coarse = commanded(&coarse, problem.recording);
        let mut late = 0.0;
        projected.score(|at, dt| {
            let added = rows[at].clone().map(|row| coarse[row] - fine[row]).sum::<f64>() / rows[at].len().max(1) as f64;
            late += (added - late) * share_after(dt, lag_s);
            late
        })
    };
    let usual = usual_duty(samples.iter().map(|row| row.duty_percent));
    let comb: Vec<f64> = comb(usual).collect();
    let mut rated: Vec<(f64, f64)> = comb.par_iter().map(|step| (score(*step), *step)).collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    let closer = rated.par_iter().take(BEST).map(|(z2, step)| {
        let near = CLOSER.map(|share| step + share * spacing(*step, usual)).map(|near| (score(near), near));
        near.into_iter().fold((*z2, *step), |best, next| if next.0 > best.0 { next } else { best }).1
    });
    (closer.collect(), comb.len())
}

/// Root mean square, 1 to 150 percent: the comb has as many steps as it is large.
fn usual_duty(duties: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = duties.clone().count().max(1) as f64;
    (duties.map(|duty| duty * duty).sum::<f64>() / count).sqrt().clamp(1.0, NO_PERCENT)
}

fn spacing(step: f64, usual_percent: f64) -> f64 {
    step * step / (PARTS * usual_percent)
}

fn comb(usual_percent: f64) -> impl Iterator<Item = f64> {
    let next = move |step: &f64| Some(step + spacing(*step, usual_percent));
    std::iter::successors(Some(FINEST_PERCENT), next).take_while(|step| *step < COARSEST_PERCENT)
}

#[cfg(test)]
mod tests {
    use super::{comb, steps, usual_duty};
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Prior};
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use plant::effects::{DutyQuantisation, Hysteresis};
    use plant::{Effects, Model};

    #[test]
    fn the_step_of_a_coarse_duty_is_among_those_asked_for_to_a_thousandth() {
        let belief = Model { effects: Effects::default(), ..model() };
        for step_percent in [0.57, 0.8, 1.234] {
            let effects =
                Effects { duty_quantisation: Some(DutyQuantisation { step_percent }), ..belief.effects.clone() };
            let recording = record(&Model { effects, ..belief.clone() }, 1, 80);
            let folds = Folds::new(&belief, &recording);
            let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
            let (found, among) =
                steps(&problem, &problem.fit(&belief, &BASE), Effects::built_in("duty_quantisation").unwrap());
            assert!(found.iter().any(|found| (found / step_percent - 1.0).abs() < 1e-3), "{found:?} of {step_percent}");
            assert!(among > 500 && found.len() < 20, "{} of {among}", found.len());
        }
    }

    #[test]
    fn a_step_is_found_through_the_play_that_hides_most_of_it() {
        let step_percent = 0.926;
        let play = Hysteresis { half_width_percent: 0.4 };
        let known = Model { effects: Effects { hysteresis: Some(play), ..Effects::default() }, ..model() };
        let effects = Effects { duty_quantisation: Some(DutyQuantisation { step_percent }), ..known.effects.clone() };
        let recording = record(&Model { effects, ..known.clone() }, 1, 80);
        let folds = Folds::new(&known, &recording);
        let problem = Problem { recording: &recording, belief: &known, folds: &folds, prior: Prior::Belief };
        let found = steps(&problem, &problem.fit(&known, &BASE), Effects::built_in("duty_quantisation").unwrap()).0;
        assert!(found.iter().any(|found| (found / step_percent - 1.0).abs() < 1e-3), "{found:?} of {step_percent}");
    }

    #[test]
    fn no_duty_makes_the_comb_longer_than_a_percent_does() {
        for duty in [f64::NAN, 1e3, -1e6, 1e308] {
            let usual = usual_duty([20.0, duty].into_iter());
            assert!(comb(usual.max(1.0)).take(10_000).count() < 10_000, "{duty}");
        }
    }

    #[test]
    fn neighbours_on_the_comb_move_an_edge_at_a_usual_duty_by_a_sixteenth_of_a_step() {
        let all: Vec<f64> = comb(21.4).collect();
        for pair in all.windows(2) {
            let edge = (21.4 / pair[0]).round();
            assert!((edge * (pair[1] - pair[0]) / pair[0] - 1.0 / 16.0).abs() < 4e-3, "{pair:?}");
        }
    }
}
