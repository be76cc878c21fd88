//! The check of a record: can it be diagnosed, and which questions can it not answer?
//!
//! Works on the rows alone, before any model runs. Every finding is a sentence with its values that ends in what to do.
//! Spread is estimated robustly, by the median of absolute values: σ ≈ 1.4826 · MAD for a normal distribution.

use crate::record::implausible::{DutyScale, duty_beyond_percent, duty_far_below_hover, implausible_readings};
use crate::record::recording::{Recording, Sample};
use crate::stats::median::median;
use crate::thresholds::OTHER_RIG;
use plant::Model;

/// A time between rows that is this many times longer than usual is a gap.
const GAP: f64 = 3.0;
/// A reading this many robust deviations away from its neighbours is an outlier: noise gives one in 10⁸.
const OUTLIER: f64 = 6.0;
/// More exact repeats in a row than this, of a position that otherwise moves, show a sensor that refreshes slowly.
const REPEATS: usize = 3;
/// The codes by which a VL53L0X reports that it has no target.
const NO_TARGET_MM: [f64; 2] = [8190.0, 8191.0];
/// A duty whose range is smaller than this, percent, excites nothing: four steps of a 12-bit chip.
const STILL_PERCENT: f64 = 0.1;

/// A hover duty above this, percent, is out of reach of duties that are recorded as fractions.
const FRACTION_OF_HOVER: f64 = 2.0;
/// From this share of readings outside the pipe on, the record is of another pipe.
const ELSEWHERE: f64 = 0.1;
/// Rows further apart than this, the longest forecast horizon, seconds, are too slow.
const SLOWEST_S: f64 = 1.0;
/// With more rows than this at the time of the row before, percent, speeds cannot be told from the record.
const COARSE_CLOCK_PERCENT: f64 = 20.0;

/// A finding about a record that its reader should know.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The duty hardly moves.
    #[error(
        "the duty stays within {range_percent:.3} %, which excites nothing: gain, lag and dead zone cannot be told from such \
         a record; fly one with a moving setpoint"
    )]
    StillDuty {
        /// Largest minus smallest duty, percent.
        range_percent: f64,
    },
    /// The duty seems to be recorded as a fraction.
    #[error(
        "every duty lies within 0 to 1, as fractions do; if they are fractions, say [import] duty_percent.scale = 100"
    )]
    FractionalDuty,
    /// Duties that no fan takes.
    #[error("{count} duties lie beyond {limit_percent:.0} %, the first in row {row}: {duty_percent:.4e}; {scale}")]
    DutyBeyondPercent {
        /// Number of such duties.
        count: usize,
        /// The row of the first, counted from 1.
        row: usize,
        /// The first, as the record has it.
        duty_percent: f64,
        /// The limit, percent, in both directions.
        limit_percent: f64,
        /// Percent per unit of the column, where its unit is another; `None` where single rows are wrong.
        scale: DutyScale,
    },
    /// Duties far below the believed hover.
    #[error(
        "the usual duty is {usual_percent:.4e} % where {hover_percent} % are believed to hold the ball: the column holds another \
         unit, or the record is of another rig; say [import] duty_percent.scale, about {scale:.3e}, or mend plant.hover_duty_percent"
    )]
    DutyFarBelowHover {
        /// Median of the duties' sizes, percent.
        usual_percent: f64,
        /// The believed hover, percent.
        hover_percent: f64,
        /// What the duties would be multiplied by.
        scale: f64,
    },
    /// Readings that cannot be positions of the ball.
    #[error(
        "{count} readings are no position of the ball: they lie more than half the pipe's length outside of it, or jump by \
         three quarters of it and back, the first in row {row}: {reading_mm:.4e} mm; they count as empty"
    )]
    ImplausibleReadings {
        /// Number of such readings.
        count: usize,
        /// The row of the first, counted from 1.
        row: usize,
        /// The first, mm.
        reading_mm: f64,
    },
    /// Numbers that grew beyond any bound.
    #[error(
        "the forecasts of the model are not finite, so nothing can be compared; look for implausible numbers in the record, and in \
         the tables [plant] and [import]"
    )]
    NotFinite,
    /// The position never moves.
    #[error(
        "the position is {position_mm} mm in every row; check that the sensor was read, and the column of [import]"
    )]
    StillPosition {
        /// The one position, mm.
        position_mm: f64,
    },
    /// Readings outside the model's pipe.
    #[error(
        "{count} readings lie outside the model's pipe of 0 to {length_mm} mm, the furthest at {} mm; check \
         plant.pipe_length_mm and the scale and offset of [import]",
        short(*furthest_mm)
    )]
    OutsidePipe {
        /// Number of such readings.
        count: usize,
        /// The reading furthest outside, mm.
        furthest_mm: f64,
        /// Length of the model's pipe, mm.
        length_mm: f64,
    },
    /// Readings that are codes for "no target".
    #[error("{count} readings are 8190 or 8191, which a VL53L0X says without a target: they count as empty")]
    NoTarget {
        /// Number of such readings.
        count: usize,
    },
    /// The time between rows is uneven.
    #[error(
        "{count} gaps between rows, the longest {longest_s:.3} s where {usual_s:.4} s is usual; forecasts cross them by the duty before them"
    )]
    Gaps {
        /// Number of gaps.
        count: usize,
        /// The longest gap, seconds.
        longest_s: f64,
        /// The usual time between rows, seconds.
        usual_s: f64,
    },
    /// Rows at the time of the row before them.
    #[error(
        "{percent:.0} % of the rows repeat the time of the row before, the first is row {row}: the clock is coarser than the rows; \
         name a finer one as [import] time_s, or keep one row of each time"
    )]
    RepeatedTimes {
        /// Share of all rows, percent.
        percent: f64,
        /// The first such row, counted from 1.
        row: usize,
    },
    /// The rows are too far apart.
    #[error(
        "the rows are {usual_s:.3} s apart, and nothing shorter can be seen: record at least 10 a second; if the times are in another unit, say it as [import] time_s.scale (0.001 for milliseconds)"
    )]
    SlowRows {
        /// The usual time between rows, seconds.
        usual_s: f64,
    },
    /// Too few readings.
    #[error(
        "{readings} readings in free flight, and the diagnosis needs {needed}: fly longer, or name more flights of this rig together"
    )]
    TooFew {
        /// Readings in free flight.
        readings: usize,
        /// Readings that are needed.
        needed: usize,
    },
    /// Readings far from their neighbours.
    #[error(
        "{count} readings jump by more than {OUTLIER} robust deviations ({limit_mm:.1} mm) and back, {percent:.2} % of all; a reading so far off counts for little in the fits: look at them first"
    )]
    Outliers {
        /// Number of such readings.
        count: usize,
        /// Share of all readings, percent.
        percent: f64,
        /// The limit for a jump, mm.
        limit_mm: f64,
    },
    /// A log among several that cannot be diagnosed.
    #[error("this log is left out of the diagnosis, and the others are used without it")]
    LeftOut,
    /// A very long flight, of which parts are used.
    #[error(
        "of {rows} rows {used} are used, in {count} stretches spread evenly over the flight: more would take long and much memory; \
         to diagnose another part, cut the log to it"
    )]
    Stretches {
        /// Rows of the flight.
        rows: usize,
        /// Rows that are used.
        used: usize,
        /// Number of stretches.
        count: usize,
    },
    /// The diagnosis used fewer readings.
    #[error("a fast clock: the diagnosis used every duty, and one reading in {merged}")]
    Decimated {
        /// One reading out of this many was used.
        merged: usize,
    },
    /// The diagnosis used means of readings.
    #[error("a fast clock: the diagnosis used every duty, and the means of {merged} readings each")]
    Averaged {
        /// Number of readings in each mean.
        merged: usize,
    },
    /// The record and the belief do not match.
    #[error(
        "the record fits a {number} that is {ratio:.3} times the believed one: it is in other units, or of another rig; check the scales of [import] and plant.{number}"
    )]
    OtherRig {
        /// The base parameter, as the config names it.
        number: &'static str,
        /// Ratio of the fitted value to the believed one.
        ratio: f64,
    },
    /// The fitted model is outside the bounds that the record sets.
    #[error(
        "no model that this record allows fits it: {key} ends outside its bounds; check the scales of [import] and the table [plant]"
    )]
    Impossible {
        /// The key of the parameter that is outside, in its table of the config.
        key: &'static str,
    },
    /// Rows before the take-off or after the landing.
    #[error(
        "the ball lies at an end of the pipe for {before_s:.2} s before it takes off and {after_s:.2} s after it lands: these rows are left out"
    )]
    AtEnd {
        /// Time before the take-off, seconds.
        before_s: f64,
        /// Time after the landing, seconds.
        after_s: f64,
    },
    /// The same reading is repeated many times.
    #[error(
        "{percent:.0} % of the readings are repeated, up to {longest} times: the ball stands still, the readings are coarse, or \
         the sensor refreshes slower than the loop reads; in the last case mark repeats by a column `fresh` or leave them empty"
    )]
    Repeats {
        /// Share of readings in such runs, percent.
        percent: f64,
        /// The longest run, rows.
        longest: usize,
    },
}

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
        vec![no_target(&readings), implausible, outside_pipe(&seen, model), outliers(&seen, model), repeats(&seen)]
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
    [repeated, (usual_s > SLOWEST_S).then_some(Finding::SlowRows { usual_s }), gaps]
}

fn repeated_times(steps: &[f64]) -> Option<Finding> {
    let repeats = |step: &f64| *step <= 0.0;
    let count = steps.iter().filter(|step| repeats(step)).count();
    let row = steps.iter().position(repeats)? + 2;
    let percent = 100.0 * count as f64 / (steps.len() + 1) as f64;
    (percent > COARSE_CLOCK_PERCENT).then_some(Finding::RepeatedTimes { percent, row })
}

/// A number with one decimal; a very large one by its power of ten, not by three hundred digits.
fn short(value: f64) -> String {
    if value.abs() < 1e6 { format!("{value:.1}") } else { format!("{value:.3e}") }
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
    let beyond = |reading: f64| (-reading).max(reading - model.pipe_length_mm);
    let outside = || readings.iter().copied().filter(|reading| beyond(*reading) > slack_mm);
    let furthest_mm = outside().max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)))?;
    Some(Finding::OutsidePipe { count: outside().count(), furthest_mm, length_mm: model.pipe_length_mm })
}

/// Each reading against the mean of its neighbours: steady motion of the ball cancels, a single error of the sensor
/// does not.
fn outliers(readings: &[f64], model: &Model) -> Option<Finding> {
    let odd: Vec<f64> = readings.windows(3).map(|r| r[1] - (r[0] + r[2]) / 2.0).collect();
    let deviation = 1.4826 * median(odd.iter().map(|value| value.abs()).collect())?;
    // At least what the believed noise gives: the standard deviation of this difference is σ·√1.5.
    let limit_mm = OUTLIER * deviation.max(1.5_f64.sqrt() * model.noise.sensor_mm);
    let single = |w: &[f64]| w[1].abs() > limit_mm && w[1].abs() > w[0].abs() && w[1].abs() >= w[2].abs();
    let count = odd.windows(3).filter(|w| single(w)).count();
    let percent = 100.0 * count as f64 / readings.len() as f64;
    (count > 0).then_some(Finding::Outliers { count, percent, limit_mm })
}

fn repeats(readings: &[f64]) -> Option<Finding> {
    let runs = || readings.chunk_by(|a, b| a == b).map(<[f64]>::len).filter(|run| *run > REPEATS);
    let percent = 100.0 * runs().sum::<usize>() as f64 / readings.len() as f64;
    (percent > 20.0).then(|| Finding::Repeats { percent, longest: runs().max().unwrap_or_default() })
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
#[must_use]
pub fn without_codes(recording: &Recording) -> Option<Recording> {
    let samples = recording.samples();
    samples.iter().find(|sample| sample.position_mm.is_some_and(is_code))?;
    let plain = |sample: &Sample| Sample { position_mm: sample.position_mm.filter(|mm| !is_code(*mm)), ..*sample };
    Recording::new(samples.iter().map(plain).collect()).ok()
}

#[cfg(test)]
mod tests;
