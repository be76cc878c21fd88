//! Bounds of the information in a record: log-likelihood gain of the departures, and the Cramér–Rao bound of every
//! parameter.
//!
//! The rig follows the filtered heights and speeds of its flight, with a parameter slightly increased and slightly
//! decreased. The difference of the accelerations and of the sensor's signals passes through the error dynamics of a
//! Kalman filter; the standardised innovations are the derivative of the whitened record by that parameter. Turbulence,
//! noise and outliers affect the variance of a record and not its mean, coarse quantisation has no derivative, and play
//! after the ball passes noise that no filter knows: those have no bound here. Lag and delay of the sensor act as if
//! before the ball; the information in the colour of the noise is left out.

use crate::case::Case;
use crate::chance::Source;
use crate::flight::fly;
use crate::forms::STEP_S;
use crate::linear::Spread;
use crate::rig::{Parts, Rig};
use serde::Serialize;
use std::collections::BTreeMap;

/// Effects whose parameters have no bound here.
const WITHOUT: [&str; 7] = [
    "mount_backlash",
    "turbulence",
    "sensor_noise",
    "sensor_outliers",
    "sensor_quantisation",
    "duty_quantisation",
    "stale_samples",
];

/// The bounds of one case.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Bounds {
    /// Case.
    pub(crate) case: String,
    /// Half the squared whitened shift by the departures that refitted parameters of the belief cannot imitate: the
    /// log-likelihood gain of a perfect diagnosis over a refitted belief, nats. Absent for departures that affect the
    /// variance only.
    pub(crate) nats: Option<f64>,
    /// The same of each departure alone, for a belief with the others.
    pub(crate) each: BTreeMap<String, f64>,
    /// Standard deviation of every true parameter, all others being free.
    pub(crate) sigma: BTreeMap<String, f64>,
}

/// Height, speed and duty of a flight, step by step, with the rows' positions among the steps.
struct Flown {
    steps: Vec<(f64, f64, f64)>,
    rows: Vec<usize>,
}

/// Accelerations and sensor signals of a rig along a flight, step by step.
type Led = Vec<(f64, f64)>;

/// Computes the bounds of a case by flying it.
pub(crate) fn bounds(name: &str, case: &Case, source: &Source) -> Bounds {
    let flown = flown(case, source);
    let truth = parts(case);
    let columns = columns(&flown, &truth, source);
    let vectors: Vec<&[f64]> = columns.iter().map(|(_, column)| column.as_slice()).collect();
    let names = case.departures.iter().map(|gone| gone.name);
    let alone = |name: &str| Some((name.to_owned(), nats(case, &|other| other == name, &flown, source)?));
    let each = names.filter_map(alone).collect();
    let sigma = columns.iter().map(|(name, _)| name.clone()).zip(widths(&vectors)).collect();
    Bounds { case: name.to_owned(), nats: nats(case, &|_| true, &flown, source), each, sigma }
}

fn parts(case: &Case) -> Parts {
    Parts { sensor_first: true, ..case.parts() }
}

/// The derivative of the whitened record of a rig by each of its parameters, base first.
fn columns(flown: &Flown, parts: &Parts, source: &Source) -> Vec<(String, Vec<f64>)> {
    let column = |(name, change): (String, Knob)| {
        let (mut up, mut down) = (parts.clone(), parts.clone());
        let span = change(&mut up, 1.0) + change(&mut down, -1.0);
        let shift = whitened(flown, parts, &lead(flown, &up, source), &lead(flown, &down, source));
        (name, shift.iter().map(|value| value / span).collect())
    };
    knobs(parts).into_iter().map(column).collect()
}

/// The log-likelihood gain of the `asked` departures, nats. A belief is linear in gain, drag and hover, so that the
/// projection on its own columns gives the best fit, at any distance.
fn nats(case: &Case, asked: &dyn Fn(&str) -> bool, flown: &Flown, source: &Source) -> Option<f64> {
    // With clutter no model is exact, and the filter here has the usual noise.
    if case.kind.has_clutter()
        || case.departures.is_empty()
        || case.departures.iter().any(|gone| WITHOUT.contains(&gone.name))
    {
        return None;
    }
    let (truth, belief) = (parts(case), without(case, asked));
    let shift = whitened(flown, &truth, &lead(flown, &truth, source), &lead(flown, &belief, source));
    let own = columns(flown, &belief, source);
    let own: Vec<&[f64]> = own.iter().map(|(_, column)| column.as_slice()).collect();
    Some(0.5 * norm2(&beyond(shift, &own)))
}

/// The rig without the `asked` departures, except for gain, drag and hover.
fn without(case: &Case, asked: &dyn Fn(&str) -> bool) -> Parts {
    let truth = parts(case);
    let gone = |name: &str| asked(name) && case.departures.iter().any(|departure| departure.name == name);
    let kept = truth.effects.iter().filter(|effect| !gone(effect.name));
    let believed = case.believed.iter().filter(|effect| gone(effect.name));
    Parts { effects: kept.chain(believed).cloned().collect(), ..truth.clone() }
}

/// Flies a case, and filters it: effects that depend on height and speed are evaluated at the filter's prediction. The
/// true position is known too late; its error is correlated with the noise from which it would have to be separated.
fn flown(case: &Case, source: &Source) -> Flown {
    let mut duties = Vec::new();
    let flight = fly(case, source, |rig| duties.push(rig.duty));
    let rows: Vec<usize> = flight.iter().map(|row| (row.time_s / STEP_S).round() as usize).collect();
    let mut rig = Rig::new(&parts(case), source, flight[0].position_mm, 0.0);
    let (drag, mut spread, mut seen, mut steps) = (case.base.drag_per_s, Spread::WIDE, rig.x, Vec::new());
    for (pair, row) in rows.windows(2).zip(&flight[1..]) {
        for &duty in &duties[pair[0]..pair[1]] {
            rig.duty = duty;
            steps.push((rig.x, rig.v, duty));
            rig.v += STEP_S * (rig.push() - drag * rig.v);
            rig.x += STEP_S * rig.v;
            seen = rig.look();
        }
        spread = spread.after((pair[1] - pair[0]) as f64 * STEP_S, drag);
        // Outliers are limited, as in any robust filter.
        let cut = 5.0 * spread.reading().sqrt();
        let surprise = (row.position_mm - seen).clamp(-cut, cut);
        let ((kx, kv), after) = spread.corrected();
        (rig.x, rig.v, spread) = (rig.x + kx * surprise, rig.v + kv * surprise, after);
    }
    Flown { steps, rows }
}

/// Evaluates a rig along a flight.
fn lead(flown: &Flown, parts: &Parts, source: &Source) -> Led {
    let mut rig = Rig::new(parts, source, flown.steps[0].0, 0.0);
    let led = flown.steps.iter().map(|&(x, v, duty)| {
        (rig.x, rig.v, rig.duty) = (x, v, duty);
        (rig.push() - parts.base.drag_per_s * v, rig.look())
    });
    led.collect()
}

/// The innovations by the difference of two rigs along a flight, in standard deviations.
fn whitened(flown: &Flown, parts: &Parts, one: &Led, other: &Led) -> Vec<f64> {
    let (drag, mut spread) = (parts.base.drag_per_s, Spread::WIDE);
    let (mut x, mut v, mut out) = (0.0, 0.0, Vec::new());
    for pair in flown.rows.windows(2) {
        for step in pair[0]..pair[1] {
            v += STEP_S * (one[step].0 - other[step].0 - drag * v);
            x += STEP_S * v;
        }
        spread = spread.after((pair[1] - pair[0]) as f64 * STEP_S, drag);
        let surprise = x + one[pair[1] - 1].1 - other[pair[1] - 1].1;
        out.push(surprise / spread.reading().sqrt());
        let ((kx, kv), after) = spread.corrected();
        (x, v, spread) = (x - kx * surprise, v - kv * surprise, after);
    }
    out
}

/// Moves a parameter of a rig by a small step to one side, and returns the step.
type Knob = Box<dyn Fn(&mut Parts, f64) -> f64>;

/// Access to a base parameter.
type Place = fn(&mut Parts) -> &mut f64;

/// The parameters that can be moved: the base first, then every parameter of every effect that has a bound.
fn knobs(parts: &Parts) -> Vec<(String, Knob)> {
    let base: [(&str, Place); 3] = [
        ("gain_mm_per_s2_per_percent", |parts| &mut parts.base.gain_mm_per_s2_per_percent),
        ("drag_per_s", |parts| &mut parts.base.drag_per_s),
        ("hover_duty_percent", |parts| &mut parts.base.hover_duty_percent),
    ];
    let mut knobs: Vec<(String, Knob)> = Vec::new();
    for (name, place) in base {
        knobs.push((name.to_owned(), Box::new(move |parts, side| nudge(place(parts), 0.003, side))));
    }
    for effect in parts.effects.iter().filter(|effect| !WITHOUT.contains(&effect.name)) {
        for (&key, &value) in &effect.parameters {
            if value == 0.0 || (effect.name == "end_stop" && value == 600.0) || key == "centre_mm" {
                continue;
            }
            let name = effect.name;
            let knob = move |parts: &mut Parts, side| {
                let effect = parts.effects.iter_mut().find(|effect| effect.name == name);
                effect.map_or(0.0, |effect| nudge(effect.parameters.entry(key).or_default(), 0.02, side))
            };
            knobs.push((format!("{name}.{key}"), Box::new(knob)));
        }
    }
    knobs
}

fn nudge(value: &mut f64, share: f64, side: f64) -> f64 {
    let step = share * value.abs();
    *value += side * step;
    step
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm2(a: &[f64]) -> f64 {
    dot(a, a)
}

/// The part of a vector that is orthogonal to the others: Gram–Schmidt, twice for numerical accuracy.
fn beyond(mut vector: Vec<f64>, others: &[&[f64]]) -> Vec<f64> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let less = |vector: &mut Vec<f64>, basis: &[Vec<f64>]| {
        for axis in basis.iter().chain(basis) {
            let along = dot(vector, axis);
            vector.iter_mut().zip(axis).for_each(|(value, axis)| *value -= along * axis);
        }
    };
    for other in others {
        let (mut rest, size) = (other.to_vec(), norm2(other).sqrt());
        less(&mut rest, &basis);
        let left = norm2(&rest).sqrt();
        if left > 1e-9 * size {
            basis.push(rest.iter().map(|value| value / left).collect());
        }
    }
    less(&mut vector, &basis);
    vector
}

/// Standard deviation of each parameter with all others free: the reciprocal length of its orthogonal part.
fn widths(columns: &[&[f64]]) -> Vec<f64> {
    let width = |k: usize| {
        let others: Vec<&[f64]> = columns.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, c)| *c).collect();
        norm2(&beyond(columns[k].to_vec(), &others)).sqrt().recip().min(1e12)
    };
    (0..columns.len()).map(width).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::all_names;
    use crate::flight::Row;
    use crate::mixture::{Kind, Mixture};

    #[test]
    fn a_width_is_the_reciprocal_of_what_only_that_column_can_make() {
        let found = widths(&[&[3.0, 4.0, 0.0], &[0.0, 5.0, 0.0], &[0.0, 0.0, 2.0]]);
        for (width, expected) in found.iter().zip([1.0 / 3.0, 1.0 / 3.0, 0.5]) {
            assert!((width - expected).abs() < 1e-12, "{found:?}");
        }
    }

    /// Whitened innovations of a filter with the rig's model, in a flight of a neutral rig.
    fn innovations(flown: &Flown, rows: &[Row], parts: &Parts, led: &Led) -> Vec<f64> {
        let drag = parts.base.drag_per_s;
        let (mut spread, mut x, mut v, mut out) = (Spread::WIDE, rows[0].position_mm, 0.0, Vec::new());
        for (pair, row) in flown.rows.windows(2).zip(&rows[1..]) {
            for (push, step) in led[pair[0]..pair[1]].iter().zip(&flown.steps[pair[0]..]) {
                v += STEP_S * (push.0 + drag * step.1 - drag * v);
                x += STEP_S * v;
            }
            spread = spread.after((pair[1] - pair[0]) as f64 * STEP_S, drag);
            let surprise = row.position_mm - x;
            out.push(surprise / spread.reading().sqrt());
            let ((kx, kv), after) = spread.corrected();
            (x, v, spread) = (x + kx * surprise, v + kv * surprise, after);
        }
        out
    }

    #[test]
    fn the_nats_are_what_the_best_belief_of_a_search_leaves() {
        let mixture = Mixture { kinds: vec![(Kind::Outside, 1.0)], effects: vec!["supply_sag"], exact: true };
        for number in 0..2 {
            let source = Source { seed: "nearest".into(), case: number };
            let case = Case::draw(&source, &mixture);
            let (flown, truth) = (flown(&case, &source), parts(&case));
            let told = nats(&case, &|_| true, &flown, &source).unwrap();
            let true_lead = lead(&flown, &truth, &source);
            let left = |at: &[f64; 3]| {
                let mut belief = without(&case, &|_| true);
                belief.base.gain_mm_per_s2_per_percent *= at[0].exp();
                belief.base.drag_per_s *= at[1].exp();
                belief.base.hover_duty_percent += at[2];
                0.5 * norm2(&whitened(&flown, &truth, &true_lead, &lead(&flown, &belief, &source)))
            };
            // Compass search, which does not use the columns.
            let (mut at, mut best, mut step) = ([0.0; 3], left(&[0.0; 3]), 0.5);
            while step > 1e-3 {
                let tries = (0..6).map(|k| {
                    let mut there = at;
                    there[k / 2] += if k % 2 == 0 { step } else { -step };
                    (left(&there), there)
                });
                match tries.min_by(|a, b| a.0.total_cmp(&b.0)) {
                    Some((nearer, there)) if nearer < best => (best, at) = (nearer, there),
                    _ => step /= 2.0,
                }
            }
            // With a believed dead zone, hover is not quite linear.
            assert!((told / best).ln().abs() < 0.1, "case {number}: {told} nats, {best} left at {at:?}");
        }
    }

    #[test]
    fn a_delay_shows_as_much_before_the_ball_as_after_it() {
        let found = ["transport_delay", "sensor_delay"].map(|name| {
            let mixture = Mixture { kinds: vec![(Kind::Single, 1.0)], effects: vec![name], exact: true };
            let nats = |case| {
                let source = Source { seed: "twins".into(), case };
                bounds("", &Case::draw(&source, &mixture), &source).nats.unwrap()
            };
            (0..8).map(nats).sum::<f64>()
        });
        assert!((found[0] / found[1]).ln().abs() < 0.3, "{found:?}");
    }

    #[test]
    fn the_best_estimates_from_neutral_records_scatter_by_the_bounds() {
        let mixture = Mixture { kinds: vec![(Kind::None, 1.0)], effects: all_names(), exact: true };
        let (mut square, mut count) = (0.0, 0.0);
        for number in 0..40 {
            let source = Source { seed: "bounds".into(), case: number };
            let case = Case::draw(&source, &mixture);
            let (flown, parts) = (flown(&case, &source), parts(&case));
            let rows = fly(&case, &source, |_| {});
            let shift = innovations(&flown, &rows, &parts, &lead(&flown, &parts, &source));
            let columns: Vec<Vec<f64>> =
                columns(&flown, &parts, &source).into_iter().map(|(_, column)| column).collect();
            for k in 0..3 {
                let others = columns.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, c)| c.as_slice());
                let only = beyond(columns[k].clone(), &others.collect::<Vec<_>>());
                square += dot(&only, &shift).powi(2) / norm2(&only);
                count += 1.0;
            }
        }
        // 120 values, not quite independent: the standard deviation of their mean square is 0.13.
        assert!((square / count - 1.0).abs() < 0.35, "{}", square / count);
    }
}
