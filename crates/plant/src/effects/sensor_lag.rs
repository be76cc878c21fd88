//! Sensor lag: the sensor averages, so that its reading trails the ball.
//!
//! ```text
//! ds/dt = (x − s) / τ                            s, x in mm; τ in s
//! s(h) = x₀ + (s₀ − x₀)·e^(−z) + b·ψ₁ + c·ψ₂      z = h/τ, over a step h in which x = x₀ + b·θ + c·θ², θ = t/h
//! ψ₁ = 1 − (1 − e^(−z))/z     ψ₂ = 1 − 2·ψ₁/z
//! ```
//!
//! The closed form for the parabola through the ends and the middle of the step: order 4 as the motion itself,
//! and stable for any τ. Starts at its input. Leaves out that a sensor averages over a window, not for ever.
//! Source: Hochbruck and Ostermann, *Exponential Integrators*, Acta Numerica 19 (2010).

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Form, Neutral, Param, Scale, Similar, Stage, values_in_order};
use libm::expm1;
use serde::{Deserialize, Serialize};

/// The reading follows the position as a first-order lag.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorLag {
    /// Time constant τ, seconds.
    pub time_constant_s: f64,
}

impl Effect for SensorLag {
    const ENTRY: Entry = Entry {
        name: "sensor_lag",
        stage: Stage::Sensor,
        article: "a ",
        params: &[Param {
            name: "time_constant_s",
            min: 0.0,
            max: 5.0,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.03], &[0.1]],
        form: Form::Approximate,
        twins: &["fan_lag"],
        in_a_log: "the reading reverses later than the ball, without more noise",
        mend_elsewhere: "less averaging in the sensor; a Kalman filter with the lag in its model",
        mend: "a shorter timing budget, less averaging in the sensor; a Kalman filter with the lag in its model",
        similar: &[
            Similar {
                name: "sensor_delay",
                distinguished_by: "a lag makes fast reversals smaller and rounder; a delay shifts them. Move the ball \
                     back and forth fast",
            },
            Similar {
                name: "fan_lag",
                distinguished_by: "duty and position hardly separate them. With a sensor lag a second sensor is \
                     earlier than this one, and a recorded fan speed follows the duty as modelled",
            },
            Similar {
                name: "stale_samples",
                distinguished_by: "a lagging reading changes in every cycle and never jumps. Look at successive \
                     readings of a fast ball",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        senses: Some(Self::after),
        is_linear: Some(|_| true),
        lag_s: Some(|lag| [lag.time_constant_s; 2]),
        linearise: Some(|lag, plant| plant.sensor_lag_s = lag.time_constant_s),
        ..Acts::NONE
    };

    values_in_order!(time_constant_s);
}

impl SensorLag {
    /// s, mm, `dt_s` after it was `sensed_mm`, while the ball went through `path_mm`: start, middle, end.
    #[must_use]
    pub fn after(&self, sensed_mm: f64, path_mm: [f64; 3], dt_s: f64) -> f64 {
        let [start, middle, end] = path_mm;
        let z = dt_s / self.time_constant_s;
        if z == 0.0 {
            return sensed_mm;
        }
        if z.is_nan() || z.is_infinite() {
            return end;
        }
        let curve = 2.0 * (start - 2.0 * middle + end);
        let slope = end - start - curve;
        let gone = -expm1(-z);
        let psi1 = 1.0 - gone / z;
        let psi2 = 1.0 - 2.0 * psi1 / z;
        sensed_mm + (start - sensed_mm) * gone + slope * psi1 + curve * psi2
    }
}

#[cfg(test)]
mod tests {
    use super::SensorLag;

    #[test]
    fn a_parabola_is_followed_exactly_by_any_lag() {
        // x = t² from s = 0: s = t² − 2τt + 2τ²(1 − e^(−t/τ)).
        for (tau, within) in [(1e-4, 1e-12), (0.05, 1e-12), (5.0, 1e-9)] {
            let (lag, h) = (SensorLag { time_constant_s: tau }, 0.02);
            let end = (0..50)
                .map(|k| h * f64::from(k))
                .fold(0.0, |s, t| lag.after(s, [t, t + h / 2.0, t + h].map(|t| t * t), h));
            let exact = 1.0 - 2.0 * tau + 2.0 * tau * tau * -libm::expm1(-1.0 / tau);
            assert!((end - exact).abs() < within, "τ = {tau} s: {end} mm, exact {exact} mm");
        }
    }
}
