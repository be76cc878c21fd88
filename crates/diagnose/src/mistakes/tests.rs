use super::{MORE, SEEN, mistakes};
use crate::linear::linear_fit_at;
use crate::tests_support::{flown, model, record};
use crate::{Finding, Options, Recording, Sample, Verdict, diagnose};
use plant::{Effects, Model};
use std::borrow::Cow;

/// A flight of a rig with a dead zone that nobody believes, its rows changed.
fn spoilt(belief: &Model, spoil: impl Fn(&mut Sample)) -> Recording {
    let mut rig = belief.clone();
    rig.effects.set("dead_zone", &[-0.3, 0.3]);
    let mut rows = record(&rig, 6, 60).samples().to_vec();
    rows.iter_mut().for_each(spoil);
    Recording::new(rows).unwrap()
}

/// The findings of one log that are mistakes; its diagnosis must name no effect.
fn found(belief: &Model, recording: &Recording) -> Vec<Finding> {
    let named: Vec<Finding> =
        mistakes(belief, std::slice::from_ref(recording)).into_iter().map(|noted| noted.finding).collect();
    if !named.is_empty() {
        let answer = diagnose(belief, recording, &Options::default());
        assert_eq!(answer.verdict, Verdict::InsufficientData);
        assert!(answer.effects.is_empty() && answer.rounds.is_empty(), "{:?}", answer.effects);
        assert!(answer.findings.iter().any(|noted| named.contains(&noted.finding)), "{:?}", answer.findings);
    }
    named
}

/// The one finding in words.
fn said(belief: &Model, spoil: impl Fn(&mut Sample)) -> String {
    let found = found(belief, &spoilt(belief, spoil));
    assert_eq!(found.len(), 1, "{found:?}");
    found[0].to_string()
}

#[test]
fn a_record_in_our_units_has_no_mistake() {
    assert_eq!(found(&model(), &spoilt(&model(), |_| {})), []);
}

#[test]
fn a_rig_that_is_driven_both_ways_hovers_near_0_in_every_unit() {
    let gain = model().gain_mm_per_s2_per_percent / 10.0;
    let level = Model { hover_duty_percent: 0.25, gain_mm_per_s2_per_percent: gain, ..model() };
    let driven = spoilt(&model(), |row| row.duty_percent = 3.5 + 10.0 * (row.duty_percent - 21.4));
    assert_eq!(found(&level, &driven), []);
    let one_way = spoilt(&model(), |row| row.duty_percent -= 21.4 - 3.5);
    let hovers = Model { hover_duty_percent: 0.25, ..model() };
    assert!(matches!(found(&hovers, &one_way)[..], [Finding::DutyUnit { .. }]));
}

#[test]
fn readings_of_few_levels_are_in_no_other_unit() {
    let mut belief = model();
    belief.noise.sensor_mm = 0.2;
    for (step, derivative) in [(15.0, 0.02), (30.0, 0.01)] {
        let mut rig = belief.clone();
        rig.effects.set("sensor_quantisation", &[step]);
        let mut last = 0.0;
        let flight = flown(&rig, 1, 80, |time_s, reading| {
            let velocity = (reading - last) / 0.02;
            last = reading;
            let target = if time_s % 6.0 < 3.0 { 320.0 } else { 270.0 };
            21.4 + 0.006 * (target - reading) - derivative * velocity
        });
        let lag_s = belief.effects.fan_lag_s().unwrap_or_default();
        let fit = linear_fit_at(&flight, belief.drag_per_s, lag_s).unwrap();
        assert!(fit.gain > MORE * belief.gain_mm_per_s2_per_percent && fit.gain_in_deviations > SEEN, "{fit:?}");
        assert_eq!(mistakes(&belief, std::slice::from_ref(&flight)), []);
    }
}

#[test]
fn a_distance_from_above_is_named_with_scale_and_offset() {
    let said = said(&model(), |row| row.position_mm = row.position_mm.map(|mm| 583.0 - mm));
    assert!(said.contains("position_mm = { column = \"position_mm\", scale = -1, offset = 583 }"), "{said}");
}

#[test]
fn a_turned_input_is_named_with_its_scale() {
    let said = said(&model(), |row| row.duty_percent = -row.duty_percent);
    assert!(said.contains("duty_percent = { column = \"duty_percent\", scale = -1 }"), "{said}");
}

#[test]
fn a_turned_sign_of_a_rig_that_rests_at_0_is_named_with_both_lines() {
    // The same motions with the duty about 0.
    let level = Model { hover_duty_percent: 0.0, ..model() };
    let turned = spoilt(&model(), |row| row.duty_percent = 21.4 - row.duty_percent);
    let found = found(&level, &turned);
    let said = found.first().map(ToString::to_string).unwrap_or_default();
    assert!(said.contains("duty_percent = {") && said.contains("position_mm = {"), "{said}");
}

#[test]
fn metres_are_named_with_their_scale() {
    let said = said(&model(), |row| row.position_mm = row.position_mm.map(|mm| 1e-3 * mm));
    assert!(
        said.contains("metres") && said.contains("position_mm = { column = \"position_mm\", scale = 1000 }"),
        "{said}"
    );
}

#[test]
fn centimetres_are_told_from_an_effect_by_the_noise_of_the_readings() {
    let cm = |row: &mut Sample| row.position_mm = row.position_mm.map(|mm| 0.1 * mm);
    let found: Vec<Finding> =
        mistakes(&model(), &[spoilt(&model(), cm)]).into_iter().map(|noted| noted.finding).collect();
    let said = found.first().map(ToString::to_string).unwrap_or_default();
    assert!(said.contains("centimetres") && said.contains("scale = 10"), "{said}");
}

#[test]
fn a_pwm_of_8_bits_is_named_with_its_scale() {
    let said = said(&model(), |row| row.duty_percent *= 2.55);
    assert!(said.contains("duty_percent = { column = \"duty_percent\", scale = 0.3922 }"), "{said}");
}

#[test]
fn a_fraction_with_a_sign_and_volts_are_named_with_their_scales() {
    // A tenth of the gain, and ten times the duty, of which 100 % are 1 or 12 V.
    let gain_mm_per_s2_per_percent = 0.1 * model().gain_mm_per_s2_per_percent;
    let level = Model { hover_duty_percent: 0.0, gain_mm_per_s2_per_percent, ..model() };
    for (by, scales) in [(0.01, 99.9..100.1), (0.12, 6.5..9.0)] {
        let mut rows = record(&model(), 6, 60).samples().to_vec();
        rows.iter_mut().for_each(|row| row.duty_percent = 10.0 * by * (row.duty_percent - 21.4));
        let found = found(&level, &Recording::new(rows).unwrap());
        let said = found.first().map(ToString::to_string).unwrap_or_default();
        let (_, scale) = said.split_once("column = \"duty_percent\", scale = ").unwrap_or_default();
        let scale: f64 = scale.split(' ').next().unwrap_or_default().parse().unwrap_or_default();
        assert!(scales.contains(&scale), "{by}: {said}");
    }
}

#[test]
fn a_believed_hover_in_another_unit_is_named() {
    let fraction = Model { hover_duty_percent: 0.214, ..model() };
    let found = found(&fraction, &spoilt(&model(), |_| {}));
    let said = found.first().map(ToString::to_string).unwrap_or_default();
    assert!(said.contains("plant.hover_duty_percent = 21.") && said.contains("0.214"), "{said}");
}

#[test]
fn exchanged_columns_are_named() {
    let exchanged = |row: &mut Sample| {
        let position = row.position_mm.unwrap_or_default();
        (row.duty_percent, row.position_mm) = (position, Some(row.duty_percent));
    };
    // A pipe and a hover that both columns could be of.
    let belief = Model { hover_duty_percent: 200.0, ..model() };
    let rig = spoilt(&model(), exchanged);
    let named: Vec<Finding> = mistakes(&belief, rig.as_ref()).into_iter().map(|noted| noted.finding).collect();
    assert_eq!(named, [Finding::Exchanged]);
}

#[test]
fn logs_of_two_rigs_are_told_apart_and_two_of_one_rig_are_not() {
    let other = Model { gain_mm_per_s2_per_percent: 2.0 * model().gain_mm_per_s2_per_percent, ..model() };
    let logs = [record(&model(), 1, 60), record(&model(), 2, 60), record(&other, 3, 60)];
    let gains =
        logs.each_ref().map(|log| super::of_one(&model(), log).unwrap().map(|fit| (fit.gain, fit.gain_in_deviations)));
    assert!(gains.iter().all(Option::is_some), "{gains:?}");
    assert_eq!(mistakes(&model(), &logs[..2]), []);
    let found = mistakes(&model(), &logs);
    assert!(
        matches!(found[..], [crate::FlightFinding { flight: 2, finding: Finding::SeveralRigs { .. } }]),
        "{found:?} {gains:?}"
    );
    let answer = diagnose(&model(), &logs, &Options::default());
    assert_eq!((answer.verdict, answer.effects.len()), (Verdict::InsufficientData, 0));
}

#[test]
fn a_gain_that_an_effect_takes_away_is_no_mistake() {
    let mut rig = model();
    rig.effects.set("dead_zone", &[-2.0, 2.0]);
    assert_eq!(mistakes(&model(), record(&rig, 2, 60).as_ref()), []);
    let weak = Model { gain_mm_per_s2_per_percent: 0.4 * model().gain_mm_per_s2_per_percent, ..model() };
    assert_eq!(mistakes(&model(), record(&weak, 2, 60).as_ref()), []);
    let lagless = Model { effects: Effects::default(), ..model() };
    assert_eq!(mistakes(&lagless, record(&model(), 2, 60).as_ref()), []);
}

#[test]
fn an_inverted_output_is_told_from_a_sensor_above_by_its_hover() {
    let inverted = said(&model(), |row| row.duty_percent = 100.0 - row.duty_percent);
    assert!(inverted.contains("inverted output") && inverted.contains("scale = -1, offset = 100"), "{inverted}");
    let above = said(&model(), |row| row.position_mm = row.position_mm.map(|mm| 583.0 - mm));
    assert!(above.contains("from a sensor above") && !above.contains("inverted"), "{above}");
    // With a hover of 50 % both are alike.
    let middle = Model { hover_duty_percent: 50.0, ..model() };
    assert!(!said(&middle, |row| row.duty_percent = 100.0 - row.duty_percent).contains("inverted"));
}

#[test]
fn a_swinging_pendulum_whose_gravity_turns_its_gain_round_has_no_wrong_sign() {
    let belief = Model { turn_mm: Some(500.0), ..model() };
    let turned = spoilt(&model(), |row| row.duty_percent = 2.0 * 21.4 - row.duty_percent);
    let [lowest, highest] = turned.height_range();
    assert!(highest - lowest > 125.0);
    assert_eq!(mistakes(&belief, std::slice::from_ref(&turned)), []);
    let narrow = Model { turn_mm: Some(5e3), ..model() };
    assert_ne!(mistakes(&narrow, std::slice::from_ref(&turned)), []);
}

#[test]
fn readings_that_a_slow_sensor_holds_do_not_look_like_another_unit() {
    let mut rig = model();
    rig.effects.set("stale_samples", &[0.2]);
    let mut last = 0.0;
    let log = flown(&rig, 3, 200, |time_s, reading| {
        let velocity = (reading - last) / 0.02;
        last = reading;
        let target = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
        21.4 + 0.01 * (target - reading) - 0.02 * velocity
    });
    // With the repeats, the gain seems to be 3.2 times the true one.
    let weak = Model { gain_mm_per_s2_per_percent: 0.2 * model().gain_mm_per_s2_per_percent, ..model() };
    assert_eq!(mistakes(&weak, std::slice::from_ref(&log)), []);
    let fit = super::of_one(&model(), &super::without_repeats(Cow::Borrowed(&log))).unwrap().unwrap();
    assert!((fit.gain / 254.6 - 1.0).abs() < 0.2, "{fit:?}");
}
