//! Turbulence: the air pushes at random, and goes on pushing the same way for a while.
//!
//! ```text
//! dw = −w/τ·dt + σ·√(2/τ)·dW            w: acceleration, mm/s²; σ its standard deviation; τ in s
//! w(t + h) = w(t)·ρ + σ·√(1 − ρ²)·n      ρ = e^(−h/τ), n standard normal: exact for any step
//! ```
//!
//! Stationary from the start. Leaves out that turbulence grows with the flow and changes with the height.
//! Source: Uhlenbeck and Ornstein, *On the Theory of the Brownian Motion*, Phys. Rev. 36 (1930); the update is
//! Gillespie's, Phys. Rev. E 54 (1996).

use crate::acts::{Acts, Readings};
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use crate::effects::Effects;
use crate::lag;
use libm::sqrt;
use serde::{Deserialize, Serialize};

/// A coloured random force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbulence {
    /// σ: standard deviation of the acceleration, mm/s².
    pub sigma_mm_per_s2: f64,
    /// τ: correlation time, seconds.
    pub correlation_s: f64,
}

impl Effect for Turbulence {
    const ENTRY: Entry = Entry {
        name: "turbulence",
        stage: Stage::Air,
        params: &[
            Param { name: "sigma_mm_per_s2", min: 0.0, max: 1e6, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "correlation_s", min: 0.01, max: 10.0, neutral: Neutral::Any(0.5), scale: Scale::Value },
        ],
        sizes: &[&[100.0, 0.5]],
        start: Start::Values(&[&[25.0, 0.3], &[40.0, 1.0]]),
        in_a_log: "the ball wanders slowly and randomly, independent of duty, height, speed and time",
        mend: "a flow straightener above the fan (a bundle of straws), a smoother inlet, no draught in the room",
        similar: &[
            Similar {
                name: "sensor_noise",
                distinguished_by: "turbulence moves the ball, so that successive readings agree. With the fan off and \
                     the ball at rest only sensor noise is left",
            },
            Similar {
                name: "hover_drift",
                distinguished_by: "turbulence averages out and differs between flights; drift repeats. Fly the same \
                     experiment twice and compare",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> =
        Acts { coloured_force: Some(|force| *force), can_show: Some(Self::is_coloured), ..Acts::NONE };

    values_in_order!(sigma_mm_per_s2, correlation_s);
}

/// Readings within which a coloured force does not forget itself, and the seconds that are always enough.
const FORGETS_READINGS: f64 = 3.0;
const FORGETS_S: f64 = 0.1;
/// Air in a pipe does not remember a swirl for so long, seconds.
const DRIFTS_S: f64 = 5.0;

impl Turbulence {
    /// Whether readings can show the force as a separate effect: with a correlation time of a few readings it is white
    /// noise, and with a very long one it is a drift.
    #[must_use]
    pub fn is_coloured(&self, readings: &Readings) -> bool {
        ((FORGETS_READINGS * readings.period_s).min(FORGETS_S)..DRIFTS_S).contains(&self.correlation_s)
    }

    /// ρ: the share of a force that remains after `dt_s`.
    #[must_use]
    pub fn decay(&self, dt_s: f64) -> f64 {
        lag::decay(self.correlation_s, dt_s)
    }

    /// Standard deviation of what `dt_s` adds at random, mm/s².
    #[must_use]
    pub fn kick(&self, dt_s: f64) -> f64 {
        let decay = self.decay(dt_s);
        self.sigma_mm_per_s2 * sqrt(1.0 - decay * decay)
    }
}

impl Effects {
    /// The same effects with this random force in place of the present one, if any: its standard deviation, and its
    /// correlation time.
    #[must_use]
    pub fn with_coloured_force(&self, sigma_mm_per_s2: f64, correlation_s: f64) -> Self {
        Self { turbulence: Some(Turbulence { sigma_mm_per_s2, correlation_s }), ..self.clone() }
    }

    /// The same effects with the random force of `other`, or without one.
    #[must_use]
    pub fn with_coloured_force_of(&self, other: &Self) -> Self {
        Self { turbulence: other.coloured_force(), ..self.clone() }
    }

    /// Multiplies the random force by a factor. False, and nothing has changed: there is none.
    pub fn scale_coloured_force(&mut self, factor: f64) -> bool {
        self.turbulence.as_mut().map(|force| force.sigma_mm_per_s2 *= factor).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::Turbulence;

    #[test]
    fn the_variance_stays_what_it_is_for_any_step() {
        let turbulence = Turbulence { sigma_mm_per_s2: 80.0, correlation_s: 0.3 };
        for dt in [1e-4, 0.01, 1.0, 100.0] {
            let (decay, kick) = (turbulence.decay(dt), turbulence.kick(dt));
            let variance = 6400.0 * decay * decay + kick * kick;
            assert!((variance - 6400.0).abs() < 1e-8, "{variance} at {dt} s");
        }
    }
}
