//! Dither: a fan that answers only in steps is given its steps at random, so that their mean is what was asked for.
//!
//! ```text
//! duty = k·step            with probability 1 − p
//! duty = (k + 1)·step      with probability p          k·step ≤ asked < (k + 1)·step, p = asked/step − k
//! ```
//!
//! The mean is exact; the variance is p·(1 − p)·step², white, and nothing hunts across a step as rounding does.
//! Source: the thesis, section 3.2 (0.8 %); Lipshitz et al., "Quantization and Dither", J. Audio Eng. Soc. 40 (1992).

use crate::check::{OutOfRange, within};
use libm::floor;
use rand_core::Rng;
use rand_pcg::Pcg32;

/// The grid of the fan, and the seed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Dither {
    /// Distance of the duties that the fan can tell apart, percent.
    pub step_percent: f64,
    /// The same seed gives the same rounding.
    #[cfg_attr(feature = "serde", serde(default))]
    pub seed: u32,
}

/// The random numbers of one flight.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DitherState(Pcg32);

impl Dither {
    /// Checks the step against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names it with its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("dither.step_percent", self.step_percent, 0.01, 10.0)
    }

    /// The random numbers from their start.
    #[must_use]
    pub fn start(&self) -> DitherState {
        DitherState(Pcg32::new(u64::from(self.seed), 0))
    }

    /// Rounds `percent` to one of its two neighbours on the grid.
    pub fn round(&self, state: &mut DitherState, percent: f64) -> f64 {
        let steps = percent / self.step_percent;
        let below = floor(steps);
        let chance = f64::from(state.0.next_u32()) / (f64::from(u32::MAX) + 1.0);
        self.step_percent * if chance < steps - below { below + 1.0 } else { below }
    }
}

#[cfg(test)]
mod tests {
    use super::Dither;

    const DITHER: Dither = Dither { step_percent: 0.8, seed: 3 };

    #[test]
    fn only_the_two_neighbours_are_given_and_their_mean_is_what_was_asked_for() {
        let mut state = DITHER.start();
        for asked in [21.4, 20.85, 22.39] {
            let k = (asked / 0.8_f64).floor();
            let count = 20_000;
            let mut sum = 0.0;
            for _ in 0..count {
                let given = DITHER.round(&mut state, asked);
                assert!((given - 0.8 * k).abs() < 1e-9 || (given - 0.8 * (k + 1.0)).abs() < 1e-9, "{given} %");
                sum += given;
            }
            // Four sigma of the mean of so many.
            let sigma = 0.4 / f64::from(count).sqrt();
            let mean = sum / f64::from(count);
            assert!((mean - asked).abs() < 4.0 * sigma, "{mean} %, asked for {asked} %");
        }
    }

    #[test]
    fn a_duty_on_the_grid_is_left_alone() {
        let mut state = DITHER.start();
        assert!((0..1000).all(|_| DITHER.round(&mut state, 0.5 * 16.0) - 8.0 == 0.0));
    }

    #[test]
    fn one_seed_gives_the_same_rounding_and_another_seed_another() {
        let rounded = |seed| {
            let dither = Dither { seed, ..DITHER };
            let mut state = dither.start();
            core::array::from_fn::<f64, 64, _>(|_| dither.round(&mut state, 21.4))
        };
        assert_eq!(rounded(1), rounded(1));
        assert_ne!(rounded(1), rounded(2));
    }
}
