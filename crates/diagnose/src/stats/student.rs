//! Quantiles of Student's t.
//!
//! ```text
//! t_ν ≈ x + (x³ + x)/4ν + (5x⁵ + 16x³ + 3x)/96ν² + …      x: normal quantile; within 0.3 % from ν = 3 on
//! t₁ = tan(½·π·A)      t₂ = A·√(2/(1 − A²))               A: probability between −t and t
//! ```
//!
//! Source: Abramowitz & Stegun, *Handbook of Mathematical Functions*, 26.7.5; the closed forms, 26.7.2 and 26.7.3.

/// The 95 % quantile of the standard normal distribution.
pub(crate) const NORMAL_QUANTILE: f64 = 1.644_853_626_951_472;

/// Its 97.5 % quantile.
const NORMAL_QUANTILE_975: f64 = 1.959_963_984_540_054;

/// The 95 % quantile of Student's t with `freedom` degrees of freedom, at least 1: the limit of a 90 % interval.
pub(crate) fn student(freedom: f64) -> f64 {
    quantile(NORMAL_QUANTILE, 0.9, freedom)
}

/// The 97.5 % quantile: the limit of a two-sided test at 5 %.
pub(crate) fn student_975(freedom: f64) -> f64 {
    quantile(NORMAL_QUANTILE_975, 0.95, freedom)
}

/// The quantile whose normal one is `x`, which has this probability between it and its negative.
fn quantile(x: f64, between: f64, freedom: f64) -> f64 {
    if freedom < 2.0 {
        return (0.5 * std::f64::consts::PI * between).tan();
    }
    if freedom < 3.0 {
        return between * (2.0 / (1.0 - between * between)).sqrt();
    }
    let x2 = x * x;
    x + x * (x2 + 1.0) / (4.0 * freedom)
        + x * ((5.0 * x2 + 16.0) * x2 + 3.0) / (96.0 * freedom.powi(2))
        + x * (((3.0 * x2 + 19.0) * x2 + 17.0) * x2 - 15.0) / (384.0 * freedom.powi(3))
        + x * ((((79.0 * x2 + 776.0) * x2 + 1482.0) * x2 - 1920.0) * x2 - 945.0) / (92160.0 * freedom.powi(4))
}

#[cfg(test)]
mod tests {
    use super::{student, student_975};

    #[test]
    fn the_quantiles_are_those_of_the_table() {
        // Abramowitz & Stegun, table 26.10.
        let table = [6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860, 1.833, 1.812];
        for (freedom, t) in (1..).map(f64::from).zip(table).chain([(30.0, 1.697), (1e9, 1.645)]) {
            assert!((student(freedom) / t - 1.0).abs() < 1e-3, "t of {freedom}: {}", student(freedom));
        }
        let table = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
        for (freedom, t) in (1..).map(f64::from).zip(table).chain([(30.0, 2.042), (1e9, 1.960)]) {
            assert!((student_975(freedom) / t - 1.0).abs() < 3e-3, "t of {freedom}: {}", student_975(freedom));
        }
    }
}
