//! Residual tests: whether the innovations of the fitted model differ from white noise.
//!
//! ```text
//! e_k = ν_k/√S_k           white, mean 0, variance 1 under a right model, whatever the loop does
//! colour    Q = n(n+2)·Σ r_l²/(n−l), l ≤ L            Ljung and Box: (Q − L)/√(2L)
//! line      g = max_f |Σ e_k·exp(−2πi·f·t_k)|²/n      exponential with mean 1 at each frequency
//! energy    the largest |z| of mean e² in sixths of duty, height, speed and time
//! omitted   score test of omitted terms, of events, and of bursts of force: see `score_test`
//! air       (d + g·σ²)/σ: growth of the air's noise in standard deviations, without its prior
//! ```
//!
//! Sources: Ljung and Box, Biometrika 65 (1978); Fisher's test for a hidden period, Proc. R. Soc. A 125 (1929).

use crate::fit::estimate::Fit;
use crate::fit::estimate::Problem;
use crate::fit::parameter::Parameter;
use crate::record::free_flight::near_end_mm;
use crate::residual::location::{Row, Spot, rows, spots};
use crate::residual::score_test::{Found, Omitted, omitted};
use crate::residual::spectrum::periodogram;
use crate::thresholds::{COARSE, LONG, QUIET, SHARE_OF_FORM};
use plant::Model;
use serde::Serialize;

/// Statistics of the residual. Each is large for a wrong model. For a long record each is scaled to 6000 such readings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Misfit {
    /// Portmanteau statistic over half a second, standard deviations.
    pub whiteness: f64,
    /// −ln of the probability of so strong a line anywhere in the spectrum.
    pub spectral_line: f64,
    /// Uneven variance over places: −ln of its probability.
    pub variance_by_place: f64,
    /// Uneven mean over places: −ln of its probability.
    pub mean_by_place: f64,
    /// Terms that the model omits: −ln of the probability of so large scores.
    pub omitted: f64,
    /// Those terms.
    pub omitted_terms: Vec<Omitted>,
    /// Events at single moments: −ln of the probability of so large scores.
    pub events: f64,
    /// Those events.
    pub event_terms: Vec<Omitted>,
    /// How much the remaining force comes in bursts, standard deviations. A turbulence acts all the time.
    pub bursts: f64,
    /// Nats allowed for the form of the effects found, which the catalogue only approximates.
    pub form_allowance: f64,
    /// The effect that was rejected because the omitted terms without it explain more than it does, or `None`.
    pub rejected_effect: Option<&'static str>,
    /// Whether an effect was named.
    #[serde(skip)]
    pub(crate) beside_named_effect: bool,
    /// Whether the readings are coarse: the distribution of their innovations depends on the position within a step.
    pub coarse: bool,
    /// Growth of the air's noise, standard deviations.
    pub air_growth: f64,
    /// The same as a ratio to the believed noise.
    pub air_ratio: f64,
    /// Weight of each reading: below 1 for a long record.
    #[serde(skip)]
    pub(crate) weight: f64,
}

/// The innovations are not normal for so long after a ball may have touched a stop, seconds.
const FORGET_STOP_S: f64 = 0.5;
/// One part in so many of the readings must remain after that.
const LEFT_TO_JUDGE: usize = 5;
/// Longest lag of the portmanteau statistic, seconds.
const LAGS_S: f64 = 0.5;

impl Misfit {
    /// Tests the innovations of `fit`. `explained`: nats that its named effects explain; `None` if none was named.
    #[must_use]
    pub fn of(problem: &Problem<'_>, fit: &Fit, explained: Option<f64>) -> Self {
        if is_quiet(fit) {
            // The innovations are rounding errors, which need no test.
            return Self { beside_named_effect: explained.is_some(), air_ratio: 1.0, weight: 1.0, ..Self::default() };
        }
        let rows = clear_of_stops(&fit.model, rows(&fit.model, problem.recording, problem.folds));
        let spots = spots(&rows);
        let e: Vec<f64> = rows.iter().map(|row| row.standardised).collect();
        let (air_growth, air_ratio) = air_growth(problem, fit);
        let judged: Vec<usize> = rows.iter().map(|row| row.row).collect();
        let long = (LONG / rows.len().max(1) as f64).min(1.0);
        let Found { terms, moments: events, bursts } =
            omitted(problem, fit, &|row| judged.binary_search(&row).is_ok(), long);
        Self {
            whiteness: long * whiteness(&e, lags(&rows)),
            spectral_line: long * spectral_line(&periodogram(&rows)),
            variance_by_place: long * largest(&rows, &spots, |row| row.standardised * row.standardised),
            mean_by_place: long * largest(&rows, &spots, |row| row.standardised),
            omitted: terms.nats,
            form_allowance: SHARE_OF_FORM * explained.unwrap_or(0.0),
            omitted_terms: terms.terms,
            events: events.nats,
            event_terms: events.terms,
            bursts,
            rejected_effect: None,
            beside_named_effect: explained.is_some(),
            coarse: is_coarse(&fit.model),
            air_growth: long.sqrt() * air_growth,
            air_ratio,
            weight: long,
        }
    }
}

/// Whether the innovations are far smaller than the smallest noise of a model, as in a simulation without noise.
pub(crate) fn is_quiet(fit: &Fit) -> bool {
    let power: f64 = fit.innovations.iter().map(|innovation| innovation.variance_score + 1.0).sum();
    power < QUIET * fit.innovations.len() as f64
}

/// Whether the step of the readings is wide against the noise, so that readings repeat.
fn is_coarse(model: &Model) -> bool {
    model.effects.reading_step_mm().is_some_and(|step_mm| step_mm > COARSE * model.noise.sensor_mm)
}

/// The rows without a recent contact with a stop. The filter assumes normal states, which a bounce violates.
fn clear_of_stops(model: &Model, rows: Vec<Row>) -> Vec<Row> {
    let Some(stops) = model.effects.ends() else { return rows };
    let near_mm = near_end_mm(model);
    let mut clear_from_s = f64::NEG_INFINITY;
    let clear = |row: &Row| {
        let height_mm = row.known[1];
        if height_mm < stops.bottom_mm + near_mm || height_mm > stops.top_mm - near_mm {
            clear_from_s = row.time_s + FORGET_STOP_S;
        }
        row.time_s >= clear_from_s
    };
    let clear: Vec<Row> = rows.iter().copied().filter(clear).collect();
    // A ball that is always near a stop is tested with all rows.
    if clear.len() > rows.len() / LEFT_TO_JUDGE { clear } else { rows }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
fn lags(rows: &[Row]) -> usize {
    let span_s = rows.last().map_or(0.0, |row| row.time_s) - rows.first().map_or(0.0, |row| row.time_s);
    ((LAGS_S * rows.len() as f64 / span_s.max(1e-9)) as usize).clamp(5, 60)
}

/// The portmanteau statistic: mean 0 and standard deviation 1 for white innovations.
fn whiteness(e: &[f64], lags: usize) -> f64 {
    let n = e.len() as f64;
    let power: f64 = e.iter().map(|e| e * e).sum();
    let correlation = |lag: usize| e.iter().zip(e.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / power.max(1e-12);
    let q: f64 = (1..=lags).map(|lag| correlation(lag).powi(2) * n * (n + 2.0) / (n - lag as f64)).sum();
    // χ² with as many degrees of freedom as lags.
    (q - lags as f64) / (2.0 * lags as f64).sqrt()
}

fn spectral_line(periodogram: &[(f64, f64)]) -> f64 {
    // Two frequencies per independent one.
    let independent = (periodogram.len() as f64 / 2.0).max(1.0);
    periodogram.iter().map(|(_, power)| *power).fold(0.0, f64::max) - independent.ln()
}

/// −ln of the probability that any of `count` standard normal numbers is so large.
fn neg_log_chance(z: f64, count: usize) -> f64 {
    let chance = libm::erfc(z.abs() / std::f64::consts::SQRT_2);
    -(count as f64 * chance).max(1e-300).ln()
}

/// −ln of the probability of so uneven a mean over places.
fn largest(rows: &[Row], spots: &[Spot], value: impl Fn(&Row) -> f64) -> f64 {
    let n = rows.len() as f64;
    let m = rows.iter().map(&value).sum::<f64>() / n;
    let variance = rows.iter().map(|row| (value(row) - m).powi(2)).sum::<f64>() / n;
    let z = |(.., place): &Spot| {
        let count = place.len() as f64;
        let excess = place.iter().map(|&k| value(&rows[k]) - m).sum::<f64>();
        (excess / (count * (1.0 - count / n) * variance).max(1e-12).sqrt()).abs()
    };
    let most = spots.iter().map(z).fold(0.0, f64::max);
    neg_log_chance(most, spots.len())
}

/// Growth of the air's noise: in standard deviations, and as a ratio to the believed noise.
fn air_growth(problem: &Problem<'_>, fit: &Fit) -> (f64, f64) {
    let at = fit.parameters.iter().position(|parameter| *parameter == Parameter::AirNoise);
    let deviation = at.and_then(|at| fit.deviations().get(at).copied()).filter(|deviation| deviation.is_finite());
    let Some(deviation) = deviation else { return (0.0, 1.0) };
    let d = Parameter::AirNoise.distance(&fit.model, problem.belief);
    let (_, slope, curvature) = Parameter::AirNoise.prior(&fit.model, problem.belief);
    // From the record alone: the information and the gradient of the prior are subtracted.
    let information = (1.0 / deviation.powi(2) - curvature).max(1e-6);
    let alone = d - slope / information;
    (alone * information.sqrt(), alone.exp())
}

#[cfg(test)]
mod tests {
    use super::Misfit;
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Prior};
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    fn residue(belief: &Model, rig: &Model, seed: u64) -> Misfit {
        let recording = record(rig, seed, 60);
        let folds = Folds::new(belief, &recording);
        let problem = Problem { recording: &recording, belief, folds: &folds, prior: Prior::Belief };
        Misfit::of(&problem, &problem.fit(belief, &BASE), None)
    }

    #[test]
    fn a_right_model_leaves_nothing_over() {
        for seed in 0..20 {
            let left = residue(&model(), &model(), seed);
            assert!(!left.is_significant(), "seed {seed}: {left:?}");
        }
    }

    #[test]
    fn a_missing_lag_and_a_restless_air_are_left_over() {
        let without = Model { effects: Effects::default(), ..model() };
        assert!(residue(&without, &model(), 1).is_significant());
        let mut turbulent = model();
        turbulent.noise.acceleration_psd_mm2_per_s3 *= 3.0;
        let left = residue(&model(), &turbulent, 1);
        assert!(left.is_significant() && (2.0..4.5).contains(&left.air_ratio), "{left:?}");
    }
}
