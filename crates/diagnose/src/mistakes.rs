//! Mistakes of units, signs and columns, found before the search: no effect is blamed for them.
//!
//! ```text
//! gain and hover of the record, by least squares over the innovations, with the believed drag and lag
//! gain < 0: a sign      hover far off: the unit of the duty      gain far off: a unit      more if exchanged: columns
//! as believed with another clock: the unit of the times
//! several logs: gains or hovers that differ by more than chance and by more than one rig's do
//! ```
//!
//! The limits were chosen on the 240 records of `tests/blind`, rigs with up to four effects that their beliefs lack.
//! There, every gain is above 0; the gain is 0.08 to 4.6 times the believed one; hover is off by less than 0.9 %; with
//! columns exchanged, the gain lies within 9 deviations of 0; and of two halves of a record, no gains differ by a
//! factor of 1.6 and 6 deviations, and no hovers by 0.7 %.

mod clock;

use crate::linear::{LinearFit, Order, beginning, linear_fit, linear_fit_at};
use crate::record::airborne::airborne;
use crate::record::check::Finding;
use crate::record::implausible::plausible;
use crate::record::prepare::FlightFinding;
use crate::record::quantisation::coarse_step;
use crate::record::recording::{Recording, Sample};
use crate::record::sample_hold::hold;
use crate::record::units::OTHER_HOVER;
use crate::stats::median::median;
use crate::stats::spread::spread;
use crate::thresholds::ENOUGH_READINGS;
use clock::other_clock;
use plant::Model;
use std::borrow::Cow;

/// A gain that lies this many of its deviations from 0 is seen.
const SEEN: f64 = 8.0;
/// A gain so many times the believed one, or so few, is in other units; a small one only where the input explains so
/// large a share of the forecasts' variance, because an effect may take most of a gain away.
const MORE: f64 = 6.5;
const LESS: f64 = 0.2;
const LESS_EXPLAINS: f64 = 0.25;
const FAR_LESS: f64 = 0.02;
/// Or where the noise of the readings is smaller by the same factor, within this one.
const LIKE_THE_GAIN: f64 = 2.0;
/// A believed hover nearer to 0 tells nothing about units, percent.
const NEAR_ZERO_PERCENT: f64 = 2.0;
/// With columns exchanged the gain is seen so well, and explains so much more.
const EXCHANGED_SEEN: f64 = 15.0;
const EXCHANGED_EXPLAINS: f64 = 0.05;
/// Two logs of one rig differ by no more than this factor of their gains, and so many deviations.
const GAINS: f64 = 1.6;
const GAINS_DEVIATIONS: f64 = 8.0;
/// Their hovers by no more than this share of them and this share of the range of duties.
const HOVERS: f64 = 0.08;
const HOVERS_OF_RANGE: f64 = 0.1;

/// A log fitted by a linear plant.
struct FittedLog {
    flight: usize,
    fit: LinearFit,
    readings: f64,
}

/// The mistakes of units, signs and columns in several logs of a rig that is believed to be `belief`, by log.
#[must_use]
pub fn mistakes(belief: &Model, recordings: &[Recording]) -> Vec<FlightFinding> {
    let mut found = Vec::new();
    let mut fitted: Vec<FittedLog> = Vec::new();
    for (flight, recording) in recordings.iter().enumerate() {
        let recording = without_repeats(flown(recording, belief));
        match of_one(belief, &recording) {
            Ok(Some(fit)) => fitted.push(FittedLog { flight, fit, readings: recording.readings() as f64 }),
            Ok(None) => {}
            Err(finding) => found.push(FlightFinding { flight, finding }),
        }
    }
    if found.is_empty() { several(&fitted, recordings) } else { found }
}

/// The log's linear plant; `None` where nothing is seen.
fn of_one(belief: &Model, recording: &Recording) -> Result<Option<LinearFit>, Finding> {
    let lag_s = belief.effects.fan_lag_s().unwrap_or_default();
    let Some(fit) = linear_fit_at(recording, belief.drag_per_s, lag_s) else { return Ok(None) };
    let readings = recording.readings() as f64;
    // The steps of a coarse sensor are no normal noise. In closed loop they bias the gain: by a factor of 7 and 23 on
    // two practice records with steps of 8 and 15 mm.
    if coarse_step(recording, belief).is_some() {
        return Ok(None);
    }
    if let Some(clock) = other_clock(belief, &fit, recording) {
        return Err(clock);
    }
    let [lowest, highest] = recording.height_range();
    // Gravity pulls a pendulum the other way beyond a quarter of a turn, which no linear plant does.
    if belief.turn_mm.is_some_and(|turn_mm| highest - lowest > turn_mm / 4.0) {
        return Ok(None);
    }
    if fit.gain_in_deviations.abs() < SEEN {
        return exchanged(&fit, recording, readings).map_or(Ok(None), Err);
    }
    let sign = (fit.gain < 0.0).then(|| sign(belief, &fit, recording));
    match sign.or_else(|| unit(belief, &fit, recording)) {
        Some(finding) => Err(finding),
        None => Ok(Some(fit)),
    }
}

/// The first rows, without those on the ground, codes of the sensor and other readings that are no position.
fn flown<'a>(recording: &'a Recording, belief: &Model) -> Cow<'a, Recording> {
    let first = plausible(beginning(recording), belief);
    // A ball that lies still shows no gain; one that seems to lie still all the time is in another unit.
    let flies = airborne(&first, belief).filter(|(_, flies)| 2 * flies.readings() > first.readings());
    flies.map_or(first, |(_, flies)| Cow::Owned(flies))
}

/// The recording without the repeats of a sensor that refreshes slower than the rows. They are no readings, and in
/// closed loop they bias the gain: by a factor of 10 on a practice record that holds each reading for 0.11 s.
fn without_repeats(recording: Cow<'_, Recording>) -> Cow<'_, Recording> {
    if hold(&recording).is_none() {
        return recording;
    }
    let mut last = None;
    let mut is_new = |mm: &f64| last.replace(*mm) != Some(*mm);
    let fresh = |row: &Sample| Sample { position_mm: row.position_mm.filter(&mut is_new), ..*row };
    let rows: Vec<Sample> = recording.samples().iter().map(fresh).collect();
    Recording::new(rows).map_or(recording, Cow::Owned)
}

/// Whose sign is wrong: a duty near the believed hover is right.
fn sign(belief: &Model, fit: &LinearFit, recording: &Recording) -> Finding {
    let hover = belief.hover_duty_percent;
    let usual = median(recording.samples().iter().map(|row| row.duty_percent).collect()).unwrap_or_default();
    let deviations = fit.gain_in_deviations.abs();
    if hover.abs() < NEAR_ZERO_PERCENT {
        return Finding::SignReversed { deviations };
    }
    if usual * hover > 0.0 {
        let off = |duty: f64| (duty / hover).abs().ln().abs();
        // Half the distance: near a hover of 50 % both readings of the duty are about as likely.
        if off(100.0 - usual) < OTHER_HOVER.ln().min(0.5 * off(usual)) {
            return Finding::InputInverted { deviations, usual_percent: usual };
        }
        // The pipe stays where it is.
        let (bottom, top) = belief.pipe_mm();
        return Finding::PositionReversed { deviations, offset_mm: bottom + top };
    }
    Finding::InputReversed { deviations }
}

fn unit(belief: &Model, fit: &LinearFit, recording: &Recording) -> Option<Finding> {
    let ratio = fit.gain / belief.gain_mm_per_s2_per_percent;
    let (hover, seen) = (belief.hover_duty_percent, fit.hover);
    // A belief in a fraction is compared too: the record then hovers far from 0. A rig that is driven both ways hovers
    // near 0, wherever that is.
    let duties = spread(recording.samples().iter().map(|row| row.duty_percent)).unwrap_or_default();
    let is_far = hover.abs().max(seen.abs()) > NEAR_ZERO_PERCENT && seen.abs() > duties;
    let has_hover = is_far && hover * seen > 0.0;
    if has_hover && (seen / hover).ln().abs() > OTHER_HOVER.ln() {
        return Some(Finding::DutyUnit { hover_percent: seen, believed_percent: hover, scale: hover / seen });
    }
    // No effect that takes a part of the gain takes the same part of the sensor's noise.
    let noise = fit.sensor / belief.noise.sensor_mm;
    let shrinks = (noise / ratio).ln().abs() < LIKE_THE_GAIN.ln();
    let much_less =
        ratio < FAR_LESS || (ratio < LESS && (shrinks || fit.explained(recording.readings() as f64) > LESS_EXPLAINS));
    if !(ratio > MORE || much_less) {
        return None;
    }
    let gain = fit.gain;
    Some(if has_hover { Finding::PositionUnit { ratio, gain } } else { Finding::GainUnit { ratio, gain } })
}

/// The finding that position and duty are exchanged.
fn exchanged(fit: &LinearFit, recording: &Recording, readings: f64) -> Option<Finding> {
    let exchange =
        |row: &Sample| Some(Sample { duty_percent: row.position_mm?, position_mm: Some(row.duty_percent), ..*row });
    let rows: Vec<Sample> = recording.samples().iter().filter_map(exchange).collect();
    let other = linear_fit(&Recording::new(rows).ok()?, Order::Second)?;
    let more = other.explained(readings) - fit.explained(readings);
    (other.gain_in_deviations.abs() > EXCHANGED_SEEN && more > EXCHANGED_EXPLAINS).then_some(Finding::Exchanged)
}

/// Logs whose gain or hover differs from the first one's.
fn several(logs: &[FittedLog], recordings: &[Recording]) -> Vec<FlightFinding> {
    let Some((first, others)) = logs.split_first() else { return Vec::new() };
    let range = recordings.iter().map(|one| one.duty_range()[1] - one.duty_range()[0]).fold(0.0, f64::max);
    let differs = |log: &&FittedLog| {
        let (a, b) = (&first.fit, &log.fit);
        let ratio = (b.gain / a.gain).ln().abs();
        let deviation = a.gain_in_deviations.recip().hypot(b.gain_in_deviations.recip());
        let hovers = HOVERS * a.hover.abs().max(b.hover.abs()) + HOVERS_OF_RANGE * range;
        (ratio > GAINS.ln() && ratio > GAINS_DEVIATIONS * deviation) || (b.hover - a.hover).abs() > hovers
    };
    let finding = |log: &FittedLog| Finding::SeveralRigs {
        gain_ratio: log.fit.gain / first.fit.gain,
        hover_percent: log.fit.hover,
        first_hover_percent: first.fit.hover,
    };
    let enough = |log: &&FittedLog| log.readings >= ENOUGH_READINGS as f64;
    let others = others.iter().filter(enough).filter(differs);
    others.map(|log| FlightFinding { flight: log.flight, finding: finding(log) }).collect()
}

#[cfg(test)]
mod tests;
