//! Initial values for an effect that a user wrote: a scan over the parameters that have no neutral value.
//!
//! ```text
//! θ·∂adds/∂θ at each place p of the range          force, or shift of the readings, of small neutral parameters θ
//! z²(p), θ(p)                                       joint score and best sizes: see `ProjectedInnovations::joint`
//! places                                            a scale apart, or a seventh of the range where that is nearer
//! ```
//!
//! The likelihood has a maximum at every frequency, height or moment that noise resembles, and a fit climbs the nearest
//! one. A filter run for each place would take seconds; a score is one linear pass. Only local maxima of the score are
//! returned: places beside them lead to the same fit, and are no choice of their own.

use crate::fit::estimate::{Fit, Problem};
use crate::residual::score_test::{Before, FilterRun, Joint, ProjectedInnovations, share_after};
use plant::{Conditions, Definition, OWN_STATES, ParameterTable, Stage};
use rayon::prelude::*;

/// The number of local maxima from which a search starts, and the shares of the best sizes there. The best sizes go
/// with other base parameters than the fit has, and may be too large without those: a force of 200 mm/s² at 1.13 Hz was
/// lost from full sizes alone.
const BEST: usize = 8;
const SHARES: [f64; 3] = [1.0, 0.4, 0.15];
/// Places of a range without a scale, and the ratio of its ends from which on they are at equal ratios.
const FEW: f64 = 8.0;
const WIDE: f64 = 20.0;
/// The most places of all ranges together, and of an effect with states, whose score takes several times as long. 512
/// are 0.01 Hz apart up to 5 Hz, half the width of a maximum in a record of 60 s.
const MOST: f64 = 512.0;
const MOST_WITH_STATES: f64 = 128.0;

/// Initial values, the best first, and the number of local maxima that they were chosen from.
#[derive(Default)]
pub(crate) struct Scanned {
    pub(crate) values: Vec<Vec<f64>>,
    pub(crate) maxima: usize,
}

/// The initial values with the highest scores given `fit`. `None`: the effect acts already, or has nothing to scan.
pub(crate) fn scan(problem: &Problem<'_>, fit: &Fit, effect: &'static Definition) -> Option<Scanned> {
    let free = effect.table().parameters.values().filter(|parameter| parameter.neutral.is_none()).count();
    if free == 0 || fit.model.effects.values(effect.entry().name).is_some() {
        return None;
    }
    let run = FilterRun::of(problem, fit.clone(), &|row| problem.folds.counts(row));
    let linear = Linearised::of(problem, fit, &run);
    let maxima = linear.maxima(effect);
    let values = maxima.iter().take(BEST).flat_map(Maximum::starts);
    Some(Scanned { values: values.collect(), maxima: maxima.len() })
}

/// A local maximum of the score.
pub(crate) struct Maximum {
    /// z² of the sizes together.
    pub(crate) square: f64,
    /// The values there, with the neutral sizes.
    neutral: Vec<f64>,
    /// The values there, with the best sizes.
    values: Vec<f64>,
}

impl Maximum {
    /// Initial values of a fit: the values with shares of the best sizes.
    pub(crate) fn starts(&self) -> [Vec<f64>; SHARES.len()] {
        let pairs = || self.neutral.iter().zip(&self.values);
        SHARES.map(|share| pairs().map(|(none, all)| none + share * (all - none)).collect())
    }
}

/// The innovations of a fit, linear in what a small effect adds.
pub(crate) struct Linearised<'a> {
    projected: ProjectedInnovations<'a>,
    before: Vec<Option<Before>>,
    /// Behind which an effect of the actuator acts, seconds.
    lag_s: f64,
}

impl<'a> Linearised<'a> {
    /// Of the filter run of `fit`.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit, run: &'a FilterRun) -> Self {
        let (projected, before) = (ProjectedInnovations::of(run), run.before_readings(problem));
        Self { projected, before, lag_s: fit.model.linear().fan_lag_s }
    }

    /// The local maxima of the score of an effect over its free values, the best first.
    pub(crate) fn maxima(&self, effect: &'static Definition) -> Vec<Maximum> {
        let parameters: Vec<&ParameterTable> = effect.table().parameters.values().collect();
        let free = parameters.iter().filter(|parameter| parameter.neutral.is_none()).count();
        let most = if effect.table().states.is_empty() { MOST } else { MOST_WITH_STATES };
        let axes = parameters.iter().map(|parameter| match parameter.neutral {
            Some(neutral) => vec![neutral],
            None => places(parameter, most.powf(1.0 / free as f64)),
        });
        let grid = Grid { axes: axes.collect() };
        let small = Small { effect, parameters: &parameters, linear: self };
        let scored: Vec<Option<(f64, Vec<f64>)>> =
            (0..grid.len()).into_par_iter().map(|at| small.scored(grid.values(at))).collect();
        let score = |at: usize| scored[at].as_ref().map_or(0.0, |(square, _)| *square);
        let tops = (0..grid.len()).filter(|at| grid.is_local_maximum(*at, score));
        let maximum = |at: usize| {
            let (square, values) = scored[at].clone()?;
            Some(Maximum { square, neutral: grid.values(at), values })
        };
        let mut maxima: Vec<Maximum> = tops.filter_map(maximum).collect();
        maxima.sort_by(|a, b| b.square.total_cmp(&a.square));
        maxima
    }
}

/// Places of a range from one end to the other.
fn places(parameter: &ParameterTable, most: f64) -> Vec<f64> {
    let ParameterTable { low, high, scale, .. } = *parameter;
    let ratio = (high / low).powf(1.0 / (most.min(FEW) - 1.0).max(1.0));
    let is_wide = low > 0.0 && high / low > WIDE;
    let finest = (high - low) / (most - 1.0).max(1.0);
    let scale = scale.map_or(f64::INFINITY, |scale| scale.max(finest));
    let next = |at: &f64| {
        let few = if is_wide { at * (ratio - 1.0) } else { (high - low) / (FEW - 1.0) };
        Some(at + few.max(if is_wide { 0.0 } else { finest }).min(scale))
    };
    // What rounding leaves of the last step is no step.
    let end = high - 1e-9 * (high - low);
    std::iter::successors(Some(low), next).take_while(|at| *at < end).chain([high]).collect()
}

/// Places of several ranges; the last one varies fastest.
struct Grid {
    axes: Vec<Vec<f64>>,
}

impl Grid {
    fn len(&self) -> usize {
        self.axes.iter().map(Vec::len).product()
    }

    /// For each axis: the distance of neighbours along it, and the number of its places.
    fn strides(&self) -> impl Iterator<Item = (usize, usize)> {
        let after = |axis: usize| self.axes[axis + 1..].iter().map(Vec::len).product();
        (0..self.axes.len()).map(move |axis| (after(axis), self.axes[axis].len()))
    }

    fn values(&self, at: usize) -> Vec<f64> {
        self.strides().zip(&self.axes).map(|((stride, count), axis)| axis[at / stride % count]).collect()
    }

    /// Whether a score is above 0 and above those of its neighbours. Of equal neighbours the first counts.
    fn is_local_maximum(&self, at: usize, score: impl Fn(usize) -> f64) -> bool {
        let own = score(at);
        own > 0.0
            && self.strides().all(|(stride, count)| {
                let place = at / stride % count;
                (place == 0 || own > score(at - stride)) && (place + 1 == count || own >= score(at + stride))
            })
    }
}

/// An effect that is small, so that what it adds is linear in the parameters that have a neutral value.
struct Small<'a> {
    effect: &'static Definition,
    parameters: &'a [&'a ParameterTable],
    linear: &'a Linearised<'a>,
}

impl Small<'_> {
    /// The joint score of the parameters with a neutral value, the others being as in `values`; and the values with the
    /// best sizes. `None` where all of them are neutral.
    fn scored(&self, mut values: Vec<f64>) -> Option<(f64, Vec<f64>)> {
        let sized: Vec<(usize, f64)> = self.parameters.iter().enumerate().filter_map(step).collect();
        let added: Vec<Vec<(f64, f64)>> = sized
            .iter()
            .map(|(index, step)| {
                let mut of_one = values.clone();
                of_one[*index] += step;
                self.added(&of_one)
            })
            .collect();
        let Joint { square, sizes } = self.linear.projected.joint(sized.len(), |one, k| added[one][k])?;
        let mut acts = false;
        for ((index, step), size) in sized.into_iter().zip(sizes) {
            let ParameterTable { low, high, .. } = *self.parameters[index];
            let neutral = values[index];
            values[index] = (neutral + size * step).clamp(low, high);
            acts |= values[index] != neutral;
        }
        acts.then_some((square, values))
    }

    /// The force before each reading, mm/s², and the shift of the reading, mm.
    fn added(&self, values: &[f64]) -> Vec<(f64, f64)> {
        let (mut own, mut late) = ([0.0; OWN_STATES], 0.0);
        let stage = self.effect.table().stage;
        let of = |before: &Option<Before>| {
            let Some(Before { dt_s, conditions, is_first }) = before else { return (0.0, 0.0) };
            if *is_first {
                (own, late) = (self.effect.settled_with(values, conditions), 0.0);
            }
            let now = Conditions { own, ..*conditions };
            own = self.effect.states_with(values, &now, *dt_s);
            let added = self.effect.adds_with(values, &Conditions { own, ..now });
            match stage {
                Stage::Sensor => (0.0, added),
                Stage::Air | Stage::Ball => (added, 0.0),
                Stage::Actuator => {
                    let change = conditions.gain_mm_per_s2_per_percent * added - late;
                    late += change * share_after(*dt_s, self.linear.lag_s);
                    (late, 0.0)
                }
            }
        };
        self.linear.before.iter().map(of).collect()
    }
}

/// The index of a parameter that has a neutral value, and a step from it within its bounds.
fn step((index, parameter): (usize, &&ParameterTable)) -> Option<(usize, f64)> {
    let ParameterTable { neutral, scale, low, high, .. } = **parameter;
    let (neutral, step) = (neutral?, scale.unwrap_or(0.1 * (high - low)));
    Some((index, if neutral + step <= high { step } else { (-step).max(low - neutral) }))
}

#[cfg(test)]
mod tests {
    use super::{Grid, places, scan};
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Prior};
    use crate::record::folds::Folds;
    use crate::tests_support::{model, shaken};
    use plant::{Definition, DefinitionTable, Model, ParameterTable, Stage, StateTable};

    fn parameter(value: Option<f64>, scale: Option<f64>, low: f64, high: f64) -> ParameterTable {
        let neutral = if value.is_some() { None } else { Some(0.0) };
        ParameterTable { neutral, value, scale, low, high, unit: String::new() }
    }

    /// `a·sin + b·cos` of a frequency, in one stage.
    fn swing(stage: Stage, name: &str) -> &'static Definition {
        let size = || parameter(None, Some(0.1), -2000.0, 2000.0);
        let table = DefinitionTable {
            stage,
            adds: "a * sin(2 * pi * hz * t) + b * cos(2 * pi * hz * t)".into(),
            looks: String::new(),
            mend: String::new(),
            parameters: [
                ("a".to_owned(), size()),
                ("b".to_owned(), size()),
                ("hz".to_owned(), parameter(Some(0.5), Some(0.01), 0.05, 5.0)),
            ]
            .into(),
            states: [].into(),
        };
        Definition::new(name, &table).unwrap()
    }

    /// A part of the fan's force that swings: a resonance with two states.
    fn resonance() -> &'static Definition {
        let state = |rate: &str, start: &str| StateTable { rate: rate.into(), start: start.into() };
        let table = DefinitionTable {
            stage: Stage::Air,
            adds: "share * (p - fan)".into(),
            looks: String::new(),
            mend: String::new(),
            parameters: [
                ("share".to_owned(), parameter(None, Some(0.2), -1.0, 1.0)),
                ("hz".to_owned(), parameter(Some(1.0), None, 0.3, 6.5)),
            ]
            .into(),
            states: [
                ("p".to_owned(), state("q", "fan")),
                ("q".to_owned(), state("(2 * pi * hz)^2 * (fan - p) - 0.4 * 2 * pi * hz * q", "0")),
            ]
            .into(),
        };
        Definition::new("resonance_of_a_scan", &table).unwrap()
    }

    /// The best initial values for a rig with these values, and the number of local maxima.
    fn best(effect: &'static Definition, values: &[f64]) -> (Vec<f64>, usize) {
        let mut belief = model();
        belief.effects.written.define(effect);
        let mut rig = belief.clone();
        assert!(rig.effects.set(effect.entry().name, values));
        let recording = shaken(&rig, 3, 40);
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let scanned = scan(&problem, &problem.fit(&belief, &BASE), effect).unwrap();
        assert!(scanned.values.len() <= 24);
        (scanned.values[0].clone(), scanned.maxima)
    }

    #[test]
    fn a_periodic_force_of_unknown_frequency_is_found_with_its_size_and_phase_at_every_stage() {
        let sizes = [(Stage::Air, 40.0), (Stage::Sensor, 3.0), (Stage::Actuator, 0.2)];
        for ((stage, size), hz) in sizes.into_iter().zip([0.333, 2.717, 1.234]) {
            let (found, maxima) =
                best(swing(stage, &format!("swing_{}", stage.name())), &[0.6 * size, -0.8 * size, hz]);
            assert!((found[2] - hz).abs() < 0.012, "{stage:?}: {found:?}");
            let amplitude = found[0].hypot(found[1]);
            assert!((0.6..1.4).contains(&(amplitude / size)), "{stage:?}: {found:?}");
            // Its phase, at the middle of the record.
            let phase = |a: f64, b: f64, hz: f64| b.atan2(a) + std::f64::consts::TAU * hz * 20.0;
            let off = phase(found[0], found[1], found[2]) - phase(0.6, -0.8, hz);
            assert!(off.cos() > 0.8, "{stage:?}: {found:?}");
            assert!(maxima > 40 && maxima < 250, "{maxima}");
        }
    }

    #[test]
    fn a_resonance_far_from_its_usual_frequency_is_found() {
        // In the order of their names: the frequency, then the share.
        let (found, _) = best(resonance(), &[3.0, 0.8]);
        assert!((2.0..4.5).contains(&found[0]) && (0.3..1.0).contains(&found[1]), "{found:?}");
    }

    #[test]
    fn an_effect_that_acts_already_and_one_without_free_values_are_not_scanned() {
        let effect = swing(Stage::Air, "swing_that_acts");
        let mut belief: Model = model();
        belief.effects.written.define(effect);
        belief.effects.set(effect.entry().name, &[1.0, 1.0, 0.5]);
        let recording = shaken(&belief, 3, 20);
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        assert!(scan(&problem, &problem.fit(&belief, &BASE), effect).is_none());
    }

    #[test]
    fn places_are_a_scale_apart_eight_without_one_and_at_equal_ratios_where_the_range_is_wide() {
        let even = places(&parameter(Some(1.0), None, -5.0, 9.0), 512.0);
        assert_eq!(even, [-5.0, -3.0, -1.0, 1.0, 3.0, 5.0, 7.0, 9.0]);
        let wide = places(&parameter(Some(1.0), None, 0.1, 12.8), 512.0);
        assert!(wide.len() == 8 && wide.windows(2).all(|pair| (pair[1] / pair[0] - 2.0).abs() < 1e-9), "{wide:?}");
        let fine = places(&parameter(Some(0.5), Some(0.01), 0.05, 5.0), 512.0);
        assert!((490..520).contains(&fine.len()) && (fine[400] - fine[399] - 0.01).abs() < 1e-9, "{}", fine.len());
        // A tiny scale asks for no more than the most.
        assert!(places(&parameter(Some(0.5), Some(1e-9), 0.05, 5.0), 100.0).len() < 120);
    }

    #[test]
    fn a_local_maximum_is_above_its_neighbours_along_every_range() {
        let grid = Grid { axes: vec![vec![0.0, 1.0], vec![5.0], vec![2.0, 3.0, 4.0]] };
        let scores = [1.0, 3.0, 2.0, 4.0, 0.0, 2.0];
        let maxima: Vec<usize> = (0..grid.len()).filter(|at| grid.is_local_maximum(*at, |at| scores[at])).collect();
        assert_eq!(maxima, [1, 3]);
        assert_eq!(grid.values(3), [1.0, 5.0, 2.0]);
    }
}
