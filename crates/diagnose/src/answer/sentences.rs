//! A diagnosis in sentences: the verdict, each effect, and the residual. Terminal, page and document use them.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::document::Interval;
use crate::answer::headline::listed;
use crate::answer::ladder::Rest;
use crate::answer::verdict::Verdict;
use crate::residual::constancy::SMALL_VARIATION;
use crate::residual::misfit::Misfit;
use crate::residual::score_test::Omitted;
use crate::select::stepwise::{Change, NamedEffect};
use crate::thresholds::{AIR_RATIO, LIKELY};
use plant::Stage;

/// Largest number of terms in a sentence.
const MOST_TERMS: usize = 3;
/// Explanation of the letters in terms.
const LETTERS: &str = "u: duty about hover, x: height, v: speed, t: time, each over its own deviation; ~τ: as it was over the last τ; u≈f: as a resonance of f swings with it";

impl Diagnosis {
    /// An effect in one line: its probability, its change, its parameters with their 90 % intervals, and the effects
    /// that are indistinguishable from it.
    #[must_use]
    pub fn effect_in_words(&self, named: &NamedEffect) -> String {
        let entry = named.candidate.entry;
        let sure = format!("{:<22} {} sure   ", entry.name, chance_in_words(named.probability));
        if named.change == Change::Removed {
            let is = if named.probability < LIKELY { "perhaps" } else { "and" };
            return format!("{sure}believed, {is} not there: leave it out of the model");
        }
        let own = self.effect_parameters(named);
        let in_order = entry.params.iter().filter_map(|param| Some((param.name, *own.get(param.name)?)));
        let difference = self.difference(entry).map(|(difference, [value, low, high])| {
            (difference.name, Interval { value, low: Some(low), high: Some(high), at_bound: None })
        });
        let numbers: Vec<String> =
            in_order.chain(difference).map(|(name, interval)| format!("{name} = {}", interval.in_words())).collect();
        let retuned = if named.change == Change::Retuned { "retuned   " } else { "" };
        let twins = match &named.indistinguishable_from[..] {
            [] => String::new(),
            names => format!("   (cannot be told from {})", names.join(", ")),
        };
        let large = named.evidence.variation.filter(|variation| variation.share > SMALL_VARIATION);
        let varies = large.map_or_else(String::new, |variation| {
            format!("   ({}: it may stand for another effect)", variation.in_words())
        });
        format!("{sure}{retuned}{}{twins}{varies}", numbers.join(", "))
    }

    /// Whether there is a verdict, and a significant residual.
    fn has_residual(&self) -> bool {
        self.verdict != Verdict::InsufficientData && self.rest.is_significant
    }

    /// The terms of the residual that are reported, the most significant first.
    fn reported_terms(&self) -> impl Iterator<Item = &Omitted> {
        self.misfit.omitted_terms.iter().filter(|_| self.misfit.omitted_is_reported()).take(MOST_TERMS)
    }

    /// The same of its events.
    fn reported_events(&self) -> impl Iterator<Item = &Omitted> {
        self.misfit.event_terms.iter().filter(|_| self.misfit.events_are_reported()).take(MOST_TERMS)
    }

    /// A significant residual: how much of the gap it is, whether it matters, and its form. `None` if none is
    /// significant, or it has no clear form.
    #[must_use]
    pub fn residual_in_words(&self) -> Option<String> {
        if !self.has_residual() {
            return None;
        }
        let size = match self.rest {
            Rest { matters: false, .. } => "too little to matter for a forecast of 1 s".to_owned(),
            Rest { share: Some(share), .. } => format!("{:.0} % of the gap that the refit leaves", 100.0 * share),
            Rest { share: None, .. } => return self.form_in_words(),
        };
        Some(self.form_in_words().map_or_else(|| format!("the residual is {size}"), |form| format!("{form}; {size}")))
    }

    /// What of the residual is reported: terms, then events, each the most significant first; none where the residual
    /// is not significant.
    #[must_use]
    pub fn residual_terms(&self) -> Vec<&Omitted> {
        if !self.has_residual() {
            return Vec::new();
        }
        self.reported_terms().chain(self.reported_events()).collect()
    }

    /// The residual without its terms: how much, and whether it is noise of the air; `None` where it is not
    /// significant.
    #[must_use]
    pub fn residual_size_in_words(&self) -> Option<String> {
        if !self.has_residual() {
            return None;
        }
        let size = match self.rest {
            Rest { matters: false, .. } => "a residual remains, too little to matter for a forecast of 1 s".to_owned(),
            Rest { share: Some(share), .. } => {
                format!("{:.0} % of the gap that the refit leaves is explained by no effect", 100.0 * share)
            }
            Rest { share: None, .. } => "a residual remains".to_owned(),
        };
        let misfit = &self.misfit;
        let without =
            self.rejected_effect().map(|name| format!("{name} explains less than its terms, and is left out"));
        let air = (misfit.air_ratio > AIR_RATIO)
            .then(|| format!("the noise of the air is {:.1} times as strong as believed", misfit.air_ratio));
        let acts = stage_in_words(misfit).map(|acts| acts.trim_start_matches("; ").to_owned());
        Some([Some(size), acts, without, air].into_iter().flatten().collect::<Vec<_>>().join("; "))
    }

    /// The effect that explains less than the terms of the residual. The search by forecasts may have named it since.
    fn rejected_effect(&self) -> Option<&'static str> {
        let is_named = |name: &str| self.effects.iter().any(|named| named.candidate.entry.name == name);
        self.misfit.rejected_effect.filter(|name| !is_named(name))
    }

    /// The letters in the forms of [`Self::residual_terms`].
    pub const RESIDUAL_LETTERS: &'static str = LETTERS;

    /// The form of the residual; `None` if it has no clear form.
    fn form_in_words(&self) -> Option<String> {
        let misfit = &self.misfit;
        let with_score = |term: &Omitted| format!("{} (z = {:.1})", term.words, term.z);
        let terms: Vec<String> = self.reported_terms().map(with_score).collect();
        let known = (!terms.is_empty()).then(|| format!("{} [{LETTERS}]", terms.join(", ")));
        let events: Vec<String> = self.reported_events().map(with_score).collect();
        let events = (!events.is_empty()).then(|| events.join(", "));
        let air = (misfit.air_ratio > AIR_RATIO)
            .then(|| format!("noise of the air {:.1} times as strong as believed", misfit.air_ratio));
        let form: Vec<String> = known.into_iter().chain(events).chain(air).collect();
        let acts = stage_in_words(misfit).unwrap_or_default();
        let without =
            self.rejected_effect().map_or(String::new(), |name| format!(" without {name}, which explains less,"));
        (!form.is_empty()).then(|| format!("the residual{without} looks like {}{acts}", form.join(", and ")))
    }

    /// Which of the effects that were found the mended model does not have, and why; `None`: it has them all.
    #[must_use]
    pub fn left_out_in_words(&self) -> Option<String> {
        let names: Vec<String> = self.left_out().into_iter().map(str::to_owned).collect();
        let names = (!names.is_empty()).then(|| listed(&names))?;
        Some(format!("the mended model is without {names}, with which forecasts are no better"))
    }

    /// The verdict, each effect, the residual, and what the mended model lacks, one sentence each.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let effects = self.effects.iter().map(|named| self.effect_in_words(named));
        let residual =
            self.residual_in_words().into_iter().chain(self.formula_in_words()).chain(self.left_out_in_words());
        std::iter::once(self.verdict_in_words()).chain(effects).chain(residual).collect()
    }
}

impl Interval {
    /// The value with its interval, and the bound that it lies at, in the number format of a config.
    #[must_use]
    pub fn in_words(&self) -> String {
        let plain = |value: f64| format!("{:.*}", decimals(value), value + 0.0);
        let ends = self.low.zip(self.high).map(|(low, high)| format!(" ({} to {})", plain(low), plain(high)));
        let bound = self.at_bound.map(|bound| format!(" [at {}, the bound of the search]", plain(bound)));
        format!("{}{}{}", plain(self.value), ends.unwrap_or_default(), bound.unwrap_or_default())
    }
}

/// Half of the smallest number that six decimal places show.
const SMALLEST: f64 = 5e-7;

/// Decimal places for three significant digits; none for 0.
#[must_use]
pub fn decimals(value: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few places")]
    let places = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    if value.abs() < SMALLEST { 0 } else { places }
}

/// A probability in words that do not promise certainty.
#[must_use]
pub fn chance_in_words(chance: f64) -> String {
    match 100.0 * chance {
        percent if percent > 99.0 => "more than 99 %".into(),
        percent if percent < 1.0 => "less than 1 %".into(),
        percent => format!("{percent:.0} %"),
    }
}

/// The stage with most of the residual, in words.
fn stage_in_words(misfit: &Misfit) -> Option<String> {
    let nats = Stage::ALL.map(|stage| (misfit.nats_at(stage), stage));
    let all: f64 = nats.iter().map(|(own, _)| own).sum();
    let (_, stage) = nats.into_iter().find(|(own, _)| *own > 0.5 * all)?;
    Some(format!("; most of that belongs to the {}", stage.name()))
}

#[cfg(test)]
mod tests {
    use super::chance_in_words;

    #[test]
    fn no_probability_is_said_to_be_certain() {
        let said = [1.0, 0.996, 0.984, 0.5, 0.004].map(chance_in_words);
        assert_eq!(said, ["more than 99 %", "more than 99 %", "98 %", "50 %", "less than 1 %"]);
    }
}
