//! A model's Kalman filter along a recording, and forecasts from any of its readings.
//!
//! ```text
//! state x = (y, v, A)                         see `plant::Motion`
//! x ← RK4(x, duty), P ← Φ·P·Φᵀ + Q            Φ = ∂RK4/∂x by central differences
//! Q = PSD·dt/6 · ( g₀·g₀ᵀ + 4·g·gᵀ + g₁·g₁ᵀ )   white acceleration over a step: Simpson's rule of Φ(s)·e_v
//!     g₀ = e_v, g₁ = Φ·e_v, g = (g₀ + g₁)/2
//! ```
//!
//! The extended Kalman filter: exact for the linear part, which central differences reproduce to rounding,
//! and for whatever acts on the duty alone. Each stretch between two rows uses its real length.
//! Source: Gelb, *Applied Optimal Estimation*, chapter 6.

use crate::likelihood::Surprise;
use crate::recording::{Recording, Sample};
use control::kalman::Kalman;
use nalgebra::{Matrix3, RowVector3, Vector3};
use plant::{Model, Motion};

/// Longest integration step, seconds: RK4 is exact to 1e-6 of a rig's motion there.
const MAX_STEP_S: f64 = 0.02;
/// The reading is the position.
const POSITION: RowVector3<f64> = RowVector3::new(1.0, 0.0, 0.0);
/// Steps of the central differences in mm, mm/s and mm/s²: small beside a flight, large beside rounding.
const NUDGE: [f64; 3] = [1e-3, 1e-2, 1e-1];
/// Before the first reading nothing is known of the velocity but that a ball in a pipe stays below 2 m/s.
const VELOCITY_PRIOR_MM_PER_S: f64 = 1000.0;

/// Wild readings come singly: so many in a row are the ball, and the filter is what was wrong.
const WILD_IN_A_ROW: u32 = 2;

/// A model's filter along a recording: its estimate after each reading.
#[derive(Debug)]
pub struct Track<'a> {
    model: &'a Model,
    samples: &'a [Sample],
    /// Rows that hold a reading, and the estimate after it.
    estimates: Vec<(usize, Kalman<3>)>,
    /// Every reading but the first, as it was seen coming.
    surprises: Vec<Surprise>,
}

/// What a model expects of a later reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// The row of the reading.
    pub row: usize,
    /// Expected reading, mm.
    pub position_mm: f64,
    /// Its variance by the model's noise, the reading's own included, mm².
    pub variance_mm2: f64,
}

impl<'a> Track<'a> {
    /// Runs the filter of `model` over `recording`.
    #[must_use]
    pub fn new(model: &'a Model, recording: &'a Recording) -> Self {
        let samples = recording.samples();
        let mut estimates = Vec::with_capacity(samples.len());
        let mut surprises = Vec::with_capacity(samples.len());
        let mut filter: Option<Kalman<3>> = None;
        let mut wild_run = 0;
        for (row, sample) in samples.iter().enumerate() {
            if let (Some(filter), Some(before)) = (&mut filter, row.checked_sub(1).map(|r| &samples[r])) {
                advance(filter, model, before.duty_percent, sample.time_s - before.time_s);
            }
            if let Some(reading) = sample.position_mm {
                let filter = filter.get_or_insert_with(|| prior(model, reading, sample.duty_percent));
                let surprise = take(filter, row, reading, reading_variance(model), wild_run >= WILD_IN_A_ROW);
                wild_run = if surprise.weight < 0.5 { wild_run + 1 } else { 0 };
                if !estimates.is_empty() {
                    surprises.push(surprise);
                }
                estimates.push((row, *filter));
            }
        }
        Self { model, samples, estimates, surprises }
    }

    /// Every reading but the first, which has nothing to be compared with, as the model saw it coming.
    #[must_use]
    pub fn into_surprises(self) -> Vec<Surprise> {
        self.surprises
    }

    /// What was known after each reading but the last: its row, and position, velocity and fan acceleration.
    pub fn states(&self) -> impl Iterator<Item = (usize, [f64; 3])> {
        let known = self.estimates.iter().take(self.estimates.len().saturating_sub(1));
        known.map(|(row, filter)| (*row, [filter.state[0], filter.state[1], filter.state[2]]))
    }

    /// How many readings the recording has.
    #[must_use]
    pub fn readings(&self) -> usize {
        self.estimates.len()
    }

    /// The row, time and position of reading number `reading`.
    #[must_use]
    pub fn reading(&self, reading: usize) -> Option<(usize, f64, f64)> {
        let &(row, _) = self.estimates.get(reading)?;
        let sample = self.samples.get(row)?;
        Some((row, sample.time_s, sample.position_mm?))
    }

    /// Forecasts every later reading from what was known after reading number `from`, by the recorded duty.
    pub fn forecasts(&self, from: usize) -> impl Iterator<Item = Forecast> {
        let start = self.estimates.get(from).copied();
        let (mut row, mut filter) = start.map_or((usize::MAX, None), |(row, filter)| (row, Some(filter)));
        std::iter::from_fn(move || {
            let filter = filter.as_mut()?;
            loop {
                let (before, next) = (self.samples.get(row)?, self.samples.get(row + 1)?);
                row += 1;
                advance(filter, self.model, before.duty_percent, next.time_s - before.time_s);
                if next.position_mm.is_some() {
                    let (position_mm, variance_mm2) = filter.expect(&POSITION, reading_variance(self.model));
                    return Some(Forecast { row, position_mm, variance_mm2 });
                }
            }
        })
    }
}

/// The filter before its first reading, which it then takes as it takes every other.
fn prior(model: &Model, reading_mm: f64, duty_percent: f64) -> Kalman<3> {
    let commanded = model.commanded(duty_percent);
    // How far the fan may be from where it is told to go: it may stand still.
    let fan_percent = if model.effects.fan_lag.is_some() { model.hover_duty_percent.abs().max(1.0) } else { 0.0 };
    let fan = fan_percent * model.gain_mm_per_s2_per_percent;
    let deviations = Vector3::new(model.pipe_length_mm, VELOCITY_PRIOR_MM_PER_S, fan);
    Kalman {
        state: Vector3::new(reading_mm, 0.0, commanded),
        covariance: Matrix3::from_diagonal(&deviations.component_mul(&deviations)),
    }
}

/// A reading's variance, never quite 0: a sensor without noise still leaves the filter a division.
fn reading_variance(model: &Model) -> f64 {
    model.noise.sensor_mm.powi(2).max(1e-9)
}

/// Takes a reading as far as it is no wild one: its weight divides the variance of the innovation. `believed`: take it
/// whatever it looks like.
fn take(filter: &mut Kalman<3>, row: usize, reading: f64, variance: f64, believed: bool) -> Surprise {
    let (expected, expected_variance) = filter.expect(&POSITION, variance);
    let surprise = Surprise::of(row, reading - expected, expected_variance);
    let weight = if believed { 1.0 } else { surprise.weight.max(1e-6) };
    filter.update(reading, &POSITION, variance + expected_variance / weight - expected_variance);
    surprise
}

/// Moves the filter on by `dt_s` under a constant duty.
fn advance(filter: &mut Kalman<3>, model: &Model, duty_percent: f64, dt_s: f64) {
    let commanded = model.commanded(duty_percent);
    let steps = (dt_s / model.longest_step_s(MAX_STEP_S)).ceil().max(1.0);
    let dt = dt_s / steps;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
    for _ in 0..steps as u64 {
        let motion =
            Motion { position_mm: filter.state[0], velocity_mm_per_s: filter.state[1], fan_mm_per_s2: filter.state[2] };
        // An end of the pipe stops the ball, not the doubt about it: the covariance grows as if there were none.
        let transition = derivative(|nudged| nudged.step_in_endless_pipe(model, commanded, dt), &motion);
        let next = motion.step(model, commanded, dt);
        filter.predict(vector(&next), &transition, &process_noise(model, &transition, dt));
    }
}

/// The covariance that white acceleration gathers over a step with this `transition`.
fn process_noise(model: &Model, transition: &Matrix3<f64>, dt: f64) -> Matrix3<f64> {
    let (first, last) = (Vector3::y(), transition * Vector3::y());
    let middle = (first + last) / 2.0;
    let outer = |g: Vector3<f64>| g * g.transpose();
    (outer(first) + 4.0 * outer(middle) + outer(last)) * (model.noise.acceleration_psd_mm2_per_s3 * dt / 6.0)
}

fn vector(motion: &Motion) -> Vector3<f64> {
    Vector3::new(motion.position_mm, motion.velocity_mm_per_s, motion.fan_mm_per_s2)
}

/// ∂flow/∂x at `motion` by central differences.
fn derivative(flow: impl Fn(&Motion) -> Motion, motion: &Motion) -> Matrix3<f64> {
    let columns = std::array::from_fn::<_, 3, _>(|i| {
        let nudged = |by: f64| {
            let mut nudged = *motion;
            match i {
                0 => nudged.position_mm += by,
                1 => nudged.velocity_mm_per_s += by,
                _ => nudged.fan_mm_per_s2 += by,
            }
            vector(&flow(&nudged))
        };
        (nudged(NUDGE[i]) - nudged(-NUDGE[i])) / (2.0 * NUDGE[i])
    });
    Matrix3::from_columns(&columns)
}

#[cfg(test)]
mod tests {
    use super::{Track, VELOCITY_PRIOR_MM_PER_S};
    use crate::tests_support::{model, record};
    use plant::{Model, Noise};

    #[test]
    fn forecasts_of_a_noiseless_flight_by_its_own_model_are_exact() {
        let noise = Noise { sensor_mm: 0.0, acceleration_psd_mm2_per_s3: 0.0 };
        let own = Model { noise, ..model() };
        let recording = record(&own, 1, 20);
        // A filter that trusts its readings forgets that the ball took off in the middle of a step.
        let noise = Noise { sensor_mm: 1e-4, acceleration_psd_mm2_per_s3: 360.0 };
        let trusting = Model { noise, ..own };
        let track = Track::new(&trusting, &recording);
        for forecast in track.forecasts(400) {
            let real = recording.samples()[forecast.row].position_mm.unwrap();
            assert!((forecast.position_mm - real).abs() < 0.02, "{} for {real}", forecast.position_mm);
        }
    }

    #[test]
    fn the_spread_of_forecasts_is_what_the_filter_says_it_is() {
        // Normalised squared errors of one-second forecasts average to 1, over many flights.
        let own = model();
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..40 {
            let recording = record(&own, seed, 30);
            let track = Track::new(&own, &recording);
            for from in (100..1400).step_by(50) {
                let forecast = track.forecasts(from).nth(49).unwrap();
                let real = recording.samples()[forecast.row].position_mm.unwrap();
                sum += (forecast.position_mm - real).powi(2) / forecast.variance_mm2;
                count += 1.0;
            }
        }
        // 1040 almost independent errors: five standard errors are 0.22.
        assert!((sum / count - 1.0_f64).abs() < 0.22, "{}", sum / count);
    }

    #[test]
    fn one_wild_reading_is_passed_over_and_a_ball_that_moved_is_followed() {
        let own = model();
        let good = record(&own, 5, 20);
        let spoilt = |rows: std::ops::Range<usize>| {
            let rows = good.samples().iter().enumerate().map(|(k, s)| {
                let jump = if rows.contains(&k) { 150.0 } else { 0.0 };
                crate::Sample { position_mm: s.position_mm.map(|mm| mm + jump), ..*s }
            });
            crate::Recording::new(rows.collect()).unwrap()
        };
        let expected_after = |recording: &crate::Recording, row: usize| {
            Track::new(&own, recording).forecasts(row).next().unwrap().position_mm
        };
        let clean = expected_after(&good, 500);
        assert!((expected_after(&spoilt(500..501), 500) - clean).abs() < 1.0);
        assert!((expected_after(&spoilt(500..1000), 510) - clean).abs() > 100.0);
    }

    #[test]
    fn rows_without_a_reading_are_flown_through() {
        let own = model();
        let full = record(&own, 5, 20);
        let thinned = full.samples().iter().enumerate();
        let thinned = thinned.map(|(k, s)| crate::Sample { position_mm: s.position_mm.filter(|_| k % 3 == 0), ..*s });
        let recording = crate::Recording::new(thinned.collect()).unwrap();
        let track = Track::new(&own, &recording);
        assert_eq!(track.readings(), full.samples().len().div_ceil(3));
        assert!(track.forecasts(10).all(|forecast| forecast.row % 3 == 0));
    }

    #[test]
    fn the_first_reading_leaves_the_velocity_open() {
        let own = model();
        let recording = record(&own, 5, 5);
        let track = Track::new(&own, &recording);
        let first = track.forecasts(0).next().unwrap();
        // One period later the velocity's prior dominates the variance.
        assert!(first.variance_mm2 > (0.9 * VELOCITY_PRIOR_MM_PER_S * 0.02).powi(2), "{}", first.variance_mm2);
    }
}
