//! The found effects as curves over the signal that they depend on: the acceleration as believed, as mended with its
//! band, and as the record has it in bins.
//!
//! ```text
//! bin     = mean of the mended curve over the readings in it + θ      θ: what the mended model leaves there
//! ends    = ± 1.645·σ                                                 of a bin: σ of θ, see `BinnedForces`
//! band    = ± 1.645·√(gᵀ·C·g)      g: gradient of the curve by the fitted parameters, C: their covariance
//! ```
//!
//! All other signals are at rest: the duty at hover, the ball still at mid-pipe, half of the time gone.

mod readings;

use crate::answer::diagnosis::Diagnosis;
use crate::fit::estimate::{Fit, Problem};
use crate::fit::profile::OF_90_PERCENT;
use crate::residual::score_test::{BinnedForces, FilterRun, share_after};
use crate::select::stepwise::{Change, NamedEffect};
use crate::thresholds::{LIKELY, WIDER};
use plant::{Entry, Late, Model, Settled, Stage};
use readings::{Bins, Readings};

/// What an effect is drawn over, and what is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Abscissa {
    /// Acceleration, mm/s², over the duty, percent.
    Duty,
    /// Acceleration, mm/s², over the height, mm.
    Height,
    /// Acceleration beside the linear drag of the mended model, mm/s², over the velocity, mm/s.
    Speed,
    /// Acceleration, mm/s², over the time of the flight, seconds.
    Time,
    /// Acceleration by one percent of duty, mm/s², over the time of the flight, seconds.
    GainOverTime,
    /// The share of the acceleration that has come, over the seconds since the duty moved.
    AfterDuty,
}

/// What the record has in a part of the abscissa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Binned {
    /// The mean of the abscissa there.
    pub at: f64,
    /// The value, and the ends of its 90 % interval.
    pub value: f64,
    /// Low end.
    pub low: f64,
    /// High end.
    pub high: f64,
}

/// An effect over the signal that it depends on.
#[derive(Clone, Debug)]
pub struct EffectCurve {
    /// Its name.
    pub effect: &'static str,
    /// The axes.
    pub over: Abscissa,
    /// The mended model: abscissa, value, and the ends of its 90 % band.
    pub mended: Vec<[f64; 4]>,
    /// The belief.
    pub believed: Vec<(f64, f64)>,
    /// The record.
    pub bins: Vec<Binned>,
}

/// Points of a curve.
const POINTS: u32 = 160;
/// Half of the 90 % band of a curve, standard deviations.
const REACH: f64 = OF_90_PERCENT * WIDER;
/// A curve that differs by less than this, mm/s², depends on nothing.
const NOTHING: f64 = 1e-6;

/// The curves of the effects that are likelier than not and depend on one signal.
pub(crate) fn effect_curves(found: &Diagnosis, problem: &Problem<'_>) -> Vec<EffectCurve> {
    let is_drawn = |named: &&NamedEffect| named.change != Change::Removed && named.probability >= LIKELY;
    let there = found.effects.iter().filter(is_drawn);
    there.filter_map(|named| curve(found, problem, named.candidate.entry)).collect()
}

fn curve(found: &Diagnosis, problem: &Problem<'_>, effect: &'static Entry) -> Option<EffectCurve> {
    let has = |fit: &&Fit| fit.model.effects.values(effect.name).is_some();
    let fit = [&found.mended, &found.with_effects].into_iter().find(has)?;
    // Without parameters of its own, so that the bins take all that is left.
    let bare = Fit { parameters: Vec::new(), ..fit.clone() };
    let run = FilterRun::of(problem, bare, &|row| problem.folds.counts(row));
    let readings = Readings::of(problem, &run)?;
    let over = abscissa(&fit.model, effect, &readings)?;
    let drawn = Drawn { effect, over, middle_s: readings.middle_s(), drag_per_s: fit.model.drag_per_s };
    let bins = readings.bins(over, &fit.model, effect)?;
    let [from, to] = bins.range();
    let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(POINTS);
    let mended: Vec<[f64; 4]> = (0..=POINTS).map(|k| around(fit, &drawn, at(k))).collect();
    let believed: Vec<(f64, f64)> = (0..=POINTS).map(|k| (at(k), drawn.value(problem.belief, at(k)))).collect();
    let mut bins = binned(&drawn, fit, &run, &bins).unwrap_or_default();
    let span = span(mended.iter().map(|point| point[1]).chain(believed.iter().map(|point| point.1)));
    bins.retain(|bin| bin.high - bin.low < span);
    Some(EffectCurve { effect: effect.name, over, mended, believed, bins })
}

/// The largest value minus the smallest: a bin that is less certain than that says nothing about the curve.
fn span(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}

/// What the record has in each bin.
fn binned(drawn: &Drawn, fit: &Fit, run: &FilterRun, bins: &Bins) -> Option<Vec<Binned>> {
    let lags = fit.model.linear().fan_lag_s;
    let lag_s =
        if drawn.effect.stage == Stage::Actuator && drawn.effect.acts.late != Some(Late::Lag) { lags } else { 0.0 };
    let BinnedForces { sizes, deviations } = BinnedForces::of(run, bins.len(), &bins.pushes, lag_s)?;
    let one = |(bin, (size, deviation)): (usize, (f64, f64))| {
        let inside = bins.samples(bin);
        let value = inside.iter().map(|at| drawn.value(&fit.model, *at)).sum::<f64>() / inside.len() as f64 + size;
        let (at, reach) = (inside.iter().sum::<f64>() / inside.len() as f64, OF_90_PERCENT * deviation);
        Binned { at, value, low: value - reach, high: value + reach }
    };
    Some(sizes.into_iter().zip(deviations).enumerate().map(one).collect())
}

/// The first signal over which the effect changes the acceleration. `None`: it depends on none, or on its own states.
fn abscissa(model: &Model, effect: &'static Entry, readings: &Readings) -> Option<Abscissa> {
    if effect.acts.late.is_some() {
        return Some(Abscissa::AfterDuty);
    }
    let all: &[Abscissa] = match effect.stage {
        Stage::Actuator => &[Abscissa::GainOverTime, Abscissa::Time, Abscissa::Duty],
        Stage::Air | Stage::Ball => {
            &[Abscissa::GainOverTime, Abscissa::Time, Abscissa::Speed, Abscissa::Height, Abscissa::Duty]
        }
        Stage::Sensor => &[],
    };
    let mut without = model.clone();
    without.effects.remove(effect.name);
    let depends = |over: &Abscissa| {
        let drawn = Drawn { effect, over: *over, middle_s: readings.middle_s(), drag_per_s: model.drag_per_s };
        let [from, to] = readings.range(*over);
        let added = |k: u32| {
            let at = from + (to - from) * f64::from(k) / f64::from(POINTS);
            drawn.value(model, at) - drawn.value(&without, at)
        };
        (0..=POINTS).any(|k| (added(k) - added(0)).abs() > NOTHING)
    };
    all.iter().copied().find(depends)
}

/// One effect over one signal.
struct Drawn {
    effect: &'static Entry,
    over: Abscissa,
    middle_s: f64,
    /// The linear drag that is left out over the speed: it would hide what is added to it.
    drag_per_s: f64,
}

impl Drawn {
    /// The value of a model there.
    fn value(&self, model: &Model, at: f64) -> f64 {
        let hover = Settled {
            duty_percent: model.hover_duty_percent,
            position_mm: model.middle_mm(),
            velocity_mm_per_s: 0.0,
            time_s: self.middle_s,
        };
        let of = |at: Settled| model.settled_acceleration(at);
        match self.over {
            Abscissa::Duty => of(Settled { duty_percent: at, ..hover }),
            Abscissa::Height => of(Settled { position_mm: at, ..hover }),
            Abscissa::Speed => of(Settled { velocity_mm_per_s: at, ..hover }) + self.drag_per_s * at,
            Abscissa::Time => of(Settled { time_s: at, ..hover }),
            Abscissa::GainOverTime => {
                let there = Settled { time_s: at, ..hover };
                of(Settled { duty_percent: hover.duty_percent + 1.0, ..there }) - of(there)
            }
            Abscissa::AfterDuty => arrived(self.effect, model.effects.late_s(self.effect.name), at),
        }
    }
}

/// The share of a change of the duty that has come after so many seconds through an effect that is late by `late_s`.
fn arrived(effect: &Entry, late_s: f64, after_s: f64) -> f64 {
    match effect.acts.late {
        Some(Late::Lag) if late_s > 0.0 => share_after(after_s, late_s),
        _ => f64::from(u8::from(after_s >= late_s)),
    }
}

/// Abscissa, value of the mended model, and the ends of its band there.
fn around(fit: &Fit, drawn: &Drawn, at: f64) -> [f64; 4] {
    let value = drawn.value(&fit.model, at);
    if drawn.over == Abscissa::AfterDuty {
        // A jump has no derivative; the band is that of the time at which it comes.
        let late = |model: &Model| model.effects.late_s(drawn.effect.name);
        let (late_s, reach_s) = (late(&fit.model), REACH * fit.deviation_of(late));
        let end = |by: f64| arrived(drawn.effect, (late_s + by).max(0.0), at);
        return [at, value, end(reach_s), end(-reach_s)];
    }
    let reach = REACH * fit.deviation_of(|model| drawn.value(model, at));
    [at, value, value - reach, value + reach]
}

#[cfg(test)]
mod tests;
