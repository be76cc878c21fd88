//! The variance of a reading.

use plant::Model;

/// A reading's variance, never quite 0: a sensor without noise still leaves the filter a division.
pub(crate) fn reading_variance(model: &Model) -> f64 {
    model.effects.reading_sigma_mm(model.noise.sensor_mm).powi(2).max(1e-9)
}
