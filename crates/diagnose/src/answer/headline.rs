//! The verdict in one sentence: the headline of terminal, page and document.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::ladder::Rung;
use crate::answer::verdict::{Verdict, matters, parameters_matter};
use crate::select::stepwise::{Change, NamedEffect, is_of_path};
use crate::thresholds::LIKELY;
use plant::{Effects, Entry, Stage};

/// The headline of a residual that is significant, and that no likely effect explains.
const NO_EFFECT: &str = "Something separates simulator and rig that no effect of the catalogue explains";

/// What a significant residual means beside a noise that may hold it.
const HIDDEN: &str = "but a residual is significant, and that noise may hide a missing effect";

impl Diagnosis {
    /// The verdict in one sentence, without a full stop.
    #[must_use]
    pub fn verdict_in_words(&self) -> String {
        match self.verdict {
            Verdict::NoGap if self.noise_may_hide() => {
                format!("The simulator forecasts this record as well as its noise allows, {HIDDEN}")
            }
            Verdict::NoGap => "No gap: the simulator forecasts this record as well as noise allows".into(),
            Verdict::Parameters if self.noise_may_hide() => {
                format!("The simulator's numbers are off; with others it forecasts this record well, {HIDDEN}")
            }
            Verdict::Parameters => {
                "The simulator lacks no effect that this record shows, but its numbers are off".into()
            }
            Verdict::InsufficientData => "This record cannot say what separates simulator and rig".into(),
            Verdict::Unexplained => {
                let likely = self.effects.iter().filter(|named| named.probability >= LIKELY);
                let likely: Vec<_> = likely.collect();
                match (&likely[..], self.rest.matters) {
                    ([], true) => NO_EFFECT.into(),
                    ([], false) => format!("{NO_EFFECT}, but too little to matter for a forecast of 1 s"),
                    (likely, _) => {
                        let [kept, small, out] = self.partitioned(likely);
                        format!("{}, but most of the gap has another cause", headline(&kept, &small, &out))
                    }
                }
            }
            Verdict::Effect => {
                // A change of a believed effect is stated beside others only if it is likelier than not.
                let is_sure = |named: &&NamedEffect| named.change == Change::Added || named.probability >= LIKELY;
                let (mut stated, doubtful): (Vec<_>, Vec<_>) = self.effects.iter().partition(is_sure);
                if stated.is_empty() {
                    stated = doubtful;
                }
                let [kept, small, out] = self.partitioned(&stated);
                let said = headline(&kept, &small, &out);
                let [nominal, refitted, mended] = &self.gaps;
                let are_off = !kept.iter().any(|named| is_on_the_motion(named.candidate.entry))
                    && parameters_matter(nominal, refitted, mended, &self.mended.model)
                    && !self.believed_numbers_are_right();
                if are_off { format!("The simulator's numbers are off; {}", as_clause(&said)) } else { said }
            }
        }
    }

    /// Whether the residual is significant, and the noise too large to tell how much it matters.
    fn noise_may_hide(&self) -> bool {
        self.mends_noise && self.rest.is_significant
    }

    /// The named effects that the mended model does not have.
    #[must_use]
    pub fn left_out(&self) -> Vec<&'static str> {
        let added = self.effects.iter().filter(|named| named.change == Change::Added);
        let names = added.map(|named| named.candidate.entry.name);
        names.filter(|name| self.mended.model.effects.values(name).is_none()).collect()
    }

    /// The effects that matter and that the mended model has, those of them that are too small to matter, and others,
    /// which it leaves out. Where each is small and together they close the gap, all matter.
    fn partitioned<'a>(&self, effects: &[&'a NamedEffect]) -> [Vec<&'a NamedEffect>; 3] {
        let left_out = self.left_out();
        let is_out = |named: &&NamedEffect| left_out.contains(&named.candidate.entry.name);
        let (out, kept): (Vec<&NamedEffect>, Vec<&NamedEffect>) = effects.iter().copied().partition(is_out);
        let (small, kept): (Vec<&NamedEffect>, Vec<&NamedEffect>) =
            kept.into_iter().partition(|named| self.is_small(named));
        if kept.is_empty() && self.effects_close_the_gap() { [small, kept, out] } else { [kept, small, out] }
    }

    /// Whether the effects together lower the error at 1 s by enough to matter, beside numbers as believed.
    fn effects_close_the_gap(&self) -> bool {
        let [nominal, _, mended] = &self.gaps;
        self.believed_numbers_are_right() && parameters_matter(nominal, mended, mended, &self.mended.model)
    }

    /// Whether an added effect on the path moves no forecast of 1 s by enough to matter, neither alone nor beside the
    /// others. Effects of the sensor are no part of the motion, and matter to a loop by other figures.
    fn is_small(&self, named: &NamedEffect) -> bool {
        let entry = named.candidate.entry;
        let at = self.ladder.iter().position(|rung| rung.name == Some(entry.name));
        let step = at.and_then(|at| Some([self.ladder.get(at.checked_sub(1)?)?, self.ladder.get(at)?]));
        is_on_the_motion(entry)
            && named.change == Change::Added
            && step.is_some_and(|step| self.hardly_moves(step, named) == Some(true))
    }

    /// The same of the effect of the step between two rungs; `None` without the errors at 1 s.
    fn hardly_moves(&self, [below, with]: [&Rung; 2], named: &NamedEffect) -> Option<bool> {
        let [nominal, refitted, mended] = &self.gaps;
        let (floor, mended) = (mended.floor_mm[2]?, mended.error_mm[2]?);
        let [nominal, refitted, below] = [nominal.error_mm[2]?, refitted.error_mm[2]?, below.error_mm[2]?];
        let fall = with.alone.unwrap_or(0.0) * (nominal.powi(2) - floor.powi(2));
        let alone = (refitted.powi(2) - fall).max(0.0).sqrt();
        let rise = named.evidence.dropped_share * (refitted.powi(2) - floor.powi(2));
        let without = (mended.powi(2) + rise).max(0.0).sqrt();
        let falls = [below - with.error_mm[2]?, refitted - alone, without - mended];
        Some(!falls.into_iter().any(|fall| matters(fall, floor, &self.mended.model)))
    }
}

/// Whether an effect is one of the motion and not of the sensor or the scatter.
fn is_on_the_motion(entry: &Entry) -> bool {
    entry.stage != Stage::Sensor && is_of_path(entry)
}

/// An effect and those that are indistinguishable from it, each with its article.
#[must_use]
pub fn with_rivals(named: &NamedEffect) -> String {
    let names = std::iter::once(&named.candidate.entry.name).chain(&named.indistinguishable_from);
    names.map(|name| with_article(name)).collect::<Vec<_>>().join(" or ")
}

/// "a, b and c".
pub(super) fn listed(names: &[String]) -> String {
    match names {
        [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        _ => names.concat(),
    }
}

/// The headline of effects that the mended model has, of those among them that are too small to matter, and of others
/// that it leaves out.
fn headline(kept: &[&NamedEffect], small: &[&NamedEffect], out: &[&NamedEffect]) -> String {
    let also = |effects: &[&NamedEffect], why: &str| {
        let names: Vec<String> = effects.iter().map(|named| with_rivals(named)).collect();
        (!names.is_empty()).then(|| format!("also seen, but {why}: {}", listed(&names)))
    };
    let left_out = also(out, "left out of the mended model");
    let (first, also_small) = match (kept, small) {
        ([], []) => return format!("{}; with that, forecasts are no better", of_effects(out)),
        ([], _) => (format!("{}, but too little to matter for a forecast of 1 s", of_effects(small)), None),
        _ => (of_effects(kept), also(small, "too small to matter for a forecast of 1 s")),
    };
    [Some(first), also_small, left_out].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

fn of_effects(effects: &[&NamedEffect]) -> String {
    let by = |change| {
        let own = effects.iter().filter(move |named| named.change == change);
        own.map(|named| with_rivals(named)).collect::<Vec<_>>()
    };
    let clause = |change, before: &str, after: &str| {
        let names = by(change);
        (!names.is_empty()).then(|| format!("{before}{}{after}", listed(&names)))
    };
    let clauses = [
        clause(Change::Added, "the rig has ", " that the simulator lacks"),
        clause(Change::Retuned, "the rig has ", " of another size than believed"),
        clause(Change::Removed, "the simulator has ", " that the rig lacks"),
    ];
    first_letter(&clauses.into_iter().flatten().collect::<Vec<_>>().join("; "), char::to_ascii_uppercase)
}

/// "a dead zone", "an end stop", "turbulence".
fn with_article(name: &str) -> String {
    format!("{}{}", Effects::built_in(name).map_or("a ", |entry| entry.article), name.replace('_', " "))
}

/// A sentence as a clause after another one.
fn as_clause(sentence: &str) -> String {
    first_letter(sentence, char::to_ascii_lowercase)
}

fn first_letter(words: &str, of: impl Fn(&char) -> char) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| std::iter::once(of(&first)).chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::{listed, with_article};
    use crate::answer::diagnosis::Diagnosis;
    use crate::answer::verdict::Verdict;
    use crate::diagnose;
    use crate::options::Options;
    use crate::tests_support::{model, record};

    #[test]
    fn names_are_spoken_as_a_person_would() {
        assert_eq!(
            ["dead_zone", "end_stop", "turbulence"].map(with_article),
            ["a dead zone", "an end stop", "turbulence"]
        );
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
    }

    #[test]
    fn a_headline_without_a_likely_effect_asserts_none() {
        let mut found = found_of(20.0);
        found.verdict = Verdict::Unexplained;
        found.effects.iter_mut().for_each(|named| named.probability = 0.4);
        found.rest.matters = true;
        let said = "Something separates simulator and rig that no effect of the catalogue explains";
        assert_eq!(found.verdict_in_words(), said);
        found.rest.matters = false;
        assert_eq!(found.verdict_in_words(), format!("{said}, but too little to matter for a forecast of 1 s"));
    }

    #[test]
    fn a_noise_that_may_hide_a_missing_effect_is_no_proof_that_there_is_no_gap() {
        let mut found = found_of(2.0);
        found.verdict = Verdict::NoGap;
        found.rest.is_significant = true;
        found.mends_noise = false;
        assert_eq!(found.verdict_in_words(), "No gap: the simulator forecasts this record as well as noise allows");
        found.mends_noise = true;
        assert_eq!(
            found.verdict_in_words(),
            "The simulator forecasts this record as well as its noise allows, but a residual is significant, and that \
             noise may hide a missing effect"
        );
    }

    /// The diagnosis of a rig with little noise, with a gain 5 % above the belief and this much friction.
    fn found_of(friction_mm_per_s2: f64) -> Diagnosis {
        let mut belief = model();
        belief.noise.sensor_mm = 0.3;
        belief.noise.acceleration_psd_mm2_per_s3 = 1.0;
        let mut rig = belief.clone();
        rig.gain_mm_per_s2_per_percent *= 1.05;
        rig.effects.set("wall_friction", &[friction_mm_per_s2]);
        let options = Options { without_formula: true, ..Options::default() };
        diagnose(&belief, &record(&rig, 4, 80), &options)
    }

    #[test]
    fn an_effect_that_moves_no_forecast_is_said_to_be_too_small_to_matter_and_a_large_one_is_not() {
        let small = "The simulator's numbers are off; the rig has wall friction that the simulator lacks, but too \
                     little to matter for a forecast of 1 s";
        assert_eq!(found_of(2.0).verdict_in_words(), small);
        assert_eq!(found_of(20.0).verdict_in_words(), "The rig has wall friction that the simulator lacks");
    }
}
