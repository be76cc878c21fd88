//! The closed loop before and after the mend: how the ball followed the steps of a record, and how it follows them when
//! the record's own controller flies the believed model and the mended one.
//!
//! ```text
//! overshoot, peak time, settling to ±5 %      medians over the steps; a step that never settled counts as infinite
//! critical gain                               see `critical_gain`
//! ```
//!
//! The steps are flown in virtual time with the noise of each model, with several seeds where the record is short:
//! noise adds as much to the overshoot of a simulation as to that of a record. An excitation that was added to the
//! control is in no log and is not flown. Definitions of the metrics: see [`super::step_response`].

mod critical_gain;
mod stretch;

use super::step_response::{Moment, Step, steps_of};
use super::virtual_flight::Desk;
use crate::log::reader::LoadedLog;
use config::Tables;
use control::design::step::BAND;
use critical_gain::critical_gain;
use diagnose::{ClosedLoop, Compared, Simulated};
use plant::Model;
use rayon::prelude::*;
use stretch::Stretch;

/// Simulated seconds that are enough for medians, and the largest number of flights.
const ENOUGH_S: f64 = 240.0;
const MOST_SEEDS: u64 = 4;

/// Medians over steps.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    overshoot_percent: Option<f64>,
    peak_s: Option<f64>,
    settling_s: Option<f64>,
}

/// Measures logs of one rig, and the two models where the controller of each log is known; the critical gain is that of
/// the last log. No `mended` model: nothing was mended.
#[must_use]
pub fn measure(logs: &[LoadedLog], tables: &Tables, belief: &Model, mended: Option<&Model>) -> ClosedLoop {
    let desks: Vec<Option<Desk>> = logs.iter().map(|log| Desk::that_flew(log, tables)).collect();
    let stretches: Vec<Option<Stretch>> = logs.iter().map(Stretch::of).collect();
    let steps: Vec<Step> = stretches.iter().flatten().flat_map(|stretch| steps_of(stretch.moments())).collect();
    let with_steps = |stretch: &&Stretch| !steps_of(stretch.moments()).is_empty();
    let both = desks.iter().zip(&stretches);
    let flown: Vec<(&Desk, &Stretch)> =
        both.filter_map(|(desk, stretch)| desk.as_ref().zip(stretch.as_ref().filter(with_steps))).collect();
    let models = [Some(belief), mended];
    let desk = desks.last().and_then(Option::as_ref);
    let (flown, critical) = rayon::join(
        || models.map(|model| model.map(|model| fly(&flown, model)).unwrap_or_default()),
        || models.map(|model| desk.zip(model).and_then(|(desk, model)| critical_gain(desk, model))),
    );
    let figures = [Figures::of(&steps), flown[0], flown[1]];
    ClosedLoop {
        steps: steps.len(),
        overshoot_percent: compared(figures.map(|figures| figures.overshoot_percent)),
        peak_time_s: compared(figures.map(|figures| figures.peak_s)),
        settling_band_percent: 100.0 * BAND,
        settling_s: compared(figures.map(|figures| figures.settling_s)),
        critical_gain_ratio: Simulated { nominal: critical[0], mended: critical[1] },
    }
}

const fn compared([recorded, nominal, mended]: [Option<f64>; 3]) -> Compared {
    Compared { recorded, nominal, mended }
}

/// The step metrics of `model` on the steps of each record, flown by its own controller. A loop that lost the ball has
/// none.
fn fly(records: &[(&Desk, &Stretch)], model: &Model) -> Figures {
    let total_s: f64 = records.iter().map(|(_, stretch)| stretch.duration_s()).sum();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let seeds = ((ENOUGH_S / total_s).ceil() as u64).clamp(1, MOST_SEEDS);
    let flights = records.par_iter().flat_map_iter(|record| (1..=seeds).map(move |seed| (*record, seed)));
    let steps = flights.map(|((desk, stretch), seed)| {
        let (programme, lead_s) = stretch.programme(desk, model);
        let flown = desk.fly(model, &programme, seed);
        let later = flown.cycles.iter().filter(|cycle| cycle.time_s >= lead_s);
        flown.fault.is_none().then(|| steps_of(&later.map(Moment::from).collect::<Vec<_>>()))
    });
    let all: Option<Vec<Vec<Step>>> = steps.collect::<Vec<_>>().into_iter().collect();
    all.map_or_else(Figures::default, |all| Figures::of(&all.concat()))
}

impl Figures {
    fn of(steps: &[Step]) -> Self {
        Self {
            overshoot_percent: median(steps.iter().map(|step| Some(step.overshoot_percent))),
            peak_s: median(steps.iter().map(|step| step.peak_s)),
            settling_s: median(steps.iter().map(|step| step.settling_s)),
        }
    }
}

/// The median, where a missing value counts as infinite. `None`: at least half of the values are missing, or there are
/// none.
pub fn median(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let mut values: Vec<f64> = values.map(|value| value.unwrap_or(f64::INFINITY)).collect();
    values.sort_by(f64::total_cmp);
    let (upper, lower) = (values.get(values.len() / 2)?, values.get(values.len().checked_sub(1)? / 2)?);
    Some((lower + upper) / 2.0).filter(|median| median.is_finite())
}

#[cfg(test)]
pub(crate) mod tests;
