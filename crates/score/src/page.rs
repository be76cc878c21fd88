//! The score of many blind diagnoses as tables in Markdown, for a terminal or a page.

use crate::{Calibration, Loss, Numbers, ParameterScore, Proportion, Score};
use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{CellAlignment, Table};
use serde::Serialize;
use std::collections::BTreeMap;

/// The document that `blind --json` writes.
#[derive(Debug, Serialize)]
pub struct BlindDocument {
    /// Name and version of this document.
    pub schema: &'static str,
    /// Number of answers with each verdict.
    pub answers: BTreeMap<&'static str, usize>,
    /// Cases that could not be read.
    pub unreadable: usize,
    /// The score, if the truth is known.
    pub score: Option<Score>,
}

/// The document as a page.
#[must_use]
pub fn page(document: &BlindDocument) -> String {
    let answers = document.answers.iter().map(|(verdict, count)| format!("{count} {verdict}"));
    let unreadable = (document.unreadable > 0).then(|| format!("{} unreadable", document.unreadable));
    let all = document.unreadable + document.answers.values().sum::<usize>();
    let answers = answers.chain(unreadable).collect::<Vec<_>>().join(", ");
    let counted = format!("{all} cases: {answers}");
    let Some(score) = &document.score else { return counted };
    let kinds: Vec<String> = score.cases.iter().map(|(kind, count)| format!("{count} {}", kind.word())).collect();
    let mut parts = vec![format!("{counted}\nin truth: {}", kinds.join(", ")), shares(score), means(score)];
    parts.push(format!("Probabilities\n\n{}", bins(&score.calibration)));
    parts.push(format!("Estimated numbers\n\n{}", numbers(&score.numbers)));
    parts.push(if score.losses.is_empty() {
        "No losses.".into()
    } else {
        format!("Losses: {}\n\n{}", score.losses.len(), losses(&score.losses))
    });
    parts.join("\n\n")
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_preset(ASCII_MARKDOWN).set_header(header);
    table
}

fn finished(mut table: Table, numbers_from: usize) -> String {
    for column in table.column_iter_mut().skip(numbers_from) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.to_string()
}

fn shares(score: &Score) -> String {
    let mut table = table(&["share", "of", "%", "95 % interval"]);
    for share in &score.shares {
        let Proportion { count, n, .. } = share.proportion;
        table.add_row([share.what.into(), format!("{count} of {n}"), points(share.proportion), ends(share.proportion)]);
    }
    finished(table, 1)
}

fn points(proportion: Proportion) -> String {
    proportion.share.map_or("–".into(), |share| format!("{:.1}", 100.0 * share))
}

fn ends(proportion: Proportion) -> String {
    if proportion.n == 0 {
        return "–".into();
    }
    format!("{:.1} to {:.1}", 100.0 * proportion.low, 100.0 * proportion.high)
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("–".into(), |value| format!("{value:.digits$}"))
}

fn means(score: &Score) -> String {
    let mut table = table(&["number", ""]);
    let points = score.median_closed_difference.map(|difference| 100.0 * difference);
    for (what, value) in [
        ("names in a set, twins counted once, mean", number(score.mean_set_size, 2)),
        ("Brier score of the probabilities", number(score.calibration.brier, 3)),
        ("closed share, median distance from that of the true effects, points", number(points, 1)),
    ] {
        table.add_row([what.into(), value]);
    }
    finished(table, 1)
}

fn bins(calibration: &Calibration) -> String {
    let mut table = table(&["probability", "entries", "mean", "share right"]);
    for bin in &calibration.bins {
        table.add_row([
            format!("{:.1} to {:.1}", bin.from, bin.to),
            bin.entries.to_string(),
            number(bin.mean_probability, 2),
            number(bin.share_right, 2),
        ]);
    }
    finished(table, 1)
}

fn numbers(numbers: &Numbers) -> String {
    let mut table = table(&[
        "parameter",
        "90 % intervals that hold the truth",
        "%",
        "95 % interval",
        "no interval",
        "median width",
        "median bound",
        "width / bound",
        "error, %",
    ]);
    let mut row = |name: &str, score: &ParameterScore| {
        let covered = score.covered;
        table.add_row([
            name.into(),
            format!("{} of {}", covered.count, covered.n),
            points(covered),
            ends(covered),
            score.without_interval.to_string(),
            number(score.median_width, 4),
            number(score.median_bound, 4),
            number(score.median_width_over_bound, 2),
            number(score.median_relative_error.map(|error| 100.0 * error), 1),
        ]);
    };
    row("gain, drag, hover", &numbers.base);
    row("of effects", &numbers.effects);
    for (name, score) in &numbers.parameters {
        row(name, score);
    }
    finished(table, 1)
}

fn losses(losses: &[Loss]) -> String {
    let mut table = table(&["case", "kind", "loss", "truth", "answer", "nats at best", "nats shown"]);
    for loss in losses {
        let kind = if loss.left_out { "left out" } else { loss.kind.word() };
        let (nats, shown) = (number(loss.nats, 1), number(loss.shown, 1));
        table.add_row([loss.case.as_str(), kind, loss.outcome.word(), &loss.truth, &loss.answer, &nats, &shown]);
    }
    table.to_string()
}
