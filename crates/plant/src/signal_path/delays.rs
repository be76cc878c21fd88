//! Delays and time constants of the effects that are on, over all places of the signal path.

use super::{acts, name};
use crate::effect::Effect;
use crate::effects::{Effects, for_each_effect};

/// The dead time of an effect, of the duty and of the reading together, seconds.
fn dead_time_s<E: Effect>(effect: &E) -> f64 {
    let acts = acts(effect);
    [acts.delays_duty, acts.delays_reading].into_iter().flatten().map(|delay| delay(effect)).sum()
}

/// The time constants of an effect, up and down, seconds; `None`: it is no lag.
fn time_constants_s<E: Effect>(effect: &E) -> Option<[f64; 2]> {
    acts(effect).lag_s.map(|lag| lag(effect))
}

impl Effects {
    /// The delay by one effect, seconds: its dead time, or the mean of its time constants; 0 if it is off or no delay.
    #[must_use]
    pub fn late_s(&self, effect_name: &str) -> f64 {
        let mut sum = 0.0;
        for_each_effect!(self, effect => if name(effect) == effect_name {
            sum += dead_time_s(effect) + time_constants_s(effect).map_or(0.0, |[up, down]| (up + down) / 2.0);
        });
        sum
    }

    /// The longest delay from duty to reading by all of them, seconds: dead times, and the longer of each lag's time
    /// constants.
    #[must_use]
    pub fn latest_s(&self) -> f64 {
        let mut sum = 0.0;
        for_each_effect!(self, effect => {
            sum += dead_time_s(effect) + time_constants_s(effect).map_or(0.0, |[up, down]| up.max(down));
        });
        sum
    }

    /// The reciprocal of the shortest time constant of a lag or of turbulence, 1/s; 0 without.
    pub(crate) fn fastest_lag_per_s(&self) -> f64 {
        let mut rate = self.coloured_force().map_or(0.0, |turbulence| 1.0 / turbulence.correlation_s);
        for_each_effect!(self, effect => if let Some([up, down]) = time_constants_s(effect) {
            rate = rate.max(1.0 / up.min(down));
        });
        rate
    }
}
