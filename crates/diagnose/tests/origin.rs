//! Where 0 of the position lies is a matter of the column alone: a record that is moved, in a pipe that is moved as
//! far, has the same diagnosis.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use diagnose::{Diagnosis, Options, Recording, Sample, diagnose};
use plant::{Effects, Model, Noise, Simulator};

/// A power of two, so that a moved reading has the digits of the other.
const MOVED_MM: f64 = -512.0;

/// A rig in a pipe with this lower end.
fn rig(bottom_mm: f64, effects: &[(&'static str, &[f64])]) -> Model {
    let mut model = Model {
        gain_mm_per_s2_per_percent: 250.0,
        drag_per_s: 1.9,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: bottom_mm,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
        effects: Effects::default(),
    };
    effects.iter().for_each(|(name, values)| assert!(model.effects.set(name, values)));
    model
}

/// A minute of steps between two heights of a rig whose force falls with the height.
fn flown() -> Recording {
    let truth = rig(0.0, &[("height_dependent_flow", &[6.0])]);
    let mut simulator = Simulator::new(truth, 3);
    let rows = (0..3000).map(|k| {
        let time_s = 0.02 * f64::from(k);
        simulator.advance_to(time_s);
        let reading = (simulator.reading_mm() * 16.0).round() / 16.0;
        let setpoint = if (k / 200) % 2 == 0 { 200.0 } else { 380.0 };
        let duty_percent = (21.4 + 0.012 * (setpoint - reading)).clamp(10.0, 40.0);
        simulator.drive(duty_percent);
        Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
    });
    Recording::new(rows.collect()).unwrap()
}

fn named(found: &Diagnosis) -> Vec<(&'static str, Vec<f64>)> {
    let values = |name| found.mended.model.effects.values(name).unwrap_or_default();
    found.effects.iter().map(|one| one.candidate.entry.name).map(|name| (name, values(name))).collect()
}

#[test]
fn a_record_and_a_pipe_that_are_moved_together_have_the_same_diagnosis() {
    let at_zero = flown();
    let row = |row: &Sample| Sample { position_mm: row.position_mm.map(|mm| mm + MOVED_MM), ..*row };
    let moved = Recording::new(at_zero.samples().iter().map(row).collect()).unwrap();
    let of = |bottom_mm, recording| diagnose(&rig(bottom_mm, &[]), &[recording], &Options::default());
    let [zero, moved] = [of(0.0, at_zero), of(MOVED_MM, moved)];
    let (wanted, found) = (named(&zero), named(&moved));
    assert_eq!(wanted[0].0, "height_dependent_flow");
    assert_eq!((zero.verdict, wanted.len()), (moved.verdict, found.len()));
    for ((wanted, a), (found, b)) in wanted.iter().zip(&found) {
        assert_eq!(wanted, found);
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3 * a.abs().max(1.0)), "{wanted}: {a:?}, {b:?}");
    }
    let errors = [&zero, &moved].map(|found| found.ladder.last().unwrap().error_mm[2].unwrap());
    assert!((errors[0] - errors[1]).abs() < 1e-3, "{errors:?}");
}
