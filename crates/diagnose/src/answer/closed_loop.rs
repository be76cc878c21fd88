//! The figures of the closed loop that a document holds. They are measured where the controller is known, outside this crate.

use serde::Serialize;

/// What one quantity is in the record and in the two simulations; `None` where there is nothing to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Compared {
    /// On the rig.
    pub recorded: Option<f64>,
    /// The model as believed, flown by the record's controller.
    pub nominal: Option<f64>,
    /// The mended model, flown by it.
    pub mended: Option<f64>,
}

/// A quantity that only a simulation can show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Simulated {
    /// The model as believed.
    pub nominal: Option<f64>,
    /// The mended model.
    pub mended: Option<f64>,
}

/// The figures of the closed loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Steps of the record that were looked at.
    pub steps: usize,
    /// Largest excursion beyond the new setpoint, percent of the jump.
    pub overshoot_percent: Compared,
    /// Time of the first visible peak beyond the new setpoint, seconds.
    pub peak_time_s: Compared,
    /// The band that counts as settled, percent of the jump to either side.
    pub settling_band_percent: f64,
    /// Time until the ball stays in that band, seconds.
    pub settling_s: Compared,
    /// The smallest multiple of the loop's proportional gain at which it loses stability.
    pub critical_gain_ratio: Simulated,
}

/// An experiment that is worth flying next.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextExperiment {
    /// Its short name.
    pub name: &'static str,
    /// Why this one, in a sentence.
    pub reason: String,
    /// What it tells apart.
    pub separates: Vec<&'static str>,
    /// How decisively, nats per minute of it, for the pair that it separates least.
    pub expected_nats: f64,
    /// The file that `run` and `simulate` fly.
    pub file: String,
}
