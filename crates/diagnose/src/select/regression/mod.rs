//! A regression without a filter, for initial values of a fit.
//!
//! ```text
//! x″ = K·(u − hover) − a·x′ + Σ b_k·f_k(t)                             f: known forces per unit of b
//! D f = (f₃ − f₂)/(t₃ − t₂) − (f₂ − f₁)/(t₂ − t₁)                      over readings a horizon apart
//! D x = K·D∬u − a·D∫x + Σ b_k·D∬f_k + c·D(t²/2)                        c = −K·hover
//! ```
//!
//! D takes the straight lines out of both sides, so that no velocity is needed; the equation holds exactly for any
//! horizon and at uneven times, and is linear in the unknowns. A fit of a linear plant cancels the input against a force
//! that it lacks: where a filter starts from it, or from the belief, the likelihood has many local maxima. Where motion
//! is slow beside a misfit, least squares attenuate K and with it b; so they are also solved for the believed K and a.
//! Equations of wild readings are left out by their residuals, once. Source: Preisig and Rippin, "Theory and application of the modulating function method", Computers & Chemical
//! Engineering 17 (1993); D is the method with a triangle as its function.

mod friction;
mod pendulum;

use crate::record::recording::{Recording, Sample};
use crate::stats::quantile::quantile;
use nalgebra::{DMatrix, DVector};
use plant::{Entry, Model, Start};
use std::ops::Range;

/// Horizons, seconds: from short ones, which follow fast motion, to long ones, which average noise.
const HORIZONS_S: [f64; 3] = [0.05, 0.15, 0.5];

/// The models with `entry` that follow from regressions over each horizon, of all unknowns and then with the believed gain
/// and drag, beside the noise and the other effects of `model`; none where no regression finds the effect.
pub(crate) fn regressed(entry: &Entry, model: &Model, belief: &Model, recording: &Recording) -> Vec<Model> {
    match entry.start {
        Start::DutyOverHeight => pendulum::regressed(entry, model, belief, recording),
        Start::AgainstMotion(_) => friction::regressed(entry, model, belief, recording),
        _ => Vec::new(),
    }
}

/// The integrals at a reading since the start of its flight.
struct Integrals {
    time_s: f64,
    position_mm: f64,
    /// ∬u, ∫x, the ∬f in their order, t²/2.
    known: Vec<f64>,
}

/// The integrals at each reading of a flight; `forces`: the known forces that depend on the position.
fn integrals(recording: &Recording, flight: &Range<usize>, forces: impl Fn(f64) -> Vec<f64>) -> Vec<Integrals> {
    let rows = &recording.samples()[flight.clone()];
    let readings = rows.iter().filter_map(|row| Some((row.time_s, row.position_mm?)));
    let Some((start_s, first_mm)) = readings.clone().next() else { return Vec::new() };
    let mut duties = Duties { rows, time_s: start_s, once: 0.0, twice: 0.0 };
    let count = forces(first_mm).len();
    let (mut of_position, mut once, mut twice) = (0.0, vec![0.0; count], vec![0.0; count]);
    let mut last: Option<(f64, f64, Vec<f64>)> = None;
    let each = readings.map(|(time_s, x)| {
        let now = forces(x);
        if let Some((before_s, before_mm, before)) = &last {
            let dt = time_s - before_s;
            of_position += dt * 0.5 * (before_mm + x);
            for at in 0..count {
                // The integral of a straight line, twice.
                twice[at] += dt * once[at] + dt * dt * (2.0 * before[at] + now[at]) / 6.0;
                once[at] += dt * 0.5 * (before[at] + now[at]);
            }
        }
        last = Some((time_s, x, now));
        let since_s = time_s - start_s;
        let mut known = vec![duties.twice_until(time_s), of_position];
        known.extend(twice.iter().copied());
        known.push(0.5 * since_s * since_s);
        Integrals { time_s, position_mm: x, known }
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

/// D over three readings.
struct Difference {
    /// Of the position, mm/s.
    position: f64,
    known: Vec<f64>,
    /// How far the position moved from the first to the second reading, and on to the third, mm.
    moved_mm: [f64; 2],
}

/// D of each integral, over the readings about `horizon_s` before and after.
fn differences(rows: &[Integrals], horizon_s: f64) -> impl Iterator<Item = Difference> {
    let span_s = rows.last().zip(rows.first()).map_or(0.0, |(last, first)| last.time_s - first.time_s);
    let per_s = rows.len() as f64 / span_s.max(f64::MIN_POSITIVE);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of rows")]
    let apart = ((horizon_s * per_s).round() as usize).clamp(1, rows.len().max(1));
    (apart..rows.len().saturating_sub(apart)).filter_map(move |at| {
        let [first, second, third] = [at - apart, at, at + apart].map(|at| &rows[at]);
        let spans_s = [second.time_s - first.time_s, third.time_s - second.time_s];
        // Two readings at one time have no difference.
        if spans_s.iter().any(|span_s| *span_s <= 0.0) {
            return None;
        }
        let of = |f: [f64; 3]| (f[2] - f[1]) / spans_s[1] - (f[1] - f[0]) / spans_s[0];
        let [x1, x2, x3] = [first, second, third].map(|row| row.position_mm);
        let known = (0..second.known.len()).map(|k| of([first, second, third].map(|row| row.known[k]))).collect();
        Some(Difference { position: of([x1, x2, x3]), known, moved_mm: [x2 - x1, x3 - x2] })
    })
}

/// Residuals beyond so many standard deviations, by their median, are of wild readings.
const WILD: f64 = 4.0;
/// Median of the absolute value of a normal variable, in standard deviations.
const MEDIAN: f64 = 0.6745;

/// The sums of least squares over one horizon, without the equations of wild readings.
struct Sums {
    squares: DMatrix<f64>,
    products: DVector<f64>,
}

impl Sums {
    /// Of these equations, each D x and D of what is known; `None`: there are too few.
    fn of(equations: &[(f64, Vec<f64>)]) -> Option<Self> {
        let first = Self::of_all(equations.iter())?;
        let solved = first.solved()?;
        let residual = |(position, known): &(f64, Vec<f64>)| {
            (position - known.iter().zip(&solved).map(|(known, b)| known * b).sum::<f64>()).abs()
        };
        let mut sizes: Vec<f64> = equations.iter().map(residual).collect();
        sizes.sort_by(f64::total_cmp);
        let most = WILD / MEDIAN * quantile(&sizes, 0.5);
        Self::of_all(equations.iter().filter(|one| residual(one) <= most))
    }

    fn of_all<'a>(equations: impl Iterator<Item = &'a (f64, Vec<f64>)>) -> Option<Self> {
        let mut sums: Option<Self> = None;
        for (position, known) in equations {
            let (count, known) = (known.len(), DVector::from_column_slice(known));
            let zero = || Self { squares: DMatrix::zeros(count, count), products: DVector::zeros(count) };
            let Self { squares, products } = sums.get_or_insert_with(zero);
            squares.ger(1.0, &known, &known, 1.0);
            products.axpy(*position, &known, 1.0);
        }
        sums
    }

    /// K, −a, the b in their order, and c.
    fn solved(&self) -> Option<Vec<f64>> {
        solved(&self.squares, &self.products)
    }

    /// The same where K and −a are known.
    fn solved_given(&self, known: [f64; 2]) -> Option<Vec<f64>> {
        let rest = self.products.len() - 2;
        let of_known = self.squares.view((2, 0), (rest, 2)) * DVector::from(known.to_vec());
        let squares = self.squares.view((2, 2), (rest, rest)).into_owned();
        let other = solved(&squares, &(self.products.rows(2, rest) - of_known))?;
        Some(known.into_iter().chain(other).collect())
    }

    /// Solved for all unknowns, and then for the believed gain and drag.
    fn both_ways(all: &[Self], belief: &Model) -> impl Iterator<Item = Vec<f64>> {
        let believed = [belief.gain_mm_per_s2_per_percent, -belief.drag_per_s];
        let given = all.iter().filter_map(move |sums| sums.solved_given(believed));
        all.iter().filter_map(Self::solved).chain(given)
    }
}

/// The solution of normal equations, in columns of like size: the integrals have other units.
fn solved(squares: &DMatrix<f64>, products: &DVector<f64>) -> Option<Vec<f64>> {
    let scale = squares.diagonal().map(|square| 1.0 / square.sqrt());
    let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| scale[i] * squares[(i, j)] * scale[j]);
    let solution = scaled.cholesky()?.solve(&products.component_mul(&scale)).component_mul(&scale);
    Some(solution.as_slice().to_vec())
}

/// The model with this gain, drag and constant force; `None`: it is not possible.
fn with_base(model: &Model, gain: f64, minus_drag: f64, constant: f64) -> Option<Model> {
    let found = Model {
        gain_mm_per_s2_per_percent: gain,
        drag_per_s: (-minus_drag).max(0.0),
        hover_duty_percent: -constant / gain,
        ..model.clone()
    };
    found.check().ok().map(|()| found)
}
