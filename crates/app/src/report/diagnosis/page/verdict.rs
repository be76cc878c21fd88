//! The verdict in one sentence.

use crate::report::kit::page::parts::{capital, spoken};
use diagnose::{Change, Diagnosis, NamedEffect, Verdict};
use plant::Effects;

/// What was found, for someone who reads one sentence.
pub(super) fn sentence(found: &Diagnosis) -> String {
    match found.verdict {
        Verdict::NoGap => "No gap: the simulator forecasts this record as well as noise allows".into(),
        Verdict::Parameters => "The simulator lacks no effect that this record shows, but its numbers are off".into(),
        Verdict::InsufficientData => "This record cannot say what separates simulator and rig".into(),
        Verdict::Unexplained if found.effects.is_empty() => {
            "Something separates simulator and rig that no effect of the catalogue explains".into()
        }
        Verdict::Unexplained if !found.misfit.is_significant() => {
            format!("{}, which are more effects at once than one record proves", of_effects(&found.effects))
        }
        Verdict::Unexplained => {
            format!("{}, and something is left that no effect explains", of_effects(&found.effects))
        }
        Verdict::Effect => of_effects(&found.effects),
    }
}

fn of_effects(effects: &[NamedEffect]) -> String {
    let by = |change| effects.iter().filter(move |named| named.change == change).map(with_its_like).collect::<Vec<_>>();
    let clause = |change, before: &str, after: &str| {
        let names = by(change);
        (!names.is_empty()).then(|| format!("{before}{}{after}", listed(&names)))
    };
    let clauses: Vec<String> = [
        clause(Change::Added, "the rig has ", " that the simulator lacks"),
        clause(Change::Retuned, "the rig has ", " of another size than believed"),
        clause(Change::Removed, "the simulator has ", " that the rig lacks"),
    ]
    .into_iter()
    .flatten()
    .collect();
    capital(&clauses.join("; "))
}

/// An effect, and those that it cannot be told from.
pub(super) fn with_its_like(named: &NamedEffect) -> String {
    let names = std::iter::once(&named.candidate.entry.name).chain(&named.indistinguishable_from);
    names.map(|name| with_article(name)).collect::<Vec<_>>().join(" or ")
}

/// "a dead zone", "an end stop", "turbulence".
fn with_article(name: &str) -> String {
    format!("{}{}", Effects::entry(name).map_or("", |entry| entry.article), spoken(name))
}

/// "a, b and c".
fn listed(names: &[String]) -> String {
    match names {
        [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::{listed, with_article};

    #[test]
    fn names_are_spoken_as_a_person_would() {
        assert_eq!(
            ["dead_zone", "end_stop", "turbulence"].map(with_article),
            ["a dead zone", "an end stop", "turbulence"]
        );
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
    }
}
