//! A filter run along a record and its sensitivities: the scores of forces, of shifts, and of spreads.

use super::scores::Scores;
use super::terms::{Known, Term};
use crate::filter::ekf::{Segment, Sensitivity};
use crate::filter::innovation::Innovation;
use crate::filter::track::{expected_mm, segments};
use crate::fit::estimate::{Fit, Problem};
use crate::fit::lag_form::{dead_time_beside, form_s, lags};
use crate::fit::parameter::Parameter;
use crate::record::recording::Recording;
use nalgebra::DVector;
use plant::Model;
use std::ops::Range;

/// A reading with less weight than this is left out.
const LEAST_WEIGHT: f64 = 1e-3;
/// Longest time step of the regressors between two readings, seconds.
const GAP_S: f64 = 1.0;

/// A filter run along a record: the regressors before each reading, and its innovation.
pub(crate) struct FilterRun {
    pub(super) fit: Fit,
    pub(super) steps: Vec<Step>,
    /// For each fitted parameter: sensitivity of each expected reading, standard deviations.
    pub(super) own: Vec<Vec<f64>>,
    /// The same for the form of each lag, in the scale of its prior.
    forms: Vec<Vec<f64>>,
}

/// A reading, the filter segment before it, and the regressors.
pub(super) struct Step {
    /// Time of the reading, seconds.
    pub(super) time_s: f64,
    pub(super) leg: Segment,
    pub(super) innovation: Innovation,
    /// Time since the previous reading, seconds; `None` if there is none.
    pub(super) dt: Option<f64>,
    known: Known,
    pub(super) judged: bool,
}

impl Step {
    /// The square root of the weight of the reading.
    pub(super) fn root_weight(&self) -> f64 {
        self.innovation.weight.max(LEAST_WEIGHT).sqrt()
    }

    pub(super) fn has_weight(&self) -> bool {
        self.innovation.weight > LEAST_WEIGHT
    }
}

impl FilterRun {
    /// Runs the filter of `fit` along the record. Only rows that are `judged` are scored.
    pub(crate) fn of(problem: &Problem<'_>, fit: Fit, judged: &dyn Fn(usize) -> bool) -> Self {
        let way = segments(&fit.model, problem.recording);
        let own = fit.parameters.iter().filter(|parameter| !parameter.is_noise());
        let own = own.map(|parameter| moved(problem, &fit.model, *parameter, &way)).collect();
        let forms = forms_of_lags(&fit.model).map(|(model, late)| moved(problem, &model, late, &way)).collect();
        let known = known(problem, &fit, &way);
        let steps = way.into_iter().zip(known).map(|((innovation, leg), (dt, known))| {
            let judged = dt.is_some() && judged(innovation.row);
            Step { time_s: problem.recording.samples()[innovation.row].time_s, leg, innovation, dt, known, judged }
        });
        Self { fit, steps: steps.collect(), own, forms }
    }

    /// The row of each reading.
    pub(crate) fn rows(&self) -> Vec<usize> {
        self.steps.iter().map(|step| step.innovation.row).collect()
    }

    /// Scores of forces and shifts, in this order, together with the columns of the fitted parameters.
    pub(super) fn motions(&self, forces: &[Term], shifts: &[Term]) -> Scores {
        let terms = forces.len() + shifts.len();
        let mut scores = Scores::new(self.own.len(), self.forms.len(), terms);
        let before = self.own.len() + self.forms.len();
        let mut nudged = vec![Sensitivity::zero(); terms];
        let mut row = DVector::zeros(before + terms);
        for (k, step) in self.steps.iter().enumerate() {
            let Some(dt) = step.dt else {
                nudged.fill(Sensitivity::zero());
                continue;
            };
            let (innovation, root_weight) = (&step.innovation, step.root_weight());
            let deviation = innovation.variance_mm2.sqrt();
            for (at, (nudged, term)) in nudged.iter_mut().zip(forces.iter().chain(shifts)).enumerate() {
                let value = (term.of)(&step.known);
                let (push, shift_mm) = if at < forces.len() { (value, 0.0) } else { (0.0, value) };
                let moved_mm = nudged.go(&step.leg, (dt, push, shift_mm), innovation);
                row[before + at] = root_weight * moved_mm / deviation;
            }
            for (at, own) in self.own.iter().chain(&self.forms).enumerate() {
                row[at] = root_weight * own[k];
            }
            if step.judged && step.has_weight() && row.iter().all(|value| value.is_finite()) {
                scores.add(&row, innovation.standardised / root_weight);
            }
        }
        scores
    }

    /// The rows whose duties were in force between the previous reading and each reading.
    pub(crate) fn rows_on_the_way(&self, recording: &Recording) -> Vec<Range<usize>> {
        let samples = recording.samples();
        let delay_s = self.fit.model.effects.duty_delay_s();
        let (mut before, mut rows) = (0, Vec::with_capacity(self.steps.len()));
        for step in &self.steps {
            let flight = recording.flight_of(step.innovation.row);
            let until_s = samples[flight.start].time_s + step.leg.time_s - delay_s;
            let from = before.max(flight.start);
            let end = from + samples[from..flight.end].partition_point(|row| row.time_s < until_s);
            rows.push(from..end.max(from + 1).min(flight.end));
            before = end.saturating_sub(1);
        }
        rows
    }

    /// Scores of spreads given a constant noise level, and the variance of the variable they are scores of.
    pub(super) fn spreads(&self, terms: &[Term]) -> (Scores, f64) {
        let mut scores = Scores::new(1, 0, terms.len());
        let judged = || self.steps.iter().filter(|step| step.judged && step.has_weight());
        // The cube root of a square is nearly normal, so that a few large squares are not taken for a spread.
        let size = |step: &Step| step.innovation.standardised.abs().powf(2.0 / 3.0);
        let count = judged().count().max(1) as f64;
        let mean = judged().map(size).sum::<f64>() / count;
        let variance = judged().map(|step| (size(step) - mean).powi(2)).sum::<f64>() / count;
        for step in judged() {
            let row = DVector::from_iterator(
                1 + terms.len(),
                std::iter::once(1.0).chain(terms.iter().map(|term| (term.of)(&step.known))),
            );
            scores.add(&row, size(step));
        }
        scores.settle();
        (scores, variance.max(f64::MIN_POSITIVE))
    }
}

/// For each lag of `model`: the model with the dead time that represents its form, and the parameter of that dead time.
fn forms_of_lags(model: &Model) -> impl Iterator<Item = (Model, Parameter)> + '_ {
    lags().filter_map(|lag| {
        let late = dead_time_beside(lag)?;
        if model.effects.values(lag.name).is_none() || model.effects.values(late.name).is_some() {
            return None;
        }
        let mut with_late = model.clone();
        with_late.effects.set(late.name, &[0.0]);
        let size = form_s(&model.effects, lag);
        Some((with_late, Parameter::Effect { entry: late, index: 0, size }))
    })
}

/// Sensitivity of each expected reading to a parameter, standard deviations per scale of the parameter.
fn moved(problem: &Problem<'_>, model: &Model, parameter: Parameter, way: &[(Innovation, Segment)]) -> Vec<f64> {
    let there = expected_mm(&parameter.stepped(model, Parameter::DIFFERENCE), problem.recording);
    let shift = |(innovation, _): &(Innovation, Segment)| {
        let moved_mm = there[innovation.row].map_or(0.0, |there| there - innovation.expected_mm);
        moved_mm / Parameter::DIFFERENCE / innovation.variance_mm2.sqrt()
    };
    way.iter().map(shift).collect()
}

/// Mean and standard deviation; the latter is never 0.
fn spread(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt().max(f64::MIN_POSITIVE))
}

/// Time since the previous reading and the regressors before each reading.
fn known(problem: &Problem<'_>, fit: &Fit, way: &[(Innovation, Segment)]) -> Vec<(Option<f64>, Known)> {
    let samples = problem.recording.samples();
    let u = |at: usize| samples[way[at].0.row].duty_percent - fit.model.hover_duty_percent;
    let scale_u = spread((0..way.len()).map(u)).1;
    let (middle, scale_x) = spread(way.iter().map(|(_, leg)| leg.known.0));
    let scale_v = spread(way.iter().map(|(_, leg)| leg.known.1)).1;
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
        let (x, v) = way[before].1.known;
        let t = 2.0 * way[k].1.time_s / length_s.max(f64::MIN_POSITIVE) - 1.0;
        known.go_on(dt, [u(before) / scale_u, (x - middle) / scale_x, v / scale_v, t]);
        (Some(dt), known)
    };
    (0..way.len()).map(step).collect()
}
