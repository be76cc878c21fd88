//! Whether what a fit found is what its name says, and what that name costs on a rig that is believed to be as it is.

use crate::fit::lag_form::{LAGS, late_s};
use crate::fit::parameter::is_read_off;
use crate::select::candidates::{Candidate, Search};
use plant::{Effects, Entry};

/// Effects that make something late.
const LATE: [&str; 5] = ["transport_delay", "sensor_delay", "sensor_lag", "fan_lag", "spin_asymmetry"];
/// What the form of a believed lag may be worth to an effect that makes something late, nats.
const COST_BESIDE_A_LAG: f64 = 7.0;
/// What is late by less than this share of it and of the lag beside it is that lag's form: of two lags in series, the small one.
const SHARE_OF_A_LAG: f64 = 0.16;
/// Numbers that are this near to doing nothing, in their own scale, do nothing.
const NOTHING: f64 = 1e-3;
/// Effects whose first number is their strength: at 0 the others mean nothing.
const NOISES: [&str; 2] = ["turbulence", "sensor_outliers"];
/// Wild readings are so many deviations of the noise away.
const WILD: f64 = 5.0;
/// Readings within which a coloured force does not forget itself, and the seconds that are always enough.
const FORGETS: f64 = 3.0;
const FORGETS_S: f64 = 0.1;
/// Air in a pipe does not remember a swirl for so long, seconds.
const DRIFTS_S: f64 = 5.0;

impl Search<'_> {
    /// Whether an effect was found, and not just noise or other base parameters under its name.
    pub(crate) fn is_plausible(&self, candidate: &Candidate) -> bool {
        self.does_something(candidate)
            && self.is_wild_enough(candidate)
            && self.is_coloured(candidate)
            && self.is_more_than_form(candidate)
    }

    /// A fit that switched its effect off again has found better numbers for the rest, and no effect.
    fn does_something(&self, candidate: &Candidate) -> bool {
        if is_read_off(candidate.entry.name) {
            return true;
        }
        let own = candidate.fit.free.iter().filter(|free| free.is_of(candidate.entry.name));
        let off: Vec<f64> =
            own.filter_map(|free| free.off_neutral(&candidate.fit.model, self.problem.belief)).collect();
        let has_strength = NOISES.contains(&candidate.entry.name);
        off.iter().take(if has_strength { 1 } else { off.len() }).any(|off| off.abs() > NOTHING)
    }

    /// Wild readings that are hardly wild are the tails of the noise.
    fn is_wild_enough(&self, candidate: &Candidate) -> bool {
        let noise = &self.problem.belief.noise;
        candidate.fit.model.effects.sensor_outliers.is_none_or(|wild| wild.size_mm > WILD * noise.sensor_mm)
            || self.problem.belief.effects.sensor_outliers.is_some()
    }

    /// A force that forgets itself within a few readings is white noise, and one that remembers itself for long is a drift.
    fn is_coloured(&self, candidate: &Candidate) -> bool {
        let recording = self.problem.recording;
        let few_s = FORGETS * recording.duration_s() / recording.readings().max(1) as f64;
        let coloured = few_s.min(FORGETS_S)..DRIFTS_S;
        candidate.fit.model.effects.turbulence.is_none_or(|air| coloured.contains(&air.correlation_s))
            || self.problem.belief.effects.turbulence.is_some()
    }

    /// Where the speed of the fan is recorded, its lag is seen as it is, and has no form to be mistaken.
    fn is_more_than_form(&self, candidate: &Candidate) -> bool {
        self.problem.recording.has_fan_speed() || !is_form_of_a_lag(candidate.entry.name, &candidate.fit.model.effects)
    }

    /// A rig's lag is never quite of first order: where one is believed, another thing that is late may only mend its form.
    pub(crate) fn cost_of_form(&self, entry: &Entry) -> f64 {
        let believed = &self.problem.belief.effects;
        let lag = LAGS.iter().any(|(lag, _)| believed.values(lag).is_some());
        if lag && LATE.contains(&entry.name) { COST_BESIDE_A_LAG } else { 0.0 }
    }
}

/// Whether effect `name` is late by so little beside a lag that it may be the rest of that lag, which is never quite of first order.
fn is_form_of_a_lag(name: &str, effects: &Effects) -> bool {
    let own_s = late_s(effects, name);
    let beside_s: f64 = LAGS.iter().filter(|(lag, _)| *lag != name).map(|(lag, _)| late_s(effects, lag)).sum();
    LATE.contains(&name) && own_s < SHARE_OF_A_LAG * (own_s + beside_s)
}

#[cfg(test)]
mod tests {
    use super::is_form_of_a_lag;
    use plant::Effects;

    /// Effects with these first numbers, the second of two the same.
    fn with(lates: &[(&str, f64)]) -> Effects {
        let mut effects = Effects::default();
        for (name, seconds) in lates {
            effects.set(name, &vec![*seconds; Effects::entry(name).unwrap().params.len()]);
        }
        effects
    }

    #[test]
    fn what_is_late_by_little_beside_a_lag_is_its_form() {
        let lag = ("fan_lag", 0.2);
        for late in ["transport_delay", "sensor_delay", "sensor_lag"] {
            assert!(is_form_of_a_lag(late, &with(&[lag, (late, 0.03)])), "{late}");
            assert!(!is_form_of_a_lag(late, &with(&[lag, (late, 0.05)])), "{late}");
            assert!(!is_form_of_a_lag(late, &with(&[(late, 0.03)])), "{late} alone");
        }
        assert!(is_form_of_a_lag("fan_lag", &with(&[("fan_lag", 0.02), ("sensor_lag", 0.2)])));
        assert!(is_form_of_a_lag("sensor_delay", &with(&[("sensor_delay", 0.02), ("spin_asymmetry", 0.2)])));
        assert!(!is_form_of_a_lag("spin_asymmetry", &with(&[("spin_asymmetry", 0.02)])));
        assert!(!is_form_of_a_lag("dead_zone", &with(&[lag, ("dead_zone", 0.01)])));
    }
}
