//! The 90 % intervals of the fitted parameters, in the units of the config.

use crate::answer::diagnosis::Diagnosis;
use crate::fit::intervals::Reach;
use crate::fit::lag_form::forms_beside_s;
use crate::fit::parameter::Parameter;
use crate::fit::profile::OF_90_PERCENT;
use crate::thresholds::WIDER;
use plant::{Difference, Entry};

/// Step of the numerical derivative of a value, in the scale of the parameter.
const SLIGHTLY: f64 = 1e-4;

impl Diagnosis {
    /// The 90 % intervals of the parameters of the mended model, in the units of the config: low and high. Parameters
    /// that are not identifiable are left out, and the step of a duty quantisation.
    #[must_use]
    pub fn intervals(&self) -> Vec<(Parameter, f64, f64)> {
        let end = |parameter: Parameter, by: f64| parameter.value(&parameter.stepped(&self.mended.model, by));
        let ends = |(parameter, [down, up]): &Reach| {
            let form = OF_90_PERCENT * self.form_beside(*parameter);
            Some((*parameter, end(*parameter, -down.hypot(form))?, end(*parameter, up.hypot(form))?))
        };
        self.reaches.iter().filter_map(ends).collect()
    }

    /// The difference of two parameters of an effect that is known far better than each, in their unit, with its 90 %
    /// interval. `None` if the effect has none or was not found, or if the difference is not identifiable.
    #[must_use]
    pub fn difference(&self, effect: &Entry) -> Option<(Difference, [f64; 3])> {
        let difference = effect.difference?;
        let values = self.mended.model.effects.values(effect.name)?;
        let end = |wanted: usize| {
            let at = self.mended.parameters.iter().position(|one| one.index_in(effect.name) == Some(wanted))?;
            let parameter = self.mended.parameters[at];
            let moved = |by: f64| parameter.value(&parameter.stepped(&self.mended.model, by));
            Some((at, (moved(SLIGHTLY)? - moved(-SLIGHTLY)?) / (2.0 * SLIGHTLY)))
        };
        let [from, to] = difference.of;
        let ((lower, by_lower), (upper, by_upper)) = (end(from)?, end(to)?);
        let covariance = self.mended.covariance();
        let variance = by_lower * by_lower * covariance[(lower, lower)]
            + by_upper * by_upper * covariance[(upper, upper)]
            - 2.0 * by_lower * by_upper * covariance[(lower, upper)];
        let (width, reach) = (values[to] - values[from], OF_90_PERCENT * WIDER * variance.sqrt());
        reach.is_finite().then(|| (difference, [width, (width - reach).max(0.0), width + reach]))
    }

    /// Standard deviation of a parameter due to the form of the lags next to it, in the scale of the parameter.
    fn form_beside(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Effect { size, .. } => {
                let form_s = |entry| forms_beside_s(&self.mended.model.effects, entry);
                parameter.entry().map_or(0.0, form_s) / size
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::tests_support::{model, record, shaken};
    use crate::{Options, Parameter, diagnose};
    use plant::Effects;

    #[test]
    fn the_width_of_a_dead_zone_is_known_far_better_than_its_edges() {
        let mut rig = model();
        rig.effects.set("dead_zone", &[-0.3, 0.3]);
        let found = diagnose(&model(), &record(&rig, 3, 80), &Options::default());
        let (_, [width, low, high]) = found.difference(Effects::built_in("dead_zone").unwrap()).unwrap();
        assert!(low < 0.6 && 0.6 < high && low < width && width < high, "{width}: {low} to {high}");
        let edges = found.intervals().into_iter().filter(|(parameter, ..)| parameter.is_of("dead_zone"));
        let narrowest = edges.map(|(_, low, high)| high - low).fold(f64::INFINITY, f64::min);
        assert!(high - low < 0.5 * narrowest, "{low} to {high}, an edge {narrowest}");
    }

    #[test]
    fn the_interval_of_a_delay_beside_a_lag_of_another_form_holds_it() {
        // The lag that is believed to be one of 0.2 s consists of two in series.
        let mut rig = model();
        for (name, seconds) in [("fan_lag", 0.19), ("sensor_lag", 0.01), ("transport_delay", 0.08)] {
            rig.effects.set(name, &[seconds]);
        }
        for seed in 0..2 {
            let found = diagnose(&model(), &shaken(&rig, seed, 120), &Options::default());
            let is_delay =
                |parameter: &Parameter| parameter.is_of("transport_delay") || parameter.is_of("sensor_delay");
            let delay = found.intervals().into_iter().find(|(parameter, ..)| is_delay(parameter));
            let (_, low, high) = delay.unwrap();
            assert!((low..high).contains(&0.08) && high - low < 0.06, "seed {seed}: {low} to {high} s");
        }
    }
}
