//! The 90 % intervals of the numbers that a diagnosis found.
//!
//! ```text
//! half = 1.645·√( (w·σ)² + f² )        σ: of the likelihood at its best; w: how much wider, 1 of what is read off; f: what a delay may stand for of all lags
//! ```

use crate::diagnosis::Diagnosis;
use crate::free::Free;
use crate::lag::forms_beside_s;
use crate::profile::OF_90_PERCENT;

/// How much wider intervals are than those of the likelihood: where a ball bounces, and a filter takes its state for normal all the same; of
/// other effects, whose form is never quite that of the catalogue; and of the base parameters, which suffer less from that. Of withheld rigs
/// some 90 % lie within.
const WIDER_AT_STOPS: f64 = 3.5;
const WIDER: f64 = 1.35;
const WIDER_OF_BASE: f64 = 1.25;

impl Diagnosis {
    /// The 90 % intervals of the numbers that the mended model moved, in the units of the config. None of a number that the record
    /// does not determine, nor of a step of duty, where each valley is a grid of its own.
    /// They are wider than the likelihood's own, which takes the form of an effect for exact; that of a delay also by what it may stand for
    /// of the forms of the lags.
    #[must_use]
    pub fn intervals(&self) -> Vec<(Free, f64, f64)> {
        let wider = |(free, deviation): (Free, f64)| (free, (deviation * wider(free)).hypot(self.form_beside(free)));
        let moved = self.mended.free.iter().copied().zip(self.mended.deviations()).map(wider);
        let moved = moved.chain(self.read_off.iter().copied());
        let known = moved.filter(|(free, deviation)| deviation.is_finite() && !free.is_of("duty_quantisation"));
        let end = |free: Free, by: f64| free.value(&free.moved(&self.mended.model, by));
        let ends = |free: Free, half: f64| Some((free, end(free, -half)?, end(free, half)?));
        known.filter_map(|(free, deviation)| ends(free, OF_90_PERCENT * deviation)).collect()
    }

    /// How far a number may stand for the form of what is beside it, in its own scale.
    fn form_beside(&self, free: Free) -> f64 {
        match free {
            Free::Effect { name, size, .. } => forms_beside_s(&self.mended.model.effects, name) / size,
            _ => 0.0,
        }
    }
}

/// How much wider the interval of a number is than that of the likelihood.
fn wider(free: Free) -> f64 {
    match free {
        Free::Effect { name: "end_stop", .. } => WIDER_AT_STOPS,
        Free::Effect { .. } => WIDER,
        _ => WIDER_OF_BASE,
    }
}

#[cfg(test)]
mod tests {
    use crate::tests_support::{model, shaken};
    use crate::{Free, Options, diagnose};

    #[test]
    fn the_interval_of_a_delay_beside_a_lag_of_another_form_holds_it() {
        // The lag that is believed to be one of 0.2 s is two in series.
        let mut rig = model();
        for (name, seconds) in [("fan_lag", 0.19), ("sensor_lag", 0.01), ("transport_delay", 0.08)] {
            rig.effects.set(name, &[seconds]);
        }
        for seed in 0..2 {
            let found = diagnose(&model(), &shaken(&rig, seed, 120), &Options::default());
            let is_delay = |free: &Free| free.is_of("transport_delay") || free.is_of("sensor_delay");
            let delay = found.intervals().into_iter().find(|(free, ..)| is_delay(free));
            let (_, low, high) = delay.unwrap();
            assert!((low..high).contains(&0.08) && high - low < 0.06, "seed {seed}: {low} to {high} s");
        }
    }
}
