//! `[rig]`: the hardware.

use super::signals::{OutputEnable, SecondSensor, Tachometer};
use control::check::{OutOfRange, within};
use serde::{Deserialize, Serialize};

/// `[rig]`: the hardware.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// The rig's name in MQTT topics.
    pub name: String,
    /// From the sensor's window to the ball when it rests at the bottom, mm.
    pub sensor_to_bottom_mm: f64,
    /// Factor of the sensor's distances, from a two-end calibration. Absent: 1.
    #[serde(default = "right", skip_serializing_if = "is_right")]
    pub sensor_scale: f64,
    /// PWM frequency asked of the fan driver, hertz.
    pub fan_pwm_hz: f64,
    /// Device file of the GPIO lines of the tables below.
    #[serde(default = "of_a_pi", skip_serializing_if = "is_of_a_pi")]
    pub gpio_chip: String,
    /// `[rig.tachometer]`
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tachometer: Option<Tachometer>,
    /// `[rig.second_sensor]`
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_sensor: Option<SecondSensor>,
    /// `[rig.output_enable]`
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_enable: Option<OutputEnable>,
    /// Words of another rig, [`super::words::Words`]: taken out before this table is read, and here as keys that it
    /// knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<String>,
    /// As `position`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_unit: Option<String>,
    /// As `position`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// As `position`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_unit: Option<String>,
}

fn of_a_pi() -> String {
    "/dev/gpiochip0".into()
}

fn is_of_a_pi(chip: &str) -> bool {
    chip == of_a_pi()
}

pub(super) const fn right() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks with a reference")]
pub(super) fn is_right(scale: &f64) -> bool {
    *scale == right()
}

impl Rig {
    pub(super) fn check(&self) -> Result<(), OutOfRange> {
        within("sensor_to_bottom_mm", self.sensor_to_bottom_mm, 50.0, 2000.0)?;
        within("sensor_scale", self.sensor_scale, 0.5, 2.0)?;
        within("fan_pwm_hz", self.fan_pwm_hz, 24.0, 10_000.0)?;
        self.check_signals()
    }
}
