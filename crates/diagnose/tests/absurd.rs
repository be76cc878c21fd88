//! Records with numbers that are finite and absurd: units off by any power of ten, single wild cells anywhere, any
//! length. They have an answer, in time and memory that depend on their length alone, and no sure name from what was
//! spoilt.

use diagnose::identify::{GreyBox, Poles};
use diagnose::measure::critical::critical;
use diagnose::measure::jumps::jumps;
use diagnose::measure::noise_floor::noise_floor;
use diagnose::{Diagnosis, Options, Recording, Sample, Verdict, check, diagnose, log_likelihood};
use plant::effects::FanLag;
use plant::{Effects, Model, Noise, Simulator};
use rayon::prelude::*;

fn model() -> Model {
    Model {
        gain_mm_per_s2_per_percent: 254.6,
        drag_per_s: 1.889,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
        effects: Effects { fan_lag: Some(FanLag { time_constant_s: 0.2 }), ..Effects::default() },
    }
}

/// A flight of the believed rig between two heights.
fn flown(rows: u32) -> Vec<Sample> {
    let mut simulator = Simulator::new(model(), 5);
    let mut last = 0.0;
    let row = |k: u32| {
        let time_s = 0.02 * f64::from(k);
        simulator.advance_to(time_s);
        let reading = simulator.reading_mm();
        let setpoint = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
        let duty_percent = 21.4 + 0.01 * (setpoint - reading) - 0.025 * (reading - last);
        last = reading;
        simulator.drive(duty_percent);
        Sample { time_s, setpoint_mm: Some(setpoint), duty_percent, position_mm: Some(reading), ..Sample::default() }
    };
    (0..rows).map(row).collect()
}

/// What is done to a cell, with a number.
type Touch = fn(&mut Sample, f64);

/// A way to spoil a record.
type Spoiler = Box<dyn Fn(&mut [Sample]) + Sync + Send>;

/// All rows of a column times a factor.
fn scaled() -> Vec<(String, Spoiler)> {
    let powers = [-300, -30, -9, -3, -1, 1, 2, 3, 6, 12, 100, 300].map(|power| 10.0_f64.powi(power));
    let columns: [(&str, Touch); 4] = [
        ("time", |row, by| row.time_s *= by),
        ("duty", |row, by| row.duty_percent *= by),
        ("position", |row, by| row.position_mm = row.position_mm.map(|mm| mm * by)),
        ("setpoint", |row, by| row.setpoint_mm = row.setpoint_mm.map(|mm| mm * by)),
    ];
    let each = columns.into_iter().flat_map(|(name, times)| powers.map(|by| (name, times, by)));
    let spoiler = |(name, times, by): (&str, Touch, f64)| {
        let spoil: Spoiler = Box::new(move |rows| rows.iter_mut().for_each(|row| times(row, by)));
        (format!("{name} times {by:e}"), spoil)
    };
    each.map(spoiler).collect()
}

/// One cell of a column, wild.
fn single() -> Vec<(String, Spoiler)> {
    let values = [-1e308, -1e6, -1e3, 1e-308, 1e3, 1e5, 1e9, 1e308];
    let columns: [(&str, Touch); 3] = [
        ("duty", |row, to| row.duty_percent = to),
        ("position", |row, to| row.position_mm = Some(to)),
        ("setpoint", |row, to| row.setpoint_mm = Some(to)),
    ];
    let each = columns.into_iter().flat_map(|(name, set)| values.map(|to| (name, set, to)));
    let spoiler = |(k, (name, set, to)): (usize, (&str, Touch, f64))| {
        let spoil: Spoiler = Box::new(move |rows| {
            let at = [0, rows.len() / 3, rows.len() - 1][k % 3];
            set(&mut rows[at], to);
        });
        (format!("one {name} of {to:e}"), spoil)
    };
    each.enumerate().map(spoiler).collect()
}

/// Everything that reads a record. Panics are failures; everything else is an answer.
fn all_of(recording: &Recording) -> Diagnosis {
    let belief = model();
    let _ = check(recording, &belief);
    let _ = (critical(recording), jumps(recording, 1.889), noise_floor(recording));
    let _ = GreyBox::identify(&belief, recording, Poles::Two);
    let _ = log_likelihood(&belief, recording, &belief, None);
    diagnose(&belief, std::slice::from_ref(recording), &Options::default())
}

/// The sure names of a verdict.
fn sure(found: &Diagnosis) -> Vec<&'static str> {
    if found.verdict == Verdict::InsufficientData {
        return Vec::new();
    }
    found.effects.iter().filter(|named| named.probability >= 0.5).map(|named| named.candidate.entry.name).collect()
}

#[test]
fn columns_in_units_off_by_any_power_of_ten_have_an_answer_and_no_sure_name() {
    let plain = flown(600);
    scaled().into_par_iter().for_each(|(what, spoil)| {
        let mut rows = plain.clone();
        spoil(&mut rows);
        let Ok(recording) = Recording::new(rows) else { return };
        let found = all_of(&recording);
        if !what.starts_with("setpoint") {
            assert_eq!(sure(&found), [""; 0], "{what}");
        }
    });
}

#[test]
fn a_single_wild_cell_has_an_answer_and_no_sure_name() {
    let plain = flown(600);
    single().into_par_iter().for_each(|(what, spoil)| {
        let mut rows = plain.clone();
        spoil(&mut rows);
        let Ok(recording) = Recording::new(rows) else { return };
        assert_eq!(sure(&all_of(&recording)), [""; 0], "{what}");
    });
}

#[test]
fn records_of_any_length_have_an_answer() {
    let plain = flown(700);
    [20_usize, 21, 25, 40, 76, 77, 100, 151, 299, 301, 450, 700].into_par_iter().for_each(|rows| {
        let found = all_of(&Recording::new(plain[..rows].to_vec()).unwrap());
        assert_eq!(sure(&found), [""; 0], "{rows} rows");
    });
}
