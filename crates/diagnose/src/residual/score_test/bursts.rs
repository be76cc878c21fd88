//! Whether the residual force acts all the time, as that of a turbulence does, or in bursts.
//!
//! ```text
//! b = n·Σz⁴/(Σz²)²                      kurtosis of the scores of a force pulse at each moment: 3 for normal scores
//! n = 1/mean ρ⁴(k − l) over k, l        effective number of independent scores, for cov(He₄(z_k), He₄(z_l)) = 24·ρ⁴
//! Z(b, n)                               the standard normal quantile of the kurtosis b of n normal scores
//! ```
//!
//! A coloured force follows gusts as well as a turbulence. Between gusts it has nothing to follow.
//! Sources: Harvey and Koopman, "Diagnostic checking of unobserved-components time series models", Journal of
//! Business & Economic Statistics 10 (1992); Anscombe and Glynn, "Distribution of the kurtosis statistic b2 for normal
//! samples", Biometrika 70 (1983).

/// Smallest number of independent scores: the transform is valid from 20 on.
const FEWEST: f64 = 20.0;
/// Longest lag with correlated scores: the effect of a force pulse in readings, at the highest density of moments.
const LAGS: usize = 400;

/// Kurtosis of these scores as a standard normal number: large for bursts, 0 for too few scores.
pub(super) fn bursts(scores: &[f64]) -> f64 {
    let count = scores.len() as f64;
    let power = |exponent: i32| scores.iter().map(|z| z.powi(exponent)).sum::<f64>() / count;
    let (square, fourth) = (power(2), power(4));
    let independent = count / together(scores, square * count);
    if square > 0.0 && independent >= FEWEST { as_normal(fourth / square.powi(2), independent) } else { 0.0 }
}

/// Σ ρ⁴ over the lags.
fn together(scores: &[f64], power: f64) -> f64 {
    let correlation =
        |lag: usize| scores.iter().zip(&scores[lag..]).map(|(now, later)| now * later).sum::<f64>() / power;
    1.0 + 2.0 * (1..scores.len().min(LAGS)).map(|lag| correlation(lag).powi(4)).sum::<f64>()
}

/// The kurtosis `b` of `n` normal numbers as a standard normal number: Anscombe and Glynn, equations 7 to 9.
fn as_normal(b: f64, n: f64) -> f64 {
    let mean = 3.0 * (n - 1.0) / (n + 1.0);
    let variance = 24.0 * n * (n - 2.0) * (n - 3.0) / ((n + 1.0).powi(2) * (n + 3.0) * (n + 5.0));
    let skew = 6.0 * (n * n - 5.0 * n + 2.0) / ((n + 7.0) * (n + 9.0))
        * (6.0 * (n + 3.0) * (n + 5.0) / (n * (n - 2.0) * (n - 3.0))).sqrt();
    let a = 6.0 + 8.0 / skew * (2.0 / skew + (1.0 + 4.0 / skew.powi(2)).sqrt());
    let x = (b - mean) / variance.sqrt();
    let root = ((1.0 - 2.0 / a) / (1.0 + x * (2.0 / (a - 4.0)).sqrt()).max(f64::MIN_POSITIVE)).cbrt();
    (1.0 - 2.0 / (9.0 * a) - root) / (2.0 / (9.0 * a)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{as_normal, bursts};
    use plant::Normal;

    #[test]
    fn the_kurtosis_of_a_published_sample_is_as_rare_as_it_is_published() {
        // Cholesterol of 62 people: D'Agostino, Belanger and D'Agostino, The American Statistician 44 (1990),
        // b = 4.58, Z = 2.21.
        assert!((as_normal(4.58, 62.0) - 2.21).abs() < 0.01, "{}", as_normal(4.58, 62.0));
    }

    /// Normal numbers with a correlation length of `reach`, times a scale that changes every `stay` numbers, cyclic in
    /// `sizes`.
    fn numbers(seed: u64, reach: f64, stay: usize, sizes: &[f64]) -> Vec<f64> {
        let (mut normal, mut now) = (Normal::new(seed, 3), 0.0);
        let keep = (-1.0 / reach).exp();
        let next = |k: usize| {
            now = keep * now + (1.0 - keep * keep).sqrt() * normal.draw();
            now * sizes[k / stay % sizes.len()]
        };
        (0..4000).map(next).collect()
    }

    #[test]
    fn what_comes_all_the_time_is_no_burst_however_long_its_memory() {
        for reach in [0.1, 5.0, 20.0] {
            let found: Vec<f64> = (0..40).map(|seed| bursts(&numbers(seed, reach, 1, &[7.0]))).collect();
            let (mean, most) = (found.iter().sum::<f64>() / 40.0, found.iter().copied().fold(0.0, f64::max));
            assert!(mean.abs() < 0.5 && most < 3.1, "{reach}: mean {mean}, most {most}");
        }
    }

    #[test]
    fn what_comes_and_goes_is_one() {
        let found = bursts(&numbers(1, 20.0, 100, &[1.0, 0.1, 0.1, 0.1]));
        assert!(found > 4.0, "{found}");
        assert_eq!(bursts(&[]), 0.0);
        assert_eq!(bursts(&[0.0; 100]), 0.0);
    }
}
