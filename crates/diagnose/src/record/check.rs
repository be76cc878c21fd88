//! The check of a record: can it be diagnosed, and which questions can it not answer?
//!
//! Works on the rows alone, before any model runs. Every finding is a sentence with its values that ends in what to do.
//! Spread is estimated robustly, by the median of absolute values: σ ≈ 1.4826 · MAD for a normal distribution.

pub use crate::record::finding::Finding;

use crate::record::implausible::{duty_beyond_percent, duty_far_below_hover, implausible_readings};
use crate::record::recording::{Recording, Sample};
use crate::stats::median::median;
use crate::thresholds::OTHER_RIG;
use plant::Model;

/// A time between rows that is this many times longer than usual is a gap.
pub(super) const GAP: f64 = 3.0;
/// A reading this many robust deviations away from its neighbours is an outlier: noise gives one in 10⁸.
pub(crate) const OUTLIER: f64 = 6.0;
/// A reading whose time is this near to the middle of its neighbours, as a share of the time between these, counts as
/// in the middle, because files round their times. Chosen: steps that differ by a tenth.
const EVEN: f64 = 0.025;
/// More exact repeats in a row than this, of a position that otherwise moves, show a sensor that refreshes slowly.
const REPEATS: usize = 3;
/// Repeats are a finding from this share of all readings on, percent.
pub(super) const REPEATED_PERCENT: f64 = 20.0;
/// The codes by which a VL53L0X reports that it has no target.
const NO_TARGET_MM: [f64; 2] = [8190.0, 8191.0];
/// A duty whose range is smaller than this, percent, excites nothing: four steps of a 12-bit chip.
pub(super) const STILL_PERCENT: f64 = 0.1;

/// A hover duty above this, percent, is out of reach of duties that are recorded as fractions.
const FRACTION_OF_HOVER: f64 = 2.0;
/// From this share of readings outside the pipe on, the record is of another pipe.
const ELSEWHERE: f64 = 0.1;
/// Rows further apart than this, the longest forecast horizon, seconds, are too slow.
pub(crate) const SLOWEST_S: f64 = 1.0;
/// With more rows than this at the time of the row before, percent, speeds cannot be told from the record.
pub(super) const COARSE_CLOCK_PERCENT: f64 = 20.0;

/// The findings about `recording`, which is one flight, to know before it is compared with `model`.
#[must_use]
pub fn check(recording: &Recording, model: &Model) -> Vec<Finding> {
    let samples = recording.samples();
    let readings: Vec<f64> = samples.iter().filter_map(|sample| sample.position_mm).collect();
    let still = readings.iter().all(|reading| Some(reading) == readings.first());
    let of_position = if still {
        vec![readings.first().map(|&position_mm| Finding::StillPosition { position_mm })]
    } else {
        let seen: Vec<f64> = readings.iter().copied().filter(|reading| !is_code(*reading)).collect();
        let implausible = implausible_readings(samples, model, is_code);
        vec![no_target(&readings), implausible, outside_pipe(&seen, model), outliers(samples, model), repeats(&seen)]
    };
    duty(samples, model).into_iter().chain(clock(samples)).chain(of_position).flatten().collect()
}

fn duty(samples: &[Sample], model: &Model) -> [Option<Finding>; 4] {
    let (low, high) = samples
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s.duty_percent), high.max(s.duty_percent)));
    let fraction = low >= 0.0 && high <= 1.0 && high > low;
    let still = high - low < STILL_PERCENT && !fraction;
    [
        fraction.then_some(Finding::FractionalDuty),
        still.then_some(Finding::StillDuty { range_percent: high - low }),
        duty_beyond_percent(samples, model),
        duty_far_below_hover(samples, model).filter(|_| !fraction),
    ]
}

fn clock(samples: &[Sample]) -> [Option<Finding>; 3] {
    let mut steps: Vec<f64> = samples.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    let repeated = repeated_times(&steps);
    if repeated.is_some() {
        steps.retain(|step| *step > 0.0);
    }
    let Some(usual_s) = median(steps.clone()) else { return [repeated, None, None] };
    let long = || steps.iter().filter(|step| **step > GAP * usual_s);
    let longest_s = long().copied().fold(0.0, f64::max);
    let gaps = (longest_s > 0.0).then(|| Finding::Gaps { count: long().count(), longest_s, usual_s });
    // Gaps that are half of the rows leave their median as it is.
    let apart_s = usual_s.max(steps.iter().sum::<f64>() / steps.len() as f64);
    [repeated, (apart_s > SLOWEST_S).then_some(Finding::SlowRows { usual_s: apart_s }), gaps]
}

fn repeated_times(steps: &[f64]) -> Option<Finding> {
    let repeats = |step: &f64| *step <= 0.0;
    let count = steps.iter().filter(|step| repeats(step)).count();
    let row = steps.iter().position(repeats)? + 2;
    let percent = 100.0 * count as f64 / (steps.len() + 1) as f64;
    (percent > COARSE_CLOCK_PERCENT).then_some(Finding::RepeatedTimes { percent, row })
}

fn is_code(reading: f64) -> bool {
    NO_TARGET_MM.contains(&reading)
}

fn no_target(readings: &[f64]) -> Option<Finding> {
    let count = readings.iter().filter(|reading| is_code(**reading)).count();
    (count > 0).then_some(Finding::NoTarget { count })
}

fn outside_pipe(readings: &[f64], model: &Model) -> Option<Finding> {
    // Noise moves the readings of a ball at an end a little beyond it.
    let slack_mm = OUTLIER * model.noise.sensor_mm;
    let (bottom_mm, top_mm) = model.pipe_mm();
    let beyond = |reading: f64| (bottom_mm - reading).max(reading - top_mm);
    let outside = || readings.iter().copied().filter(|reading| beyond(*reading) > slack_mm);
    let furthest_mm = outside().max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)))?;
    Some(Finding::OutsidePipe { count: outside().count(), furthest_mm, bottom_mm, top_mm })
}

/// Each reading against the line between its neighbours: steady motion of the ball cancels, a single error of the
/// sensor does not.
fn outliers(samples: &[Sample], model: &Model) -> Option<Finding> {
    let readings: Vec<(f64, f64)> = samples
        .iter()
        .filter_map(|sample| Some((sample.time_s, sample.position_mm.filter(|reading| !is_code(*reading))?)))
        .collect();
    let odd: Vec<(f64, f64)> = readings.windows(3).map(|r| beside_line([r[0], r[1], r[2]])).collect();
    let deviation = 1.4826 * median(odd.iter().map(|(value, _)| value.abs()).collect())?;
    // At least what the believed noise gives: the standard deviation of this difference is σ·√1.5.
    let limit_mm = OUTLIER * deviation.max(1.5_f64.sqrt() * model.noise.sensor_mm);
    // An error at one reading gives −½, 1, −½ of itself, whose sum is 0. A turn of the ball gives differences of one
    // sign, whose sum is up to 3 times the middle one. The limit between the two, ½, was chosen by hand. A step of a
    // reading that is held gives 0, ½, −½: only one neighbour is on the other side. Where one step is more than twice
    // the other, the weights leave ⅓ to ⅔, and motion is no line over the longer one.
    let single = |w: &[(f64, f64)]| {
        let [(before, _), (value, weight), (after, _)] = [w[0], w[1], w[2]];
        value.abs() > limit_mm
            && before * value < 0.0
            && after * value < 0.0
            && (before + value + after).abs() < value.abs() / 2.0
            && (weight - 0.5).abs() <= 1.0 / 6.0
    };
    let count = odd.windows(3).filter(|w| single(w)).count();
    let percent = 100.0 * count as f64 / readings.len() as f64;
    (count > 0).then_some(Finding::Outliers { count, percent, limit_mm })
}

/// The middle one of three readings above the line between the others, mm, and the weight of the last one in it.
fn beside_line([(t0, y0), (t1, y1), (t2, y2)]: [(f64, f64); 3]) -> (f64, f64) {
    let weight = if t2 > t0 { (t1 - t0) / (t2 - t0) } else { 0.5 };
    let weight = if (weight - 0.5).abs() < EVEN { 0.5 } else { weight };
    (y1 - ((1.0 - weight) * y0 + weight * y2), weight)
}

fn repeats(readings: &[f64]) -> Option<Finding> {
    let runs = || readings.chunk_by(|a, b| a == b).map(<[f64]>::len).filter(|run| *run > REPEATS);
    let percent = 100.0 * runs().sum::<usize>() as f64 / readings.len() as f64;
    (percent > REPEATED_PERCENT).then(|| Finding::Repeats { percent, longest: runs().max().unwrap_or_default() })
}

/// Whether findings make a diagnosis impossible: nothing moves, or the record and the belief are not of one rig.
pub(crate) fn is_hopeless(findings: &[Finding], recording: &Recording, model: &Model) -> bool {
    let is_reading = |sample: &&Sample| sample.position_mm.is_some_and(|mm| !is_code(mm));
    let readings = recording.samples().iter().filter(is_reading).count();
    findings.iter().any(|finding| match finding {
        Finding::StillDuty { .. }
        | Finding::StillPosition { .. }
        | Finding::SlowRows { .. }
        | Finding::RepeatedTimes { .. }
        | Finding::DutyFarBelowHover { .. }
        | Finding::Exchanged
        | Finding::DutyBeyondPercent { .. } => true,
        Finding::FractionalDuty => model.hover_duty_percent > FRACTION_OF_HOVER,
        Finding::OutsidePipe { count, .. } => *count as f64 > ELSEWHERE * readings as f64,
        _ => false,
    })
}

/// The finding about a fitted model whose gain or drag differs so much from the belief that it is another rig. Much
/// less drag is no such finding: an effect can take its place.
pub(crate) fn other_rig(belief: &Model, mended: &Model) -> Option<Finding> {
    let gain = mended.gain_mm_per_s2_per_percent / belief.gain_mm_per_s2_per_percent;
    let drag = mended.drag_per_s / belief.drag_per_s;
    if gain.max(gain.recip()) > OTHER_RIG {
        return Some(Finding::OtherRig { number: "gain_mm_per_s2_per_percent", ratio: gain });
    }
    // A believed drag of 0 gives no ratio.
    (belief.drag_per_s > 0.0 && drag > OTHER_RIG).then_some(Finding::OtherRig { number: "drag_per_s", ratio: drag })
}

/// The recording without the readings by which a VL53L0X reports no target (8190, 8191); `None` if it has none of them.
pub(crate) fn without_codes(recording: &Recording) -> Option<Recording> {
    let samples = recording.samples();
    samples.iter().find(|sample| sample.position_mm.is_some_and(is_code))?;
    let plain = |sample: &Sample| Sample { position_mm: sample.position_mm.filter(|mm| !is_code(*mm)), ..*sample };
    Recording::new(samples.iter().map(plain).collect()).ok()
}

#[cfg(test)]
mod tests;
