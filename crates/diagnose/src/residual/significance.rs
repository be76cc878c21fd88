//! Whether the residual is significant, and at which stage of the signal path it acts.
//!
//! ```text
//! together  Σ −ln p of omitted terms, events, line, mean and air
//! ```
//!
//! Chance makes one of these statistics large. A wrong model makes many of them a little larger.
//!
//! Source: Fisher's method of combining p-values, *Statistical Methods for Research Workers*, 4th edition (1932),
//! section 21.1.

use crate::residual::misfit::Misfit;
use crate::thresholds::{
    AIR_AS_GUESSED, AIR_RATIO, ALONE, BURSTS, EVENTS, MEAN_BESIDE_RANDOM_FORCE, OMITTED_BESIDE_NAME,
    OMITTED_BESIDE_RANDOM_FORCE, OMITTED_COARSE, REPORTED, TOGETHER, UNEVEN_VARIANCE, WHITE_NOISE_KEPT,
    WHITE_NOISE_KEPT_SIGMAS, WHITENESS,
};
use plant::Stage;

impl Misfit {
    /// Whether the residual is significant.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.one_is_significant() || self.only_all_are_significant()
    }

    /// Whether the omitted terms are reported: they are significant, or a good part of a sum that is significant.
    #[must_use]
    pub fn omitted_is_reported(&self) -> bool {
        self.omitted_is_significant() || self.has_part_in_it(self.omitted)
    }

    /// The same for the events.
    #[must_use]
    pub fn events_are_reported(&self) -> bool {
        self.events_are_significant() || self.has_part_in_it(self.events)
    }

    /// Nats of the residual that belong to a stage, by its reported terms and events.
    #[must_use]
    pub fn nats_at(&self, stage: Stage) -> f64 {
        let terms = self.omitted_terms.iter().filter(|_| self.omitted_is_reported());
        let moments = self.event_terms.iter().filter(|_| self.events_are_reported());
        let own = terms.chain(moments).filter(|omitted| omitted.stage == Some(stage));
        own.map(|omitted| 0.5 * omitted.z.powi(2)).sum()
    }

    fn one_is_significant(&self) -> bool {
        let shape = self.whiteness > WHITENESS
            || self.mean_by_place > ALONE
            || self.variance_by_place > UNEVEN_VARIANCE
            || self.spectral_line > ALONE
            || self.air_growth_nats() > ALONE;
        (shape && !self.coarse) || self.omitted_is_significant() || self.events_are_significant()
    }

    fn only_all_are_significant(&self) -> bool {
        // A named effect explains a part of most statistics, so that their sum tells no more than each alone.
        !self.coarse && !self.beside_named_effect && !self.one_is_significant() && self.joint_nats() > TOGETHER
    }

    fn omitted_is_significant(&self) -> bool {
        let limit = if self.form_allowance > 0.0 { OMITTED_BESIDE_NAME } else { ALONE };
        self.rejected_effect.is_some()
            || self.beyond_allowance(self.omitted) > if self.coarse { OMITTED_COARSE } else { limit }
    }

    fn events_are_significant(&self) -> bool {
        self.beyond_allowance(self.events) > if self.coarse { OMITTED_COARSE } else { EVENTS }
    }

    /// Nats of the omitted terms if every reading had full weight.
    pub(crate) fn omitted_in_full(&self) -> f64 {
        self.omitted / self.weight
    }

    /// This misfit with the rejected effect `name`, if its omitted terms explain more than the `gain` of that effect.
    /// The terms are corrected for the choice among hundreds, and the true form of what is missing would have beaten
    /// them.
    pub(crate) fn beaten_by_omitted(self, name: &'static str, gain: f64) -> Option<Self> {
        let beaten = self.beyond_allowance(self.omitted) / self.weight > gain;
        (beaten && !self.coarse).then_some(Self { rejected_effect: Some(name), ..self })
    }

    fn has_part_in_it(&self, nats: f64) -> bool {
        self.only_all_are_significant() && self.beyond_allowance(nats) > REPORTED
    }

    /// Σ −ln p of all statistics.
    pub(crate) fn joint_nats(&self) -> f64 {
        let scored = [self.omitted, self.events].map(|nats| self.beyond_allowance(nats));
        let seen = [self.spectral_line, self.mean_by_place, self.air_growth_nats()];
        scored.iter().chain(&seen).map(|nats| nats.max(0.0)).sum()
    }

    /// Nats beyond the allowance for the form of the effects found.
    fn beyond_allowance(&self, nats: f64) -> f64 {
        nats - self.form_allowance
    }

    /// −ln of the probability of such a growth of the air's noise.
    pub(crate) fn air_growth_nats(&self) -> f64 {
        let nats = -(0.5 * libm::erfc(self.air_growth / std::f64::consts::SQRT_2)).max(f64::MIN_POSITIVE).ln();
        if self.air_ratio > AIR_RATIO { nats } else { nats.min(AIR_AS_GUESSED) }
    }

    /// Whether a turbulence that was found is plausible: it leaves no residual, and the white noise stays as believed.
    /// A coloured force follows anything that is missing. But then it replaces white noise, or leaves omitted terms,
    /// or acts only in bursts.
    #[must_use]
    pub fn allows_random_force(&self) -> bool {
        let untouched = WHITE_NOISE_KEPT.contains(&self.air_ratio) || self.air_growth.abs() < WHITE_NOISE_KEPT_SIGMAS;
        let nowhere = self.coarse || self.mean_by_place < MEAN_BESIDE_RANDOM_FORCE;
        let follows_nothing = self.omitted < OMITTED_BESIDE_RANDOM_FORCE && nowhere && self.bursts < BURSTS;
        !self.is_significant() && follows_nothing && untouched
    }
}

#[cfg(test)]
mod tests {
    use crate::residual::misfit::Misfit;
    use crate::residual::score_test::Omitted;
    use plant::Stage;

    #[test]
    fn many_small_deviations_are_significant_and_one_as_large_is_chance() {
        let one = Misfit { omitted: 10.0, ..Misfit::default() };
        let many = Misfit { events: 1.0, spectral_line: 2.0, mean_by_place: 2.0, ..one.clone() };
        assert!(!one.is_significant() && !one.omitted_is_reported());
        assert!(many.is_significant() && many.omitted_is_reported() && !many.events_are_reported());
        // Within a step of a coarse sensor nothing is normal. An allowance for the form of effects reduces the nats.
        assert!(!Misfit { coarse: true, ..many.clone() }.is_significant());
        assert!(!Misfit { form_allowance: 6.0, ..many }.is_significant());
    }

    #[test]
    fn terms_that_say_more_than_a_name_are_left_instead_of_it_and_cells_say_nothing() {
        let left = Misfit { omitted: 5.0, weight: 0.5, ..Misfit::default() };
        assert!(left.clone().beaten_by_omitted("hover_drift", 11.0).is_none() && !left.is_significant());
        let instead = left.clone().beaten_by_omitted("hover_drift", 9.0).unwrap();
        assert!(
            instead.is_significant() && instead.omitted_is_reported() && instead.rejected_effect == Some("hover_drift")
        );
        // The allowance for the form of earlier effects is subtracted.
        assert!(Misfit { form_allowance: 1.0, ..left.clone() }.beaten_by_omitted("hover_drift", 9.0).is_none());
        assert!(Misfit { coarse: true, ..left }.beaten_by_omitted("hover_drift", 9.0).is_none());
    }

    #[test]
    fn beside_a_name_nothing_is_said_together() {
        let many = Misfit { omitted: 10.0, events: 1.0, spectral_line: 2.0, mean_by_place: 2.0, ..Misfit::default() };
        assert!(many.is_significant() && !Misfit { beside_named_effect: true, ..many }.is_significant());
    }

    #[test]
    fn a_turbulence_that_pushes_one_way_somewhere_is_none_but_for_readings_in_cells() {
        let with =
            |mean_by_place| Misfit { mean_by_place, air_ratio: 1.0, beside_named_effect: true, ..Misfit::default() };
        assert!(with(4.0).allows_random_force() && !with(6.0).allows_random_force() && !with(6.0).is_significant());
        assert!(Misfit { coarse: true, ..with(6.0) }.allows_random_force());
    }

    #[test]
    fn a_stage_answers_for_the_terms_that_act_there_and_are_worth_a_word() {
        let term = |z, stage| Omitted { words: String::new(), z, stage: Some(stage) };
        let omitted_terms = vec![term(5.0, Stage::Actuator), term(-2.0, Stage::Sensor), term(1.0, Stage::Actuator)];
        let of = |omitted| Misfit { omitted, omitted_terms: omitted_terms.clone(), ..Misfit::default() };
        let nats = [Stage::Actuator, Stage::Sensor, Stage::Ball].map(|stage| of(12.0).nats_at(stage));
        assert_eq!(nats, [13.0, 2.0, 0.0]);
        assert_eq!(of(3.0).nats_at(Stage::Actuator), 0.0);
    }

    #[test]
    fn air_that_is_about_as_restless_as_its_owner_guessed_says_little() {
        let left =
            |air_ratio| Misfit { omitted: 5.0, mean_by_place: 4.0, air_growth: 3.5, air_ratio, ..Misfit::default() };
        assert!(!left(1.2).is_significant() && left(1.4).is_significant());
        let alone = |air_ratio| Misfit { air_growth: 5.0, air_ratio, ..Misfit::default() };
        assert!(!alone(1.2).is_significant() && alone(1.4).is_significant());
    }
}
