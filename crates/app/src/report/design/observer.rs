//! The gains of an observer as a document.

use control::observer::Observer;
use serde::Serialize;

/// The document of `airball design observer --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    /// Name and version of this document.
    pub schema: &'static str,
    /// The states of the model, with their units.
    pub states: Vec<&'static str>,
    /// Time between readings, seconds.
    pub period_s: f64,
    /// W: intensities of the white noise on the rates of the states, in each one's unit squared per second.
    pub process_intensities: Vec<f64>,
    /// V: one reading's variance times the period, as if it were white noise in continuous time, mm²·s.
    pub reading_intensity_mm2_s: f64,
    /// L of dx̂/dt = … + L·(y − ŷ).
    pub continuous: Vec<f64>,
    /// L of x̂ ← x̂ + L·(y − ŷ) at every reading.
    pub sampled: Vec<f64>,
    /// The observer of the patch.
    pub observer: Observer,
    /// Its L: position in mm, velocity in mm/s, fan and hover in control values, per millimetre of innovation. Empty
    /// where W has noise that no observer in flight has.
    pub flown: Vec<f64>,
}
