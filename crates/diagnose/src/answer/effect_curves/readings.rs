//! The signals before each reading, and their bins.

use super::Abscissa;
use crate::fit::estimate::Problem;
use crate::record::recording::Recording;
use crate::residual::score_test::{FilterRun, Pushes};
use crate::stats::quantile::quantile;
use plant::{Entry, Model};
use std::ops::Range;

/// Bins over a signal, and over the time since the duty moved.
const BINS: usize = 14;
const LATE_BINS: usize = 6;
/// Shares of the readings between which a signal is drawn.
const SEEN: [f64; 2] = [0.005, 0.995];
/// Widths of an effect between two edges that are drawn on each side of it.
const WIDTHS: f64 = 2.0;
/// Fewest readings in a bin.
const FEWEST: usize = 10;
/// Narrowest bin, as a share of the range.
const NARROWEST: f64 = 0.025;
/// The time since the duty moved is drawn up to this many times the lateness, but not less than the seconds.
const LATENESSES: f64 = 3.0;
const SHORTEST_S: f64 = 0.2;

/// The signals before a reading.
#[derive(Clone, Copy)]
struct Before {
    duty_percent: f64,
    position_mm: f64,
    velocity_mm_per_s: f64,
    time_s: f64,
    /// The rows whose duties were in force, and the seconds since the previous reading.
    dt_s: f64,
}

/// The signals before each reading of a record; `None` where a reading has no previous one.
pub(super) struct Readings<'a> {
    recording: &'a Recording,
    /// The row of each reading.
    rows: Vec<usize>,
    before: Vec<Option<Before>>,
}

/// Bins with their readings, and the forces of each bin before each reading.
pub(super) struct Bins {
    samples: Vec<Vec<f64>>,
    range: [f64; 2],
    pub(super) pushes: Vec<Pushes>,
}

impl Bins {
    pub(super) const fn len(&self) -> usize {
        self.samples.len()
    }

    /// The abscissae of the readings in a bin.
    pub(super) fn samples(&self, bin: usize) -> &[f64] {
        &self.samples[bin]
    }

    pub(super) const fn range(&self) -> [f64; 2] {
        self.range
    }
}

impl<'a> Readings<'a> {
    /// `None`: there are too few readings.
    pub(super) fn of(problem: &Problem<'a>, run: &FilterRun) -> Option<Self> {
        let samples = problem.recording.samples();
        let mean = |rows: Range<usize>| {
            let duties = samples[rows.clone()].iter().map(|row| row.duty_percent);
            duties.sum::<f64>() / rows.len().max(1) as f64
        };
        let on_the_way = run.rows_on_the_way(problem.recording);
        let before = run.before_readings(problem).into_iter().zip(on_the_way).map(|(before, rows)| {
            let before = before?;
            Some(Before {
                duty_percent: mean(rows),
                position_mm: before.conditions.position_mm,
                velocity_mm_per_s: before.conditions.velocity_mm_per_s,
                time_s: before.conditions.time_s,
                dt_s: before.dt_s,
            })
        });
        let before: Vec<Option<Before>> = before.collect();
        let rows = run.rows();
        (before.iter().flatten().count() > BINS * FEWEST).then_some(Self { recording: problem.recording, rows, before })
    }

    /// The middle of the longest flight, seconds.
    pub(super) fn middle_s(&self) -> f64 {
        0.5 * self.before.iter().flatten().map(|before| before.time_s).fold(0.0, f64::max)
    }

    fn signal(&self, over: Abscissa) -> Vec<f64> {
        let of = |before: &Before| match over {
            Abscissa::Duty => before.duty_percent,
            Abscissa::Height => before.position_mm,
            Abscissa::Speed => before.velocity_mm_per_s,
            Abscissa::Time | Abscissa::GainOverTime => before.time_s,
            Abscissa::AfterDuty => 0.0,
        };
        self.before.iter().map(|before| before.as_ref().map_or(f64::NAN, of)).collect()
    }

    /// The range in which a signal was nearly always.
    pub(super) fn range(&self, over: Abscissa) -> [f64; 2] {
        let mut values = self.signal(over);
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        SEEN.map(|share| quantile(&values, share))
    }

    /// The bins of an effect over a signal; `None` where the signal did not move.
    pub(super) fn bins(&self, over: Abscissa, model: &Model, effect: &Entry) -> Option<Bins> {
        if over == Abscissa::AfterDuty {
            return Some(self.after_duty(model, effect));
        }
        let (values, [low, high]) = (self.signal(over), window(over, model, effect, self.range(over)));
        if high - low <= 1e-9 {
            return None;
        }
        let edges = edges(&values, [low, high]);
        let mut samples = vec![Vec::new(); edges.len() + 1];
        let hover = model.hover_duty_percent;
        let push = |(value, before): (&f64, &Option<Before>)| {
            let Some(before) = before.filter(|_| (low..=high).contains(value)) else { return Pushes::new() };
            let bin = edges.partition_point(|edge| edge <= value);
            samples[bin].push(*value);
            vec![(bin, if over == Abscissa::GainOverTime { before.duty_percent - hover } else { 1.0 })]
        };
        let pushes = values.iter().zip(&self.before).map(push).collect();
        Some(Bins { samples, range: [low, high], pushes })
    }

    /// Bins over the time since the duty moved: in each, the step response may differ from that of the model.
    fn after_duty(&self, model: &Model, effect: &Entry) -> Bins {
        let late_s = model.effects.late_s(effect.name);
        let to = (LATENESSES * late_s).max(SHORTEST_S);
        let width = to / LATE_BINS as f64;
        let others_s = model.effects.duty_delay_s() + model.effects.reading_delay_s();
        let others_s = if effect.acts.late == Some(plant::Late::DeadTime) { others_s - late_s } else { others_s };
        let duties = Duties::of(self.recording);
        let gain = model.gain_mm_per_s2_per_percent;
        let push = |(row, before): (&usize, &Option<Before>)| {
            let Some(before) = before else { return Pushes::new() };
            let end_s = self.recording.samples()[*row].time_s - others_s;
            let u = |late: usize| {
                let to_s = end_s - late as f64 * width;
                duties.mean(self.recording.flight_of(*row), [to_s - before.dt_s, to_s])
            };
            let values: Vec<f64> = (0..=LATE_BINS).map(u).collect();
            values.windows(2).map(|pair| gain * (pair[0] - pair[1])).enumerate().collect()
        };
        let pushes = self.rows.iter().zip(&self.before).map(push).collect();
        // Ten places within each bin stand for the curve there.
        let within = |bin: usize| (0..10).map(|k| (bin as f64 + 0.05 + 0.1 * f64::from(k)) * width).collect();
        Bins { samples: (0..LATE_BINS).map(within).collect(), range: [0.0, to], pushes }
    }
}

/// The part of a range that is drawn: about an effect between two edges of the duty, some times its width.
fn window(over: Abscissa, model: &Model, effect: &Entry, [low, high]: [f64; 2]) -> [f64; 2] {
    let edges = effect.difference.filter(|_| over == Abscissa::Duty).zip(model.effects.values(effect.name));
    let Some((difference, values)) = edges else { return [low, high] };
    let [from, to] = difference.of.map(|edge| model.hover_duty_percent + values[edge]);
    let beside = WIDTHS * (to - from);
    [low.max(from - beside), high.min(to + beside)]
}

/// The integral of the duty, for its mean over any time.
struct Duties<'a> {
    recording: &'a Recording,
    /// The integral up to each row, within its flight, percent seconds.
    integral: Vec<f64>,
}

impl<'a> Duties<'a> {
    fn of(recording: &'a Recording) -> Self {
        let samples = recording.samples();
        let mut integral = vec![0.0; samples.len()];
        for flight in recording.flights() {
            for row in flight.start + 1..flight.end {
                let last = &samples[row - 1];
                integral[row] = integral[row - 1] + last.duty_percent * (samples[row].time_s - last.time_s);
            }
        }
        Self { recording, integral }
    }

    /// The mean over a time; before the flight the duty was that of its first row.
    fn mean(&self, flight: Range<usize>, [from_s, to_s]: [f64; 2]) -> f64 {
        let up_to = |time_s: f64| {
            let rows = &self.recording.samples()[flight.clone()];
            let row = rows.partition_point(|row| row.time_s <= time_s).max(1) - 1;
            self.integral[flight.start + row] + rows[row].duty_percent * (time_s - rows[row].time_s)
        };
        (up_to(to_s) - up_to(from_s)) / (to_s - from_s).max(1e-9)
    }
}

/// The edges between bins: half by the number of readings, half by distance, so that crowded places are resolved and
/// rare ones are seen. A bin that is too narrow or has too few readings is joined with the next.
fn edges(values: &[f64], [low, high]: [f64; 2]) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| (low..=high).contains(value)).collect();
    sorted.sort_by(f64::total_cmp);
    let (count, mut edges, mut since) = (sorted.len() as f64, Vec::new(), 0);
    for (rank, value) in sorted.iter().enumerate() {
        let key = 0.5 * rank as f64 / count + 0.5 * (value - low) / (high - low);
        let next = (edges.len() + 1) as f64 / BINS as f64;
        let begin = edges.last().copied().unwrap_or(low);
        let is_new = *value > begin + NARROWEST * (high - low) && high > *value + NARROWEST * (high - low);
        if key >= next && since >= FEWEST && sorted.len() - rank >= FEWEST && is_new {
            edges.push(*value);
            since = 0;
        }
        since += 1;
    }
    edges
}
