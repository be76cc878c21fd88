//! How well a model explains a recording: the likelihood of its Kalman innovations, robust to wild readings.
//!
//! ```text
//! p(ν) = (1 − ε)·N(ν; 0, S) + ε·N(ν; 0, κ²·S)        ε = 0.002, κ = 10
//! ```
//!
//! One wild reading costs a model some 10 nats, not thousands, and moves its filter by the share in which it is no wild
//! one. The contamination is part of every model alike, so that likelihoods of different models compare.
//! Source: Huber, *Robust Statistics*, the gross-error model.

use crate::recording::Recording;
use plant::Model;

/// Share of wild readings that every model grants.
const WILD_SHARE: f64 = 0.002;
/// How many times wider they scatter.
const WILD_WIDTH: f64 = 10.0;

/// One reading as a model saw it coming.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surprise {
    /// The row of the reading.
    pub row: usize,
    /// ν: reading minus expectation, mm.
    pub residual_mm: f64,
    /// S: its expected variance, mm².
    pub variance_mm2: f64,
    /// The chance that it is no wild reading.
    pub weight: f64,
    /// ln p(ν), nats.
    pub log_density: f64,
}

impl Surprise {
    /// Weighs the residual of a reading. `outliers`: probability and size of wild readings that the model believes in.
    #[must_use]
    pub fn of(row: usize, residual_mm: f64, variance_mm2: f64, outliers: Option<(f64, f64)>) -> Self {
        let normal = |off_mm: f64, width: f64| {
            let square = (residual_mm - off_mm).powi(2) / variance_mm2;
            -0.5 * (square / (width * width) + (std::f64::consts::TAU * variance_mm2).ln()) - width.ln()
        };
        let (share, size_mm) = outliers.unwrap_or_default();
        let good = normal(0.0, 1.0) + ((1.0 - WILD_SHARE) * (1.0 - share)).ln();
        let wild = normal(0.0, WILD_WIDTH) + WILD_SHARE.ln();
        let sides = [size_mm, -size_mm].map(|off| normal(off, 1.0) + ((1.0 - WILD_SHARE) * share / 2.0).ln());
        let most = good.max(wild).max(sides[0]).max(sides[1]);
        let log_density =
            most + [good, wild, sides[0], sides[1]].map(|part| (part - most).exp()).iter().sum::<f64>().ln();
        Self { row, residual_mm, variance_mm2, weight: (good - log_density).exp(), log_density }
    }

    /// A reading that can only repeat the one before: certain to within the recording's resolution if it does, and as good as
    /// impossible if it does not.
    #[must_use]
    pub fn of_repeat(row: usize, repeats: bool, resolution_mm: f64) -> Self {
        let log_density = -resolution_mm.ln() + if repeats { 0.0 } else { WILD_SHARE.ln() - WILD_WIDTH };
        Self { row, residual_mm: 0.0, variance_mm2: 1.0, weight: 1.0, log_density }
    }

    /// ν/√S: normal with variance 1 when the model is right.
    #[must_use]
    pub fn standardised(&self) -> f64 {
        self.residual_mm / self.variance_mm2.sqrt()
    }
}

/// After the start, or after the ball lay at an end of the pipe, the filter needs so long to forget it, seconds.
const FORGET_S: f64 = 1.5;
/// A ball nearer to an end than this lies there, mm, or five deviations of its sensor.
const AT_END_MM: f64 = 10.0;

/// Which rows count in a comparison of models: those where the ball has been in free flight for a while. At an end the
/// state is not normal, and a filter that takes it for normal would pay for that with its parameters.
#[must_use]
pub fn in_free_flight(model: &Model, recording: &Recording) -> Vec<bool> {
    let near_mm = AT_END_MM.max(5.0 * model.noise.sensor_mm);
    let mut quiet_from_s = recording.samples().first().map_or(0.0, |first| first.time_s) + FORGET_S;
    let at_end = |mm: f64| mm < near_mm || mm > model.pipe_length_mm - near_mm;
    let counts = recording.samples().iter().map(|sample| {
        if sample.position_mm.is_some_and(at_end) {
            quiet_from_s = sample.time_s + FORGET_S;
        }
        sample.time_s >= quiet_from_s
    });
    counts.collect()
}

/// The log-likelihood of every reading of `recording` under `model`, nats.
#[must_use]
pub fn surprises(model: &Model, recording: &Recording) -> Vec<Surprise> {
    crate::track::surprises(model, recording)
}

#[cfg(test)]
mod tests {
    use super::Surprise;

    #[test]
    fn the_density_integrates_to_one() {
        let step = 0.01;
        for outliers in [None, Some((0.1, 30.0)), Some((1.0, 0.0))] {
            let density = |k| Surprise::of(0, f64::from(k) * step, 4.0, outliers).log_density.exp();
            let total: f64 = (-20_000..20_000).map(|k| density(k) * step).sum();
            assert!((total - 1.0).abs() < 1e-9, "{outliers:?}: {total}");
        }
    }

    #[test]
    fn a_usual_reading_counts_fully_and_a_wild_one_hardly() {
        assert!(Surprise::of(0, 2.0, 4.0, None).weight > 0.99);
        let wild = Surprise::of(0, 20.0, 4.0, None);
        assert!(wild.weight < 1e-10 && wild.log_density > -13.0, "{wild:?}");
    }
}
