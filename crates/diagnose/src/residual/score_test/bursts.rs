//! Whether pushes come all the time, as those of a turbulence do, or in bursts.
//!
//! ```text
//! b = n·Σz⁴/(Σz²)²                      kurtosis of the scores of a push at each moment: 3 where they are normal
//! n = 1/mean ρ⁴(k − l) over k, l          as many independent ones leave the same doubt, for cov(He₄(z_k), He₄(z_l)) = 24·ρ⁴
//! Z(b, n)                               the normal number that is as rare as b of n normal ones
//! ```
//!
//! A coloured force follows gusts as well as it follows a turbulence; between gusts it has nothing to follow.
//! Sources: Harvey and Koopman, "Diagnostic checking of unobserved-components time series models", Journal of Business & Economic
//! Statistics 10 (1992); Anscombe and Glynn, "Distribution of the kurtosis statistic b2 for normal samples", Biometrika 70 (1983).

/// Independent scores that a kurtosis needs: the transform is for 20 and more.
const FEWEST: f64 = 20.0;
/// Scores so many places apart may still go together: as long as the trace of a push, at the most starts in a second.
const LAGS: usize = 400;

/// How much larger the kurtosis of these scores is than that of normal ones, deviations. 0 where they are too few.
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

/// The kurtosis `b` of `n` normal numbers as a normal number: Anscombe and Glynn, equations 7 to 9 of their paper's transform.
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
        // Cholesterol of 62 people: D'Agostino, Belanger and D'Agostino, The American Statistician 44 (1990), b = 4.58, Z = 2.21.
        assert!((as_normal(4.58, 62.0) - 2.21).abs() < 0.01, "{}", as_normal(4.58, 62.0));
    }

    /// Numbers that go together over about `reach` places, each of a size that changes every `stay` places from one of `sizes` to the next.
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
