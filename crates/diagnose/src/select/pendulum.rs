//! Initial values for gravity on a rig whose position is an angle: a regression without a filter.
//!
//! ```text
//! x″ = K·(u − hover) − a·x′ + A·sin(2πx/turn) + B·cos(2πx/turn)
//! D f = (f₃ − f₂)/(t₃ − t₂) − (f₂ − f₁)/(t₂ − t₁)                     over readings a horizon apart
//! D x = K·D∬u − a·D∫x + A·D∬sin + B·D∬cos + c·D(t²/2)                  c = −K·hover
//! ```
//!
//! D takes the straight lines out of both sides, so that no velocity is needed; the equation holds exactly for any
//! horizon and at uneven times, and is linear in K, a, A, B and c. A fit of a linear plant cancels the input against the
//! gravity that it lacks: where a filter starts from it, or from the belief with another angle, the likelihood has
//! many local maxima. Where motion is slow beside a misfit, least squares attenuate K and with it A and B; so they are
//! also solved for the believed K and a.
//! Source: Preisig and Rippin, "Theory and application of the modulating function method", Computers & Chemical
//! Engineering 17 (1993); D is the method with a triangle as its function.

use crate::record::recording::{Recording, Sample};
use nalgebra::{SMatrix, SVector};
use plant::{Entry, Model};
use std::f64::consts::TAU;
use std::ops::Range;

/// Horizons, seconds: from short ones, which follow fast motion, to long ones, which average noise.
const HORIZONS_S: [f64; 3] = [0.05, 0.15, 0.5];
/// The unknowns.
const COUNT: usize = 5;

/// A row of integrals since the start of the flight: x, ∬u, ∫x, ∬sin, ∬cos, t²/2; and its time.
type Integrals = (f64, [f64; COUNT + 1]);

/// The models with gravity as `entry` that follow from regressions over each horizon, of all unknowns and then with the
/// believed gain and drag, beside the noise and the other effects of `model`; none where the position is no angle.
pub(crate) fn regressed(entry: &Entry, model: &Model, belief: &Model, recording: &Recording) -> Vec<Model> {
    let Some(turn_mm) = model.turn_mm else { return Vec::new() };
    let flights = recording.flights().iter();
    let integrals: Vec<Vec<Integrals>> = flights.map(|flight| integrals(recording, flight, turn_mm)).collect();
    let sums: Vec<Sums> = HORIZONS_S.iter().map(|horizon_s| Sums::of(&integrals, *horizon_s)).collect();
    let free = sums.iter().map(Sums::solved);
    let given = sums.iter().map(|sums| sums.solved_given([belief.gain_mm_per_s2_per_percent, -belief.drag_per_s]));
    free.chain(given).filter_map(|solved| pendulum(entry, model, solved?)).collect()
}

/// The integrals at each reading of a flight.
fn integrals(recording: &Recording, flight: &Range<usize>, turn_mm: f64) -> Vec<Integrals> {
    let rows = &recording.samples()[flight.clone()];
    let readings = rows.iter().filter_map(|row| Some((row.time_s, row.position_mm?)));
    let Some((start_s, _)) = readings.clone().next() else { return Vec::new() };
    let mut duties = Duties { rows, time_s: start_s, once: 0.0, twice: 0.0 };
    let (mut last, mut once) = (None, [0.0; 3]);
    let mut twice = [0.0; 2];
    let each = readings.map(|(time_s, x)| {
        let (sin, cos) = (TAU * x / turn_mm).sin_cos();
        let now = [x, sin, cos];
        if let Some((before_s, before)) = last.replace((time_s, now)) {
            let dt: f64 = time_s - before_s;
            let mean = |at: usize| 0.5 * (before[at] + now[at]);
            for at in 0..2 {
                // The integral of a straight line, twice.
                twice[at] += dt * once[at + 1] + dt * dt * (2.0 * before[at + 1] + now[at + 1]) / 6.0;
            }
            once = [0, 1, 2].map(|at| once[at] + dt * mean(at));
        }
        let since_s = time_s - start_s;
        (time_s, [x, duties.twice_until(time_s), once[0], twice[0], twice[1], 0.5 * since_s * since_s])
    });
    each.collect()
}

/// The integral of the duty, each value from its row to the next.
struct Duties<'a> {
    rows: &'a [Sample],
    time_s: f64,
    once: f64,
    twice: f64,
}

impl Duties<'_> {
    /// The integral of the integral until a time, which is not before the last one.
    fn twice_until(&mut self, time_s: f64) -> f64 {
        while let Some(row) = self.rows.first().filter(|_| self.time_s < time_s) {
            let end_s = self.rows.get(1).map_or(time_s, |next| next.time_s.min(time_s));
            let dt = (end_s - self.time_s).max(0.0);
            self.twice += dt * self.once + 0.5 * dt * dt * row.duty_percent;
            self.once += dt * row.duty_percent;
            self.time_s = self.time_s.max(end_s);
            match self.rows.get(1) {
                Some(next) if next.time_s <= time_s => self.rows = &self.rows[1..],
                _ => break,
            }
        }
        self.twice
    }
}

/// D of each integral, over the readings about `horizon_s` before and after.
fn differences(rows: &[Integrals], horizon_s: f64) -> impl Iterator<Item = [f64; COUNT + 1]> {
    let span_s = rows.last().zip(rows.first()).map_or(0.0, |(last, first)| last.0 - first.0);
    let per_s = rows.len() as f64 / span_s.max(f64::MIN_POSITIVE);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of rows")]
    let apart = ((horizon_s * per_s).round() as usize).clamp(1, rows.len().max(1));
    (apart..rows.len().saturating_sub(apart)).map(move |at| {
        let [(t1, f1), (t2, f2), (t3, f3)] = [at - apart, at, at + apart].map(|at| &rows[at]);
        std::array::from_fn(|k| (f3[k] - f2[k]) / (t3 - t2) - (f2[k] - f1[k]) / (t2 - t1))
    })
}

/// The sums of least squares over one horizon.
struct Sums {
    squares: SMatrix<f64, COUNT, COUNT>,
    products: SVector<f64, COUNT>,
}

impl Sums {
    fn of(flights: &[Vec<Integrals>], horizon_s: f64) -> Self {
        let mut sums = Self { squares: SMatrix::zeros(), products: SVector::zeros() };
        for [x, known @ ..] in flights.iter().flat_map(|rows| differences(rows, horizon_s)) {
            let known = SVector::from(known);
            sums.squares += known * known.transpose();
            sums.products += known * x;
        }
        sums
    }

    /// K, −a, A, B and c.
    fn solved(&self) -> Option<[f64; COUNT]> {
        solved(&self.squares, &self.products).map(Into::into)
    }

    /// The same where K and −a are known.
    fn solved_given(&self, known: [f64; 2]) -> Option<[f64; COUNT]> {
        let of_known = self.squares.fixed_view::<3, 2>(2, 0) * SVector::from(known);
        let squares = self.squares.fixed_view::<3, 3>(2, 2).into_owned();
        let [sin, cos, constant] = solved(&squares, &(self.products.fixed_rows::<3>(2) - of_known))?.into();
        Some([known[0], known[1], sin, cos, constant])
    }
}

/// The solution of normal equations, in columns of like size: the integrals have other units.
fn solved<const N: usize>(squares: &SMatrix<f64, N, N>, products: &SVector<f64, N>) -> Option<SVector<f64, N>> {
    let scale = squares.diagonal().map(|square| 1.0 / square.sqrt());
    let scaled = SMatrix::<f64, N, N>::from_fn(|i, j| scale[i] * squares[(i, j)] * scale[j]);
    Some(scaled.cholesky()?.solve(&products.component_mul(&scale)).component_mul(&scale))
}

/// The model with these values; `None`: it is not possible.
fn pendulum(entry: &Entry, model: &Model, [gain, minus_drag, sin, cos, constant]: [f64; COUNT]) -> Option<Model> {
    let radian_mm = model.turn_mm? / TAU;
    // A·sin + B·cos = −amplitude·sin(2π·(x − centre)/turn)
    let (gradient, centre_mm) = (sin.hypot(cos) / radian_mm, cos.atan2(-sin) * radian_mm);
    // Of the turns the one nearest to the middle of the pipe.
    let turns = ((0.5 * model.pipe_length_mm - centre_mm) / model.turn_mm?).round();
    let mut found = Model {
        gain_mm_per_s2_per_percent: gain,
        drag_per_s: (-minus_drag).max(0.0),
        hover_duty_percent: -constant / gain,
        ..model.clone()
    };
    found.effects.set(entry.name, &[gradient, centre_mm + turns * model.turn_mm?, model.turn_mm?]);
    found.check().ok().map(|()| found)
}

#[cfg(test)]
mod tests {
    use super::regressed;
    use crate::tests_support::model;
    use crate::{Recording, Sample};
    use plant::{Effects, Input, Model, Motion};

    /// 100 mm per radian.
    const TURN_MM: f64 = 100.0 * std::f64::consts::TAU;

    /// A pendulum that hangs at 4000 mm, moved by two sines at uneven times; its readings in steps of 0.3 mm.
    fn swinging(rig: &Model) -> Recording {
        let mut motion = Motion::at_rest(4000.0, 0.0);
        let duty = |t: f64| 10.0 + 12.0 * (4.1 * t).sin() + 7.0 * (1.3 * t).cos();
        let rows = (0..2000).map(|k: i32| {
            let (now, dt) = (0.01 * f64::from(k), 0.01 + 0.002 * f64::from(k % 2));
            let time_s = now + 0.002 * f64::from(k / 2);
            let row = Sample {
                time_s,
                duty_percent: duty(time_s),
                position_mm: Some((motion.position_mm / 0.3).round() * 0.3),
                ..Sample::default()
            };
            let commanded_mm_per_s2 = rig.gain_mm_per_s2_per_percent * (duty(time_s) - rig.hover_duty_percent);
            motion = motion.step_in_endless_pipe(rig, Input { commanded_mm_per_s2, time_s, setpoint_mm: None }, dt);
            row
        });
        Recording::new(rows.collect()).unwrap()
    }

    #[test]
    fn a_pendulum_is_found_from_its_swings_whatever_is_believed() {
        let gravity = Effects::built_in("height_dependent_flow").unwrap();
        let turn_mm = Some(TURN_MM);
        let belief = Model { turn_mm, pipe_length_mm: 8000.0, effects: Effects::default(), ..model() };
        let mut rig =
            Model { gain_mm_per_s2_per_percent: 300.0, drag_per_s: 0.7, hover_duty_percent: 9.0, ..belief.clone() };
        rig.effects.set(gravity.name, &[17.0, 4000.0, TURN_MM]);
        let all = regressed(gravity, &belief, &belief, &swinging(&rig));
        assert_eq!(all.len(), 6);
        let found = &all[1];
        let values = found.effects.values(gravity.name).unwrap();
        let near =
            |value: f64, truth: f64, within: f64| assert!((value - truth).abs() < within, "{value}, not {truth}");
        near(values[0], 17.0, 0.5);
        near((values[1] - 4000.0).rem_euclid(TURN_MM).min((4000.0 - values[1]).rem_euclid(TURN_MM)), 0.0, 5.0);
        near(found.gain_mm_per_s2_per_percent, 300.0, 9.0);
        near(found.drag_per_s, 0.7, 0.1);
        near(found.hover_duty_percent, 9.0, 0.4);
        let half = Model { gain_mm_per_s2_per_percent: 150.0, drag_per_s: 0.7, ..belief.clone() };
        let given = regressed(gravity, &belief, &half, &swinging(&rig)).swap_remove(4);
        assert_eq!((given.gain_mm_per_s2_per_percent, given.drag_per_s), (150.0, 0.7));
        let truth = regressed(gravity, &belief, &rig, &swinging(&rig)).swap_remove(4);
        near(truth.effects.values(gravity.name).unwrap()[0], 17.0, 0.5);
        near(truth.hover_duty_percent, 9.0, 0.4);
    }

    #[test]
    fn a_position_that_is_no_angle_has_no_pendulum() {
        let gravity = Effects::built_in("height_dependent_flow").unwrap();
        assert!(regressed(gravity, &model(), &model(), &crate::tests_support::record(&model(), 1, 20)).is_empty());
    }
}
