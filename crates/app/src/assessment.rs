//! What a loop bears: the linear plant of a model under a PID, in continuous time and sampled as the firmware does it.
//!
//! The document of `airball design` (`airball.design/1`). Frequencies in rad/s, poles in 1/s (continuous) or as z (sampled).

use control::design::critical::{critical_gain, critical_integral_time};
use control::design::law::{Gains, closed};
use control::design::margins::{gain_margins, phase_margins};
use control::design::{DesignError, Linear, Plane, Transfer, step};
use serde::Serialize;

/// One crossing of −180°.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GainMargin {
    /// Where, rad/s.
    pub omega: f64,
    /// The factor of the gain that brings the loop to the edge.
    pub factor: f64,
}

/// One crossing of gain 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseMargin {
    /// Where, rad/s.
    pub omega: f64,
    /// Phase that may be lost, degrees.
    pub phase_deg: f64,
    /// Delay that may be added, seconds.
    pub delay_s: f64,
}

/// The step of the setpoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    /// Percent of the step.
    pub overshoot_percent: f64,
    /// When the ball is highest, seconds; `None`: never beyond.
    pub peak_s: Option<f64>,
    /// 10 % to 90 %, seconds.
    pub rise_s: f64,
    /// Outside ±5 % for the last time, seconds.
    pub settling_s: f64,
}

/// What one loop bears.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assessment {
    /// Whether every pole decays.
    pub stable: bool,
    /// In the order of frequency.
    pub gain_margins: Vec<GainMargin>,
    /// In the order of frequency.
    pub phase_margins: Vec<PhaseMargin>,
    /// The K_p at which the loop loses stability, its other gains kept; `None`: at none, or it has no stability at any.
    pub critical_kp_per_mm: Option<f64>,
    /// The T_i at which it does, seconds.
    pub critical_ti_s: Option<f64>,
    /// `None`: the loop is not stable.
    pub step: Option<Step>,
    /// Poles of the closed loop, real and imaginary part.
    pub poles: Vec<[f64; 2]>,
}

/// A PID in words of JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pid {
    /// K_p: control value per millimetre.
    pub kp_per_mm: f64,
    /// T_i, seconds; `null` is infinite: no integral.
    pub ti_s: f64,
    /// T_d, seconds.
    pub td_s: f64,
    /// N of the derivative filter.
    pub derivative_n: f64,
}

/// The plant in words of JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plant {
    /// K, mm/s² per percent.
    pub gain_mm_per_s2_per_percent: f64,
    /// a, 1/s.
    pub drag_per_s: f64,
    /// Fall of the lift with height, 1/s².
    pub gradient_per_s2: f64,
    /// Lag of the fan, seconds.
    pub fan_lag_s: f64,
    /// Lag of the sensor, seconds.
    pub sensor_lag_s: f64,
    /// All delays, seconds.
    pub delay_s: f64,
}

impl From<Linear> for Plant {
    fn from(plant: Linear) -> Self {
        Self {
            gain_mm_per_s2_per_percent: plant.gain,
            drag_per_s: plant.drag_per_s,
            gradient_per_s2: plant.gradient_per_s2,
            fan_lag_s: plant.fan_lag_s,
            sensor_lag_s: plant.sensor_lag_s,
            delay_s: plant.delay_s,
        }
    }
}

impl From<Gains> for Pid {
    fn from(gains: Gains) -> Self {
        let Gains { kp_per_mm, ti_s, td_s, derivative_n } = gains;
        Self { kp_per_mm, ti_s, td_s, derivative_n }
    }
}

/// A loop: gains around a plant.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    /// The plant.
    pub plant: Linear,
    /// The controller.
    pub gains: Gains,
    /// Whether the derivative acts on the error, and not on the measurement alone.
    pub derivative_on_error: bool,
}

impl Loop {
    /// In continuous time.
    #[must_use]
    pub fn continuous(&self) -> Assessment {
        self.assess(&self.plant.continuous())
    }

    /// Sampled every `period_s` seconds.
    ///
    /// # Errors
    /// [`DesignError::DelayTooLong`].
    pub fn sampled(&self, period_s: f64) -> Result<Assessment, DesignError> {
        Ok(self.assess(&self.plant.sampled(period_s)?))
    }

    fn assess(&self, plant: &Transfer) -> Assessment {
        let of = self.gains.feedback(plant.plane).then(plant);
        let closed = closed(&self.gains, plant, self.derivative_on_error);
        let gain = gain_margins(&of);
        let phase = phase_margins(&of);
        // Sampled poles are shown as z, not as δ.
        let unit = if plant.plane == Plane::Continuous { 0.0 } else { 1.0 };
        Assessment {
            stable: of.is_stable_closed(1.0),
            gain_margins: gain.iter().map(|m| GainMargin { omega: m.omega, factor: m.factor }).collect(),
            phase_margins: phase
                .iter()
                .map(|m| PhaseMargin { omega: m.omega, phase_deg: m.phase_deg, delay_s: m.delay_s })
                .collect(),
            critical_kp_per_mm: critical_gain(&self.gains, plant).value(),
            critical_ti_s: critical_integral_time(&self.gains, plant).value(),
            step: step::figures(&closed).map(|figures| Step {
                overshoot_percent: figures.overshoot_percent,
                peak_s: figures.peak_s,
                rise_s: figures.rise_s,
                settling_s: figures.settling_s,
            }),
            poles: of.closed_poles(1.0).iter().map(|pole| [pole.re + unit, pole.im]).collect(),
        }
    }
}
