//! The formula for what no effect explains, for the document and in words.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::document::Interval;
use crate::answer::ladder::Step;
use plant::{Definition, Stage};
use serde::Serialize;
use std::collections::BTreeMap;

/// A term of the formula: an effect as a user may write it.
#[derive(Clone, Debug, Serialize)]
pub struct FormulaTerm {
    /// Its name in the patch.
    pub name: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// What it is, in words.
    pub words: &'static str,
    /// What it adds: mm/s² in the air and at the ball, percent in the actuator, mm in the sensor.
    pub adds: &'static str,
    /// Its parameters with their 90 % intervals.
    pub parameters: BTreeMap<&'static str, Interval>,
}

impl Diagnosis {
    /// The terms of the formula; empty if there is none.
    #[must_use]
    pub fn formula_terms(&self) -> Vec<FormulaTerm> {
        let term = |shape: &&'static Definition| FormulaTerm {
            name: shape.entry().name,
            stage: shape.table().stage,
            words: &shape.table().looks,
            adds: &shape.table().adds,
            parameters: self.parameters_of(shape.entry()),
        };
        self.formula.iter().map(term).collect()
    }

    /// The formula in words: what it is, its terms with their numbers, its share of the gap, and the effect of the
    /// catalogue that comes nearest. `None` if there is none.
    #[must_use]
    pub fn formula_in_words(&self) -> Option<String> {
        let terms = self.formula.iter().map(|shape| {
            let own = self.parameters_of(shape.entry());
            let numbers = own.iter().map(|(name, interval)| {
                let unit = shape.table().parameters.get(*name).map_or("", |parameter| parameter.unit.as_str());
                let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
                format!("{name} = {}{unit}", interval.in_words())
            });
            let numbers = numbers.collect::<Vec<_>>().join(", ");
            format!("{}: `{}`, {numbers}", shape.table().looks, shape.table().adds)
        });
        let terms: Vec<String> = terms.collect();
        let rung = self.ladder.iter().find(|rung| rung.step == Step::Formula)?;
        let closes = rung.share.map_or(String::new(), |share| {
            let [value, low, high] = [share.value, share.low, share.high].map(|share| 100.0 * share);
            format!("; it closes {value:.0} % ({low:.0} to {high:.0}) of the gap")
        });
        let nearest =
            self.nearest_effect().map_or(String::new(), |name| format!("; of the catalogue {name} comes nearest"));
        Some(format!("no effect of the catalogue, but {}{closes}{nearest}", terms.join("; and ")))
    }

    /// The effect of the catalogue with the largest gain on the refitted belief, if it is not among the named ones.
    fn nearest_effect(&self) -> Option<&'static str> {
        let best = self.rounds.first()?.iter().find(|scored| scored.in_full && scored.held_out_gain > 0.0)?;
        let is_named = self.effects.iter().any(|named| named.candidate.entry.name == best.name);
        (!is_named).then_some(best.name)
    }
}
