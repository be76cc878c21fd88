//! Tests of the patches.

use super::{lag_of, patch};
use crate::analysis::measurement::Found;
use config::{Tables, with_other_control};
use control::design::critical::critical_gain;
use control::design::law::Gains;
use diagnose::measure::Estimate;
use diagnose::measure::critical::Critical;
use diagnose::measure::dead_zone::DeadZone;
use diagnose::measure::jumps::Jumps;

fn tables() -> Tables {
    toml::from_str(include_str!("../../../../../../config.toml")).unwrap()
}

fn within(value: f64, half: f64) -> Estimate {
    Estimate { value, low: value - half, high: value + half }
}

/// The patch of a dead zone with these edges.
fn of_edges(lower: f64, upper: f64) -> String {
    let gain = within(800.0, 10.0);
    let [lower_duty_percent, upper_duty_percent] = [lower, upper].map(|edge| within(edge, 0.02));
    let zone = DeadZone { lower_duty_percent, upper_duty_percent, gain_below: gain, gain_above: gain };
    let jumps = Jumps { drag_per_s: 3.0, lag_s: within(0.2, 0.01), jumps: vec![] };
    patch(&Found::DeadZone { zone, jumps }, &tables()).unwrap().unwrap()
}

#[test]
fn a_dead_zone_is_corrected_and_believed_about_its_middle() {
    let text = of_edges(21.1, 21.9);
    let found: toml::Table = toml::from_str(&text).unwrap();
    for table in [&found["compensation"], &found["plant"]["effects"]] {
        let zone = &table["dead_zone"];
        let [lower, upper] = ["lower_percent", "upper_percent"].map(|key| zone[key].as_float().unwrap());
        assert!((lower + 0.4).abs() < 1e-9 && (upper - 0.4).abs() < 1e-9, "{text}");
    }
    for table in ["compensation", "plant"] {
        assert!((found[table]["hover_duty_percent"].as_float().unwrap() - 21.5).abs() < 1e-9, "{text}");
    }
}

#[test]
fn a_zone_that_may_be_none_moves_hover_alone() {
    let text = of_edges(21.40, 21.43);
    assert!(!text.contains("dead_zone") && text.contains("hover_duty_percent"), "{text}");
}

#[test]
fn the_lag_of_a_critical_gain_is_the_models_own() {
    let tables = tables();
    let plant = tables.plant.as_ref().unwrap().linear().sampled(0.02).unwrap();
    let exact = critical_gain(&Gains::pi(1.0, 15.0), &plant).value().unwrap();
    let found = Critical { kp_per_mm: within(exact, 0.0), ti_s: 15.0, omega: 3.9, swings: vec![] };
    let lag_s = lag_of(&found, &tables).unwrap();
    assert!((lag_s - 0.257).abs() < 1e-4, "{lag_s} s");
}

#[test]
fn a_gain_on_the_setpoint_is_scaled_with_the_gain_on_the_position() {
    let mut tables = tables();
    let law = tables.controller.as_mut().unwrap().state_feedback.as_mut().unwrap();
    (law.position_per_mm, law.setpoint_per_mm) = (0.02, Some(0.03));
    let scaled = with_other_control(&tables, 300.0);
    for (key, wanted) in [("position_per_mm", 6.0), ("setpoint_per_mm", 9.0)] {
        let path = format!("controller.state_feedback.{key}");
        let found = scaled.iter().find(|(scaled, _)| *scaled == path).unwrap().1;
        assert!((found - wanted).abs() < 1e-9, "{key}: {found}");
    }
}
