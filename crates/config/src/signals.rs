//! `[rig]`'s optional signals: the fan's tachometer, a second range sensor, and the fan driver's output-enable.

use super::Rig;
use control::check::{OutOfRange, within};
use hal::ASIDE;
use serde::{Deserialize, Serialize};

/// Addresses in use: the first sensor, the one where it waits, the fan driver, and all PCA9685 at once.
const TAKEN: [u8; 4] = [0x29, ASIDE, 0x40, 0x70];

/// `[rig.tachometer]`: the fan's speed, by the edges of a line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tachometer {
    /// The GPIO line.
    pub line: u32,
    /// Edges per revolution; computer fans give two.
    pub pulses_per_revolution: u32,
    /// The speed at hover, rpm: of the simulated fan, and the observer's scale for the measured speed.
    pub hover_rpm: f64,
    /// A driven fan without an edge for this long has stalled, seconds.
    pub stalled_after_s: f64,
}

/// `[rig.second_sensor]`: another VL53L0X on the same bus.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondSensor {
    /// The GPIO line of its XSHUT.
    pub xshut_line: u32,
    /// Its address on the bus after the move.
    pub address: u8,
    /// Direction in which it looks.
    #[serde(default)]
    pub looks: Looks,
    /// From its window to the ball when it rests at the bottom, mm.
    pub to_bottom_mm: f64,
    /// Factor of its distances. Absent: 1.
    #[serde(default = "super::rig::right", skip_serializing_if = "super::rig::is_right")]
    pub scale: f64,
    /// Sensors that differ by more than this disagree, mm.
    pub disagree_mm: f64,
    /// A disagreement of this length ends the flight, seconds.
    pub disagree_s: f64,
}

/// Direction in which a sensor looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Looks {
    /// From the top of the pipe, as the first one.
    #[default]
    Down,
    /// From below the ball.
    Up,
}

/// `[rig.output_enable]`: the pin that turns all outputs of the fan driver off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputEnable {
    /// The GPIO line.
    pub line: u32,
}

impl SecondSensor {
    /// The ball's position at a distance from the window, mm.
    #[must_use]
    pub fn position_mm(&self, distance_mm: f64) -> f64 {
        match self.looks {
            Looks::Down => self.to_bottom_mm - self.scale * distance_mm,
            Looks::Up => self.scale * distance_mm - self.to_bottom_mm,
        }
    }

    /// The distance at which the sensor sees a ball, mm.
    #[must_use]
    pub fn distance_mm(&self, position_mm: f64) -> f64 {
        match self.looks {
            Looks::Down => (self.to_bottom_mm - position_mm) / self.scale,
            Looks::Up => (self.to_bottom_mm + position_mm) / self.scale,
        }
    }
}

impl Rig {
    pub(super) fn check_signals(&self) -> Result<(), OutOfRange> {
        if let Some(tachometer) = &self.tachometer {
            within("tachometer.pulses_per_revolution", f64::from(tachometer.pulses_per_revolution), 1.0, 100.0)?;
            within("tachometer.hover_rpm", tachometer.hover_rpm, 10.0, 100_000.0)?;
            within("tachometer.stalled_after_s", tachometer.stalled_after_s, 0.3, 10.0)?;
        }
        let Some(second) = &self.second_sensor else { return Ok(()) };
        within("second_sensor.address", f64::from(second.address), f64::from(0x08), f64::from(0x77))?;
        within("second_sensor.to_bottom_mm", second.to_bottom_mm, 0.0, 2000.0)?;
        within("second_sensor.scale", second.scale, 0.5, 2.0)?;
        within("second_sensor.disagree_mm", second.disagree_mm, 1.0, 2000.0)?;
        within("second_sensor.disagree_s", second.disagree_s, 0.0, 10.0)
    }

    /// Whether the signals use different lines and addresses.
    pub(super) fn check_wiring(&self) -> Result<(), (&'static str, String)> {
        if let Some(address) = self.second_sensor.map(|second| second.address).filter(|address| TAKEN.contains(address))
        {
            let taken = TAKEN.map(|taken| format!("{taken:#04x}")).join(", ");
            let message = format!("{address:#04x} is taken, as are {taken}; take another, for instance 0x30");
            return Err(("rig.second_sensor.address", message));
        }
        let lines = [
            ("rig.tachometer.line", self.tachometer.map(|tachometer| tachometer.line)),
            ("rig.second_sensor.xshut_line", self.second_sensor.map(|second| second.xshut_line)),
            ("rig.output_enable.line", self.output_enable.map(|pin| pin.line)),
        ];
        for (k, (key, line)) in lines.iter().enumerate().filter(|(_, (_, line))| line.is_some()) {
            if let Some((other, _)) = lines[..k].iter().find(|(_, taken)| taken == line) {
                return Err((key, format!("{other} has the same line; a line carries one signal")));
            }
        }
        Ok(())
    }
}
