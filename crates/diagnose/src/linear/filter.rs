//! The innovations of a linear plant as a regression on its gain and its hover.

use super::step::Step;
use super::{LinearFit, Order, Point, period_s};
use crate::record::recording::Recording;

/// Variance of the first state in readings' variances.
const UNKNOWN: f64 = 1e9;
/// First innovations of a flight that do not count: they set the state.
const SETTLING: usize = 8;
/// Fewest innovations.
const FEWEST: usize = 40;

/// The columns of a recording as the regression needs them.
pub(super) struct Input {
    /// Rows of each flight: time, input, reading.
    flights: Vec<Vec<(f64, f64, Option<f64>)>>,
    /// The usual time between rows, seconds.
    pub(super) period_s: f64,
}

impl Input {
    pub(super) fn of(recording: &Recording) -> Option<Self> {
        let moves = |[low, high]: [f64; 2]| high > low;
        if !moves(recording.duty_range()) || !moves(recording.height_range()) {
            return None;
        }
        let first = recording.samples().iter().find_map(|sample| sample.position_mm).unwrap_or_default();
        let row = |sample: &crate::Sample| {
            (sample.time_s, sample.duty_percent, sample.position_mm.map(|position| position - first))
        };
        let flights =
            recording.flights().iter().map(|rows| recording.samples()[rows.clone()].iter().map(row).collect());
        Some(Self { flights: flights.collect(), period_s: period_s(recording)? })
    }
}

/// Sums of the regression of the innovations, each over its deviation.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: usize,
    log_variance: f64,
    yy: f64,
    yu: f64,
    y1: f64,
    uu: f64,
    u1: f64,
    one: f64,
}

/// The result of the regression.
#[derive(Clone, Copy, Debug)]
pub(super) struct Regression {
    gain: f64,
    constant: f64,
    gain_deviation: f64,
    variance: f64,
    pub(super) log_likelihood: f64,
    of_input: f64,
}

impl Regression {
    pub(super) fn fit(self, point: Point, period_s: f64) -> LinearFit {
        LinearFit {
            order: point.order,
            gain: self.gain,
            gain_in_deviations: self.gain / self.gain_deviation,
            hover: -self.constant / self.gain,
            drag_per_s: point.drag_per_s,
            spring_per_s2: point.spring_per_s2,
            lag_s: point.lag_s,
            sensor: self.variance.sqrt(),
            psd: self.variance * noise_psd(point, period_s),
            log_likelihood: self.log_likelihood,
            of_input: self.of_input,
        }
    }
}

/// The noise's power spectral density per variance of a reading.
fn noise_psd(point: Point, period_s: f64) -> f64 {
    let power = match point.order {
        Order::First => 1,
        Order::Second | Order::Spring | Order::Unstable => 3,
        Order::Drifting => 5,
    };
    point.noise_ratio / period_s.powi(power)
}

/// Filters the flights and fits gain and constant. `None`: too few innovations, or numbers that are not finite.
pub(super) fn regression(input: &Input, point: Point) -> Option<Regression> {
    let psd = noise_psd(point, input.period_s);
    let mut sums = Sums::default();
    for rows in &input.flights {
        filter(rows, point, psd, &mut sums);
    }
    solve(&sums)
}

fn filter(rows: &[(f64, f64, Option<f64>)], point: Point, psd: f64, sums: &mut Sums) {
    let Some(&(mut time_s, first, _)) = rows.first() else { return };
    // States of the reading's, the input's and the constant's channel; their common covariance.
    let mut states = [[0.0; 3]; 3];
    let force = if point.order == Order::Drifting { UNKNOWN } else { 0.0 };
    let (mut p, mut seen) = ([UNKNOWN, 0.0, 0.0, UNKNOWN, 0.0, force], 0);
    let (mut held, mut lagged) = (first, first);
    let mut step: Option<(f64, Step)> = None;
    for &(now_s, next, reading) in rows {
        let dt = now_s - time_s;
        if dt > 0.0 {
            let step = match step {
                // Times as text differ in their last digits.
                Some((of, step)) if (of - dt).abs() < 1e-6 * of => step,
                _ => step.insert((dt, Step::over(dt, point))).1,
            };
            let mean = if point.lag_s > 0.0 {
                let before = lagged;
                lagged = held + (lagged - held) * (-dt / point.lag_s).exp();
                0.5 * (before + lagged)
            } else {
                held
            };
            for (state, input) in states.iter_mut().zip([0.0, mean, 1.0]) {
                *state = step.moved(*state, input);
            }
            p = step.spread(p, psd);
        }
        (time_s, held) = (now_s, next);
        let Some(reading) = reading else { continue };
        let s = p[0] + 1.0;
        let innovations = [reading - states[0][0], -states[1][0], -states[2][0]];
        let gain = [p[0] / s, p[1] / s, p[2] / s];
        for (state, innovation) in states.iter_mut().zip(innovations) {
            *state = std::array::from_fn(|i| state[i] + gain[i] * innovation);
        }
        p = [p[0] / s, p[1] / s, p[2] / s, p[3] - gain[1] * p[1], p[4] - gain[1] * p[2], p[5] - gain[2] * p[2]];
        seen += 1;
        if seen > SETTLING {
            sums.add(s, innovations[0], -innovations[1], -innovations[2]);
        }
    }
}

impl Sums {
    fn add(&mut self, s: f64, y: f64, u: f64, one: f64) {
        self.count += 1;
        self.log_variance += s.ln();
        self.yy += y * y / s;
        self.yu += y * u / s;
        self.y1 += y * one / s;
        self.uu += u * u / s;
        self.u1 += u * one / s;
        self.one += one * one / s;
    }
}

fn solve(sums: &Sums) -> Option<Regression> {
    let n = sums.count as f64;
    let determinant = sums.uu * sums.one - sums.u1 * sums.u1;
    if sums.count < FEWEST || determinant <= 1e-12 * sums.uu * sums.one {
        return None;
    }
    let gain = (sums.yu * sums.one - sums.y1 * sums.u1) / determinant;
    let constant = (sums.y1 * sums.uu - sums.yu * sums.u1) / determinant;
    let least = f64::MIN_POSITIVE * 1e10;
    let rest = (sums.yy - gain * sums.yu - constant * sums.y1).max(1e-12 * sums.yy).max(least);
    let without = (sums.yy - sums.y1 * sums.y1 / sums.one).max(rest);
    let log_likelihood = |rest: f64| -0.5 * (n * (rest / n).ln() + sums.log_variance);
    let variance = rest / n;
    let found = Regression {
        gain,
        constant,
        gain_deviation: (variance * sums.one / determinant).sqrt(),
        variance,
        log_likelihood: log_likelihood(rest),
        of_input: log_likelihood(rest) - log_likelihood(without),
    };
    (found.gain * found.constant * found.gain_deviation * found.log_likelihood).is_finite().then_some(found)
}
