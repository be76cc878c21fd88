//! Open-loop records, detrended: a line is subtracted from the position of each open-loop stretch, and the mean from
//! its duty.
//!
//! ```text
//! ÿ = K·(u − h) − a·ẏ,   y' = y − (b·t + c)   ⟹   ÿ' = K·(u − h − a·b/K) − a·ẏ'
//! ```
//!
//! A line subtracted from the position only shifts the hover duty of the stretch. The rest is an unknown constant force
//! per stretch, which the filter estimates. Gain, drag and lag do not change, whatever the line. This does not hold if
//! the lift depends on height.
//! Source: the thesis, section 3.1.3, detrends its open-loop records by a line.

use crate::identify::grey_box::{GreyBox, Poles, TooLittle};
use crate::record::recording::{Recording, Sample, duration_s};
use crate::stats::line::line;
use plant::Model;

/// The shortest stretch that is used, seconds: the filter forgets its initial state in half of it.
pub(super) const SHORTEST_S: f64 = 4.0;
/// Distance from an end within which the ball may lie there, mm.
const AT_END_MM: f64 = 10.0;
/// Length of the virtual pipe of a detrended ball, in lengths of the real one: no line reaches its ends.
const LONGER: f64 = 10.0;
/// Remaining uncertainty of hover, percent, 1σ; and its correlation time, which makes it constant.
const HOVER_PERCENT: f64 = 0.3;
const FOR_EVER_S: f64 = 1e5;

/// Open-loop stretches for identification.
#[derive(Clone, Debug)]
pub struct OpenLoop {
    /// The stretches in sequence.
    pub recording: Recording,
    /// The longest stretch without control, also if it is too short, seconds.
    longest_s: f64,
    /// The belief.
    believed: Model,
    /// The belief in a pipe without ends, with a constant force for the remaining offset.
    detrended: Model,
}

impl OpenLoop {
    /// The open-loop stretches of `flights` that are long enough. A record without any setpoint is open loop as a
    /// whole.
    #[must_use]
    pub fn of(flights: &[Recording], belief: &Model) -> Self {
        let mut there = Model { pipe_length_mm: (LONGER * belief.pipe_length_mm).min(1e6), ..belief.clone() };
        let sigma_mm_per_s2 = HOVER_PERCENT * belief.gain_mm_per_s2_per_percent;
        if there.effects.coloured_force().is_none() {
            there.effects = there.effects.with_coloured_force(sigma_mm_per_s2, FOR_EVER_S);
        }
        let (bottom, top) = belief.pipe_mm();
        let free = |s: &Sample| s.position_mm.is_none_or(|mm| mm > bottom + AT_END_MM && mm < top - AT_END_MM);
        let open = |s: &Sample| s.setpoint_mm.is_none() && free(s);
        let of_flight = |flight: &'_ Recording| {
            let stretches = flight.samples().chunk_by(|a, b| open(a) && open(b));
            stretches.filter(|rows| rows.iter().all(open)).map(<[Sample]>::to_vec).collect::<Vec<_>>()
        };
        let stretches: Vec<Vec<Sample>> = flights.iter().flat_map(of_flight).collect();
        let longest_s = stretches.iter().map(|rows| duration_s(rows)).fold(0.0, f64::max);
        let recording = Recording::together(stretches.iter().filter_map(|rows| detrended(rows, &there)));
        Self { recording, longest_s, believed: belief.clone(), detrended: there }
    }

    /// Identifies a plant with this number of poles. Hover is not identifiable: it differs between stretches.
    ///
    /// # Errors
    /// [`TooLittle`]: the open-loop stretches are too few or too short.
    pub fn identify(&self, poles: Poles) -> Result<GreyBox, TooLittle> {
        let mut found = GreyBox::identify(&self.detrended, &self.recording, poles).map_err(|error| match error {
            TooLittle::Readings { readings } => TooLittle::OpenLoop { readings, longest_s: self.longest_s },
            other => other,
        })?;
        found.estimates.retain(|estimate| estimate.name != "hover_duty_percent");
        for model in [&mut found.fit.model, &mut found.held_out.model] {
            model.effects = model.effects.with_coloured_force_of(&self.believed.effects);
            model.pipe_length_mm = self.believed.pipe_length_mm;
            model.hover_duty_percent = self.believed.hover_duty_percent;
        }
        Ok(found)
    }
}

/// `rows` about the middle of the pipe and the hover duty; `None` if too short.
fn detrended(rows: &[Sample], belief: &Model) -> Option<Recording> {
    let first = rows.first()?;
    if duration_s(rows) < SHORTEST_S {
        return None;
    }
    let points: Vec<(f64, f64)> = rows.iter().filter_map(|s| Some((s.time_s - first.time_s, s.position_mm?))).collect();
    let (slope, offset) = line(&points)?;
    let mean = rows.iter().map(|s| s.duty_percent).sum::<f64>() / rows.len() as f64;
    let middle_mm = belief.middle_mm();
    let flat = |s: &Sample| Sample {
        position_mm: s.position_mm.map(|mm| mm - offset - slope * (s.time_s - first.time_s) + middle_mm),
        duty_percent: s.duty_percent - mean + belief.hover_duty_percent,
        ..*s
    };
    Recording::new(rows.iter().map(flat).collect()).ok()
}

#[cfg(test)]
mod tests {
    use super::OpenLoop;
    use crate::tests_support::model;
    use crate::{Recording, Sample};

    fn row(k: u32, open: bool) -> Sample {
        let time_s = 0.02 * f64::from(k);
        let position_mm = Some(200.0 + 12.0 * time_s + if k.is_multiple_of(2) { 1.0 } else { -1.0 });
        Sample { time_s, setpoint_mm: (!open).then_some(300.0), duty_percent: 22.0, position_mm, ..Sample::default() }
    }

    #[test]
    fn each_stretch_without_control_loses_its_line_and_its_mean() {
        let rows = (0..1000).map(|k| row(k, (200..500).contains(&k) || k >= 900)).collect();
        let found = OpenLoop::of(&[Recording::new(rows).unwrap()], &model());
        // The stretch of 2 s at the end is too short.
        assert_eq!(found.recording.flights().len(), 1);
        let middle = found.detrended.middle_mm();
        let rows = found.recording.samples();
        assert_eq!(rows.len(), 300);
        assert!(rows.iter().all(|s| (s.position_mm.unwrap() - middle).abs() < 1.1 && s.duty_percent == 21.4));
    }

    #[test]
    fn a_ball_at_an_end_is_no_open_loop() {
        let at_end = |k: u32| Sample { position_mm: Some(if k < 400 { 3.0 } else { 300.0 }), ..row(k, true) };
        let found = OpenLoop::of(&[Recording::new((0..900).map(at_end).collect()).unwrap()], &model());
        assert_eq!(found.recording.flights(), std::slice::from_ref(&(0..500)));
    }
}
