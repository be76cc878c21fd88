//! The transient method on a sweep of gains: (K_g, a) from the pulses at each gain, and their mean.
//!
//! ```text
//! mean pulse of a gain → overshoot R and peak time T_p → δ, ω_n → K_g, a          R, T_p: of a cubic about the peak
//! no significant overshoot: δ = 1, ω_n = 1.678/t_half                      1 − (1 + x)·e⁻ˣ = 1/2 at x = 1.678
//! ```
//!
//! The pulses of a gain are averaged before R and T_p are determined, with the square of the step size as weight: the
//! maximum of one noisy pulse is biased upwards, and so is a mean of such maxima. The cubic replaces the smoothing of
//! the thesis, a centred mean over 16 points. The intervals come from the jackknife over pulses; that of the mean
//! includes the scatter between gains.
//! Sources: the thesis, section 3.1.2; Efron and Stein, "The jackknife estimate of variance", Annals of Statistics 9
//! (1981).

use crate::fit::profile::OF_90_PERCENT;
use crate::identify::grey_box::ParameterEstimate;
use crate::identify::transient::peak::{first_peak, half_way_s};
use crate::identify::transient::second_order::{Transient, TwoPoles};
use crate::identify::transient::steps::{Pulse, Rejected, pulses};
use crate::record::recording::Recording;
use crate::stats::student::student;
use serde::Serialize;

/// Gains that differ by less than this share are equal.
const SAME: f64 = 0.03;
/// Smallest number of pulses per gain.
const FEWEST: usize = 4;
/// An overshoot is significant above so many standard deviations.
const SEEN: f64 = 2.0;
/// ω_n·t_half of a critically damped loop.
const HALF_WAY: f64 = 1.678_346_99;

/// The result of the pulses at one gain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfGain {
    /// K_p, percent per mm.
    pub kp_per_mm: f64,
    /// Number of averaged pulses.
    pub pulses: usize,
    /// R, share of the step; 0 without significant overshoot.
    pub overshoot: f64,
    /// T_p, seconds; `None` without significant overshoot.
    pub peak_s: Option<f64>,
    /// δ; 1 without significant overshoot.
    pub damping: f64,
    /// ω_n, rad/s.
    pub omega: f64,
    /// K_g with its 90 % interval.
    pub gain: ParameterEstimate,
    /// a with its 90 % interval.
    pub drag: ParameterEstimate,
    /// Time since the step in s, and position as a share of the step.
    #[serde(skip)]
    pub mean_pulse: Vec<(f64, f64)>,
}

/// The result of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// Results by gain, lowest first.
    pub gains: Vec<OfGain>,
    /// K_g: mean over the gains with significant overshoot.
    pub gain: ParameterEstimate,
    /// a: the same.
    pub drag: ParameterEstimate,
    /// Steps that were not used.
    pub rejected: Rejected,
}

/// Why a sweep gives no result.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoSweep {
    /// No usable pulses.
    #[error(
        "no gain has {FEWEST} pulses of a proportional controller ({short} jumps were too short, {not_proportional} not in proportion to the error); fly experiments/gain-pulses.toml once for each gain"
    )]
    NoPulses {
        /// Rejected because they are too short.
        short: usize,
        /// Rejected because the control is not proportional.
        not_proportional: usize,
    },
    /// No significant overshoot.
    #[error(
        "no overshoot is seen at any of {gains} gains up to {highest_per_mm} per mm; add higher gains to the sweep"
    )]
    NoOvershoot {
        /// Number of gains.
        gains: usize,
        /// The highest gain.
        highest_per_mm: f64,
    },
}

impl Sweep {
    /// Evaluates the sweep in `recording`. `dead_time_s`: dead time of sample-and-hold and computation, usually half a
    /// period.
    ///
    /// # Errors
    /// [`NoSweep`]: too few pulses, or none with significant overshoot.
    pub fn of(recording: &Recording, dead_time_s: f64) -> Result<Self, NoSweep> {
        let (mut all, rejected) = pulses(recording);
        all.sort_by(|a, b| a.kp_per_mm.total_cmp(&b.kp_per_mm));
        let groups =
            all.chunk_by(|a, b| b.kp_per_mm < (1.0 + SAME) * a.kp_per_mm).filter(|group| group.len() >= FEWEST);
        let gains: Vec<OfGain> = groups.filter_map(|group| of_gain(group, dead_time_s)).collect();
        let Some(last) = gains.last() else {
            let Rejected { short, not_proportional } = rejected;
            return Err(NoSweep::NoPulses { short, not_proportional });
        };
        let refused = NoSweep::NoOvershoot { gains: gains.len(), highest_per_mm: last.kp_per_mm };
        let seen = |of: fn(&OfGain) -> ParameterEstimate| {
            gains.iter().filter(|g| g.peak_s.is_some()).map(of).collect::<Vec<_>>()
        };
        let (gain, drag) = (mean(&seen(|g| g.gain)), mean(&seen(|g| g.drag)));
        let (gain, drag) = gain.zip(drag).ok_or(refused)?;
        Ok(Self { gains, gain, drag, rejected })
    }
}

/// R, T_p and the resulting plant from one mean pulse.
struct Reading {
    overshoot: f64,
    peak_s: Option<f64>,
    transient: Transient,
    plant: TwoPoles,
}

fn of_gain(group: &[Pulse], dead_time_s: f64) -> Option<OfGain> {
    let n = group.len() as f64;
    let kp_per_mm = group.iter().map(|pulse| pulse.kp_per_mm).sum::<f64>() / n;
    let left_out = |k: usize| group.iter().enumerate().filter(move |(other, _)| *other != k).map(|(_, pulse)| pulse);
    let peaks = (0..group.len()).map(|k| first_peak(&mean_pulse(left_out(k))).map_or(0.0, |peak| peak.1 - 1.0));
    let overshoot_sigma = jackknife(&peaks.collect::<Vec<_>>());
    let is_seen = first_peak(&mean_pulse(group.iter())).is_some_and(|peak| peak.1 - 1.0 > SEEN * overshoot_sigma);
    let read = |points: &[(f64, f64)]| reading(points, kp_per_mm, dead_time_s, is_seen);
    let mean_pulse_of_all = mean_pulse(group.iter());
    let whole = read(&mean_pulse_of_all)?;
    let others: Vec<Reading> = (0..group.len()).filter_map(|k| read(&mean_pulse(left_out(k)))).collect();
    let estimate = |name, of: fn(&TwoPoles) -> f64| {
        let value = of(&whole.plant);
        let logs: Vec<f64> = others.iter().map(|other| of(&other.plant).ln()).collect();
        let half = student((group.len() - 1) as f64) * jackknife(&logs);
        ParameterEstimate { name, value, low: Some(value * (-half).exp()), high: Some(value * half.exp()) }
    };
    Some(OfGain {
        kp_per_mm,
        pulses: group.len(),
        overshoot: whole.overshoot,
        peak_s: whole.peak_s,
        damping: whole.transient.damping,
        omega: whole.transient.omega,
        gain: estimate("gain_mm_per_s2_per_percent", |plant| plant.gain),
        drag: estimate("drag_per_s", |plant| plant.drag_per_s),
        mean_pulse: mean_pulse_of_all,
    })
}

/// Evaluates a mean pulse; `None` if it is not a step response.
fn reading(points: &[(f64, f64)], kp_per_mm: f64, dead_time_s: f64, is_seen: bool) -> Option<Reading> {
    let (overshoot, peak_s, transient) = if is_seen {
        let (peak_s, height) = first_peak(points)?;
        (height - 1.0, Some(peak_s), Transient::of_step(height - 1.0, peak_s - dead_time_s)?)
    } else {
        let omega = HALF_WAY / (half_way_s(points)? - dead_time_s);
        (0.0, None, Transient { damping: 1.0, omega })
    };
    let plant = transient.plant_behind(kp_per_mm, dead_time_s);
    (plant.gain > 0.0 && plant.drag_per_s > 0.0).then_some(Reading { overshoot, peak_s, transient, plant })
}

/// The mean of pulses as time and share of the step, weighted by the square of the step size. The offset of the settled
/// position is common to all pulses, so that an error of the hover duty does not matter.
fn mean_pulse<'a>(pulses: impl Iterator<Item = &'a Pulse> + Clone) -> Vec<(f64, f64)> {
    let settled = |sign: f64| {
        let all: Vec<f64> = pulses.clone().filter(|p| sign * p.jump_mm > 0.0).map(|p| p.settled_mm).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    };
    // Upward and downward pulses have equal weight, so that incomplete settling cancels.
    let sides = [settled(1.0), settled(-1.0)];
    let offset_mm = sides.iter().flatten().sum::<f64>() / sides.iter().flatten().count().max(1) as f64;
    let shortest = pulses.clone().map(|pulse| pulse.points.len()).min().unwrap_or_default();
    let point = |k: usize| {
        let sum = pulses.clone().fold((0.0, 0.0, 0.0), |(t, y, w), pulse| {
            let (time_s, mm) = pulse.points[k];
            let jump = pulse.jump_mm;
            (t + jump * jump * time_s, y + jump * (mm - pulse.from_mm - offset_mm), w + jump * jump)
        });
        (sum.0 / sum.2, sum.1 / sum.2)
    };
    (0..shortest).map(point).collect()
}

/// Jackknife standard deviation from the estimates without each pulse.
fn jackknife(without: &[f64]) -> f64 {
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    ((n - 1.0) / n * without.iter().map(|x| (x - mean).powi(2)).sum::<f64>()).sqrt()
}

/// The mean of the logarithms, weighted by their intervals. Its interval grows if they scatter by more than that.
fn mean(all: &[ParameterEstimate]) -> Option<ParameterEstimate> {
    let first = all.first()?;
    let log = |of: &ParameterEstimate| Some((of.value.ln(), (of.high? / of.low?).ln().max(1e-9).powi(-2)));
    let logs: Vec<(f64, f64)> = all.iter().filter_map(log).collect();
    let weight: f64 = logs.iter().map(|(_, w)| w).sum();
    let mean = logs.iter().map(|(x, w)| w * x).sum::<f64>() / weight;
    // The weights come from intervals, whose width is twice the quantile times the standard deviation.
    let width = 2.0 * OF_90_PERCENT;
    let scatter = logs.iter().map(|(x, w)| width * width * w * (x - mean).powi(2)).sum::<f64>();
    let wider = (scatter / (logs.len() - 1).max(1) as f64).max(1.0);
    let half = OF_90_PERCENT * wider.sqrt() / (width * weight.sqrt());
    let value = mean.exp();
    Some(ParameterEstimate {
        name: first.name,
        value,
        low: Some(value * (-half).exp()),
        high: Some(value * half.exp()),
    })
}
