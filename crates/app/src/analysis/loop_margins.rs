//! Stability margins and step response of a loop: the linear plant of a model under a controller, in continuous time
//! and sampled as the firmware does it.
//!
//! The document of `airball design` (`airball.design/1`). Frequencies in rad/s, poles in 1/s (continuous) or as z
//! (sampled).

use super::sensitivity;
use control::design::critical::{critical_gain, critical_integral_time};
use control::design::law::{Gains, Law, Weights};
use control::design::lqg::Observed;
use control::design::margins::{gain_margins, phase_margins};
use control::design::{DesignError, Linear, Plane, Transfer, step};
use serde::Serialize;

/// The period of the sensor's readings, seconds: assumed by an observer where no loop's period is known.
const SENSOR_PERIOD_S: f64 = 0.02;

/// One crossing of −180°.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GainMargin {
    /// Frequency, rad/s.
    pub omega: f64,
    /// The factor of the gain that brings the loop to the stability limit.
    pub factor: f64,
}

/// One crossing of gain 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseMargin {
    /// Frequency, rad/s.
    pub omega: f64,
    /// Phase that may be lost, degrees.
    pub phase_deg: f64,
    /// Delay that may be added, seconds.
    pub delay_s: f64,
}

/// The step response to the setpoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    /// Overshoot, percent of the step.
    pub overshoot_percent: f64,
    /// Time of the peak, seconds; `None`: no overshoot.
    pub peak_s: Option<f64>,
    /// Rise time from 10 % to 90 %, seconds.
    pub rise_s: f64,
    /// Settling time to ±5 %, seconds.
    pub settling_s: f64,
}

/// Margins, step response and poles of one loop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assessment {
    /// Whether every pole decays.
    pub stable: bool,
    /// In the order of frequency.
    pub gain_margins: Vec<GainMargin>,
    /// In the order of frequency.
    pub phase_margins: Vec<PhaseMargin>,
    /// The peak of the sensitivity, M_s. `None`: the loop is not stable.
    pub peak_sensitivity: Option<f64>,
    /// The critical K_p of a PID loop, its other gains kept; `None`: the loop is stable at every gain, or at none.
    pub critical_kp_per_mm: Option<f64>,
    /// The critical T_i, seconds.
    pub critical_ti_s: Option<f64>,
    /// `None`: the loop is not stable.
    pub step: Option<Step>,
    /// Poles of the closed loop, real and imaginary part.
    pub poles: Vec<[f64; 2]>,
}

/// A PID as JSON.
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
    /// b: weight of the setpoint in the proportional part.
    pub setpoint_weight: f64,
    /// c: weight of the setpoint in the derivative part.
    pub derivative_weight: f64,
}

/// The plant as JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plant {
    /// K, mm/s² per unit of the control value: percent of duty, or nominal mm/s² behind a predistortion.
    pub gain_mm_per_s2_per_control: f64,
    /// a, 1/s.
    pub drag_per_s: f64,
    /// Decrease of the lift with height, 1/s².
    pub gradient_per_s2: f64,
    /// Lag of the fan, seconds.
    pub fan_lag_s: f64,
    /// Lag of the sensor, seconds.
    pub sensor_lag_s: f64,
    /// All delays, seconds.
    pub delay_s: f64,
}

impl Pid {
    /// As JSON.
    #[must_use]
    pub const fn of(gains: &Gains, weights: &Weights) -> Self {
        let Gains { kp_per_mm, ti_s, td_s, derivative_n } = *gains;
        let Weights { setpoint: setpoint_weight, derivative: derivative_weight } = *weights;
        Self { kp_per_mm, ti_s, td_s, derivative_n, setpoint_weight, derivative_weight }
    }
}

impl From<Linear> for Plant {
    fn from(plant: Linear) -> Self {
        Self {
            gain_mm_per_s2_per_control: plant.gain,
            drag_per_s: plant.drag_per_s,
            gradient_per_s2: plant.gradient_per_s2,
            fan_lag_s: plant.fan_lag_s,
            sensor_lag_s: plant.sensor_lag_s,
            delay_s: plant.delay_s,
        }
    }
}

/// The controller that closes a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Closing {
    /// A PID, or a state feedback of position and velocity, which is one.
    Pid(Gains, Weights),
    /// A feedback of the observer's estimate.
    Lqg(Observed),
}

/// A loop: a controller around a plant.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    /// The plant.
    pub plant: Linear,
    /// The controller.
    pub closing: Closing,
    /// Time between samples, seconds, where it is known.
    pub period_s: Option<f64>,
}

impl Loop {
    /// In continuous time.
    ///
    /// # Errors
    /// [`DesignError::NoRiccatiSolution`]: the observer has no steady-state gain.
    pub fn continuous(&self) -> Result<Assessment, DesignError> {
        self.assess(&self.plant.continuous())
    }

    /// Sampled as the firmware does it; `None` where the period is not known.
    ///
    /// # Errors
    /// [`DesignError::DelayTooLong`], [`DesignError::NoRiccatiSolution`].
    pub fn sampled(&self) -> Result<Option<Assessment>, DesignError> {
        self.period_s.map(|period_s| self.assess(&self.plant.sampled(period_s)?)).transpose()
    }

    /// The controller's law.
    ///
    /// # Errors
    /// [`DesignError::NoRiccatiSolution`]: the observer has no steady-state gain.
    pub fn law(&self, plane: Plane) -> Result<Law, DesignError> {
        match &self.closing {
            Closing::Pid(gains, weights) => Ok(gains.law(plane, *weights)),
            Closing::Lqg(observed) => observed.law(plane, self.period_s.unwrap_or(SENSOR_PERIOD_S)),
        }
    }

    fn assess(&self, plant: &Transfer) -> Result<Assessment, DesignError> {
        let law = self.law(plant.plane)?;
        let of = law.feedback.then(plant);
        let (gain, phase) = (gain_margins(&of), phase_margins(&of));
        // Sampled poles are shown as z, not as δ.
        let unit = if plant.plane == Plane::Continuous { 0.0 } else { 1.0 };
        let gains = match &self.closing {
            Closing::Pid(gains, _) => Some(gains),
            Closing::Lqg(_) => None,
        };
        let stable = of.is_stable_closed(1.0);
        Ok(Assessment {
            stable,
            gain_margins: gain.iter().map(|m| GainMargin { omega: m.omega, factor: m.factor }).collect(),
            phase_margins: phase
                .iter()
                .map(|m| PhaseMargin { omega: m.omega, phase_deg: m.phase_deg, delay_s: m.delay_s })
                .collect(),
            peak_sensitivity: stable.then(|| sensitivity::peak(&of)),
            critical_kp_per_mm: gains.and_then(|gains| critical_gain(gains, plant).value()),
            critical_ti_s: gains.and_then(|gains| critical_integral_time(gains, plant).value()),
            step: step::figures(&law.closed(plant)).map(|figures| Step {
                overshoot_percent: figures.overshoot_percent,
                peak_s: figures.peak_s,
                rise_s: figures.rise_s,
                settling_s: figures.settling_s,
            }),
            poles: of.closed_poles(1.0).iter().map(|pole| [pole.re + unit, pole.im]).collect(),
        })
    }
}
