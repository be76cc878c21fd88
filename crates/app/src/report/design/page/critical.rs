//! The page of critical gains: the models of the thesis compared with its rig, and with the third pole that explains
//! it.

use crate::report::design::critical_gain::{RIG, Row, Table};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{capital, glossary, minus, number, table, to_copy, values};
use crate::report::kit::page::record::Record;
use crate::report::kit::page::{Page, Section};
use maud::{Markup, html};

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The critical gains.
    pub found: &'a Table,
    /// The difference between each model and the rig, in words.
    pub gaps: &'a [String],
    /// The name of the config that the third pole was chosen for, and that pole as a patch, where requested.
    pub patch: Option<(&'a str, &'a str)>,
}

/// The page.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let found = report.found;
    let mut sections = vec![
        Section::across("models", "Models and rig", models(found)),
        Section::words("gap", "Errors of the models", gaps(report.gaps)),
    ];
    if let Some((_, patch)) = report.patch {
        sections.push(Section::words("simulator", "Correct the model", to_copy("patch", "third-pole.toml", patch)));
    }
    sections.push(Section::words("next", "What to do next", next(report.made)));
    sections.push(Section::words("words", "Words on this page", glossary(&WORDS)));
    let mut from = vec![format!("sampled every {} s", found.period_s)];
    from.extend(report.patch.map(|(config, _)| format!("model: {config}")));
    let record = Record { diagrams: Vec::new() };
    let (answer, first) = (answer(found), first(found));
    Page { kind: "design", from, made: report.made, answer: &answer, first, sections, record: &record }.render()
}

fn stable(found: &Table) -> usize {
    let models = found.rows.iter().take_while(|row| row.model != RIG);
    models.filter(|row| row.critical_kp_per_mm.is_none()).count()
}

fn answer(found: &Table) -> String {
    format!("In continuous time {} of the three models are stable at any gain; the rig is not", stable(found))
}

fn first(found: &Table) -> Markup {
    let line = |row: &Row| {
        let kp = row.sampled_critical_kp_per_mm.or(row.critical_kp_per_mm);
        let value = kp.map_or_else(|| "none".into(), |kp| format!("{} per mm", number(Some(kp), 4)));
        (row.model.clone(), value, format!("critical K_p at T_i = {} s", found.ti_s))
    };
    let rig = found.rows.iter().filter(|row| row.model == RIG).map(line);
    let chosen = found.rows.iter().skip_while(|row| row.model != RIG).skip(1);
    let poles = chosen.map(|row| {
        let value = format!("{} 1/s", number(row.fan_pole_per_s, 3));
        (row.model.clone(), value, "fan pole for which it has the critical gain of the rig".to_owned())
    });
    let numbers: Vec<(String, String, String)> = rig.chain(poles).collect();
    html! {
        p.lede {
            "A model with two poles is stable at any gain. The rig is not, because its fan has a pole as well. If this \
             pole is chosen so that a model has "
            "the critical gain of the rig, the model predicts the critical integral time, which was also measured and \
             not used."
        }
        h2.unseen { "The rig, and the pole that each model lacks" }
        div.first { (values(&numbers)) }
    }
}

fn models(found: &Table) -> Markup {
    let or_none = |value: Option<f64>, places: usize, none: &str| {
        html! { (value.map_or_else(|| none.to_owned(), |value| number(Some(value), places))) }
    };
    let row = |row: &Row| {
        let continuous = if row.model == RIG { "–" } else { "none" };
        let cells = vec![
            or_none(row.fan_pole_per_s, 3, "–"),
            or_none(row.critical_kp_per_mm, 4, continuous),
            or_none(row.sampled_critical_kp_per_mm, 4, "none"),
            or_none(row.critical_ti_s, 3, "none"),
        ];
        (html! { (row.model) }, cells)
    };
    let rows: Vec<_> = found.rows.iter().map(row).collect();
    let slowest = format!("critical T_i at K_p = {}, s", found.kp_per_mm);
    let heads = ["model", "fan's pole, 1/s", "critical K_p, continuous", "critical K_p, sampled", &slowest];
    table("Critical gains and integral times", &heads, &rows)
}

fn gaps(all: &[String]) -> Markup {
    html! { ul { @for gap in all { li { (capital(&minus(gap))) "." } } } }
}

fn next(made: &Made) -> Markup {
    html! {
        ul {
            li { "Measure the critical gain of your own rig: " (made.then("airball measure critical-gain")) "." }
            li { "Find the fan pole of your own model from it: "
                (made.then("airball identify third-pole --critical-gain K --patch-out third-pole.toml")) "." }
        }
    }
}

const WORDS: [(&str, &str); 3] = [
    ("critical", "The value at which the loop is marginally stable, with its other gains unchanged."),
    ("pole", "A mode of the plant: it decays faster the further left the pole is. The fan pole is 1 over the fan lag."),
    (
        "sampled",
        "The loop as the firmware runs it: one reading per period, and a duty that is held until the next one.",
    ),
];
