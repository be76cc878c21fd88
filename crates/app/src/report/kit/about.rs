//! About which height and duty a model was linearised.

use control::design::Linear;
use plant::Model;
use serde::Serialize;

/// A gradient below this, 1/s², is none but for the rounding of the differences.
const NO_GRADIENT_PER_S2: f64 = 1e-3;

/// The slopes of a model at the height and the duty about which it was linearised.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct About {
    /// The duty, percent.
    pub duty_percent: f64,
    /// The height, mm.
    pub position_mm: f64,
    /// Acceleration per percent of duty there, mm/s² per percent.
    pub gain_mm_per_s2_per_percent: f64,
    /// Linear drag there, 1/s.
    pub drag_per_s: f64,
    /// Decrease of the lift with height there, 1/s².
    pub gradient_per_s2: f64,
}

impl About {
    /// The linear plant with these slopes; its lags and delays are those of the model.
    #[must_use]
    pub fn linear(&self, model: &Model) -> Linear {
        let Self { gain_mm_per_s2_per_percent: gain, drag_per_s, gradient_per_s2, .. } = *self;
        Linear { gain, drag_per_s, gradient_per_s2, ..model.linear() }
    }

    /// In words.
    #[must_use]
    pub fn words(&self) -> String {
        let Self { duty_percent, position_mm, gain_mm_per_s2_per_percent, drag_per_s, gradient_per_s2 } = self;
        let gradient = if gradient_per_s2.abs() < NO_GRADIENT_PER_S2 { 0.0 } else { *gradient_per_s2 };
        format!(
            "linearised at {duty_percent:.1} % and {position_mm:.0} mm: gain {gain_mm_per_s2_per_percent:.0} mm/s² per \
             percent, drag {drag_per_s:.2} 1/s, gradient {gradient:.2} 1/s²"
        )
    }
}
