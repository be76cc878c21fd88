//! The variance of a reading.

use plant::Model;

/// A reading's variance, never quite 0: a sensor without noise still leaves the filter a division.
pub(crate) fn reading_variance(model: &Model) -> f64 {
    let believed = model.noise.sensor_mm;
    let sigma = model.effects.sensor_noise.map_or(believed, |noise| noise.total_mm(believed));
    sigma.powi(2).max(1e-9)
}
