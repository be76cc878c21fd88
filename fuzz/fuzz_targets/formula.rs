//! Any text as a formula, at any numbers: refused with a short printable reason, or a value that its dual number and its
//! range agree with.
#![no_main]

use formula::Formula;
use libfuzzer_sys::fuzz_target;

const NAMES: [&str; 5] = ["x", "v", "u", "k", "start"];

// The text up to a zero byte, then the numbers, of eight bytes each: lower and upper bound of each variable, and where
// between them it is.
fuzz_target!(|bytes: &[u8]| {
    let mut parts = bytes.splitn(2, |byte| *byte == 0);
    let Some(text) = parts.next().and_then(|text| std::str::from_utf8(text).ok()) else { return };
    let formula = match Formula::parse(text, &NAMES) {
        Ok(formula) => formula,
        Err(mistake) => {
            let characters = text.chars().count();
            assert!((1..=characters + 1).contains(&mistake.column), "{mistake:?}");
            return printable(&mistake.to_string());
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
        Err(mistake) => printable(&mistake.to_string()),
    }
    let _ = (formula.is_affine_in(&[0, 1]), formula.uses(3));
});

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).take(20).map(|chunk| f64::from_le_bytes(chunk.try_into().expect("eight bytes"))).collect()
}

fn agree(formula: &Formula, variables: &[f64], towards: &[f64]) {
    let (value, dual) = (formula.value(variables), formula.dual(variables, towards).0);
    assert_eq!(value.to_bits(), dual.to_bits(), "{formula} at {variables:?}");
}

fn printable(why: &str) {
    assert!(why.len() < 1000 && !why.chars().any(char::is_control), "{why:?}");
}
