//! A comparison in words, for a terminal.

use super::document::{Comparison, SideEntry};
use crate::report::kit::table::empty;
use crate::report::kit::words::digits;
use diagnose::NumberChange;

/// Half of a 90 % interval, standard deviations.
const OF_90_PERCENT: f64 = 1.645;

/// The answer in a sentence, without a full stop.
#[must_use]
pub fn answer(found: &Comparison) -> String {
    let mut changed: Vec<String> =
        found.numbers.iter().filter(|one| one.is_beyond_chance).map(|one| name(one).replace('_', " ")).collect();
    changed.extend(found.lateness.filter(|late| late.is_beyond_chance).map(|_| "lateness of the cycles".into()));
    match changed.as_slice() {
        [] if found.is_together_beyond_chance == Some(true) => {
            "The rig changed beyond chance, but no single number of it does: they changed together".into()
        }
        [] => "No number of the rig changed beyond chance".into(),
        [one] => format!("One number of the rig changed beyond chance: {one}"),
        all => format!("{} numbers of the rig changed beyond chance: {}", all.len(), all.join(", ")),
    }
}

/// A number, as the config below `[plant]` names it.
#[must_use]
pub fn name(one: &NumberChange) -> String {
    if one.table.is_empty() { one.key.clone() } else { format!("{}.{}", one.table, one.key) }
}

/// Name, before, after, difference with its 90 % interval, and the judgement.
#[must_use]
pub fn row(one: &NumberChange) -> [String; 5] {
    let difference = one.after - one.before;
    let interval = one.deviation.map_or(String::new(), |sigma| format!(" ± {}", digits(OF_90_PERCENT * sigma)));
    let said = match (one.is_beyond_chance, one.deviation) {
        (true, _) => "changed",
        (false, Some(_)) => "within chance",
        (false, None) => "not determined",
    };
    [name(one), digits(one.before), digits(one.after), digits(difference) + &interval, said.into()]
}

/// The effects of a side.
#[must_use]
pub fn effects(side: &SideEntry) -> String {
    let one = |(name, probability): &(String, f64)| format!("{name} ({:.0} %)", 100.0 * probability);
    let all: Vec<String> = side.effects.iter().map(one).collect();
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

/// The comparison, line by line.
#[must_use]
pub fn lines(found: &Comparison) -> Vec<String> {
    let [before, after] = &found.sides;
    let mut lines = vec![format!("{}.", answer(found))];
    lines.push(format!("before    {}: effects {}", before.name, effects(before)));
    lines.push(format!("after     {}: effects {}", after.name, effects(after)));
    let mut table = empty(["number of the rig", "before", "after", "difference, 90 %", ""]);
    found.numbers.iter().for_each(|one| {
        table.add_row(row(one));
    });
    lines.push(table.to_string());
    if !found.of_one_model {
        lines.push(
            "The numbers are of the models of two diagnoses. Where these have different effects, compare the two logs \
             instead."
                .into(),
        );
    }
    lines.extend(errors(found));
    lines.extend(found.lateness.map(|late| {
        let said = if late.is_beyond_chance { "changed" } else { "within chance" };
        format!(
            "95 % of the cycles began within {:.3} ms before, {:.3} ms after: {said}.",
            late.before_ms, late.after_ms
        )
    }));
    lines
}

/// The errors of both models on both records.
fn errors(found: &Comparison) -> Option<String> {
    let [on_before, on_after] = found.error_mm?;
    let mm = |value: Option<f64>| value.map_or_else(|| "–".into(), |mm| format!("{mm:.2}"));
    let mut table = empty(["error 1 s ahead, mm", "record before", "record after"]);
    for (at, name) in ["model fitted to before", "model fitted to after"].into_iter().enumerate() {
        table.add_row([name.to_owned(), mm(on_before[at]), mm(on_after[at])]);
    }
    Some(table.to_string())
}
