//! Linear plants fitted to a recording without initial values: which one, with which gain and of which sign.
//!
//! ```text
//! second order   ÿ = K·(u − h) − a·ẏ + w          first order   ẏ = K·(u − h) − a·y + w
//! with a spring  ÿ = K·(u − h) − a·ẏ − k·y + w    reading  y + noise,   w white
//! ```
//!
//! With a, k and the ratio of the noises given, the innovations of the Kalman filter are linear in K and K·h, so both
//! follow by least squares, and the likelihood is maximised over a grid of the others. The input is the recorded one,
//! in closed loop as well (direct approach): the innovations of a right model are white.
//! Source: Harvey, *Forecasting, Structural Time Series Models and the Kalman Filter*, section 3.4 (regression by
//! innovations).

mod filter;
pub(crate) mod step;

use crate::record::recording::Recording;
use crate::stats::median::median;
use filter::{Input, Regression, regression};
use rayon::prelude::*;
use std::borrow::Cow;

/// The form of the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// The input drives the speed of what is read.
    First,
    /// The input drives its acceleration.
    Second,
    /// The same, with a force that returns it to one place.
    Spring,
    /// The same, with a force that drives it away from one place: negative stiffness, unstable in open loop.
    Unstable,
    /// The input drives its acceleration, beside a force that wanders: w is the rate of that force.
    Drifting,
}

/// A fitted linear plant, in the units of the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearFit {
    /// Its form.
    pub order: Order,
    /// K: per unit of the input; may be negative.
    pub gain: f64,
    /// K in its standard deviations.
    pub gain_in_deviations: f64,
    /// The input that holds it still.
    pub hover: f64,
    /// a, 1/s.
    pub drag_per_s: f64,
    /// k, 1/s²; 0 without a spring, below 0 where the force drives it away.
    pub spring_per_s2: f64,
    /// Time constant of a lag before the plant, seconds.
    pub lag_s: f64,
    /// Standard deviation of a reading.
    pub sensor: f64,
    /// Power spectral density of w.
    pub psd: f64,
    /// Maximum of the log-likelihood, nats.
    pub log_likelihood: f64,
    /// By how much the input raises it, nats.
    pub of_input: f64,
}

/// Rows at the beginning of a flight that a linear plant is fitted to: 60 s at 200 Hz.
const MOST_ROWS: usize = 12_000;

impl LinearFit {
    /// Share of the forecasts' variance that the input explains, of a fit to so many readings.
    #[must_use]
    pub fn explained(&self, readings: f64) -> f64 {
        1.0 - (-2.0 * self.of_input / readings.max(1.0)).exp()
    }
}

/// The beginning of a long flight, as much of it as a linear plant is fitted to.
pub(crate) fn beginning(flight: &Recording) -> Cow<'_, Recording> {
    let rows = flight.samples().get(..MOST_ROWS);
    let first = rows.and_then(|rows| Recording::new(rows.to_vec()).ok());
    first.map_or(Cow::Borrowed(flight), Cow::Owned)
}

/// Drags of the grid, 1/s, and the factor of their refinement.
const DRAGS_PER_S: [f64; 8] = [0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Springs of the grid, 1/s².
const SPRINGS_PER_S2: [f64; 7] = [0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0];
/// Negative stiffnesses: from −g/l of an upright pendulum of 1 m to −2g/gap of a ball 7 mm below a magnet.
const UNSTABLE_PER_S2: [f64; 6] = [-10.0, -30.0, -100.0, -300.0, -1000.0, -3000.0];
/// Lags of the grid, seconds.
const LAGS_S: [f64; 3] = [0.05, 0.15, 0.4];
/// Ratios of the noises of the grid: variance that w adds in one period, over that of a reading.
const NOISE_RATIOS: [f64; 7] = [1e-9, 1e-7, 1e-5, 1e-3, 1e-1, 10.0, 1e3];
/// Factors by which the grid is refined around its best point.
const REFINED: [f64; 5] = [0.33, 0.56, 1.0, 1.8, 3.0];
const FINER: [f64; 5] = [0.75, 0.87, 1.0, 1.15, 1.33];

/// What the grid varies.
#[derive(Clone, Copy, Debug)]
struct Point {
    order: Order,
    drag_per_s: f64,
    spring_per_s2: f64,
    lag_s: f64,
    noise_ratio: f64,
}

/// The most likely plant of a form. `None`: too few readings, or an input or a position that never moves.
#[must_use]
pub fn linear_fit(recording: &Recording, order: Order) -> Option<LinearFit> {
    let input = Input::of(recording)?;
    let springs = match order {
        Order::Spring => &SPRINGS_PER_S2[..],
        Order::Unstable => &UNSTABLE_PER_S2,
        Order::First | Order::Second | Order::Drifting => &[0.0],
    };
    let mut grid = Vec::new();
    for &drag_per_s in &DRAGS_PER_S {
        for &spring_per_s2 in springs {
            let all = NOISE_RATIOS.iter();
            grid.extend(all.map(|&noise_ratio| Point { order, drag_per_s, spring_per_s2, lag_s: 0.0, noise_ratio }));
        }
    }
    let (coarse, _) = best(&input, &grid)?;
    let lags =
        std::iter::once(0.0).chain(if order == Order::First { &LAGS_S[..0] } else { &LAGS_S[..] }.iter().copied());
    let with_lags: Vec<Point> = lags.flat_map(|lag_s| refined(Point { lag_s, ..coarse }, REFINED)).collect();
    let (near, _) = best(&input, &with_lags)?;
    let (point, found) = best(&input, &refined(near, FINER))?;
    Some(found.fit(point, input.period_s))
}

/// The most likely plant whose drag and lag are given.
#[must_use]
pub fn linear_fit_at(recording: &Recording, drag_per_s: f64, lag_s: f64) -> Option<LinearFit> {
    let input = Input::of(recording)?;
    let at = |noise_ratio| Point { order: Order::Second, drag_per_s, spring_per_s2: 0.0, lag_s, noise_ratio };
    let (coarse, _) = best(&input, &NOISE_RATIOS.map(at))?;
    let (point, found) = best(&input, &REFINED.map(|by| at(coarse.noise_ratio * by * by)))?;
    Some(found.fit(point, input.period_s))
}

/// Points around one, in drag, noise and spring.
fn refined(point: Point, factors: [f64; 5]) -> Vec<Point> {
    let drags = factors.map(|by| Point { drag_per_s: point.drag_per_s * by, ..point });
    let both =
        drags.iter().flat_map(|near| factors.map(|by| Point { noise_ratio: near.noise_ratio * by * by, ..*near }));
    let springs = if point.spring_per_s2 == 0.0 { &[1.0][..] } else { &factors };
    let all =
        both.flat_map(|near| springs.iter().map(move |by| Point { spring_per_s2: near.spring_per_s2 * by, ..near }));
    all.collect()
}

/// The most likely of some points.
fn best(input: &Input, points: &[Point]) -> Option<(Point, Regression)> {
    let fits: Vec<(Point, Regression)> =
        points.par_iter().filter_map(|point| Some((*point, regression(input, *point)?))).collect();
    fits.into_iter().max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood))
}

/// The usual time from row to row, seconds.
fn period_s(recording: &Recording) -> Option<f64> {
    let steps = recording
        .flights()
        .iter()
        .flat_map(|flight| recording.samples()[flight.clone()].windows(2).map(|pair| pair[1].time_s - pair[0].time_s));
    median(steps.filter(|step| *step > 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::{Order, linear_fit, linear_fit_at};
    use crate::random_for_tests::uniform;
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    /// A heater: ẏ = 0.03·u − (y − 20)/30, read with noise, its power drawn anew every 50 s.
    pub(crate) fn heater() -> Recording {
        let (mut level, mut power) = (20.0, 0.0);
        let mut random = uniform(1);
        let rows = (0..6000).map(|k| {
            if k % 500 == 0 {
                power = 100.0 * (random() + 0.5);
            }
            let noise = 0.1 * (random() + random() + random());
            let row = Sample {
                time_s: 0.1 * f64::from(k),
                duty_percent: power,
                position_mm: Some(level + noise),
                ..Sample::default()
            };
            level += 0.1 * (0.03 * power - (level - 20.0) / 30.0);
            row
        });
        Recording::new(rows.collect()).unwrap()
    }

    fn turned(recording: &Recording) -> Recording {
        let row = |row: &Sample| Sample { duty_percent: -row.duty_percent, ..*row };
        Recording::new(recording.samples().iter().map(row).collect()).unwrap()
    }

    #[test]
    fn gain_hover_drag_and_lag_are_found_in_closed_loop_without_initial_values() {
        let fit = linear_fit(&record(&model(), 3, 80), Order::Second).unwrap();
        assert!((0.5..1.5).contains(&(fit.gain / 254.6)), "{fit:?}");
        assert!((fit.hover - 21.4).abs() < 0.05 && fit.lag_s > 0.0, "{fit:?}");
        let at = linear_fit_at(&record(&model(), 3, 80), 1.889, 0.2).unwrap();
        assert!((at.gain / 254.6 - 1.0).abs() < 0.2 && (at.sensor / 2.5 - 1.0).abs() < 0.1, "{at:?}");
    }

    #[test]
    fn an_input_of_the_other_sign_has_a_gain_of_the_other_sign() {
        let flight = record(&model(), 3, 80);
        let [plain, other] = [&flight, &turned(&flight)].map(|one| linear_fit(one, Order::Second).unwrap());
        assert!((plain.gain + other.gain).abs() < 1e-6 * plain.gain, "{plain:?} {other:?}");
        assert!((plain.hover + other.hover).abs() < 1e-6 && other.gain_in_deviations < -20.0, "{other:?}");
    }

    #[test]
    fn a_heater_is_a_plant_of_first_order_and_a_ball_is_not() {
        let likelihood = |recording: &Recording, order| linear_fit(recording, order).unwrap().log_likelihood;
        let heater = heater();
        let first = linear_fit(&heater, Order::First).unwrap();
        assert!((first.drag_per_s - 1.0 / 30.0).abs() < 0.005, "{first:?}");
        assert!(first.log_likelihood > likelihood(&heater, Order::Second) + 100.0);
        let ball = record(&model(), 3, 80);
        assert!(likelihood(&ball, Order::Second) > likelihood(&ball, Order::First) + 100.0);
    }

    #[test]
    fn what_never_moves_has_no_fit() {
        let rows = (0..100).map(|k| Sample { time_s: f64::from(k), position_mm: Some(1.0), ..Sample::default() });
        assert!(linear_fit(&Recording::new(rows.collect()).unwrap(), Order::Second).is_none());
    }
}
