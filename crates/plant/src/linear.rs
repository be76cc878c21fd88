//! The linear part of a model: what a design can use.
//!
//! ```text
//! gain, drag, height_dependent_flow.gradient, fan_lag (or the mean of spin_asymmetry's two), sensor_lag
//! delay = transport_delay + sensor_delay + stale_samples.hold/2      a held reading is half of its hold old on average
//! ```
//!
//! Every other effect bends, sticks, drifts or scatters, and is left out.

use crate::model::Model;
use control::design::Linear;

impl Model {
    /// The linear plant about hover at mid-pipe.
    #[must_use]
    pub fn linear(&self) -> Linear {
        let mut plant = Linear::two_poles(self.gain_mm_per_s2_per_percent, self.drag_per_s);
        self.effects.linearise(&mut plant);
        plant
    }

    /// The names of the effects that are on and that [`Model::linear`] leaves out.
    #[must_use]
    pub fn not_linear(&self) -> Vec<&'static str> {
        self.effects.present().iter().filter(|entry| !entry.acts.is_linear).map(|entry| entry.name).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::Model;
    use crate::effects::{DeadZone, Effects, FanLag, SensorDelay, TransportDelay};
    use crate::model::tests::thesis;

    #[test]
    fn delays_add_up_and_what_bends_is_named() {
        let model = Model {
            effects: Effects {
                transport_delay: Some(TransportDelay { delay_s: 0.03 }),
                sensor_delay: Some(SensorDelay { delay_s: 0.02 }),
                dead_zone: Some(DeadZone { lower_percent: -0.3, upper_percent: 0.3 }),
                fan_lag: Some(FanLag { time_constant_s: 0.257 }),
                ..Effects::default()
            },
            ..thesis()
        };
        assert!((model.linear().delay_s - 0.05).abs() < 1e-15);
        assert_eq!(model.not_linear(), ["dead_zone"]);
    }
}
