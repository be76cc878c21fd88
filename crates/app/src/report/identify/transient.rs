//! A sweep of proportional gains in words and as a document.

use super::{SCHEMA, digits, said};
use crate::report::kit::table::empty;
use diagnose::identify::{OfGain, Sweep};
use serde::Serialize;

/// The document that `identify transient --json` writes.
#[derive(Debug, Serialize)]
pub struct Document<'a> {
    schema: &'static str,
    method: &'static str,
    dead_time_s: f64,
    #[serde(flatten)]
    sweep: &'a Sweep,
    version: &'static str,
}

impl<'a> Document<'a> {
    /// The document of a sweep.
    #[must_use]
    pub const fn of(sweep: &'a Sweep, dead_time_s: f64) -> Self {
        Self { schema: SCHEMA, method: "transient", dead_time_s, sweep, version: env!("CARGO_PKG_VERSION") }
    }
}

/// Gain by gain, and the mean.
#[must_use]
pub fn lines(found: &Sweep) -> Vec<String> {
    let mut table = empty(HEADS);
    for gain in &found.gains {
        table.add_row(row(gain));
    }
    let mut lines = vec![table.to_string()];
    let unseen = found.gains.iter().filter(|gain| gain.peak_s.is_none()).count();
    let means = found.gains.len() - unseen;
    lines.push(format!("mean      K_g = {}, a = {}, of {means} gains", said(&found.gain), said(&found.drag)));
    if unseen > 0 {
        lines.push(format!(
            "          {unseen} without a visible overshoot count as critically damped, and not in the mean"
        ));
    }
    let rejected = found.rejected;
    if rejected.short + rejected.not_proportional > 0 {
        lines.push(format!(
            "rejected  {} steps as too short, {} as not proportional to the error",
            rejected.short, rejected.not_proportional
        ));
    }
    lines.push("The model has two poles, so a fan pole biases K_g and a. `airball identify grey-box` finds it.".into());
    lines
}

/// The column heads of the table.
pub const HEADS: [&str; 8] =
    ["K_p, % per mm", "pulses", "overshoot", "peak", "damping", "ω_n, rad/s", "K_g, mm/s² per %", "a, 1/s"];

/// The row of a gain.
pub fn row(gain: &OfGain) -> [String; 8] {
    [
        digits(gain.kp_per_mm),
        gain.pulses.to_string(),
        format!("{:.1} %", 100.0 * gain.overshoot),
        gain.peak_s.map_or_else(|| "none".into(), |peak_s| format!("{peak_s:.2} s")),
        format!("{:.3}", gain.damping),
        format!("{:.3}", gain.omega),
        said(&gain.gain),
        said(&gain.drag),
    ]
}
