//! The whole record: as pictures without a script, and as numbers for the charts that zoom.

use super::figure::{Size, picture};
use crate::report::plot::Diagram;
use maud::{Markup, html};
use serde::Serialize;
use std::collections::BTreeMap;

/// Rows that a chart zooms into at most: 3 MB are enough for a page.
const MOST_ROWS: usize = 12_000;

/// Diagrams over one time, below each other.
#[derive(Default)]
pub(super) struct Record {
    pub(super) diagrams: Vec<Diagram>,
}

/// How the charts are used, for those whose browser runs the script.
pub(super) fn how_to_zoom() -> Markup {
    html! {
        p.script-only hidden {
            "Drag across a chart to zoom, double-click to see all again; or use the buttons, or + and −, the arrow keys and 0 on a chart."
        }
    }
}

/// A chart as the script reads it: one column of times, and a column for each line.
#[derive(Serialize)]
struct Chart {
    ordinate: &'static str,
    times: Vec<f64>,
    lines: Vec<Column>,
    shaded: Vec<(f64, f64)>,
}

#[derive(Serialize)]
struct Column {
    label: &'static str,
    ink: String,
    values: Vec<Option<f64>>,
}

impl Record {
    /// The pictures, each of which the script replaces by a chart.
    pub(super) fn still(&self, alts: &[&str]) -> Markup {
        html! {
            div #record-charts {
                @for (diagram, alt) in self.diagrams.iter().zip(alts) {
                    div.still { (picture(diagram, Size::WIDE, alt)) }
                }
            }
        }
    }

    /// The numbers, safe inside a script.
    pub(super) fn json(&self) -> String {
        let charts: Vec<Chart> = self.diagrams.iter().map(Chart::of).collect();
        // A list of numbers and of words of this program always serialises.
        serde_json::to_string(&charts).unwrap_or_default().replace('<', "\\u003c")
    }
}

impl Chart {
    fn of(diagram: &Diagram) -> Self {
        let rounded = |value: f64, to: f64| (value * to).round() / to;
        let mut rows: BTreeMap<i64, Vec<Option<f64>>> = BTreeMap::new();
        for (number, line) in diagram.lines.iter().enumerate() {
            for (time_s, value) in line.points.iter().filter(|point| point.0.is_finite() && point.1.is_finite()) {
                #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
                let row = rows.entry((1e3 * time_s).round() as i64).or_insert_with(|| vec![None; diagram.lines.len()]);
                row[number] = Some(rounded(*value, 100.0));
            }
        }
        let every = rows.len().div_ceil(MOST_ROWS).max(1);
        let kept = || rows.iter().step_by(every);
        let column = |number: usize, label, colour| Column {
            label,
            ink: crate::report::palette::name(colour).to_owned(),
            values: kept().map(|(_, row)| row[number]).collect(),
        };
        Self {
            ordinate: diagram.ordinate,
            times: kept().map(|(ms, _)| *ms as f64 / 1e3).collect(),
            lines: diagram.lines.iter().enumerate().map(|(k, line)| column(k, line.label, line.colour)).collect(),
            shaded: diagram.shaded.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Record;
    use crate::report::palette::{MENDED, RECORDED};
    use crate::report::plot::{Diagram, Line};

    #[test]
    fn a_chart_has_one_row_a_time_and_nothing_where_a_line_has_no_point() {
        let line = |label, colour, points: &[(f64, f64)]| Line { label, colour, points: points.to_vec() };
        let lines = vec![
            line("recorded", RECORDED, &[(0.0, 1.0), (0.02, 2.0)]),
            line("mended", MENDED, &[(0.02, 2.5), (f64::NAN, f64::NAN), (0.04, 3.0)]),
        ];
        let record = Record { diagrams: vec![Diagram { ordinate: "</script>", lines, ..Diagram::default() }] };
        let json = record.json();
        assert!(!json.contains('<'), "{json}");
        let charts: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(charts[0]["times"], serde_json::json!([0.0, 0.02, 0.04]));
        assert_eq!(charts[0]["lines"][0]["values"], serde_json::json!([1.0, 2.0, null]));
        assert_eq!(charts[0]["lines"][1]["values"], serde_json::json!([null, 2.5, 3.0]));
        assert_eq!(charts[0]["lines"][1]["ink"], "mended");
    }

    #[test]
    fn a_long_record_is_thinned_to_what_a_page_bears() {
        let points = (0..100_000).map(|k| (0.01 * f64::from(k), f64::from(k % 500) / 7.0)).collect();
        let lines = vec![Line { label: "recorded", colour: RECORDED, points }];
        let json = Record { diagrams: vec![Diagram { lines, ..Diagram::default() }] }.json();
        assert!(json.len() < 200_000, "{}", json.len());
    }
}
