//! Any text as a formula, at any numbers: refused with a short printable reason, or a value that its dual number and its
//! range agree with. Any text as the table of a written effect: refused likewise, or an effect that flies.
#![no_main]

use formula::Formula;
use libfuzzer_sys::fuzz_target;
use plant::{Definition, DefinitionTable, Effects, Input, Model, Motion, Noise, Simulator};

const NAMES: [&str; 5] = ["x", "v", "u", "k", "start"];

// The text up to a zero byte, then the numbers, of eight bytes each: lower and upper bound of each variable, and where
// between them it is.
fuzz_target!(|bytes: &[u8]| {
    let mut parts = bytes.splitn(2, |byte| *byte == 0);
    let Some(text) = parts.next().and_then(|text| std::str::from_utf8(text).ok()) else { return };
    if let Ok(table) = toml::from_str(text) {
        return effect(&table, &numbers(parts.next().unwrap_or_default()));
    }
    let formula = match Formula::parse(text, &NAMES) {
        Ok(formula) => formula,
        Err(mistake) => {
            let characters = text.chars().count();
            assert!((1..=characters + 1).contains(&mistake.column), "{mistake:?}");
            return printable(&mistake.to_string(), 1000);
        }
    };
    let numbers = numbers(parts.next().unwrap_or_default());
    let number = |k: usize| numbers.get(k).copied().unwrap_or_default();
    agree(&formula, &NAMES.map(|_| number(0)), &numbers);
    agree(&formula, &numbers, &[1.0]);

    let bounds: [(f64, f64); 5] = std::array::from_fn(|k| (number(3 * k), number(3 * k + 1)));
    let between = |k: usize, (low, high): (f64, f64)| {
        let share = number(3 * k + 2);
        let share = if share.is_finite() { share.abs() % 1.0 } else { 1.0 };
        (low * (1.0 - share) + high * share).max(low).min(high)
    };
    let variables: [f64; 5] = std::array::from_fn(|k| between(k, bounds[k]));
    agree(&formula, &variables, &[0.0, 1.0]);
    match formula.range(&bounds) {
        Ok((low, high)) => {
            for variables in [variables, bounds.map(|(low, _)| low), bounds.map(|(_, high)| high)] {
                let value = formula.value(&variables);
                assert!(low <= value && value <= high, "{text} at {variables:?}: {value} not within {low} to {high}");
            }
        }
        Err(mistake) => printable(&mistake.to_string(), 1000),
    }
    let _ = (formula.is_affine_in(&[0, 1]), formula.uses(3));
});

/// A table of an effect: its text is read as the same again, and a rig with it flies, whatever becomes of the ball.
fn effect(table: &DefinitionTable, numbers: &[f64]) {
    let definition = match Definition::new("fuzzed", table) {
        Ok(definition) => definition,
        // Each control character of its formula takes up to ten.
        Err(error) => return printable(&error.message, 6000),
    };
    let written: toml::Table = toml::from_str(&definition.to_string()).expect("its text is TOML");
    let again: DefinitionTable = written["effect"]["fuzzed"].clone().try_into().expect("and a table of an effect");
    assert_eq!(again, *table);
    let mut model = rig();
    model.effects.written.define(definition);
    let within = |(k, param): (usize, &plant::Param)| {
        let share = numbers.get(k).copied().filter(|number| number.is_finite()).unwrap_or(1.0).abs() % 1.0;
        (param.min + share * (param.max - param.min)).clamp(param.min, param.max)
    };
    let values: Vec<f64> = definition.entry().params.iter().enumerate().map(within).collect();
    assert!(model.effects.set("fuzzed", &values));
    assert_eq!(model.check(), Ok(()));
    let number = |k: usize| numbers.get(k).copied().unwrap_or_default();
    let input = Input { commanded_mm_per_s2: number(0), time_s: number(1), setpoint_mm: numbers.get(2).copied() };
    let motion = Motion { velocity_mm_per_s: number(3), ..model.at_rest_under(number(4), input) };
    let (_, derivatives) = motion.step_with_derivatives(&model, input, 0.02);
    let along = derivatives.by_velocity;
    let _ = (model.seen_along(&along, input, &motion), model.slopes_at(number(5), number(6)), definition.physics());
    fly(model, numbers);
}

/// Flies for some cycles with duties and setpoints of any size.
fn fly(model: Model, numbers: &[f64]) {
    let mut rig = Simulator::new(model, 1);
    for (cycle, number) in (1_u32..=20).zip(numbers.iter().chain(&[21.4]).cycle()) {
        let _ = rig.reading_mm();
        rig.set_setpoint(Some(*number).filter(|setpoint_mm| setpoint_mm.is_finite()));
        rig.drive(if number.is_finite() { number.clamp(0.0, 100.0) } else { 0.0 });
        rig.advance_to(0.02 * f64::from(cycle));
    }
}

fn rig() -> Model {
    let mut effects = Effects::default();
    for (name, values) in [("fan_lag", 0.25), ("sensor_lag", 0.05), ("wall_friction", 50.0)] {
        assert!(effects.set(name, &[values]));
    }
    Model {
        gain_mm_per_s2_per_percent: 827.2,
        drag_per_s: 3.896,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
        effects,
    }
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).take(20).map(|chunk| f64::from_le_bytes(chunk.try_into().expect("eight bytes"))).collect()
}

fn agree(formula: &Formula, variables: &[f64], towards: &[f64]) {
    let (value, dual) = (formula.value(variables), formula.dual(variables, towards).0);
    assert_eq!(value.to_bits(), dual.to_bits(), "{formula} at {variables:?}");
}

fn printable(why: &str, most: usize) {
    assert!(why.chars().count() < most && !why.chars().any(char::is_control), "{why:?}");
}
