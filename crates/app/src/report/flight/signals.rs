//! The optional signals of a flight, in a line each.

use crate::flight::vocabulary::Cycle;
use serde::Serialize;
use std::fmt;

/// Statistics of the optional signals. Absent where the rig has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Signals {
    /// The fan's speed by its tachometer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fan: Option<FanSpeed>,
    /// The second sensor compared with the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_sensor: Option<Apart>,
}

/// The fan's speed over a flight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FanSpeed {
    /// Mean, rpm.
    pub mean_rpm: f64,
    /// Largest, rpm.
    pub most_rpm: f64,
}

/// The second sensor's readings minus the first's, where both are fresh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Apart {
    /// Mean, mm.
    pub mean_mm: f64,
    /// Standard deviation, mm.
    pub sigma_mm: f64,
    /// Cycles with a fresh position by the second, percent.
    pub fresh_percent: f64,
}

impl Signals {
    /// Of the cycles of a log.
    #[must_use]
    pub fn of(cycles: &[Cycle]) -> Self {
        let mean_rpm = moments(cycles.iter().filter_map(|cycle| cycle.fan_rpm));
        let most_rpm = cycles.iter().filter_map(|cycle| cycle.fan_rpm).fold(0.0, f64::max);
        let both = |cycle: &Cycle| Some(cycle.position2_mm? - cycle.position_mm.filter(|_| cycle.fresh)?);
        let second = cycles.iter().filter(|cycle| cycle.position2_mm.is_some()).count();
        let fresh_percent = 100.0 * second as f64 / cycles.len().max(1) as f64;
        Self {
            fan: mean_rpm.map(|(mean_rpm, _)| FanSpeed { mean_rpm, most_rpm }),
            second_sensor: moments(cycles.iter().filter_map(both)).map(|(mean_mm, sigma_mm)| Apart {
                mean_mm,
                sigma_mm,
                fresh_percent,
            }),
        }
    }
}

/// Mean and standard deviation.
fn moments(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let (sum, count) = values.clone().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    let mean = sum / count;
    let square: f64 = values.map(|value| (value - mean).powi(2)).sum();
    (count > 0.0).then(|| (mean, (square / count).sqrt()))
}

impl fmt::Display for Signals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(FanSpeed { mean_rpm, most_rpm }) = self.fan {
            writeln!(f, "fan       {mean_rpm:.0} rpm on average, {most_rpm:.0} rpm at most")?;
        }
        let Some(Apart { mean_mm, sigma_mm, fresh_percent }) = self.second_sensor else { return Ok(()) };
        writeln!(
            f,
            "second    {mean_mm:+.1} mm from the first sensor on average, σ {sigma_mm:.1} mm; fresh in {fresh_percent:.1} % of the cycles"
        )
    }
}
