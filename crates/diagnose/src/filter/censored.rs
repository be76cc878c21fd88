//! The likelihood of a quantised reading, which is interval-censored: the unrounded reading is only known to lie in a
//! cell.
//!
//! ```text
//! z ~ N(ŷ, S), cell [a, b]:   p = Φ(β) − Φ(α)      α = (a − ŷ)/√S, β = (b − ŷ)/√S
//! E z = ŷ + √S·(φ(α) − φ(β))/p      Var z = S·(1 + (α·φ(α) − β·φ(β))/p − ((φ(α) − φ(β))/p)²)
//! ```
//!
//! Source: Johnson, Kotz and Balakrishnan, *Continuous Univariate Distributions* 1, section 13.10, doubly truncated
//! normal.

use libm::erfc;
use std::f64::consts::{SQRT_2, TAU};

/// Standard deviations beyond which the asymptotic form at the nearer edge of a cell is used.
const FAR: f64 = 7.0;

/// The normal distribution truncated to a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// ln of the probability of the cell.
    pub(crate) log_probability: f64,
    /// Mean of the reading within the cell, from its expectation, in standard deviations.
    pub(crate) shift: f64,
    /// Variance of the reading within the cell, in units of its variance without truncation.
    pub(crate) spread: f64,
}

impl Cell {
    /// The cell from `low` to `high`, both in standard deviations from the expectation.
    pub(crate) fn between(low: f64, high: f64) -> Self {
        if low + high < 0.0 {
            let mirrored = Self::between(-high, -low);
            return Self { shift: -mirrored.shift, ..mirrored };
        }
        if low > FAR {
            // Mills' ratio: almost all of the probability lies at the nearer edge.
            return Self {
                log_probability: -0.5 * low * low - (low * TAU.sqrt()).ln(),
                shift: low + 1.0 / low,
                spread: 0.0,
            };
        }
        let density = |x: f64| (-0.5 * x * x).exp() / TAU.sqrt();
        let probability = 0.5 * (erfc(low / SQRT_2) - erfc(high / SQRT_2));
        let shift = (density(low) - density(high)) / probability;
        let spread = 1.0 + (low * density(low) - high * density(high)) / probability - shift * shift;
        Self { log_probability: probability.ln(), shift, spread: spread.clamp(0.0, 1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::Cell;

    #[test]
    fn a_cell_has_the_moments_of_the_normal_density_inside_it() {
        for (low, high) in [(-0.5_f64, 0.5_f64), (1.0, 1.3), (-4.0, -1.0), (2.0, 9.0)] {
            let step = (high - low) / 20_000.0;
            let points = (0..20_000).map(|k| low + (f64::from(k) + 0.5) * step);
            let moment = |power: i32| -> f64 {
                points.clone().map(|x| x.powi(power) * (-0.5 * x * x).exp() * step).sum::<f64>()
                    / std::f64::consts::TAU.sqrt()
            };
            let (p, mean) = (moment(0), moment(1) / moment(0));
            let cell = Cell::between(low, high);
            assert!((cell.log_probability - p.ln()).abs() < 1e-6, "{low} to {high}: {cell:?}");
            assert!(
                (cell.shift - mean).abs() < 1e-6 && (cell.spread - (moment(2) / p - mean * mean)).abs() < 1e-5,
                "{cell:?}"
            );
        }
    }

    #[test]
    fn a_cell_far_away_joins_on_to_a_near_one() {
        let (near, far) = (Cell::between(6.999, 9.0), Cell::between(7.001, 9.0));
        assert!((near.log_probability - far.log_probability).abs() < 0.05 && (near.shift - far.shift).abs() < 0.02);
    }
}
