//! Rate limit: the actuator follows the duty at a limited rate.
//!
//! ```text
//! |dr/dt| ≤ 100 / T        u: duty, r: the duty that acts, which moves towards u as fast as it may; both in percent,
//!                          T in s
//! ```
//!
//! T is the time for the whole range, the stroke time of a valve. Assumes one rate both ways and for every stroke, and
//! that the actuator stops at once where it arrives.
//! Source: the rate limiter, Åström and Hägglund, *PID Controllers*; the slew rate of a motor driver.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The duty that acts changes at a limited rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateLimit {
    /// Time for the whole range of 100 % of duty, seconds.
    pub full_range_s: f64,
}

impl Effect for RateLimit {
    const ENTRY: Entry = Entry {
        name: "rate_limit",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param { name: "full_range_s", min: 0.0, max: 100.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[1.0], &[2.0]],
        // Chosen by hand: from two rows of a log at 50 Hz to the longest horizon of the ladder.
        start: Start::RampsOver(&[0.03, 0.1, 0.3, 1.0]),
        in_a_log: "the response to a large step of duty is as slow as the step is large, while small changes of duty \
             act at once",
        mend_elsewhere: "a faster actuator, or a driver whose ramp is shorter; otherwise keep the controller below the \
             rate, with its own rate limit and anti-windup",
        mend: "shorten the ramp of the fan's driver; otherwise keep the controller below the rate, with its own rate \
             limit and anti-windup",
        similar: &[
            Similar {
                name: "fan_lag",
                distinguished_by: "a lag is as slow for small steps of duty as for large ones; at a limited rate a \
                     step twice as large takes twice as long. Fly steps of two sizes",
            },
            Similar {
                name: "saturation",
                distinguished_by: "with a limited rate the full force comes, but late; with a saturation it never \
                     comes. Hold a large duty for a while",
            },
            Similar {
                name: "transport_delay",
                distinguished_by: "after a delay the force comes at once and in full; at a limited rate it begins at \
                     once and grows evenly. Fly steps",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { slews: Some(Self::reached), ..Acts::NONE };

    values_in_order!(full_range_s);
}

impl RateLimit {
    /// The duty that acts, percent, so many seconds after it was `reached_percent`, towards a constant `duty_percent`.
    #[must_use]
    pub fn reached(&self, reached_percent: f64, duty_percent: f64, dt_s: f64) -> f64 {
        if self.full_range_s <= 0.0 {
            return duty_percent;
        }
        let most = 100.0 * dt_s.max(0.0) / self.full_range_s;
        reached_percent + (duty_percent - reached_percent).max(-most).min(most)
    }
}

#[cfg(test)]
mod tests {
    use super::RateLimit;

    #[test]
    fn a_step_takes_its_share_of_the_time_for_the_whole_range() {
        let limit = RateLimit { full_range_s: 2.0 };
        let by = |from, to, dt_s| limit.reached(from, to, dt_s);
        assert_eq!([by(20.0, 40.0, 0.1), by(20.0, 40.0, 0.4), by(20.0, 40.0, 3.0)], [25.0, 40.0, 40.0]);
        assert_eq!([by(20.0, 10.0, 0.1), by(20.0, 10.0, 0.0), by(20.0, 20.0, 1.0)], [15.0, 20.0, 20.0]);
        assert_eq!(RateLimit { full_range_s: 0.0 }.reached(20.0, 90.0, 0.0), 90.0);
    }
}
