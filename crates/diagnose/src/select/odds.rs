//! The odds of a named effect: a logistic function of its evidence.

use serde::Serialize;

/// Log-odds beyond which nothing changes.
pub(crate) const MOST_LOG_ODDS: f64 = 10.0;

/// What speaks for a named effect, and against it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Evidence {
    /// Held-out log-likelihood gain when it was found, nats.
    pub held_out_gain: f64,
    /// Log-odds against the other effects of the catalogue and none, by their gains, at most 10 either way.
    pub margin: f64,
    /// Rise of the mean square error at 1 s without it, as a share of what can be closed beyond the refit.
    pub dropped_share: f64,
    /// The same rise in standard errors over the stretches of the record.
    pub dropped_deviations: f64,
    /// Σ −ln p of the residual tests with all effects.
    pub rest_nats: f64,
    /// What of the mean square error all effects leave open, as a share of what can be closed beyond the refit.
    pub rest_share: f64,
    /// How many effects were added.
    pub effects: usize,
    /// Whether it changes the scatter of the readings and not their path.
    pub is_scatter: bool,
    /// Whether it is a change of a believed effect.
    pub is_change: bool,
}

/// Intercept and weights of the log-odds, in the order of [`Evidence::features`].
const WEIGHTS: [f64; 9] = [0.0; 9];

impl Evidence {
    /// The probability that the effect acts.
    #[must_use]
    pub fn probability(&self) -> f64 {
        let log_odds: f64 = WEIGHTS.iter().zip(self.features()).map(|(weight, feature)| weight * feature).sum();
        1.0 / (1.0 + (-log_odds).exp())
    }

    /// What the log-odds are linear in, each of the order of 1; the first is the intercept's.
    fn features(&self) -> [f64; 9] {
        [
            1.0,
            ((1.0 + self.held_out_gain.max(0.0)) / (1.0 + self.rest_nats.max(0.0))).ln(),
            self.margin,
            self.dropped_share,
            self.dropped_deviations.clamp(-5.0, 10.0),
            self.rest_share.clamp(0.0, 1.0),
            self.effects as f64,
            f64::from(u8::from(self.is_scatter)),
            f64::from(u8::from(self.is_change)),
        ]
    }
}
