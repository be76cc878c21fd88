//! The whole record: as pictures without a script, and as data for the charts that zoom.

use super::figure::{Size, picture};
use super::parts::words as words_table;
use crate::report::kit::plot::{Diagram, Line, Timeline, extremes};
use config::words::Words;
use maud::{Markup, html};
use serde::Serialize;
use std::collections::BTreeMap;

/// Largest number of rows for a chart that zooms: 3 MB are enough for a page.
const MOST_ROWS: usize = 12_000;

/// Diagrams over the same time, below each other.
#[derive(Default)]
pub struct Record {
    pub diagrams: Vec<Diagram>,
}

/// How the charts are used, for those whose browser runs the script.
pub fn how_to_zoom() -> Markup {
    html! {
        p.script-only hidden {
            "Drag across a chart to zoom, double-click to see all again; or use the buttons, or + and −, the arrow keys and 0 on a chart."
        }
    }
}

/// The events of a record, numbered as they follow each other.
pub fn events(timeline: &Timeline) -> Markup {
    let rows: Vec<[String; 2]> =
        timeline.events.iter().map(|(time_s, text)| [format!("{time_s:.2}"), text.clone()]).collect();
    html! { @if !rows.is_empty() { (words_table("Events: the dashed lines in the charts", &["time, \
    s", "event"], &rows)) } }
}

/// A chart as the script reads it: one column of times, and a column for each line.
#[derive(Serialize)]
struct Chart {
    ordinate: String,
    /// Decimal places of every value.
    places: usize,
    times: Vec<f64>,
    lines: Vec<Column>,
    shaded: Vec<(f64, f64)>,
    /// Times at which a line is broken, and those of events.
    breaks: Vec<f64>,
    events: Vec<f64>,
}

#[derive(Serialize)]
struct Column {
    label: String,
    ink: String,
    /// Whether the line is continuous across missing values.
    whole: bool,
    values: Vec<Option<f64>>,
}

impl Record {
    /// The pictures, each of which the script replaces by a chart.
    pub fn still(&self, alts: &[&str]) -> Markup {
        html! {
            div #record-charts {
                @for (diagram, alt) in self.diagrams.iter().zip(alts) {
                    div.still { (picture(diagram, Size::WIDE, alt)) }
                }
            }
        }
    }

    /// The numbers, safe inside a script.
    pub fn json(&self, words: &Words) -> String {
        let charts: Vec<Chart> = self.diagrams.iter().map(|diagram| Chart::of(diagram, words)).collect();
        // A list of numbers and of words of this program always serialises.
        serde_json::to_string(&charts).unwrap_or_default().replace('<', "\\u003c")
    }
}

impl Chart {
    fn of(diagram: &Diagram, words: &Words) -> Self {
        let places = places(diagram);
        #[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a few places")]
        let unit = 10_f64.powi(places as i32);
        // A line without a point would only appear in the key.
        let lines: Vec<&Line> = diagram.lines.iter().filter(|line| line.points.iter().any(|p| is_there(&p))).collect();
        let mut rows: BTreeMap<i64, Vec<Option<f64>>> = BTreeMap::new();
        for (number, line) in lines.iter().enumerate() {
            for (time_s, value) in line.points.iter().filter(is_there) {
                #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
                let row = rows.entry((1e3 * time_s).round() as i64).or_insert_with(|| vec![None; lines.len()]);
                row[number] = Some((value * unit).round() / unit);
            }
        }
        let rows = thinned(rows.into_iter().collect(), lines.len());
        let column = |(number, line): (usize, &&Line)| Column {
            label: words.of(line.label),
            ink: crate::report::kit::palette::name(line.colour).to_owned(),
            whole: line.points.iter().all(|point| is_there(&point)),
            values: rows.iter().map(|(_, row)| row[number]).collect(),
        };
        Self {
            ordinate: words.of(diagram.ordinate),
            places,
            times: rows.iter().map(|(ms, _)| *ms as f64 / 1e3).collect(),
            lines: lines.iter().enumerate().map(column).collect(),
            shaded: diagram.shaded.clone(),
            breaks: diagram.timeline.breaks.clone(),
            events: diagram.timeline.events.iter().map(|event| event.0).collect(),
        }
    }
}

/// A time in milliseconds, and the value of each line then.
type Row = (i64, Vec<Option<f64>>);

/// At most [`MOST_ROWS`] rows: two for each stretch of time, with the least and the greatest value of each line in
/// their order, so that no peak and no line is lost.
fn thinned(rows: Vec<Row>, lines: usize) -> Vec<Row> {
    if rows.len() <= MOST_ROWS {
        return rows;
    }
    let both = |stretch: &[Row]| {
        let of_line = |line: usize| {
            let points = stretch.iter().filter_map(|(ms, values)| Some((*ms as f64, values[line]?)));
            extremes(&points.collect::<Vec<_>>())
        };
        let pairs: Vec<_> = (0..lines).map(of_line).collect();
        let row = |at: usize, ms: i64| (ms, pairs.iter().map(|pair| pair.map(|points| points[at].1)).collect());
        [row(0, stretch[0].0), row(1, stretch[stretch.len() / 2].0)]
    };
    rows.chunks(rows.len().div_ceil(MOST_ROWS / 2)).flat_map(both).collect()
}

fn is_there(point: &&(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Enough decimal places for a ten-thousandth of the visible range, and at least two.
fn places(diagram: &Diagram) -> usize {
    let values = || diagram.lines.iter().flat_map(|line| &line.points).filter(is_there).map(|point| point.1);
    let span = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few places")]
    let places = (4.0 - span.max(1e-9).log10().floor()).clamp(2.0, 6.0) as usize;
    places
}

#[cfg(test)]
mod tests {
    use super::{Chart, Record};
    use crate::report::kit::palette::{MENDED, RECORDED};
    use crate::report::kit::plot::{Diagram, Line};
    use config::words::Words;

    #[test]
    fn a_chart_has_one_row_a_time_and_nothing_where_a_line_has_no_point() {
        let line = |label, colour, points: &[(f64, f64)]| Line { label, colour, points: points.to_vec() };
        let lines = vec![
            line("recorded", RECORDED, &[(0.0, 1.0), (0.02, 2.0)]),
            line("mended", MENDED, &[(0.02, 2.5), (f64::NAN, f64::NAN), (0.04, 3.0)]),
            line("never read", MENDED, &[(f64::NAN, f64::NAN)]),
        ];
        let record = Record { diagrams: vec![Diagram { ordinate: "</script>", lines, ..Diagram::default() }] };
        let json = record.json(&Words::default());
        assert!(!json.contains('<'), "{json}");
        let charts: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(charts[0]["times"], serde_json::json!([0.0, 0.02, 0.04]));
        assert_eq!(charts[0]["lines"][0]["values"], serde_json::json!([1.0, 2.0, null]));
        // The script bridges missing readings, and leaves gaps between the forecasts of a model.
        assert_eq!([&charts[0]["lines"][0]["whole"], &charts[0]["lines"][1]["whole"]], [true, false]);
        assert_eq!(charts[0]["lines"][1]["values"], serde_json::json!([null, 2.5, 3.0]));
        assert_eq!(charts[0]["lines"][1]["ink"], "mended");
        assert_eq!(charts[0]["lines"].as_array().unwrap().len(), 2);
    }

    #[test]
    fn a_share_of_a_step_keeps_the_digits_that_a_position_does_not_need() {
        let line = |points| Line { label: "recorded", colour: RECORDED, points };
        let of = |points| Chart::of(&Diagram { lines: vec![line(points)], ..Diagram::default() }, &Words::default());
        assert_eq!(of(vec![(0.0, 0.0), (1.0, 1.042_31)]).lines[0].values[1], Some(1.0423));
        assert_eq!(of(vec![(0.0, 0.0), (1.0, 412.042_31)]).lines[0].values[1], Some(412.04));
    }

    #[test]
    fn a_long_record_is_thinned_to_what_a_page_bears() {
        let points = (0..100_000).map(|k| (0.01 * f64::from(k), f64::from(k % 500) / 7.0)).collect();
        let lines = vec![Line { label: "recorded", colour: RECORDED, points }];
        let json = Record { diagrams: vec![Diagram { lines, ..Diagram::default() }] }.json(&Words::default());
        assert!(json.len() < 200_000, "{}", json.len());
    }

    #[test]
    fn a_thinned_chart_keeps_each_line_and_its_peaks() {
        // A sensor that reads in every second row, and a wild reading.
        let duty: Vec<(f64, f64)> = (0..30_000).map(|k| (0.01 * f64::from(k), 20.0)).collect();
        let height = |k: i32| (0.02 * f64::from(k) + 0.01, if k == 7_777 { 9e3 } else { 300.0 });
        let lines = vec![
            Line { label: "duty", colour: MENDED, points: duty },
            Line { label: "recorded", colour: RECORDED, points: (0..15_000).map(height).collect() },
        ];
        let chart = Chart::of(&Diagram { lines, ..Diagram::default() }, &Words::default());
        assert!(chart.times.len() <= super::MOST_ROWS && chart.times.is_sorted());
        for line in &chart.lines {
            assert!(line.values.iter().all(Option::is_some), "{}", line.label);
        }
        assert!(chart.lines[1].values.contains(&Some(9e3)));
    }
}
