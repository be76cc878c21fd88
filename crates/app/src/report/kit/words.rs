//! Names and numbers in the format of all reports.

use plant::Stage;

/// The stages of the plant, with their names.
pub const NAMES: [(Stage, &str); 4] = [
    (Stage::Actuator, Stage::Actuator.name()),
    (Stage::Air, Stage::Air.name()),
    (Stage::Ball, Stage::Ball.name()),
    (Stage::Sensor, Stage::Sensor.name()),
];

/// A p-value, which is never 0.
pub fn p_value(p: f64) -> String {
    if p < 0.001 { "p < 0.001".into() } else { format!("p = {p:.3}") }
}

/// A number with four digits.
pub fn digits(value: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 6")]
    let after = if value == 0.0 { 0 } else { (3.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize };
    format!("{value:.after$}")
}

#[cfg(test)]
mod tests {
    use super::p_value;

    #[test]
    fn a_p_value_that_rounds_to_nothing_has_a_bound() {
        assert_eq!([0.0, 0.0004, 0.012].map(p_value), ["p < 0.001", "p < 0.001", "p = 0.012"]);
    }
}
