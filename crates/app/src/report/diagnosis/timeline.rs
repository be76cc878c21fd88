//! What happened during the flights of a diagnosis, on the time of its charts: where a log begins, modes, faults and
//! commands.
//!
//! A diagnosis sorts flights by their content and leaves rows out. A flight of its rows is found again in the log that
//! has the same duties in the same order.

use crate::log::event::EventMessage;
use crate::report::kit::plot::Timeline;
use diagnose::{Recording, Sample};
use std::ops::Range;

/// Rows by which a flight is recognised.
const ROWS: usize = 20;
/// Kinds of events that explain a curve.
const SHOWN: [&str; 3] = ["mode", "fault", "command"];

/// A log: its name, its rows and its events.
pub type Log<'a> = (&'a str, &'a Recording, &'a [EventMessage]);

/// The events of `logs` along the rows of `shown`.
#[must_use]
pub fn timeline(shown: &Recording, logs: &[Log<'_>]) -> Timeline {
    let mut timeline = Timeline::default();
    for flight in shown.flights() {
        let rows = &shown.samples()[flight.clone()];
        let Some((first, last)) = rows.first().zip(rows.last()) else { continue };
        if flight.start > 0 {
            timeline.breaks.push(first.time_s);
        }
        let found = logs.iter().find_map(|log| Some((log, start_of(rows, log.1.samples())?)));
        let Some(((name, recording, events), start)) = found else { continue };
        let later_s = first.time_s - recording.samples()[start].time_s;
        if logs.len() > 1 {
            timeline.events.push((first.time_s, format!("begin of {name}")));
        }
        let during = first.time_s..=last.time_s;
        let shown = events.iter().filter(|event| SHOWN.contains(&event.kind.as_str()));
        let moved = shown.map(|event| (event.time_s + later_s, format!("{}: {}", event.kind, event.text)));
        timeline.events.extend(moved.filter(|(time_s, _)| during.contains(time_s)));
    }
    timeline
}

/// The row of `all` at which `rows` begin.
fn start_of(rows: &[Sample], all: &[Sample]) -> Option<usize> {
    let like = |at: &usize| {
        let Range { start, end } = *at..(*at + rows.len().min(ROWS)).min(all.len());
        end - start == rows.len().min(ROWS)
            && all[start..end]
                .iter()
                .zip(rows)
                .all(|(a, b)| a.duty_percent == b.duty_percent && a.setpoint_mm == b.setpoint_mm)
    };
    (0..all.len()).find(like)
}

#[cfg(test)]
mod tests {
    use super::timeline;
    use crate::log::event::EventMessage;
    use diagnose::{Recording, Sample};

    fn recording(duty: f64) -> Recording {
        let row = |k: u32| Sample {
            time_s: 0.1 * f64::from(k),
            duty_percent: duty + f64::from(k),
            position_mm: Some(f64::from(k % 7)),
            ..Sample::default()
        };
        Recording::new((0..100).map(row).collect()).unwrap()
    }

    #[test]
    fn an_event_stands_where_the_rows_of_its_log_went_in_another_order_and_without_a_beginning() {
        let (a, b) = (recording(0.0), recording(0.5));
        let event = |time_s| EventMessage { time_s, kind: "command".into(), text: "stop".into(), lateness: None };
        let late = Recording::new(a.samples()[30..].to_vec()).unwrap();
        let shown = Recording::together([b.clone(), late]);
        let (of_a, of_b) = ([event(1.0), event(5.0)], [event(2.0)]);
        let found = timeline(&shown, &[("a", &a, &of_a), ("b", &b, &of_b)]);
        // Of a, 3 s are cut off, and what is left begins after all of b.
        let begin = shown.samples()[100].time_s;
        let words = |text: &str| text.to_owned();
        assert_eq!(found.breaks, [begin]);
        let expected = [
            (0.0, words("begin of b")),
            (2.0, words("command: stop")),
            (begin, words("begin of a")),
            (begin + 2.0, words("command: stop")),
        ];
        for ((time_s, text), (expected_s, expected)) in found.events.iter().zip(&expected) {
            assert!((time_s - expected_s).abs() < 1e-9 && text == expected, "{found:?}");
        }
        assert_eq!(found.events.len(), expected.len());
    }
}
