//! The lags of a model, and what stands for the form of each.
//!
//! No rig's lag is quite of first order: of two lags in series, the small one comes to something else that is late on the same side of the ball.

use plant::Effects;

/// Effects that are a lag, and what else is late on their side of the ball.
pub(crate) const LAGS: [(&str, &str); 3] =
    [("fan_lag", "transport_delay"), ("spin_asymmetry", "transport_delay"), ("sensor_lag", "sensor_delay")];

/// How late an effect makes things, seconds: the mean of its numbers; 0 where it is off.
pub(crate) fn late_s(effects: &Effects, name: &str) -> f64 {
    effects.values(name).map_or(0.0, |numbers| numbers.iter().sum::<f64>() / numbers.len().max(1) as f64)
}
