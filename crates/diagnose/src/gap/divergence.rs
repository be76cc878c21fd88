//! The difference between two duties, as the Kullback–Leibler divergence of the readings that a model predicts from
//! them.
//!
//! ```text
//! nats = ½·Σ (ŷ'_k − ŷ_k)²/S_k        ŷ from the recorded duty, ŷ' from another; both filters use the same readings
//! ```
//!
//! The expected loss of log-likelihood of a right model with the other duty, without its random part, so that equal
//! duties have exactly 0.
//! Source: Kullback and Leibler, "On information and sufficiency", Annals of Mathematical Statistics 22 (1951), for two
//! normal densities.

use crate::filter::track::innovations;
use crate::record::free_flight::in_free_flight;
use crate::record::recording::Recording;
use plant::Model;

/// Expected loss of log-likelihood, nats, of the readings in free flight of `flown` if `model` has the duty of `other`
/// as its input. Both hold the same readings in the same order; rows without a reading may differ.
#[must_use]
pub fn kl_divergence(model: &Model, flown: &Recording, other: &Recording) -> f64 {
    let counts = in_free_flight(model, flown);
    let (seen, told) = rayon::join(|| innovations(model, flown), || innovations(model, other));
    let both = seen.iter().zip(&told).filter(|(seen, _)| counts[seen.row]);
    both.map(|(seen, told)| 0.5 * seen.weight * (told.expected_mm - seen.expected_mm).powi(2) / seen.variance_mm2).sum()
}

#[cfg(test)]
mod tests {
    use super::kl_divergence;
    use crate::filter::track::innovations;
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    #[test]
    fn what_a_wrong_duty_costs_is_what_the_likelihood_loses_on_average() {
        let (mut apart, mut lost) = (0.0, 0.0);
        for seed in 0..6 {
            let flown = record(&model(), seed, 60);
            let wrong =
                flown.samples().iter().map(|s| Sample { duty_percent: s.duty_percent + 0.05 * s.time_s.sin(), ..*s });
            let wrong = Recording::new(wrong.collect()).unwrap();
            assert_eq!(kl_divergence(&model(), &flown, &flown), 0.0);
            apart += kl_divergence(&model(), &flown, &wrong);
            // The first seconds depend on the prior and do not count.
            let total = |recording: &Recording| {
                let late = innovations(&model(), recording).into_iter().filter(|s| s.row > 100);
                late.map(|s| s.log_density).sum::<f64>()
            };
            lost += total(&flown) - total(&wrong);
        }
        // The standard deviation of the sum of losses is √(2·nats).
        assert!(apart > 20.0 && (lost - apart).abs() < 4.0 * (2.0 * apart).sqrt(), "{apart} and {lost} nats");
    }
}
