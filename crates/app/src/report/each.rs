//! The diagnoses of many logs as one table: CSV and page.

use crate::report::compare::document::CANNOT_ANSWER;
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{number, spoken, table};
use crate::report::kit::page::record::Record;
use crate::report::kit::page::{Page, Section};
use diagnose::{Interval, chance_in_words};
use maud::{Markup, html};
use serde_json::Value;

/// Base parameters of the table.
const BASE: [&str; 3] = ["gain_mm_per_s2_per_percent", "drag_per_s", "hover_duty_percent"];

/// A number with its 90 % interval, as far as these are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    value: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
}

/// An effect that was named.
#[derive(Clone, Debug, Default, PartialEq)]
struct EffectOf {
    name: String,
    probability: f64,
    parameters: Vec<(String, Estimate)>,
}

/// A log of the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Its name.
    pub log: String,
    /// Why it has no diagnosis.
    pub error: Option<String>,
    verdict: String,
    effects: Vec<EffectOf>,
    /// Errors 1 s ahead, mm: as believed, refitted, mended, by noise alone.
    errors_mm: [Option<f64>; 4],
    closed: Estimate,
    base: [Estimate; 3],
    /// The findings: the first, or of a log that cannot answer all.
    finding: String,
}

/// How many logs are diagnosed, cannot answer, and have an error.
#[must_use]
pub fn count(rows: &[Row]) -> [usize; 3] {
    let bad = rows.iter().filter(|row| row.error.is_some()).count();
    let mute = rows.iter().filter(|row| row.cannot_answer()).count();
    [rows.len() - bad - mute, mute, bad]
}

impl Row {
    fn cannot_answer(&self) -> bool {
        self.verdict == CANNOT_ANSWER
    }

    /// The row of a diagnosis' document.
    #[must_use]
    pub fn of(log: &str, json: &str) -> Self {
        let document: Value = serde_json::from_str(json).unwrap_or_default();
        let gap = &document["gap"];
        let at_1_s = |name: &str| gap[name][2].as_f64();
        let words = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let effects = document["effects"].as_array().map(Vec::as_slice).unwrap_or_default();
        let effect = |one: &Value| EffectOf {
            name: words(&one["name"]),
            probability: one["probability"].as_f64().unwrap_or_default(),
            parameters: one["parameters"]
                .as_object()
                .into_iter()
                .flatten()
                .map(|(name, value)| (name.clone(), estimate(value)))
                .collect(),
        };
        let row = Self {
            log: log.into(),
            error: document["verdict"].is_null().then(|| "its JSON is damaged; delete it and run again".into()),
            verdict: words(&document["verdict"]),
            effects: effects.iter().map(effect).collect(),
            errors_mm: ["nominal_mm", "refitted_mm", "mended_mm", "floor_mm"].map(at_1_s),
            closed: estimate(&gap["closed"]),
            base: BASE.map(|name| estimate(&document["parameters"][name])),
            finding: findings(&document),
        };
        // What a record that cannot answer leaves as believed is not its number.
        if row.cannot_answer() {
            return Self { log: row.log, verdict: row.verdict, finding: row.finding, ..Self::default() };
        }
        row
    }

    /// The row of a log without a diagnosis.
    #[must_use]
    pub fn without(log: &str, error: &str) -> Self {
        Self { log: log.into(), error: Some(error.into()), ..Self::default() }
    }

    fn effects_in_words(&self) -> String {
        let words = self.effects.iter().map(|EffectOf { name, probability, parameters }| {
            let parameters = parameters.iter().map(|(name, value)| format!(" {name} = {}", value.in_words()));
            format!("{name} {}{}", chance_in_words(*probability), parameters.collect::<String>())
        });
        words.collect::<Vec<_>>().join("; ")
    }
}

impl Estimate {
    fn in_words(self) -> String {
        let Self { low, high, .. } = self;
        self.value.map_or_else(String::new, |value| Interval { value, low, high, at_bound: None }.in_words())
    }
}

fn estimate(value: &Value) -> Estimate {
    let number = |key: &str| value[key].as_f64();
    Estimate { value: number("value"), low: number("low"), high: number("high") }
}

/// The first finding of a diagnosis, and all that leave it without an answer.
fn findings(document: &Value) -> String {
    let all = document["check"]["findings"].as_array().map(Vec::as_slice).unwrap_or_default();
    let most = if document["verdict"] == CANNOT_ANSWER { all.len() } else { 1 };
    all.iter().take(most).filter_map(Value::as_str).collect::<Vec<_>>().join("; ")
}

/// The table as CSV.
///
/// # Errors
/// The writer fails.
pub fn csv(rows: &[Row]) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut head: Vec<String> = ["log", "verdict", "effects"].map(String::from).to_vec();
    head.extend(["believed", "refitted", "mended", "noise"].map(|of| format!("error_1_s_{of}_mm")));
    for of in ["closed"].iter().chain(&BASE) {
        head.extend([(*of).to_owned(), format!("{of}_low"), format!("{of}_high")]);
    }
    head.extend(["finding", "error"].map(String::from));
    writer.write_record(&head)?;
    let cell = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    for row in rows {
        let mut cells = vec![row.log.clone(), row.verdict.clone(), row.effects_in_words()];
        cells.extend(row.errors_mm.map(cell));
        for one in std::iter::once(&row.closed).chain(&row.base) {
            cells.extend([one.value, one.low, one.high].map(cell));
        }
        cells.extend([row.finding.clone(), row.error.clone().unwrap_or_default()]);
        writer.write_record(&cells)?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The table as a page; `all`: the number of logs.
#[must_use]
pub fn page(rows: &[Row], all: usize, made: &Made) -> String {
    let [diagnosed, mute, bad] = count(rows);
    let answer = format!("{diagnosed} of {all} logs diagnosed, {mute} cannot answer, {bad} with an error");
    let record = Record { diagrams: Vec::new() };
    let from = vec![format!("{all} logs")];
    let first =
        html! { p { "Each log by itself; its name leads to its page. Errors are those of forecasts 1 s ahead." } };
    let mut sections = vec![Section::across("logs", "Log by log", of_logs(rows))];
    if mute > 0 {
        sections.push(Section::across("mute", "Why a log cannot answer", of_mute(rows)));
    }
    if bad > 0 {
        sections.push(Section::across("errors", "Without a diagnosis", of_errors(rows)));
    }
    Page { kind: "diagnoses", from, made, answer: &answer, first, sections, record: &record }.render()
}

fn of_logs(rows: &[Row]) -> Markup {
    let heads = [
        "log",
        "verdict",
        "effects",
        "believed, mm",
        "refitted",
        "mended",
        "noise",
        "gap closed, %",
        "gain",
        "drag",
        "hover",
    ];
    let cells = |row: &Row| {
        let name = html! { a href=(address(&row.log)) { (row.log) } };
        let mut cells = vec![html! { (spoken(&row.verdict)) }, html! { (row.effects_in_words()) }];
        cells.extend(row.errors_mm.map(|error| html! { (number(error, 2)) }));
        let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
        let Estimate { value, low, high } = row.closed;
        let closed = Estimate { value: percent(value), low: percent(low), high: percent(high) };
        cells.extend(std::iter::once(closed).chain(row.base).map(|one| html! { (one.in_words()) }));
        (name, cells)
    };
    let rows: Vec<_> = rows.iter().filter(|row| row.error.is_none()).map(cells).collect();
    table("Log by log, numbers with 90 % intervals", &heads, &rows)
}

fn of_mute(rows: &[Row]) -> Markup {
    let mute = rows.iter().filter(|row| row.cannot_answer());
    let rows: Vec<_> = mute.map(|row| (html! { (row.log) }, vec![html! { (row.finding) }])).collect();
    table("Logs that cannot answer", &["log", "reason"], &rows)
}

fn of_errors(rows: &[Row]) -> Markup {
    let bad = rows.iter().filter_map(|row| Some((row, row.error.as_ref()?)));
    let rows: Vec<_> = bad.map(|(row, error)| (html! { (row.log) }, vec![html! { (error) }])).collect();
    table("Logs without a diagnosis", &["log", "reason"], &rows)
}

/// The address of a log's page beside this one.
fn address(log: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_./~".contains(&byte);
    let escaped =
        log.bytes().map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") });
    format!("./{}.html", escaped.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::{Row, address, count, csv, page};
    use crate::report::kit::page::made::Made;

    #[test]
    fn a_name_that_is_markup_or_a_scheme_stays_a_name() {
        let row = Row::of("javascript:<b>&.csv", r#"{"verdict":"no_gap"}"#);
        let page = page(std::slice::from_ref(&row), 1, &Made::default());
        assert!(!page.contains("<b>") && page.contains("href=\"./javascript%3A%3Cb%3E%26.csv.html\""));
        assert_eq!(address("a/b c.mcap"), "./a/b%20c.mcap.html");
    }

    #[test]
    fn a_log_that_cannot_answer_is_not_counted_as_diagnosed_and_its_reasons_are_on_the_page() {
        let mute = r#"{"verdict":"insufficient_data","parameters":{"drag_per_s":{"value":3.9}},
            "check":{"findings":["the duty stays","too few readings"]}}"#;
        let rows =
            [Row::of("a.csv", r#"{"verdict":"no_gap"}"#), Row::of("b.csv", mute), Row::without("c.csv", "empty")];
        assert_eq!(count(&rows), [1, 1, 1]);
        let page = page(&rows, 3, &Made::default());
        assert!(page.contains("1 of 3 logs diagnosed, 1 cannot answer, 1 with an error"));
        assert!(page.contains("the duty stays; too few readings"));
        // The believed drag is not that of the record.
        assert!(!page.contains("3.9") && !csv(&rows).unwrap().contains("3.9"));
    }

    #[test]
    fn a_row_has_its_numbers_with_their_intervals() {
        let json = r#"{"verdict":"effect","effects":[{"name":"dead_zone","probability":0.96,"parameters":{"lower_percent":{"value":-0.3,"low":-0.31,"high":-0.29}}}],
            "parameters":{"drag_per_s":{"value":2.0,"low":1.9,"high":2.1}},"gap":{"nominal_mm":[1,2,3.5],"closed":{"value":0.9,"low":0.8,"high":1.0}},"check":{"findings":["a gap"]}}"#;
        let text = csv(&[Row::of("a.csv", json), Row::without("b.csv", "empty")]).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0].split(',').count(), 21, "{}", lines[0]);
        assert_eq!(
            lines[1],
            "a.csv,effect,dead_zone 96 % lower_percent = -0.300 (-0.310 to -0.290),3.5,,,,0.9,0.8,1,,,,2,1.9,2.1,,,,a \
             gap,"
        );
        assert!(lines[2].starts_with("b.csv,,,") && lines[2].ends_with(",empty"), "{}", lines[2]);
        assert!(Row::of("a.csv", "{").error.is_some());
    }
}
