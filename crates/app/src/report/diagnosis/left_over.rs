//! The shape of what no effect explains, in words.

use crate::report::kit::words::NAMES;
use diagnose::{Diagnosis, Residue, Verdict};

/// Terms that a sentence names at most.
const MOST_TERMS: usize = 3;
/// Growth of the air's noise that is worth a word, as a ratio.
const RESTLESS: f64 = 1.3;
/// What the letters of a term mean.
const LETTERS: &str = "u: duty about hover, x: height, v: speed, t: time, each over its own deviation; ~τ: as it was over the last τ; u≈f: as a resonance of f swings with it";

/// Why an answer that leaves nothing over is unexplained all the same.
const TOO_MANY: &str = "nothing is left over, but three effects or more at once follow almost any record: trust them no more than one that leaves \
    something, mend the first, fly again, and diagnose again";

/// What is left of an unexplained gap; `None` where nothing is, or where it has no shape.
#[must_use]
pub fn left_over(found: &Diagnosis) -> Option<String> {
    if found.verdict != Verdict::Unexplained {
        return None;
    }
    let residue = &found.residue;
    if !residue.is_significant() {
        return Some(TOO_MANY.to_owned());
    }
    let terms = residue.asked_for.iter().filter(|_| residue.omitted_is_worth_a_word());
    let terms: Vec<String> = terms.take(MOST_TERMS).map(|term| format!("{} (z = {:.1})", term.words, term.z)).collect();
    let known = (!terms.is_empty()).then(|| format!("{} [{LETTERS}]", terms.join(", ")));
    let moments = residue.happened.iter().filter(|_| residue.moments_are_worth_a_word());
    let moments: Vec<String> =
        moments.take(MOST_TERMS).map(|moment| format!("{} (z = {:.1})", moment.words, moment.z)).collect();
    let moments = (!moments.is_empty()).then(|| moments.join(", "));
    let restless = (residue.air_ratio > RESTLESS)
        .then(|| format!("noise of the air {:.1} times as strong as believed", residue.air_ratio));
    let shape: Vec<String> = known.into_iter().chain(moments).chain(restless).collect();
    let acts = acts(residue).unwrap_or_default();
    let without = residue.instead_of.map_or(String::new(), |name| format!(" without {name}, which explains less,"));
    (!shape.is_empty()).then(|| format!("what is left{without} looks like {}{acts}", shape.join(", and ")))
}

/// The stage that most of it belongs to, in words.
fn acts(residue: &Residue) -> Option<String> {
    let nats = NAMES.map(|(stage, name)| (residue.nats_at(stage), name));
    let all: f64 = nats.iter().map(|(own, _)| own).sum();
    let (_, name) = nats.into_iter().find(|(own, _)| *own > 0.5 * all)?;
    Some(format!("; most of that belongs to the {name}"))
}
