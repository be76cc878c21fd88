//! The 90 % intervals of the numbers that a diagnosis found, in the units of the config.

use crate::answer::diagnosis::Diagnosis;
use crate::fit::intervals::{Reach, WIDER};
use crate::fit::lag_form::forms_beside_s;
use crate::fit::parameter::Free;
use crate::fit::profile::OF_90_PERCENT;

/// A step of a number in its own scale to take its slope from.
const SLIGHTLY: f64 = 1e-4;

impl Diagnosis {
    /// The 90 % intervals of the numbers that the mended model moved, in the units of the config: low and high. None of a number that the
    /// record does not determine, nor of a step of duty.
    #[must_use]
    pub fn intervals(&self) -> Vec<(Free, f64, f64)> {
        let end = |free: Free, by: f64| free.value(&free.moved(&self.mended.model, by));
        let ends = |(free, [down, up]): &Reach| {
            let form = OF_90_PERCENT * self.form_beside(*free);
            Some((*free, end(*free, -down.hypot(form))?, end(*free, up.hypot(form))?))
        };
        self.reaches.iter().filter_map(ends).collect()
    }

    /// The width of a dead zone that was found, percent of duty, with its 90 % interval. Moving both edges is moving hover, so that an edge is known far
    /// worse than the width. `None`: there is none, or the record does not determine it.
    #[must_use]
    pub fn dead_zone_width(&self) -> Option<(f64, f64, f64)> {
        let zone = self.mended.model.effects.dead_zone?;
        let edge = |wanted: usize| {
            let is = |free: &Free| matches!(free, Free::Effect { name: "dead_zone", index, .. } if *index == wanted);
            let at = self.mended.free.iter().position(is)?;
            let moved = |by: f64| self.mended.free[at].value(&self.mended.free[at].moved(&self.mended.model, by));
            Some((at, (moved(SLIGHTLY)? - moved(-SLIGHTLY)?) / (2.0 * SLIGHTLY)))
        };
        let ((lower, by_lower), (upper, by_upper)) = (edge(0)?, edge(1)?);
        let covariance = self.mended.covariance();
        let variance = by_lower * by_lower * covariance[(lower, lower)]
            + by_upper * by_upper * covariance[(upper, upper)]
            - 2.0 * by_lower * by_upper * covariance[(lower, upper)];
        let (width, reach) = (zone.upper_percent - zone.lower_percent, OF_90_PERCENT * WIDER * variance.sqrt());
        reach.is_finite().then(|| (width, (width - reach).max(0.0), width + reach))
    }

    /// How far a number may stand for the form of what is beside it, in its own scale.
    fn form_beside(&self, free: Free) -> f64 {
        match free {
            Free::Effect { name, size, .. } => forms_beside_s(&self.mended.model.effects, name) / size,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::tests_support::{model, record, shaken};
    use crate::{Free, Options, diagnose};

    #[test]
    fn the_width_of_a_dead_zone_is_known_far_better_than_its_edges() {
        let mut rig = model();
        rig.effects.set("dead_zone", &[-0.3, 0.3]);
        let found = diagnose(&model(), &record(&rig, 3, 80), &Options::default());
        let (width, low, high) = found.dead_zone_width().unwrap();
        assert!(low < 0.6 && 0.6 < high && low < width && width < high, "{width}: {low} to {high}");
        let edges = found.intervals().into_iter().filter(|(free, ..)| free.is_of("dead_zone"));
        let narrowest = edges.map(|(_, low, high)| high - low).fold(f64::INFINITY, f64::min);
        assert!(high - low < 0.5 * narrowest, "{low} to {high}, an edge {narrowest}");
    }

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
