//! The verdict in one sentence.

use crate::report::kit::page::parts::{capital, spoken};
use diagnose::{Change, Diagnosis, Named, Verdict};

/// Effects that are spoken of without an article.
const NO_ARTICLE: [&str; 11] = [
    "duty_quantisation",
    "hysteresis",
    "saturation",
    "height_dependent_flow",
    "turbulence",
    "quadratic_drag",
    "wall_friction",
    "sensor_noise",
    "sensor_outliers",
    "sensor_quantisation",
    "stale_samples",
];

/// What was found, for someone who reads one sentence.
pub(super) fn sentence(found: &Diagnosis) -> String {
    match found.verdict {
        Verdict::NoGap => "No gap: the simulator forecasts this record as well as noise allows".into(),
        Verdict::Parameters => "The simulator lacks no effect that this record shows, but its numbers are off".into(),
        Verdict::InsufficientData => "This record cannot say what separates simulator and rig".into(),
        Verdict::Unexplained if found.effects.is_empty() => {
            "Something separates simulator and rig that no effect of the catalogue explains".into()
        }
        Verdict::Unexplained if !found.residue.is_significant() => {
            format!("{}, which are more effects at once than one record proves", of_effects(&found.effects))
        }
        Verdict::Unexplained => {
            format!("{}, and something is left that no effect explains", of_effects(&found.effects))
        }
        Verdict::Effect => of_effects(&found.effects),
    }
}

fn of_effects(effects: &[Named]) -> String {
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
pub(super) fn with_its_like(named: &Named) -> String {
    let names = std::iter::once(&named.candidate.entry.name).chain(&named.indistinguishable_from);
    names.map(|name| with_article(name)).collect::<Vec<_>>().join(" or ")
}

/// "a dead zone", "an end stop", "turbulence".
fn with_article(name: &str) -> String {
    let article = match name.chars().next() {
        _ if NO_ARTICLE.contains(&name) => "",
        Some('a' | 'e' | 'i' | 'o' | 'u') => "an ",
        _ => "a ",
    };
    format!("{article}{}", spoken(name))
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
    use super::{NO_ARTICLE, listed, with_article};
    use plant::Effects;

    #[test]
    fn names_are_spoken_as_a_person_would() {
        assert_eq!(
            ["dead_zone", "end_stop", "turbulence"].map(with_article),
            ["a dead zone", "an end stop", "turbulence"]
        );
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
        assert!(NO_ARTICLE.iter().all(|name| Effects::entry(name).is_some()));
    }
}
