//! What pages are made of: tables, bars, text to copy, numbers.

use maud::{Markup, html};
use plant::{Effects, Stage};

/// A table: what it shows, the heads of its columns, and rows that begin with their own head.
pub(super) fn table(caption: &str, heads: &[&str], rows: &[(Markup, Vec<Markup>)]) -> Markup {
    html! {
        section.scroll tabindex="0" aria-label=(caption) {
            table {
                caption { (caption) }
                thead { tr { @for head in heads { th scope="col" { (head) } } } }
                tbody {
                    @for (head, cells) in rows {
                        tr { th scope="row" { (head) } @for cell in cells { td { (cell) } } }
                    }
                }
            }
        }
    }
}

/// Bars beside each other: what they are, and for each its name, the ink that it is drawn with, and its length if it has one.
pub(super) fn bars(caption: &str, unit: &str, bars: &[(&str, &str, Option<f64>)], mark: Option<f64>) -> Markup {
    let longest = bars.iter().filter_map(|bar| bar.2).chain(mark).fold(1e-9, f64::max);
    let percent = |value: f64| format!("{:.1}", 100.0 * value / longest);
    html! {
        table.bars {
            caption { (caption) }
            tbody {
                @for (name, ink, value) in bars {
                    tr {
                        th scope="row" { (name) }
                        td.number { (number(*value, 1)) " " (unit) }
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

/// Text to be copied into a file, with the name that it should have.
pub(super) fn to_copy(id: &str, name: &str, text: &str) -> Markup {
    html! {
        div.code {
            div.about { span { code { (name) } } button type="button" data-copy=(id) hidden { "Copy" } }
            section.scroll tabindex="0" aria-label=(name) { pre id=(id) { code { (text.trim_end()) } } }
        }
    }
}

/// A number with so many places; a dash where there is none.
pub(crate) fn number(value: Option<f64>, places: usize) -> String {
    let text = |value: f64| format!("{value:.places$}");
    let is_zero = |value: f64| text(value.abs()) == text(0.0);
    value.map_or_else(|| "–".into(), |value| text(if is_zero(value) { 0.0 } else { value }).replace('-', "−"))
}

/// A number with as many places as a reader needs: three digits that count.
pub(super) fn three_digits(value: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few places")]
    let places = (2.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    number(Some(value), places)
}

/// A chance in words that do not promise certainty.
pub(crate) fn chance(chance: f64) -> String {
    match 100.0 * chance {
        percent if percent > 99.0 => "more than 99 %".into(),
        percent if percent < 1.0 => "less than 1 %".into(),
        percent => format!("{percent:.0} %"),
    }
}

/// A name of the program in words: `dead_zone` is "dead zone".
pub(crate) fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

/// The stage of the signal path at which an effect acts.
pub(crate) fn stage(effect: &str) -> &'static str {
    match Effects::entry(effect).map(|entry| entry.stage) {
        Some(Stage::Actuator) => "actuator",
        Some(Stage::Air) => "air",
        Some(Stage::Ball) => "ball",
        Some(Stage::Sensor) => "sensor",
        None => "–",
    }
}

/// A key with its unit in words: `position_mm` is "height" in "mm".
pub(super) fn signal(name: &str) -> (&'static str, &'static str) {
    match name {
        "duty_percent" => ("duty", "%"),
        "position_mm" => ("height", "mm"),
        "velocity_mm_per_s" => ("speed", "mm/s"),
        _ => ("time", "s"),
    }
}
