//! The shape of what no effect explains, in words.

use crate::report::kit::words::NAMES;
use diagnose::thresholds::AIR_RATIO;
use diagnose::{Diagnosis, Misfit, Verdict};

/// Terms that a sentence names at most.
const MOST_TERMS: usize = 3;
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
    let misfit = &found.misfit;
    if !misfit.is_significant() {
        return Some(TOO_MANY.to_owned());
    }
    let terms = misfit.omitted_terms.iter().filter(|_| misfit.omitted_is_reported());
    let terms: Vec<String> = terms.take(MOST_TERMS).map(|term| format!("{} (z = {:.1})", term.words, term.z)).collect();
    let known = (!terms.is_empty()).then(|| format!("{} [{LETTERS}]", terms.join(", ")));
    let moments = misfit.event_terms.iter().filter(|_| misfit.events_are_reported());
    let moments: Vec<String> =
        moments.take(MOST_TERMS).map(|moment| format!("{} (z = {:.1})", moment.words, moment.z)).collect();
    let moments = (!moments.is_empty()).then(|| moments.join(", "));
    let restless = (misfit.air_ratio > AIR_RATIO)
        .then(|| format!("noise of the air {:.1} times as strong as believed", misfit.air_ratio));
    let shape: Vec<String> = known.into_iter().chain(moments).chain(restless).collect();
    let acts = acts(misfit).unwrap_or_default();
    let without = misfit.outdone_effect.map_or(String::new(), |name| format!(" without {name}, which explains less,"));
    (!shape.is_empty()).then(|| format!("what is left{without} looks like {}{acts}", shape.join(", and ")))
}

/// The stage that most of it belongs to, in words.
fn acts(misfit: &Misfit) -> Option<String> {
    let nats = NAMES.map(|(stage, name)| (misfit.nats_at(stage), name));
    let all: f64 = nats.iter().map(|(own, _)| own).sum();
    let (_, name) = nats.into_iter().find(|(own, _)| *own > 0.5 * all)?;
    Some(format!("; most of that belongs to the {name}"))
}
