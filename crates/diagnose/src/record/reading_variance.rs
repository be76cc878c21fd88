//! The variance of a reading.

use plant::Model;

/// A reading's variance, always above 0 so that the filter can divide by it.
pub(crate) fn reading_variance(model: &Model) -> f64 {
    model.effects.reading_sigma_mm(model.noise.sensor_mm).powi(2).max(1e-9)
}
