//! Initial values of the parameters of an effect: usual sizes, or values that the record suggests.
//!
//! The likelihood is flat for a limit that the record never reaches, a stop that the ball never touches, or a
//! quantisation step that is slightly wrong. Their initial values come from the record.

use crate::fit::estimate::{Fit, Problem};
use crate::record::commanded::commanded;
use crate::record::read_off::read_off;
use crate::record::recording::Recording;
use crate::select::duty_step_scan;
use crate::select::optional::with_optional;
use crate::select::regression::regressed;
use crate::select::search::Search;
use crate::select::written_scan::scan;
use crate::stats::line::line;
use crate::stats::quantile::quantile;
use plant::{Entry, Model, Start};

/// Initial limits of a saturation, as shares of the range of the commanded acceleration.
const LIMITS: [f64; 3] = [0.9, 0.6, 0.35];

/// Initial stops: share of readings beyond the stop, and its distance inwards in standard deviations of the noise,
/// because noise carries readings beyond a stop.
const STOPS: [(f64, f64); 6] = [(0.003, 0.0), (0.003, 1.0), (0.003, 2.0), (0.02, 0.0), (0.05, 0.0), (0.15, 0.0)];

/// Share of the duties on either side of their usual range. Chosen by hand: a few far steps are not usual.
const BEYOND_USUAL: f64 = 0.1;

/// Initial values, and the number of values they were chosen from.
pub(crate) struct Starts {
    pub(crate) values: Vec<Vec<f64>>,
    /// The number of values that come neither from the belief nor from a scan. They come first.
    pub(crate) usual: usize,
    /// The number of values that a scan over the record found. They come next.
    pub(crate) scanned: usize,
    pub(crate) among: usize,
    /// Whether each is a separate local maximum, so that the choice among them is part of the score.
    pub(crate) are_tops: bool,
}

impl Starts {
    /// Values at these shares of the distance from the neutral value; `None` if the record suggested the values.
    pub(crate) fn nearer(&self, entry: &Entry, model: &Model, shares: &[f64]) -> Option<Self> {
        if entry.start.is_of_the_record() {
            return None;
        }
        let neutral = entry.neutral(model);
        let at = |values: &[f64], share: f64| {
            values.iter().zip(&neutral).map(|(value, none)| none + share * (value - none)).collect()
        };
        let nearer = |share: &f64| self.values.iter().map(|values| at(values, *share)).collect::<Vec<_>>();
        let values: Vec<_> = shares.iter().flat_map(nearer).collect();
        let among = self.among + values.len();
        Some(Self { usual: values.len(), scanned: 0, among, are_tops: false, values })
    }
}

/// Initial values of `entry`, given the fit so far.
pub(crate) fn starts(entry: &Entry, fit: &Fit, search: &Search<'_>) -> Starts {
    let problem = &search.problem;
    if entry.start == Start::DutySteps {
        let (steps, among) = duty_step_scan::steps(problem, fit, entry);
        let values: Vec<_> = steps.into_iter().map(|step| vec![step]).collect();
        return Starts { usual: values.len(), scanned: 0, values, among, are_tops: true };
    }
    let mut values = by_rule(entry, &fit.model, problem);
    let usual = values.len();
    let written = problem.belief.effects.written.definition(entry.name);
    let found = written.and_then(|written| scan(problem, fit, written)).unwrap_or_default();
    values.extend(found.values);
    let scanned = values.len() - usual;
    if search.is_far(fit) {
        values.extend(as_believed(entry, problem));
    }
    // Of the local maxima only the best are among the values.
    let among = values.len() - scanned + found.maxima;
    Starts { usual, scanned, among, are_tops: false, values }
}

fn by_rule(entry: &Entry, model: &Model, problem: &Problem) -> Vec<Vec<f64>> {
    let recording = problem.recording;
    let listed = |all: &[&[f64]]| all.iter().map(|values| values.to_vec()).collect();
    match entry.start {
        Start::CommandedRange => limits(model, recording),
        Start::HeightsSeen => stops(model, recording),
        Start::RampsOver(seconds) => ramps(seconds, recording),
        Start::ReadingStep | Start::ReadingHold => {
            // A fitted noise may be far from that of the sensor while the repeats of a slow one are not explained.
            read_off(entry, recording, problem.belief).map(|read| vec![read.value]).into_iter().collect()
        }
        Start::OverRecord(shares) => shares.iter().map(|share| vec![share / recording.duration_s().max(1.0)]).collect(),
        Start::Values(values) => listed(values),
        Start::DutyOverHeight if model.turn_mm.is_some() => of_regression(entry, model, problem),
        Start::AgainstMotion(values) => {
            let simple: Vec<Vec<f64>> =
                listed(values).into_iter().chain(of_regression(entry, model, problem)).collect();
            let smooth: Vec<_> = simple.iter().filter_map(|values| with_optional(entry, values, recording)).collect();
            simple.into_iter().chain(smooth).collect()
        }
        Start::Sizes | Start::DutyOverHeight | Start::DutySteps => listed(entry.sizes),
    }
}

/// What regressions find, see [`mod@crate::select::regression`].
fn of_regression(entry: &Entry, model: &Model, problem: &Problem<'_>) -> Vec<Vec<f64>> {
    let found = regressed(entry, model, problem.belief, problem.recording);
    found.iter().filter_map(|model| model.effects.values(entry.name)).collect()
}

/// Initial values from the belief, if the fit is far from it: limits on the acceleration that it commands, or a lift
/// that falls with height and balances the flown duty, whose gradient is the gain times the slope of duty over height.
fn as_believed(entry: &Entry, problem: &Problem<'_>) -> Vec<Vec<f64>> {
    match entry.start {
        Start::CommandedRange => limits(problem.belief, problem.recording),
        Start::DutyOverHeight => {
            let rows = problem.recording.samples().iter().enumerate().filter(|(row, _)| problem.folds.counts(*row));
            let pairs: Vec<(f64, f64)> = rows.filter_map(|(_, s)| Some((s.position_mm?, s.duty_percent))).collect();
            let balance = line(&pairs).map(|(slope, _)| vec![problem.belief.gain_mm_per_s2_per_percent * slope]);
            balance.into_iter().collect()
        }
        _ => Vec::new(),
    }
}

fn limits(model: &Model, recording: &Recording) -> Vec<Vec<f64>> {
    let mut commanded = commanded(model, recording);
    commanded.sort_by(f64::total_cmp);
    let (low, high) = (quantile(&commanded, 0.002).min(-1.0), quantile(&commanded, 0.998).max(1.0));
    LIMITS.map(|share| vec![share * low, share * high]).to_vec()
}

/// Times for the whole range of duty with which the usual range of duties takes each of these times.
fn ramps(seconds: &[f64], recording: &Recording) -> Vec<Vec<f64>> {
    let mut duties: Vec<f64> = recording.writes().iter().map(|write| write.duty_percent).collect();
    duties.sort_by(f64::total_cmp);
    let usual = quantile(&duties, 1.0 - BEYOND_USUAL) - quantile(&duties, BEYOND_USUAL);
    if usual > 0.0 { seconds.iter().map(|s| vec![100.0 * s / usual]).collect() } else { Vec::new() }
}

fn stops(model: &Model, recording: &Recording) -> Vec<Vec<f64>> {
    let mut heights: Vec<f64> = recording.samples().iter().filter_map(|s| s.position_mm).collect();
    heights.sort_by(f64::total_cmp);
    let (noise, (bottom, top)) = (model.noise.sensor_mm, model.pipe_mm());
    let at = |share: f64, inwards: f64| {
        let top_mm = quantile(&heights, 1.0 - share) - inwards * noise;
        let bottom_mm = quantile(&heights, share) + inwards * noise;
        [vec![bottom, top_mm, 0.5], vec![bottom_mm, top, 0.5], vec![bottom_mm, top_mm, 0.5]]
    };
    STOPS.iter().flat_map(|(share, inwards)| at(*share, *inwards)).collect()
}

#[cfg(test)]
mod tests;
