//! Closed-loop quantities of a document. They are measured outside this crate, where the controller is known.

use serde::Serialize;

/// One quantity in the record and in the two simulations; `None` if undefined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Compared {
    /// On the rig.
    pub recorded: Option<f64>,
    /// The believed model with the controller of the record.
    pub nominal: Option<f64>,
    /// The mended model with the same controller.
    pub mended: Option<f64>,
}

/// A quantity that only simulations give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Simulated {
    /// The believed model.
    pub nominal: Option<f64>,
    /// The mended model.
    pub mended: Option<f64>,
}

/// Closed-loop quantities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Number of setpoint steps that were evaluated.
    pub steps: usize,
    /// Overshoot of the new setpoint, percent of the step; like the times below the median of the steps.
    pub overshoot_percent: Compared,
    /// Time of the first clear peak beyond the new setpoint, seconds.
    pub peak_time_s: Compared,
    /// Half-width of the settling band, percent of the step.
    pub settling_band_percent: f64,
    /// Settling time: when the ball enters that band and stays in it for at least 1 s, seconds.
    pub settling_s: Compared,
    /// Critical gain: the smallest factor on the proportional gain at which the loop becomes unstable.
    pub critical_gain_ratio: Simulated,
}

/// A recommended next experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextExperiment {
    /// Its short name.
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
    /// The hypotheses that it separates.
    pub separates: Vec<&'static str>,
    /// Expected evidence, nats per minute, for the pair that it separates least.
    pub expected_nats: f64,
    /// The file for `run` and `simulate`.
    pub file: String,
}
