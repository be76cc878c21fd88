//! Where a search for an effect starts: its usual sizes, or what the record suggests.
//!
//! A limit that the record never reaches, a stop that the ball never meets or a grid that is a little off have no slope to maximise:
//! their searches start where the record says that there is something to find.

use crate::fit::estimate::{Fit, Problem};
use crate::record::commanded::commanded;
use crate::record::read_off::read_off;
use crate::record::recording::Recording;
use crate::select::duty_step_scan;
use crate::select::search::Search;
use crate::stats::line::line;
use crate::stats::quantile::quantile;
use plant::{Entry, Model, Start};

/// Shares of the range of commanded acceleration at which a saturation is looked for.
const LIMITS: [f64; 3] = [0.9, 0.6, 0.35];

/// Shares of the readings beyond a place, and how far inside of it a stop is looked for, in deviations of the noise: noise carries readings
/// beyond a stop.
const STOPS: [(f64, f64); 6] = [(0.003, 0.0), (0.003, 1.0), (0.003, 2.0), (0.02, 0.0), (0.05, 0.0), (0.15, 0.0)];

/// Where to start from, and among how many places those were chosen.
pub(crate) struct Starts {
    pub(crate) values: Vec<Vec<f64>>,
    /// How many of them are not there for the belief alone: they come first.
    pub(crate) usual: usize,
    pub(crate) among: usize,
    /// Whether each is the top of a hill of its own, so that the choice among them is part of what is scored.
    pub(crate) are_tops: bool,
}

impl Starts {
    /// These shares of the way from where `entry` does nothing to each of the starts; `None` where the record suggested them.
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
        Some(Self { usual: values.len(), among: self.among + values.len(), are_tops: false, values })
    }
}

/// Values of `entry` to start from, for a record of a rig that so far is `fit`.
pub(crate) fn starts(entry: &Entry, fit: &Fit, search: &Search<'_>) -> Starts {
    let problem = &search.problem;
    if entry.start == Start::DutySteps {
        let (steps, among) = duty_step_scan::steps(problem, fit, entry);
        let values: Vec<_> = steps.into_iter().map(|step| vec![step]).collect();
        return Starts { usual: values.len(), values, among, are_tops: true };
    }
    let mut values = by_rule(entry, &fit.model, problem.recording);
    let usual = values.len();
    if search.is_far(fit) {
        values.extend(as_believed(entry, problem));
    }
    Starts { usual, among: values.len(), are_tops: false, values }
}

fn by_rule(entry: &Entry, model: &Model, recording: &Recording) -> Vec<Vec<f64>> {
    let listed = |all: &[&[f64]]| all.iter().map(|values| values.to_vec()).collect();
    match entry.start {
        Start::CommandedRange => limits(model, recording),
        Start::HeightsSeen => stops(model, recording),
        Start::ReadingStep | Start::ReadingHold => {
            read_off(entry, recording, model).map(|read| vec![read.value]).into_iter().collect()
        }
        Start::OverRecord(shares) => shares.iter().map(|share| vec![share / recording.duration_s().max(1.0)]).collect(),
        Start::Values(values) => listed(values),
        Start::Sizes | Start::DutyOverHeight | Start::DutySteps => listed(entry.sizes),
    }
}

/// Values that the believed gain asks for, where the fit has gone far from it: limits on what it commands, or a lift that falls with height and
/// would balance the duty as it was flown, whose gradient is the gain times the slope of duty over height.
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

fn stops(model: &Model, recording: &Recording) -> Vec<Vec<f64>> {
    let mut heights: Vec<f64> = recording.samples().iter().filter_map(|s| s.position_mm).collect();
    heights.sort_by(f64::total_cmp);
    let noise = model.noise.sensor_mm;
    let at = |share: f64, inwards: f64| {
        let top_mm = quantile(&heights, 1.0 - share) - inwards * noise;
        let bottom_mm = quantile(&heights, share) + inwards * noise;
        [vec![0.0, top_mm, 0.5], vec![bottom_mm, model.pipe_length_mm, 0.5], vec![bottom_mm, top_mm, 0.5]]
    };
    STOPS.iter().flat_map(|(share, inwards)| at(*share, *inwards)).collect()
}
