//! The rungs of the ladder in words, for terminal and page.

use super::words::whole_percent;
use config::words::Words;
use diagnose::{Closed, Diagnosis, Rung, Step};
use std::fmt::Write;

/// Width of the names of rungs, letters: that of the head in mm, and a space.
const WIDTH: usize = 26;

/// What a rung adds.
pub(super) fn name(rung: &Rung) -> String {
    match (rung.step, rung.name) {
        (Step::Believed, _) => "as believed".into(),
        (Step::Refitted, _) => "numbers refitted".into(),
        (Step::Removed, _) => "absent effects left out".into(),
        (Step::Effect, name) => format!("+ {}", name.unwrap_or_default()),
        (Step::Formula, _) => "+ formula".into(),
    }
}

/// The share of the gap that a rung closes, with its interval.
pub(super) fn share(rung: &Rung) -> Option<String> {
    let Closed { value, low, high } = rung.share?;
    let [value, low, high] = [value, low, high].map(whole_percent);
    Some(format!("{value} % ({low} to {high})"))
}

/// The share that an effect would close alone. A fit that needs the other effects closes nothing alone, and may forecast
/// far worse.
pub(super) fn alone(rung: &Rung) -> Option<String> {
    rung.alone.filter(|alone| *alone >= 0.0).map(|alone| format!("{} %", whole_percent(alone)))
}

/// The ladder as a table: a line for each rung, the lowest first, and one for noise alone. Its head is in the words of
/// the rig before it is aligned, since its unit may be longer.
pub(super) fn table(found: &Diagnosis, rig: &Words) -> String {
    let head = rig.of("error ahead, held out, mm");
    let wide = head.chars().count().max(WIDTH);
    let number = |mm: Option<f64>| mm.map_or("–".into(), |mm| format!("{mm:.2}"));
    let mut text = format!(
        "{head:<wide$}{:>8}{:>8}{:>8}{:>10}   {}",
        "0.1 s", "0.5 s", "1 s", "free run", "share of the gap at 1 s"
    );
    let mut line = |name: &str, errors: [Option<f64>; 3], free: Option<f64>, share: &str| {
        let [a, b, c] = errors.map(number);
        let row = format!("{name:<wide$}{a:>8}{b:>8}{c:>8}{:>10}   {share}", number(free));
        let _ = write!(text, "\n{}", row.trim_end());
    };
    for rung in &found.ladder {
        let alone = alone(rung).filter(|_| found.ladder.len() > 3);
        let alone = alone.map_or(String::new(), |alone| format!(", alone {alone}"));
        let share = share(rung).unwrap_or_default() + &alone;
        line(&name(rung), rung.error_mm, rung.free_run_10s_mm, &share);
    }
    let floor = &found.gaps[2];
    line("noise alone", floor.floor_mm, floor.floor_free_run_10s_mm, "");
    text
}
