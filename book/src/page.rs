//! A page of the gallery as Markdown, and the list of all.

use crate::gallery::Exhibit;
use airball::book::{advice_words, number, spoken, stage, words};
use diagnose::{Verdict, chance_in_words};
use plant::{Entry, Neutral, Param, Similar};
use std::fmt::Write;

/// The first line of every page: only a page with it may be replaced.
pub(crate) const MARK: &str =
    "<!-- Made by `scripts/book --update` from the catalogue of effects; change it there. -->";
/// Largest number of other candidates that are shown.
const COMPETITORS: usize = 4;

/// The list of all exhibits.
#[must_use]
pub(crate) fn list(exhibits: &[Exhibit]) -> String {
    let mut page = format!(
        "{MARK}\n\n# Gallery of effects\n\n\
         What each effect of the catalogue does to a flight. Each page shows the simulated rig of the config with one \
         more effect, flown with one experiment (`experiments/gallery.toml`), controller and seed, and diagnosed with \
         the model of the config, which lacks the effect.\n\n\
         The last column is the answer of `diagnose` to this one record. It is not always the right name: some effects \
         hardly show here, and some look like another.\n\n\
         | effect | stage | in a log | diagnosed as |\n|---|---|---|---|\n"
    );
    for exhibit in exhibits {
        let entry = exhibit.entry;
        let name = format!("[{}]({}.md)", spoken(entry.name), entry.name);
        // Writing to a string cannot fail.
        let _ = writeln!(
            page,
            "| {name} | {} | {} | {} |",
            stage(known(exhibit), entry.name),
            entry.in_a_log,
            answer(exhibit)
        );
    }
    page
}

/// The answer in a few words: names with their probability, or the verdict.
fn answer(exhibit: &Exhibit) -> String {
    let found = &exhibit.found;
    let names = found.effects.iter().map(|named| {
        let all = std::iter::once(&named.candidate.entry.name).chain(&named.indistinguishable_from);
        let all: Vec<String> = all.map(|name| spoken(name)).collect();
        format!("{} ({})", all.join(" or "), chance_in_words(named.probability))
    });
    let verdict = match found.verdict {
        Verdict::Effect => None,
        Verdict::NoGap => Some("no gap"),
        Verdict::Parameters => Some("only gain, drag or hover"),
        Verdict::Unexplained => Some("unexplained"),
        Verdict::InsufficientData => Some("insufficient data"),
    };
    verdict.map(str::to_owned).into_iter().chain(names).collect::<Vec<_>>().join("; ")
}

/// The page of one effect.
#[must_use]
pub(crate) fn page(exhibit: &Exhibit) -> String {
    let key = exhibit.entry.name;
    let name = spoken(key);
    let sections = [
        format!("{MARK}\n\n# {}\n\n{}", capital(&name), known(exhibit).physics(key).unwrap_or_default()),
        format!(
            "Stage: {}. Config table: `[plant.effects.{key}]`.\n\n{}",
            stage(known(exhibit), key),
            numbers(exhibit)
        ),
        format!("## In a log\n\n{}.\n\n{}", capital(exhibit.entry.in_a_log), pictures(key, &name)),
        format!("## What a diagnosis says\n\n{}", diagnosis(exhibit)),
        format!("## Similar effects\n\n{}\n\n{}", similar(&exhibit.entry), competitors(exhibit)),
        format!("## Correct it\n\n{}", mend(exhibit)),
    ];
    sections.join("\n\n") + "\n"
}

fn numbers(exhibit: &Exhibit) -> String {
    let mut table = String::from("| parameter | value here | accepted | no effect at |\n|---|---|---|---|");
    for (Param { name, min, max, neutral, .. }, value) in exhibit.entry.params.iter().zip(&exhibit.values) {
        let neutral = match neutral {
            Neutral::At(value) | Neutral::Any(value) => value.to_string(),
            Neutral::PipeBottom => "the lower end of the pipe".into(),
            Neutral::PipeTop => "the upper end of the pipe".into(),
        };
        let _ = write!(table, "\n| `{name}` | {value} | {min} to {max} | {neutral} |");
    }
    table
}

fn pictures(file: &str, name: &str) -> String {
    format!(
        "![Position and duty of one experiment with {name} and without it]({file}-flight.svg)\n\n\
         The same experiment, controller and seed on two rigs: with the effect, and without it. Below, the two \
         duties.\n\n\
         ![Free runs of the config model and of the mended model, the record, and the residual \
         force]({file}-force.svg)\n\n\
         The recorded duty of the flight with the effect, simulated with two models that are restarted at the recorded \
         position every 10 s: the config model, which lacks the effect, and the mended one. Below, the residual force: \
         the force that the config model with refitted gain, drag and hover lacks for the recorded motion; over time, \
         and its mean over duty, height and speed. Shaded: significant forecast errors."
    )
}

fn diagnosis(exhibit: &Exhibit) -> String {
    format!("```text\n{}\n```", words(&exhibit.found, Some(&exhibit.compensation)))
}

/// Effects that are similar to this one, and how they are distinguished.
/// The effects of the exhibit's model, those that are known to it among them.
const fn known(exhibit: &Exhibit) -> &plant::Effects {
    &exhibit.found.mended.model.effects
}

fn similar(entry: &Entry) -> String {
    let mut text = String::from("Effects that look similar, and what separates them:\n");
    for Similar { name, distinguished_by } in entry.similar {
        let _ = write!(text, "\n- {}: {distinguished_by}.", link(name, entry.name));
    }
    text
}

/// The other candidates on this record, and what would separate those that it does not.
fn competitors(exhibit: &Exhibit) -> String {
    let found = &exhibit.found;
    let first = found.rounds.first().map(Vec::as_slice).unwrap_or_default();
    let mut tried: Vec<_> = first.iter().zip(found.chances(first)).filter(|(one, _)| one.in_full).collect();
    tried.sort_by(|a, b| b.0.held_out_gain.total_cmp(&a.0.held_out_gain));
    let mut text = String::from("No effect passed the screening of this record.");
    if !tried.is_empty() {
        text = "The effects that explain this record best, each alone, on held-out stretches. 5 nats are odds of 150 \
             to 1.\n\n\
             | effect | stage | gain, nats | probability |\n|---|---|---|---|"
            .into();
    }
    for (one, likely) in tried.into_iter().take(COMPETITORS) {
        let likely = likely.map_or_else(|| "–".into(), chance_in_words);
        let (name, gain) = (link(one.name, exhibit.entry.name), number(Some(one.held_out_gain), 1));
        let _ = write!(text, "\n| {name} | {} | {gain} | {likely} |", stage(known(exhibit), one.name));
    }
    for line in advice_words(&exhibit.advice) {
        let _ = write!(text, "\n\n{}.", capital(line.trim_end_matches('.')));
    }
    text
}

/// The name, as a link except on its own page.
fn link(name: &str, own: &str) -> String {
    if name == own { format!("**{}**", spoken(name)) } else { format!("[{}]({name}.md)", spoken(name)) }
}

fn mend(exhibit: &Exhibit) -> String {
    let entry = exhibit.entry;
    let mut text =
        format!("On the rig: {}.\n\nIn the simulator:\n\n```toml\n[plant.effects.{}]\n", entry.mend, entry.name);
    for (param, value) in entry.params.iter().zip(&exhibit.values) {
        let _ = writeln!(text, "{} = {value:?}", param.name);
    }
    text.push_str("```");
    text
}

/// The text with a capital, as at the start of a sentence.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
