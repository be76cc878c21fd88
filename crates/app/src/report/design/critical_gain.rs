//! The table of critical gains as a document.

use serde::Serialize;

/// The rig's line in the table.
pub const RIG: &str = "the rig";

/// A line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The model.
    pub model: String,
    /// The fan's pole, 1/s.
    pub fan_pole_per_s: Option<f64>,
    /// Critical gain in continuous time, percent per mm; `None`: stable at any gain.
    pub critical_kp_per_mm: Option<f64>,
    /// Critical gain of the sampled loop.
    pub sampled_critical_kp_per_mm: Option<f64>,
    /// Critical integral time, seconds.
    pub critical_ti_s: Option<f64>,
}

/// The document of `airball design critical-gain --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Name and version of this document.
    pub schema: &'static str,
    /// T_i of the critical gains, seconds.
    pub ti_s: f64,
    /// K_p of the critical integral times, percent per mm.
    pub kp_per_mm: f64,
    /// Period of the sampled loop, seconds.
    pub period_s: f64,
    /// The models as they are, the rig, and the models with the chosen pole.
    pub rows: Vec<Row>,
}
