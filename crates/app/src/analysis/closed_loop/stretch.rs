//! The part of a record whose steps are analysed, and the programme that flies its setpoints again.
//!
//! It begins with the first setpoint and ends where the controller is switched off, where it or its gains were changed
//! in flight (the config has only the first ones), or after five minutes, which is enough for medians.

use crate::analysis::step_response::Moment;
use crate::analysis::virtual_flight::Desk;
use crate::flight::experiment::{Experiment, Limits, Segment};
use crate::log::reader::LoadedLog;
use control::waveform::{MAX_STEPS, Waveform};
use plant::Model;

/// The longest part, seconds.
const LONGEST_S: f64 = 300.0;
/// A ball below this share of the pipe lies on the bottom.
const LYING: f64 = 0.1;
/// Time for the simulated ball to reach the position at which the record begins, seconds.
const LEAD_S: f64 = 12.0;

/// Rows under control.
pub(super) struct Stretch {
    moments: Vec<Moment>,
    start_s: f64,
    end_s: f64,
    /// Position of the ball at the start, mm.
    first_mm: f64,
}

impl Stretch {
    /// The part of a log. `None`: it has no setpoint or no reading there.
    pub(super) fn of(log: &LoadedLog) -> Option<Self> {
        let until_s = log.law_changes_at_s();
        let rows = log.recording.samples().iter().skip_while(|sample| sample.setpoint_mm.is_none());
        let start_s = rows.clone().next()?.time_s;
        let kept = rows.take_while(|s| s.setpoint_mm.is_some() && s.time_s < until_s.min(start_s + LONGEST_S));
        let moments: Vec<Moment> =
            kept.map(|s| Moment { time_s: s.time_s, setpoint_mm: s.setpoint_mm, position_mm: s.position_mm }).collect();
        let first_mm = moments.iter().find_map(|moment| moment.position_mm)?;
        let end_s = moments.last()?.time_s;
        (end_s > start_s).then_some(Self { moments, start_s, end_s, first_mm })
    }

    pub(super) fn moments(&self) -> &[Moment] {
        &self.moments
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.end_s - self.start_s
    }

    /// The setpoints as a programme for `desk`, cycle by cycle, and the time in which the simulated ball is brought to
    /// where the record begins.
    pub(super) fn programme(&self, desk: &Desk, model: &Model) -> (Experiment, f64) {
        let (bottom_mm, top_mm) = model.ends_mm();
        let lies = self.first_mm < bottom_mm + LYING * (top_mm - bottom_mm);
        let place_mm = self.first_mm.clamp(desk.safety.setpoint_min_mm, desk.safety.setpoint_max_mm);
        let lead = (!lies).then(|| segment(LEAD_S, Waveform::Constant { value: place_mm }));
        let period_s = desk.period_s();
        let values = self.every(period_s);
        let parts = values.chunks(MAX_STEPS).map(|part| {
            let steps = Waveform::Steps { values: part.iter().copied().collect(), each_s: period_s };
            segment(period_s * part.len() as f64, steps)
        });
        let segments = lead.into_iter().chain(parts).collect::<Vec<_>>().into();
        let title = "setpoints of the record".to_owned();
        (Experiment { title, limits: Limits::default(), segments }, if lies { 0.0 } else { LEAD_S })
    }

    /// The setpoint in force in the middle of every period.
    fn every(&self, period_s: f64) -> Vec<f64> {
        let mut row = 0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let count = (self.duration_s() / period_s).ceil() as usize;
        let value = |k: usize| {
            let time_s = self.start_s + (k as f64 + 0.5) * period_s;
            while self.moments.get(row + 1).is_some_and(|next| next.time_s <= time_s) {
                row += 1;
            }
            self.moments.get(row).and_then(|moment| moment.setpoint_mm).unwrap_or_default()
        };
        (0..count).map(value).collect()
    }
}

fn segment(duration_s: f64, setpoint: Waveform) -> Segment {
    Segment { duration_s, setpoint_mm: Some(setpoint), ..Segment::default() }
}
