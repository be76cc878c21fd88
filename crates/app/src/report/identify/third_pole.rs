//! A third pole in words, as a document and as a config patch.

use crate::report::kit::patch::rounded;
use serde::Serialize;

/// The document that `identify third-pole --json` writes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Document {
    /// `airball.identify/1`.
    pub schema: &'static str,
    /// `third_pole`.
    pub method: &'static str,
    /// The critical gain measured on the rig, percent per mm.
    pub critical_gain_per_mm: f64,
    /// The integral time of that measurement, seconds.
    pub integral_time_s: f64,
    /// Period of the sampled loop, seconds; `null`: continuous.
    pub period_s: Option<f64>,
    /// τ, seconds.
    pub fan_lag_s: f64,
    /// 1/τ.
    pub fan_pole_per_s: f64,
    /// τ of the initial model, seconds; 0: none.
    pub lag_before_s: f64,
    /// Prediction of the model with this lag: the critical integral time at half of the critical gain, seconds.
    pub critical_ti_s: Option<f64>,
}

/// The lag as a patch.
#[must_use]
pub fn patch(found: &Document) -> String {
    let Document { critical_gain_per_mm, integral_time_s, fan_lag_s, .. } = found;
    rounded(&format!(
        "# airball identify third-pole: critical gain {critical_gain_per_mm} at T_i = {integral_time_s} s.\n\
         [plant.effects.fan_lag]\ntime_constant_s = {fan_lag_s:?}\n"
    ))
}

/// The lag, and the next measurement that can check it.
#[must_use]
pub fn lines(found: &Document) -> Vec<String> {
    let how = found.period_s.map_or_else(|| "continuous".into(), |period_s| format!("sampled every {period_s} s"));
    let before = if found.lag_before_s > 0.0 { format!("{:.4} s", found.lag_before_s) } else { "none".into() };
    let mut lines = vec![format!(
        "fan lag {:.4} s, a pole at {:.3} 1/s (before: {before}); loop {how}",
        found.fan_lag_s, found.fan_pole_per_s
    )];
    if let Some(ti_s) = found.critical_ti_s {
        lines.push(format!(
            "predicts a critical T_i of {ti_s:.3} s at K_p = {}: measure it to check the model",
            0.5 * found.critical_gain_per_mm
        ));
    }
    lines
}
