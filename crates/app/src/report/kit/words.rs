//! Names and numbers in the format of all reports.

use plant::Stage;

/// The stages of the plant, with their names.
pub const NAMES: [(Stage, &str); 4] = [
    (Stage::Actuator, Stage::Actuator.name()),
    (Stage::Air, Stage::Air.name()),
    (Stage::Ball, Stage::Ball.name()),
    (Stage::Sensor, Stage::Sensor.name()),
];

/// A number with four digits.
pub fn digits(value: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 6")]
    let after = if value == 0.0 { 0 } else { (3.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize };
    format!("{value:.after$}")
}
