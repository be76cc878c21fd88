//! Rows before take-off and after landing are left out: a ball that rests at an end of the pipe shows nothing of the
//! forces that move it.
//!
//! Such rows do show that an end holds the ball, but no model of free flight describes that, and a filter that starts
//! there starts with a wrong state.

use crate::record::check::Finding;
use crate::record::free_flight::is_at_end;
use crate::record::recording::Recording;
use plant::Model;

/// Fewer rows than this are noise at the start of a flight.
const LIES: usize = 5;

/// One flight without the rows before its take-off and after its landing, with the finding about them. `None`: it has
/// no such rows, or never takes off.
pub(crate) fn airborne(flight: &Recording, belief: &Model) -> Option<(Finding, Recording)> {
    let rows = flight.samples();
    let flies = |at: &usize| rows[*at].position_mm.is_some_and(|mm| !is_at_end(belief, mm));
    let (first, last) = ((0..rows.len()).find(flies)?, (0..rows.len()).rev().find(flies)?);
    let (before, after) = (first, rows.len() - 1 - last);
    if before.max(after) < LIES {
        return None;
    }
    let finding = Finding::AtEnd {
        before_s: rows[first].time_s - rows[0].time_s,
        after_s: rows[rows.len() - 1].time_s - rows[last].time_s,
    };
    Some((finding, Recording::new(rows[first..=last].to_vec()).ok()?))
}

#[cfg(test)]
mod tests {
    use super::airborne;
    use crate::record::check::Finding;
    use crate::tests_support::{model, record};
    use crate::{Options, Recording, Sample, Verdict, diagnose};
    use plant::effects::SensorQuantisation;
    use plant::{Effects, Model};

    /// A flight that starts well after its take-off.
    fn flight(rig: &Model, seconds: u32) -> Recording {
        let whole = record(rig, 1, seconds + 3);
        let rows = whole.samples()[150..].iter();
        Recording::new(rows.map(|row| Sample { time_s: row.time_s - 3.0, ..*row }).collect()).unwrap()
    }

    /// The flight with two seconds on the ground before it and one second after it.
    fn from_ground_to_ground(flight: &Recording) -> Recording {
        let lying = |time_s: f64| Sample { time_s, duty_percent: 25.0, position_mm: Some(0.0), ..Sample::default() };
        let before = (0..100).map(|k| lying(f64::from(k) * 0.02));
        let airborne = flight.samples().iter().map(|row| Sample { time_s: row.time_s + 2.0, ..*row });
        let end_s = 2.0 + flight.duration_s();
        let after = (1..=50).map(|k| lying(end_s + f64::from(k) * 0.02));
        Recording::new(before.chain(airborne).chain(after).collect()).unwrap()
    }

    #[test]
    fn rows_on_the_ground_are_left_out_and_said() {
        let flight = flight(&model(), 40);
        let (finding, found) = airborne(&from_ground_to_ground(&flight), &model()).unwrap();
        let Finding::AtEnd { before_s, after_s } = finding else { panic!("{finding:?}") };
        assert!((before_s - 2.0).abs() < 0.03 && (after_s - 1.0).abs() < 0.03, "{finding}");
        assert_eq!(found.samples().len(), flight.samples().len());
        assert!(airborne(&flight, &model()).is_none());
        let never: Vec<Sample> = (0..500)
            .map(|k| Sample { time_s: f64::from(k) * 0.02, position_mm: Some(0.0), ..Sample::default() })
            .collect();
        assert!(airborne(&Recording::new(never).unwrap(), &model()).is_none());
    }

    #[test]
    fn the_time_on_the_ground_changes_no_answer() {
        let coarse = Effects { sensor_quantisation: Some(SensorQuantisation { step_mm: 8.0 }), ..model().effects };
        let flight = flight(&Model { effects: coarse, ..model() }, 60);
        let named = |recording: Recording| {
            let found = diagnose(&model(), &[recording], &Options::default());
            (found.verdict, found.effects.iter().map(|named| named.candidate.entry.name).collect::<Vec<_>>())
        };
        let grounded = from_ground_to_ground(&flight);
        assert_eq!(named(grounded), (Verdict::Effect, vec!["sensor_quantisation"]));
        assert_eq!(named(flight), (Verdict::Effect, vec!["sensor_quantisation"]));
    }
}
