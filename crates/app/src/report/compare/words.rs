//! A comparison in words, for a terminal.

use super::document::{ABSENT, Comparison, OF_90_PERCENT, SideEntry};
use crate::report::kit::page::parts::{capital, spoken};
use crate::report::kit::table::{self, empty};
use crate::report::kit::words::digits;
use config::words::Words;
use diagnose::{NumberChange, chance_in_words, decimals};

/// Ends of the keys of a config, and the units that they say; longer ends first.
const UNITS: [(&str, &str); 13] = [
    ("_mm_per_s2_per_percent", "mm/s² per %"),
    ("_psd_mm2_per_s3", "mm²/s³"),
    ("_mm_per_s2", "mm/s²"),
    ("_percent_per_s", "% per s"),
    ("_s_per_mm", "s/mm"),
    ("_per_s2", "1/s²"),
    ("_mm_per_s", "mm/s"),
    ("_per_mm", "1/mm"),
    ("_per_s", "1/s"),
    ("_duty_percent", "%"),
    ("_percent", "%"),
    ("_mm", "mm"),
    ("_s", "s"),
];

/// The answer in a sentence, without a full stop.
#[must_use]
pub fn answer(found: &Comparison) -> String {
    let effects: Vec<String> =
        found.only_one_side().map(|(name, is_before)| one_side(found, name, is_before)).collect();
    let numbers = of_numbers(found);
    match effects.as_slice() {
        [] => numbers,
        all if is_any(found) => format!("{}. {numbers}", capital(&all.join(", "))),
        all => format!("{}; no number that both sides have changed beyond chance", capital(&all.join(", "))),
    }
}

/// What happened to an effect that one side names. Where one model is fitted to both logs, its numbers decide.
fn one_side(found: &Comparison, name: &str, is_before: bool) -> String {
    let own = |one: &&NumberChange| one.table == name;
    let is_chance = found.of_one_model && !found.numbers.iter().filter(own).any(|one| one.is_beyond_chance);
    let (effect, vanished) = name.strip_prefix(ABSENT).map_or((name, is_before), |absent| (absent, !is_before));
    let happened = if vanished { "vanished" } else { "appeared" };
    let (effect, side) = (spoken(effect), if is_before { "the first log" } else { "the second log" });
    if is_chance && !found.numbers.iter().any(|one| own(&one)) {
        return format!("{effect} is named in {side} only");
    }
    if is_chance {
        return format!("{effect} is named in {side} only, though none of its numbers differs beyond chance");
    }
    format!("{effect} {happened}")
}

/// Whether anything is beyond chance.
fn is_any(found: &Comparison) -> bool {
    let numbers = found.numbers.iter().any(|one| one.is_beyond_chance) || found.is_together_beyond_chance == Some(true);
    numbers || found.lateness.is_some_and(|late| late.is_beyond_chance)
}

/// What is said of the numbers.
fn of_numbers(found: &Comparison) -> String {
    let mut changed: Vec<String> = found.numbers.iter().filter(|one| one.is_beyond_chance).map(in_words).collect();
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

/// A number in words, with its unit.
fn in_words(one: &NumberChange) -> String {
    let (key, unit) =
        UNITS.iter().find_map(|(end, unit)| Some((one.key.strip_suffix(end)?, *unit))).unwrap_or((&one.key, ""));
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    let of = match one.table.as_str() {
        "" | "noise" => one.table.clone(),
        effect => format!("of the {}", spoken(effect)),
    };
    let words = match of.as_str() {
        "noise" => format!("noise of the {}", spoken(key)),
        _ => format!("{} {of}", spoken(key)),
    };
    format!("{}{unit}", words.trim_end())
}

/// A number, as the config below `[plant]` names it.
#[must_use]
pub fn name(one: &NumberChange) -> String {
    if one.table.is_empty() { one.key.clone() } else { format!("{}.{}", one.table, one.key) }
}

/// Name, before, after, difference with its 90 % interval, and the judgement of this one among `all` numbers.
#[must_use]
pub fn row(one: &NumberChange, all: usize) -> [String; 5] {
    let difference = one.after - one.before;
    let reach = one.deviation.map(|sigma| OF_90_PERCENT * sigma);
    let said = match (one.is_beyond_chance, reach) {
        (true, _) => "changed".into(),
        // Of many 90 % intervals some leave out 0 by chance.
        (false, Some(reach)) if difference.abs() > reach => format!("within chance, as one of {all} numbers"),
        (false, Some(_)) => "within chance".into(),
        (false, None) => "not determined".into(),
    };
    let difference = reach.map_or_else(
        || digits(difference),
        |reach| {
            let places = decimals(reach);
            format!("{:.places$} ± {reach:.places$}", difference + 0.0)
        },
    );
    [name(one), digits(one.before), digits(one.after), difference, said]
}

/// The effects of a side.
#[must_use]
pub fn effects(side: &SideEntry) -> String {
    let one = |(name, probability): &(String, f64)| format!("{name} ({})", chance_in_words(*probability));
    let all: Vec<String> = side.effects.iter().map(one).collect();
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

/// The comparison, line by line, in the words of the rig.
#[must_use]
pub fn lines(found: &Comparison, rig: &Words) -> Vec<String> {
    let [before, after] = &found.sides;
    let mut lines = vec![rig.of(&format!("{}.", answer(found)))];
    lines.push(format!("before    {}: effects {}", before.name, rig.of(&effects(before))));
    lines.push(format!("after     {}: effects {}", after.name, rig.of(&effects(after))));
    let mut table = empty(["number of the rig", "before", "after", "difference, 90 %", ""]);
    found.numbers.iter().for_each(|one| {
        table.add_row(row(one, found.numbers.len()));
    });
    lines.push(table::in_words(&table, rig));
    if !found.of_one_model {
        lines.push(
            "The numbers are of the models of two diagnoses. Where these have different effects, compare the two logs \
             instead."
                .into(),
        );
    }
    lines.extend(errors(found, rig));
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
fn errors(found: &Comparison, rig: &Words) -> Option<String> {
    let [on_before, on_after] = found.error_mm?;
    let mm = |value: Option<f64>| value.map_or_else(|| "–".into(), |mm| format!("{mm:.2}"));
    let mut table = empty(["error 1 s ahead, mm", "record before", "record after"]);
    for (at, name) in ["model fitted to before", "model fitted to after"].into_iter().enumerate() {
        table.add_row([name.to_owned(), mm(on_before[at]), mm(on_after[at])]);
    }
    Some(table::in_words(&table, rig))
}

#[cfg(test)]
mod tests {
    use super::{Comparison, SideEntry, answer, in_words, row};
    use diagnose::NumberChange;

    fn compared(before: &[&str], after: &[&str]) -> Comparison {
        let side = |effects: &[&str]| SideEntry {
            name: "a.json".into(),
            verdict: "effect".into(),
            effects: effects.iter().map(|name| ((*name).to_owned(), 0.98)).collect(),
            error_mm: None,
            overshoot_percent: None,
            settling_s: None,
        };
        Comparison::of_documents([side(before), side(after)], &[serde_json::Value::Null, serde_json::Value::Null])
    }

    #[test]
    fn an_effect_of_one_side_is_in_the_headline() {
        let said = answer(&compared(&["dead_zone"], &[]));
        assert_eq!(said, "Dead zone vanished; no number that both sides have changed beyond chance");
        let said = answer(&compared(&[], &["fan_lag", "no play"]));
        assert!(said.starts_with("Fan lag appeared, play vanished;"), "{said}");
        let said = answer(&Comparison { of_one_model: true, ..compared(&[], &["fan_lag"]) });
        assert!(said.starts_with("Fan lag is named in the second log only; no number"), "{said}");
        let numbers = vec![NumberChange::new("fan_lag", "time_constant_s", [0.0, 0.1], [None, None])];
        let said = answer(&Comparison { of_one_model: true, numbers, ..compared(&[], &["fan_lag"]) });
        assert!(said.starts_with("Fan lag is named in the second log only, though none of its numbers"), "{said}");
        assert_eq!(answer(&compared(&["play"], &["play"])), "No number of the rig changed beyond chance");
    }

    #[test]
    fn a_number_has_words_and_a_unit_and_no_more_digits_than_its_interval() {
        let one = |table: &str, key: &str, after: f64, sigma: f64| NumberChange {
            deviation: Some(sigma),
            ..NumberChange::new(table, key, [0.0, after], [None, None])
        };
        assert_eq!(in_words(&one("", "gain_mm_per_s2_per_percent", 1.0, 1.0)), "gain (mm/s² per %)");
        let friction = one("wall_friction", "acceleration_mm_per_s2", 43.6123, 1010.3);
        assert_eq!(in_words(&friction), "acceleration of the wall friction (mm/s²)");
        assert_eq!(in_words(&one("noise", "sensor_mm", 1.0, 1.0)), "noise of the sensor (mm)");
        assert_eq!(row(&friction, 7)[3..], ["44 ± 1662", "within chance"]);
        assert_eq!(row(&one("", "drag_per_s", -12.09, 7.3), 7)[4], "within chance, as one of 7 numbers");
    }
}
