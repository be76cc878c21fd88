//! The elements of pages: tables, bars, text to copy, numbers.

use crate::report::kit::words::NAMES;
use diagnose::{Check, Finding};
use maud::{Markup, html};
use plant::Effects;

/// On a phone, each row of a table with more columns than this is a block of its own.
const MANY: usize = 5;
/// A table with more rows than this is collapsed.
const LONG: usize = 16;

/// A table: caption, column heads, and rows that begin with their own head.
pub fn table(caption: &str, heads: &[&str], rows: &[(Markup, Vec<Markup>)]) -> Markup {
    html! {
        section.scroll tabindex="0" aria-label=(caption) {
            table class=[(heads.len() > MANY).then_some("many")] {
                caption { span { (caption) } }
                thead { tr { @for head in heads { th scope="col" { (head) } } } }
                tbody {
                    @for (head, cells) in rows {
                        tr {
                            th scope="row" { (head) }
                            @for (cell, name) in cells.iter().zip(heads.iter().skip(1)) { td data-head=(name) { (cell) } }
                        }
                    }
                }
            }
        }
    }
}

/// A table of words whose first column holds the row heads; a long one is collapsed.
pub fn words<const N: usize>(caption: &str, heads: &[&str; N], rows: &[[String; N]]) -> Markup {
    let row = |row: &[String; N]| {
        let mut cells = row.iter().map(|cell| html! { (minus(cell)) });
        (cells.next().unwrap_or_default(), cells.collect())
    };
    let rows: Vec<(Markup, Vec<Markup>)> = rows.iter().map(row).collect();
    html! {
        @if rows.len() > LONG {
            details { summary { (caption) ": all " (rows.len()) } (table(caption, heads, &rows)) }
        } @else { (table(caption, heads, &rows)) }
    }
}

/// Bars beside each other: caption, and for each its name, its colour, and its length if it has one.
pub fn bars(caption: &str, unit: &str, bars: &[(&str, &str, Option<f64>)], mark: Option<f64>) -> Markup {
    let longest = bars.iter().filter_map(|bar| bar.2).chain(mark).fold(1e-9, f64::max);
    let percent = |value: f64| format!("{:.1}", 100.0 * value / longest);
    let places = places_of_errors(mark);
    html! {
        table.bars {
            caption { (caption) }
            tbody {
                @for (name, ink, value) in bars {
                    tr {
                        th scope="row" { (name) }
                        td.number { (number(*value, places)) " " (unit) }
                        td.bar aria-hidden="true" {
                            svg viewBox="0 0 100 10" preserveAspectRatio="none" {
                                rect width=(percent(value.unwrap_or(0.0))) height="10" fill=(format!("var(--{ink})")) {}
                                @if let Some(mark) = mark {
                                    line x1=(percent(mark)) x2=(percent(mark)) y1="-4" y2="14" stroke="var(--recorded)"
                                        stroke-width="1.5" vector-effect="non-scaling-stroke" {}
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The first numbers of a page: name, value, and explanation of each.
pub fn values(all: &[(String, String, String)]) -> Markup {
    html! {
        div.gap {
            dl.values {
                @for (name, value, about) in all {
                    div {
                        dt { (name) }
                        dd { strong { (value) } @if !about.is_empty() { span { (about) } } }
                    }
                }
            }
        }
    }
}

/// The findings of the check of a record, or that there are none.
pub fn findings(all: &[String]) -> Markup {
    html! {
        @if all.is_empty() {
            p { "Rate, gaps, repeats, outliers and excitation were checked and are sufficient." }
        } @else {
            ul { @for finding in all { li { (finding) } } }
        }
    }
}

/// The checks of a record, each with whether it passed, and what was found; `was_checked`: whether it was made.
pub fn checks(findings: &[(&str, &Finding)], was_checked: impl Fn(Check) -> bool) -> Markup {
    html! {
        ul.checks {
            @for check in Check::ALL {
                @let found: Vec<&(&str, &Finding)> = findings.iter().filter(|(_, one)| one.check() == check).collect();
                @let (class, sign, said) = match (found.is_empty(), check) {
                    (true, check) if !was_checked(check) => ("noted", "–", "not checked: "),
                    (true, _) => ("passed", "✓", "passed: "),
                    (false, _) if found.iter().all(|(_, one)| one.is_note()) => ("noted", "•", "noted: "),
                    (false, _) => ("failed", "✗", "not passed: "),
                };
                // Rows that were left out: the sentence of the passed check would not be true.
                @let words = match check {
                    Check::Rows if !found.is_empty() => "some rows are left out, or averaged".into(),
                    check => check.words(),
                };
                li class=(class) {
                    span.sign aria-hidden="true" { (sign) } span.unseen { (said) } (words)
                    @for (name, finding) in found {
                        p { @if !name.is_empty() { (name) ": " } (finding) "." }
                    }
                }
            }
        }
    }
}

/// Words with a capital, as at the start of a sentence.
pub fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Words whose numbers have a minus sign instead of a hyphen; hyphens within words are kept.
pub fn minus(words: &str) -> String {
    let mut before = ' ';
    let mut letters = words.chars().peekable();
    let mut signed = String::with_capacity(words.len());
    while let Some(letter) = letters.next() {
        let is_sign = letter == '-' && !before.is_alphanumeric() && letters.peek().is_some_and(char::is_ascii_digit);
        signed.push(if is_sign { '−' } else { letter });
        before = letter;
    }
    signed
}

/// A command line. It may break between its words only: after a hyphen, a flag would read as two.
pub fn command(line: &str) -> Markup {
    html! {
        code.typed { @for (k, word) in line.split(' ').enumerate() { @if k > 0 { " " } span { (word) } } }
    }
}

/// Terms on a page, and their meaning.
pub fn glossary(all: &[(&str, &str)]) -> Markup {
    html! { dl { @for (word, meaning) in all { dt { (word) } dd { (meaning) } } } }
}

/// Text to copy into a file, with the file's name.
pub fn to_copy(id: &str, name: &str, text: &str) -> Markup {
    html! {
        div.code {
            div.about { span { code { (name) } } button type="button" data-copy=(id) hidden { "Copy" } }
            section.scroll tabindex="0" aria-label=(name) { pre id=(id) { code { (text.trim_end()) } } }
        }
    }
}

/// Half of the smallest number that six decimal places show.
const SMALLEST: f64 = 5e-7;

/// A number with this many decimal places; a dash where there is none.
pub fn number(value: Option<f64>, places: usize) -> String {
    let text = |value: f64| format!("{value:.places$}");
    let is_zero = |value: f64| text(value.abs()) == text(0.0);
    value.map_or_else(|| "–".into(), |value| minus(&text(if is_zero(value) { 0.0 } else { value })))
}

/// A number with three significant digits.
pub fn three_digits(value: f64) -> String {
    number(Some(value), places(value))
}

/// The decimal places of errors beside this noise floor: two significant digits of it, and one place at least.
pub fn places_of_errors(floor: Option<f64>) -> usize {
    floor.filter(|floor| *floor > SMALLEST).map_or(1, |floor| places(floor).saturating_sub(1).max(1))
}

/// The decimal places for three significant digits; none for 0.
pub fn places(value: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few places")]
    let places = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    if value.abs() < SMALLEST { 0 } else { places }
}

/// A name of the program in words: `dead_zone` is "dead zone".
pub fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

/// The stage of the signal path at which one of the effects acts.
pub fn stage(effects: &Effects, effect: &str) -> &'static str {
    let own = effects.entry(effect).and_then(|entry| NAMES.iter().find(|(stage, _)| *stage == entry.stage));
    own.map_or("–", |(_, name)| name)
}

/// A key with its unit in words: `position_mm` is "height" in "mm".
pub fn signal(name: &str) -> (&'static str, &'static str) {
    match name {
        "duty_percent" => ("duty", "%"),
        "position_mm" => ("height", "mm"),
        "velocity_mm_per_s" => ("speed", "mm/s"),
        "lag_s" => ("time since the duty moved", "s"),
        _ => ("time", "s"),
    }
}

#[cfg(test)]
mod tests {
    use super::places_of_errors;

    #[test]
    fn errors_have_two_digits_of_the_noise_floor_and_one_decimal_at_least() {
        let floors = [None, Some(0.0), Some(12.0), Some(7.1), Some(0.42), Some(0.046)];
        assert_eq!(floors.map(places_of_errors), [1, 1, 1, 1, 2, 3]);
    }
}
