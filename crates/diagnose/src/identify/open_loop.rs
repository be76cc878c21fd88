//! Open-loop records, detrended: each stretch without control loses its own line of position and its own mean of duty.
//!
//! ```text
//! ÿ = K·(u − h) − a·ẏ,   y' = y − (b·t + c)   ⟹   ÿ' = K·(u − h − a·b/K) − a·ẏ'
//! ```
//!
//! A line taken from the position only shifts the stretch's hover. What is left of it is a force that is constant over a stretch and
//! unknown beforehand, which the filter finds: gain, drag and lag stay what they are, whatever the line. It does not hold where the lift changes
//! with height.
//! Source: the thesis, section 3.1.3, detrends its open-loop records by a line.

use crate::identify::grey_box::{GreyBox, Poles, TooLittle};
use crate::record::recording::{Recording, Sample};
use crate::stats::line::line;
use plant::Model;

/// The shortest stretch that is used, seconds: a filter forgets its start in half of it.
const SHORTEST_S: f64 = 4.0;
/// Nearer to an end than this the ball may lie there, mm.
const AT_END_MM: f64 = 10.0;
/// The pipe in which a detrended ball flies, in lengths of the real one: no line leads it to an end.
const LONGER: f64 = 10.0;
/// What a line leaves of hover, percent, 1 sigma; and for how long it stays what it is: for ever.
const HOVER_PERCENT: f64 = 0.3;
const FOR_EVER_S: f64 = 1e5;

/// Stretches without control, ready to be identified.
#[derive(Clone, Debug)]
pub struct OpenLoop {
    /// The stretches, one after another.
    pub recording: Recording,
    /// The belief as it is.
    believed: Model,
    /// The belief in a pipe without ends, with a constant force for what the lines leave.
    detrended: Model,
}

impl OpenLoop {
    /// The stretches of `flights` without control that are long enough. A record that has no setpoint anywhere is open loop as a whole.
    #[must_use]
    pub fn of(flights: &[Recording], belief: &Model) -> Self {
        let mut there = Model { pipe_length_mm: (LONGER * belief.pipe_length_mm).min(1e6), ..belief.clone() };
        let sigma_mm_per_s2 = HOVER_PERCENT * belief.gain_mm_per_s2_per_percent;
        if there.effects.coloured_force().is_none() {
            there.effects = there.effects.with_coloured_force(sigma_mm_per_s2, FOR_EVER_S);
        }
        let free = |s: &Sample| s.position_mm.is_none_or(|mm| mm > AT_END_MM && mm < belief.pipe_length_mm - AT_END_MM);
        let open = |s: &Sample| s.setpoint_mm.is_none() && free(s);
        let of_flight = |flight: &Recording| {
            let stretches = flight.samples().chunk_by(|a, b| open(a) && open(b));
            let stretches = stretches.filter(|rows| rows.iter().all(open));
            stretches.filter_map(|rows| detrended(rows, &there)).collect::<Vec<_>>()
        };
        let recording = Recording::together(flights.iter().flat_map(of_flight));
        Self { recording, believed: belief.clone(), detrended: there }
    }

    /// Identifies a plant of so many poles. Of hover it says nothing: every stretch has its own.
    ///
    /// # Errors
    /// [`TooLittle`]: there are too few stretches without control, or they are too short.
    pub fn identify(&self, poles: Poles) -> Result<GreyBox, TooLittle> {
        let mut found = GreyBox::identify(&self.detrended, &self.recording, poles)?;
        found.estimates.retain(|estimate| estimate.name != "hover_duty_percent");
        for model in [&mut found.fit.model, &mut found.held_out.model] {
            model.effects = model.effects.with_coloured_force_of(&self.believed.effects);
            model.pipe_length_mm = self.believed.pipe_length_mm;
            model.hover_duty_percent = self.believed.hover_duty_percent;
        }
        Ok(found)
    }
}

/// `rows` about the middle of the pipe and about hover. `None`: too short.
fn detrended(rows: &[Sample], belief: &Model) -> Option<Recording> {
    let (first, last) = (rows.first()?, rows.last()?);
    if last.time_s - first.time_s < SHORTEST_S {
        return None;
    }
    let points: Vec<(f64, f64)> = rows.iter().filter_map(|s| Some((s.time_s - first.time_s, s.position_mm?))).collect();
    let (slope, offset) = line(&points)?;
    let mean = rows.iter().map(|s| s.duty_percent).sum::<f64>() / rows.len() as f64;
    let middle_mm = 0.5 * belief.pipe_length_mm;
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
        // 2 s at the end are too short.
        assert_eq!(found.recording.flights().len(), 1);
        let middle = 0.5 * found.detrended.pipe_length_mm;
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
