//! What a model omits: whether the innovations ask for a force, a shift of the readings or a spread that it does not have.
//!
//! ```text
//! force θ·φ        δ ← Φ·δ + g·φ,  s = ∂ŷ/∂θ = H·δ,  δ ← (I − K·H)·δ        what it would do to each expected reading
//! shift θ·φ        s = H·δ + φ, and the filter takes it for motion
//! z                Σ e·r/√Σ r²      r: s/√S without what the fitted numbers of the model can do themselves
//! spread           the same of e² − 1 against φ
//! ```
//!
//! The score (Lagrange multiplier) test: z is normal with variance 1 under a right model, whatever the loop does, because φ is known
//! before the reading. A filter spreads what a force does over the readings that follow; this test looks for it there.
//! Source: Engle, "Wald, likelihood ratio, and Lagrange multiplier tests in econometrics", Handbook of Econometrics 2 (1984).

mod scores;
mod terms;

use crate::cursor::{Leg, Nudged};
use crate::fit::{Fit, Problem};
use crate::free::Free;
use crate::likelihood::Surprise;
use crate::track::legs;
use nalgebra::DVector;
use scores::{Asked, Scores};
use serde::Serialize;
use terms::{Known, Term};

/// Length of the differences in the scales of the fitted numbers.
const DIFFERENCE: f64 = 0.01;
/// A reading that says less than this of what was expected is left out.
const SAYS_NOTHING: f64 = 1e-3;
/// Readings further apart than this are no part of one walk, seconds.
const GAP_S: f64 = 1.0;

/// What the innovations ask for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Omitted {
    /// The term in words.
    pub words: String,
    /// Its score beside those before it, deviations.
    pub z: f64,
}

/// Terms that are asked for together, most first, and −ln of the chance of that among all that were looked at. A `weight` below 1 counts
/// each reading for less.
pub(crate) fn omitted(
    problem: &Problem<'_>,
    fit: &Fit,
    judged: &dyn Fn(usize) -> bool,
    weight: f64,
) -> (f64, Vec<Omitted>) {
    let walk = Walk::of(problem, fit, judged);
    let (forces, shifts, spreads) = (terms::forces(), terms::shifts(), terms::spreads());
    let motions = walk.motions(&forces, &shifts).asked(1.0, weight);
    let (spread, variance) = walk.spreads(&spreads);
    let spread = spread.asked(variance, weight);
    let words = |kind: &str, term: &Term| format!("{kind} {}", term.words);
    let in_motion = |at: usize| match forces.get(at) {
        Some(term) => words("a force that goes with", term),
        None => words("a shift of the readings that goes with", &shifts[at - forces.len()]),
    };
    let in_spread = |at: usize| words("noise that changes with", &spreads[at]);
    let (motions, spread) = (together(&motions, in_motion), together(&spread, in_spread));
    if spread.0 > motions.0 { spread } else { motions }
}

/// As many of them as surprise most together.
fn together(asked: &[Asked], words: impl Fn(usize) -> String) -> (f64, Vec<Omitted>) {
    let most = (0..asked.len()).max_by(|a, b| asked[*a].nats.total_cmp(&asked[*b].nats));
    let Some(most) = most else { return (0.0, Vec::new()) };
    let named = asked[..=most].iter().map(|asked| Omitted { words: words(asked.term), z: asked.z });
    (asked[most].nats, named.collect())
}

/// A filter's way along a record: what was known before each reading, and what came.
struct Walk<'a> {
    fit: &'a Fit,
    steps: Vec<Step>,
    /// By each fitted number: how far the expected readings move, in deviations.
    own: Vec<Vec<f64>>,
}

struct Step {
    leg: Leg,
    surprise: Surprise,
    /// Since the reading before, seconds; `None`: there is none.
    dt: Option<f64>,
    known: Known,
    judged: bool,
}

impl<'a> Walk<'a> {
    fn of(problem: &Problem<'_>, fit: &'a Fit, judged: &dyn Fn(usize) -> bool) -> Self {
        let way = legs(&fit.model, problem.recording);
        let own = fit.free.iter().filter(|free| !matches!(free, Free::SensorNoise | Free::AirNoise));
        let own = own.map(|free| moved(problem, fit, *free, &way)).collect();
        let known = known(problem, fit, &way);
        let steps = way.into_iter().zip(known).map(|((surprise, leg), (dt, known))| {
            let judged = dt.is_some() && judged(surprise.row) && surprise.weight > SAYS_NOTHING;
            Step { leg, surprise, dt, known, judged }
        });
        Self { fit, steps: steps.collect(), own }
    }

    /// Scores of forces and shifts, in this order, beside what the fitted numbers do.
    fn motions(&self, forces: &[Term], shifts: &[Term]) -> Scores {
        let (own, terms) = (self.own.len(), forces.len() + shifts.len());
        let mut scores = Scores::new(own, terms);
        let mut nudged = vec![Nudged::nowhere(); terms];
        let mut row = DVector::zeros(own + terms);
        for (k, step) in self.steps.iter().enumerate() {
            let Some(dt) = step.dt else {
                nudged.fill(Nudged::nowhere());
                continue;
            };
            let surprise = &step.surprise;
            // What a reading says counts as far as it says something.
            let (says, deviation) = (surprise.weight.max(SAYS_NOTHING).sqrt(), surprise.variance_mm2.sqrt());
            for (at, (nudged, term)) in nudged.iter_mut().zip(forces.iter().chain(shifts)).enumerate() {
                let value = (term.of)(&step.known);
                let (push, shift_mm) = if at < forces.len() { (value, 0.0) } else { (0.0, value) };
                let moved_mm = nudged.go(&self.fit.model, &step.leg, (dt, push, shift_mm), surprise);
                row[own + at] = says * moved_mm / deviation;
            }
            for (at, own) in self.own.iter().enumerate() {
                row[at] = says * own[k];
            }
            if step.judged && row.iter().all(|value| value.is_finite()) {
                scores.add(&row, surprise.pull / says);
            }
        }
        scores
    }

    /// Scores of spreads beside a noise that is larger everywhere, and the variance of e² − 1.
    fn spreads(&self, terms: &[Term]) -> (Scores, f64) {
        let mut scores = Scores::new(1, terms.len());
        let judged = || self.steps.iter().filter(|step| step.judged);
        let count = judged().count().max(1) as f64;
        let mean = judged().map(|step| step.surprise.stretch).sum::<f64>() / count;
        let variance = judged().map(|step| (step.surprise.stretch - mean).powi(2)).sum::<f64>() / count;
        for step in judged() {
            let row = DVector::from_iterator(
                1 + terms.len(),
                std::iter::once(1.0).chain(terms.iter().map(|term| (term.of)(&step.known))),
            );
            scores.add(&row, step.surprise.stretch);
        }
        (scores, variance.max(f64::MIN_POSITIVE))
    }
}

/// How far each expected reading moves with a fitted number, in deviations by the number's scale.
fn moved(problem: &Problem<'_>, fit: &Fit, free: Free, way: &[(Surprise, Leg)]) -> Vec<f64> {
    let mut there = vec![None; problem.recording.samples().len()];
    for (surprise, _) in legs(&free.moved(&fit.model, DIFFERENCE), problem.recording) {
        there[surprise.row] = Some(surprise.expected_mm);
    }
    let shift = |(surprise, _): &(Surprise, Leg)| {
        let moved_mm = there[surprise.row].map_or(0.0, |there: f64| there - surprise.expected_mm);
        moved_mm / DIFFERENCE / surprise.variance_mm2.sqrt()
    };
    way.iter().map(shift).collect()
}

/// Mean, and deviation never 0.
fn spread(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt().max(f64::MIN_POSITIVE))
}

/// What was known before each reading, and the time since the one before.
fn known(problem: &Problem<'_>, fit: &Fit, way: &[(Surprise, Leg)]) -> Vec<(Option<f64>, Known)> {
    let samples = problem.recording.samples();
    let u = |at: usize| samples[way[at].0.row].duty_percent - fit.model.hover_duty_percent;
    let scale_u = spread((0..way.len()).map(u)).1;
    let (middle, scale_x) = spread(way.iter().map(|(_, leg)| leg.known().0));
    let scale_v = spread(way.iter().map(|(_, leg)| leg.known().1)).1;
    let mut known = Known::default();
    let step = |k: usize| {
        let flight = problem.recording.flight_of(way[k].0.row);
        let before = k.checked_sub(1).filter(|before| flight.contains(&way[*before].0.row));
        let Some(before) = before else {
            known = Known::default();
            return (None, known);
        };
        let length_s = samples[flight.end - 1].time_s - samples[flight.start].time_s;
        let dt = (way[k].1.time_s - way[before].1.time_s).clamp(0.0, GAP_S);
        let (x, v) = way[before].1.known();
        let t = 2.0 * way[k].1.time_s / length_s.max(f64::MIN_POSITIVE) - 1.0;
        known.go_on(dt, [u(before) / scale_u, (x - middle) / scale_x, v / scale_v, t]);
        (Some(dt), known)
    };
    (0..way.len()).map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::{DIFFERENCE, Nudged, omitted};
    use crate::fit::Problem;
    use crate::folds::Folds;
    use crate::free::{BASE, Free, Prior};
    use crate::tests_support::{model, record};
    use crate::track::legs;
    use crate::{Recording, Sample};
    use plant::{Effects, Model, Simulator};

    #[test]
    fn a_constant_push_moves_what_is_expected_as_another_hover_does() {
        let own = Model { effects: Effects::default(), ..model() };
        let recording = record(&own, 3, 20);
        let (here, there) = (legs(&own, &recording), legs(&Free::Hover.moved(&own, DIFFERENCE), &recording));
        let push = -own.gain_mm_per_s2_per_percent * 0.1 * DIFFERENCE;
        let (mut nudged, mut before_s) = (Nudged::nowhere(), 0.0);
        let (mut product, mut square) = (0.0, 0.0);
        for ((taken, leg), (moved, _)) in here.iter().zip(&there).skip(1) {
            let by_push = nudged.go(&own, leg, (leg.time_s - before_s, push, 0.0), taken);
            before_s = leg.time_s;
            let by_hover = moved.expected_mm - taken.expected_mm;
            // The ball takes off from the bottom, where a push does nothing; later that is forgotten.
            if leg.time_s > 10.0 {
                product += by_push * by_hover;
                square += by_hover * by_hover;
            }
        }
        // Readings far out are taken the less the further they are, which the sensitivity leaves out.
        assert!((product / square - 1.0).abs() < 0.03, "{}", product / square);
    }

    /// A flight with a force of the height, mm/s², that no effect of the catalogue has, given as duty that nobody logged.
    fn with_force(force: impl Fn(f64) -> f64, seed: u64) -> Recording {
        let rig = model();
        let mut simulator = Simulator::new(rig.clone(), seed);
        let rows = (0..4000).map(|k| {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            let reading = simulator.reading_mm();
            let target = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
            let duty_percent = rig.hover_duty_percent + 0.01 * (target - reading);
            simulator.drive(duty_percent + force(reading) / rig.gain_mm_per_s2_per_percent);
            Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    fn asked(recording: &Recording) -> (f64, Vec<String>) {
        let folds = Folds::new(&model(), recording);
        let problem = Problem { recording, belief: &model(), folds: &folds, prior: Prior::Belief };
        let fit = problem.fit(&model(), &BASE);
        let (nats, terms) = omitted(&problem, &fit, &|row| folds.counts(row), 1.0);
        (nats, terms.into_iter().map(|term| term.words).collect())
    }

    #[test]
    fn a_ripple_of_height_is_asked_for_and_nothing_where_there_is_none() {
        let (nats, words) = asked(&with_force(|mm| 60.0 * (mm / 14.0).sin(), 1));
        let of_height = words.iter().any(|words| words.contains("wave of height"));
        assert!(nats > 10.0 && of_height, "{nats} nats for {words:?}");
        for seed in 0..10 {
            let (nats, words) = asked(&with_force(|_| 0.0, seed));
            assert!(nats < 6.5, "seed {seed}: {nats} nats for {words:?}");
        }
    }
}
