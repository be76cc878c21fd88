//! Whether what is left over is more than chance, and where on the signal path it acts.
//!
//! ```text
//! together  Σ −ln p of omitted (terms, moments), line, mean and air: chance says much to one of them, and what is missing a little to many
//! ```
//!
//! Source: Fisher's combination of chances, *Statistical Methods for Research Workers*, 4th edition (1932), section 21.1.

use crate::residual::misfit::Residue;
use plant::Stage;

/// What is no chance, whatever the rest says: nats, and deviations of the colour. None of a thousand right models passed any of these.
const ALONE: f64 = 11.0;
const COLOUR: f64 = 5.5;
/// The same of an uneven energy, which alone no wrong model passed.
const ENERGY: f64 = 12.0;
/// The same of what all say together, nats: the sum of five exponential numbers passes it four times in a thousand, and of silent rigs outside
/// the catalogue a third are found by it.
const TOGETHER: f64 = 13.0;
/// The noise of the air, which an owner guesses, counts no more than this as long as it grew by less than that, as a ratio.
const AIR_AS_GUESSED: f64 = 3.0;
const AIR_RATIO: f64 = 1.3;
/// Nats of a part of it that are worth a word.
const WORTH_A_WORD: f64 = 3.0;
/// Terms beside a name of something that the rig does, passed by about one right name in ninety: what it stands for may be outside the
/// catalogue, and to doubt it costs less than an alarm where nothing is wrong. A density of readings is no such thing.
const OMITTED_BESIDE_A_NAME: f64 = 4.5;
/// Moments, whose many looks differ less than they are counted for.
const MOMENTS: f64 = 6.5;
/// The same beside a turbulence, which follows most of what is missing.
const OMITTED_BESIDE_TURBULENCE: f64 = 4.5;
/// An uneven mean over places beside a turbulence, which pushes either way at every one of them: chance leaves as much once in 150.
const MEAN_BESIDE_TURBULENCE: f64 = 5.0;
/// Terms and moments of coarse readings: within a cell nothing is normal, and of cells that the ball takes long to cross the filter itself
/// leaves as much.
const OF_CELLS: f64 = 80.0;
/// Pushes in bursts, deviations: the largest of three lengths.
const BURSTS: f64 = 3.3;
/// White noise that a right turbulence leaves as it was believed, as ratios.
const UNTOUCHED: std::ops::Range<f64> = 0.5..1.6;
/// Deviations within which a record does not tell the white noise from that.
const TOUCHED: f64 = 2.0;

impl Residue {
    /// Whether something is left over.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.one_is_significant() || self.only_all_are_significant()
    }

    /// Whether the terms that are asked for describe what is left over: they are no chance, or a good part of what only together is none.
    #[must_use]
    pub fn omitted_is_worth_a_word(&self) -> bool {
        self.omitted_is_significant() || self.has_part_in_it(self.omitted)
    }

    /// The same of the moments at which something happened.
    #[must_use]
    pub fn moments_are_worth_a_word(&self) -> bool {
        self.moments_are_significant() || self.has_part_in_it(self.moments)
    }

    /// Nats of what is left over that its shape puts down to a stage.
    #[must_use]
    pub fn nats_at(&self, stage: Stage) -> f64 {
        let terms = self.asked_for.iter().filter(|_| self.omitted_is_worth_a_word());
        let moments = self.happened.iter().filter(|_| self.moments_are_worth_a_word());
        let own = terms.chain(moments).filter(|omitted| omitted.stage == Some(stage));
        own.map(|omitted| 0.5 * omitted.z.powi(2)).sum()
    }

    fn one_is_significant(&self) -> bool {
        let shape = self.colour > COLOUR
            || self.mean > ALONE
            || self.energy > ENERGY
            || self.line > ALONE
            || self.restless() > ALONE;
        (shape && !self.coarse) || self.omitted_is_significant() || self.moments_are_significant()
    }

    fn only_all_are_significant(&self) -> bool {
        // What is named takes its part of most of them, so that they say no more together than alone.
        !self.coarse && !self.beside_a_name && !self.one_is_significant() && self.together() > TOGETHER
    }

    fn omitted_is_significant(&self) -> bool {
        let limit = if self.of_form > 0.0 { OMITTED_BESIDE_A_NAME } else { ALONE };
        self.instead_of.is_some() || self.of_its_own(self.omitted) > if self.coarse { OF_CELLS } else { limit }
    }

    fn moments_are_significant(&self) -> bool {
        self.of_its_own(self.moments) > if self.coarse { OF_CELLS } else { MOMENTS }
    }

    /// Nats that the terms ask for, had every reading counted in full.
    pub(crate) fn asked_in_all(&self) -> f64 {
        self.omitted / self.weight
    }

    /// Itself, if its terms say more than this name does of what it left: they pay for being chosen among hundreds, and the form of what is
    /// truly missing would have beaten them.
    pub(crate) fn instead_of(self, name: &'static str, gain: f64) -> Option<Self> {
        let outdone = self.of_its_own(self.omitted) / self.weight > gain;
        (outdone && !self.coarse).then_some(Self { instead_of: Some(name), ..self })
    }

    fn has_part_in_it(&self, nats: f64) -> bool {
        self.only_all_are_significant() && self.of_its_own(nats) > WORTH_A_WORD
    }

    /// Nats of chance of all together: what is missing says a little to many of the statistics, and chance to one.
    fn together(&self) -> f64 {
        let asked = [self.omitted, self.moments].map(|nats| self.of_its_own(nats));
        let seen = [self.line, self.mean, self.restless()];
        asked.iter().chain(&seen).map(|nats| nats.max(0.0)).sum()
    }

    /// Nats beyond what the form of what was found may leave.
    fn of_its_own(&self, nats: f64) -> f64 {
        nats - self.of_form
    }

    /// −ln of the chance that the noise of the air seems to have grown so much.
    fn restless(&self) -> f64 {
        let nats = -(0.5 * libm::erfc(self.air / std::f64::consts::SQRT_2)).max(f64::MIN_POSITIVE).ln();
        if self.air_ratio > AIR_RATIO { nats } else { nats.min(AIR_AS_GUESSED) }
    }

    /// Whether a turbulence that was found may be one: it explains all, and takes nothing of the white noise that was believed. A
    /// coloured force follows whatever is missing, but it does so at the cost of the white noise, or leaves a trace of what it follows,
    /// or has nothing to follow in between.
    #[must_use]
    pub fn allows_turbulence(&self) -> bool {
        let untouched = UNTOUCHED.contains(&self.air_ratio) || self.air.abs() < TOUCHED;
        let nowhere = self.coarse || self.mean < MEAN_BESIDE_TURBULENCE;
        let follows_nothing = self.omitted < OMITTED_BESIDE_TURBULENCE && nowhere && self.bursts < BURSTS;
        !self.is_significant() && follows_nothing && untouched
    }
}

#[cfg(test)]
mod tests {
    use crate::residual::misfit::Residue;
    use crate::residual::score_test::Omitted;
    use plant::Stage;

    #[test]
    fn a_little_said_by_many_is_left_over_and_as_much_said_by_one_is_chance() {
        let one = Residue { omitted: 10.0, ..Residue::default() };
        let many = Residue { moments: 1.0, line: 2.0, mean: 2.0, ..one.clone() };
        assert!(!one.is_significant() && !one.omitted_is_worth_a_word());
        assert!(many.is_significant() && many.omitted_is_worth_a_word() && !many.moments_are_worth_a_word());
        // Within a cell of a coarse sensor nothing is normal, and what effects explained may leave a share for their form.
        assert!(!Residue { coarse: true, ..many.clone() }.is_significant());
        assert!(!Residue { of_form: 6.0, ..many }.is_significant());
    }

    #[test]
    fn terms_that_say_more_than_a_name_are_left_instead_of_it_and_cells_say_nothing() {
        let left = Residue { omitted: 5.0, weight: 0.5, ..Residue::default() };
        assert!(left.clone().instead_of("hover_drift", 11.0).is_none() && !left.is_significant());
        let instead = left.clone().instead_of("hover_drift", 9.0).unwrap();
        assert!(
            instead.is_significant() && instead.omitted_is_worth_a_word() && instead.instead_of == Some("hover_drift")
        );
        // What was found before leaves as much by its form.
        assert!(Residue { of_form: 1.0, ..left.clone() }.instead_of("hover_drift", 9.0).is_none());
        assert!(Residue { coarse: true, ..left }.instead_of("hover_drift", 9.0).is_none());
    }

    #[test]
    fn beside_a_name_nothing_is_said_together() {
        let many = Residue { omitted: 10.0, moments: 1.0, line: 2.0, mean: 2.0, ..Residue::default() };
        assert!(many.is_significant() && !Residue { beside_a_name: true, ..many }.is_significant());
    }

    #[test]
    fn a_turbulence_that_pushes_one_way_somewhere_is_none_but_for_readings_in_cells() {
        let with = |mean| Residue { mean, air_ratio: 1.0, beside_a_name: true, ..Residue::default() };
        assert!(with(4.0).allows_turbulence() && !with(6.0).allows_turbulence() && !with(6.0).is_significant());
        assert!(Residue { coarse: true, ..with(6.0) }.allows_turbulence());
    }

    #[test]
    fn a_stage_answers_for_the_terms_that_act_there_and_are_worth_a_word() {
        let term = |z, stage| Omitted { words: String::new(), z, stage: Some(stage) };
        let asked_for = vec![term(5.0, Stage::Actuator), term(-2.0, Stage::Sensor), term(1.0, Stage::Actuator)];
        let of = |omitted| Residue { omitted, asked_for: asked_for.clone(), ..Residue::default() };
        let nats = [Stage::Actuator, Stage::Sensor, Stage::Ball].map(|stage| of(12.0).nats_at(stage));
        assert_eq!(nats, [13.0, 2.0, 0.0]);
        assert_eq!(of(3.0).nats_at(Stage::Actuator), 0.0);
    }

    #[test]
    fn air_that_is_about_as_restless_as_its_owner_guessed_says_little() {
        let left = |air_ratio| Residue { omitted: 5.0, mean: 4.0, air: 3.5, air_ratio, ..Residue::default() };
        assert!(!left(1.2).is_significant() && left(1.4).is_significant());
        let alone = |air_ratio| Residue { air: 5.0, air_ratio, ..Residue::default() };
        assert!(!alone(1.2).is_significant() && alone(1.4).is_significant());
    }
}
