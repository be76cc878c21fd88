//! The monitor's screen: the rig, the last minute, numbers, faults, keys. Colours are those of the terminal, and never
//! the only mark of a state.

use super::Monitor;
use super::keys::HELP;
use crate::flight::vocabulary::word;
use crate::mqtt::seen::Seen;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph, Wrap};
use std::time::Instant;

/// Time span of the chart, seconds.
const SPAN_S: f64 = 60.0;
/// Length of the pipe until the rig has sent it, mm.
const PIPE_MM: f64 = 600.0;

/// Draws the data at the time `now`.
pub fn draw(frame: &mut Frame<'_>, monitor: &Monitor, now: Instant) {
    let [top, height, duty, numbers, word, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Min(6),
        Constraint::Length(7),
        Constraint::Length(3),
        Constraint::Length(2),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    frame.render_widget(title(monitor, now), top);
    draw_height(frame, monitor, height);
    draw_duty(frame, monitor, duty);
    frame.render_widget(Paragraph::new(said(monitor)), numbers);
    frame.render_widget(Paragraph::new(monitor.word.as_str()).wrap(Wrap { trim: true }), word);
    frame.render_widget(Line::from(HELP).style(Style::new().add_modifier(Modifier::REVERSED)), keys);
}

fn title(monitor: &Monitor, now: Instant) -> Line<'_> {
    let alarm = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);
    let link = match &monitor.link {
        None => Span::raw("dialling the broker"),
        Some(Ok(())) if monitor.online && monitor.is_silent(now) => Span::styled("rig silent", alarm),
        Some(Ok(())) if monitor.online => Span::raw("online"),
        Some(Ok(())) => Span::styled("rig offline", alarm),
        Some(Err(why)) => Span::styled(format!("no broker: {why}"), alarm),
    };
    let mode = monitor.seen.as_ref().map_or_else(String::new, |seen| word(seen.cycle.mode).replace('_', " "));
    let name = Span::styled(format!("{}  ", monitor.rig), Style::new().add_modifier(Modifier::BOLD));
    Line::from(vec![name, Span::styled(mode, Style::new().add_modifier(Modifier::REVERSED)), Span::raw("  "), link])
}

/// The points of one column, if there are any.
fn points(monitor: &Monitor, column: usize) -> Vec<(f64, f64)> {
    let all = monitor.past.iter().map(|row| (row[0], row[column]));
    all.filter(|(_, value)| value.is_finite()).collect()
}

fn times(monitor: &Monitor) -> Axis<'static> {
    let now_s = monitor.past.back().map_or(SPAN_S, |row| row[0]);
    let bounds = [now_s - SPAN_S, now_s];
    Axis::default().bounds(bounds).labels(["60 s ago", "30", "now"])
}

fn heights(from: f64, to: f64, unit: &str) -> Axis<'static> {
    Axis::default().bounds([from, to]).labels([format!("{from:.0}"), format!("{to:.0} {unit}")])
}

fn line(points: &[(f64, f64)], colour: Color) -> Dataset<'_> {
    Dataset::default().marker(Marker::Braille).graph_type(GraphType::Line).style(colour).data(points)
}

fn draw_height(frame: &mut Frame<'_>, monitor: &Monitor, area: Rect) {
    let (position, setpoint) = (points(monitor, 1), points(monitor, 2));
    let range = monitor.about.as_ref().map_or((0.0, PIPE_MM), |about| (about.position_mm.min, about.position_mm.max));
    let lines = vec![line(&setpoint, Color::DarkGray), line(&position, Color::Reset)];
    let chart = Chart::new(lines).x_axis(times(monitor)).y_axis(heights(range.0, range.1, "mm"));
    frame.render_widget(chart.block(Block::new().title("position, and setpoint in grey")), area);
}

fn draw_duty(frame: &mut Frame<'_>, monitor: &Monitor, area: Rect) {
    let duty = points(monitor, 3);
    let most = monitor.about.as_ref().map_or(100.0, |about| about.duty_percent.max);
    let chart = Chart::new(vec![line(&duty, Color::Green)]).x_axis(times(monitor)).y_axis(heights(0.0, most, "%"));
    frame.render_widget(chart.block(Block::new().title("duty")), area);
}

/// Numbers, then lateness, then the present fault.
fn said(monitor: &Monitor) -> Vec<Line<'_>> {
    let Some(seen) = &monitor.seen else { return vec![Line::from("nothing heard of the rig yet")] };
    let Seen {
        cycle,
        controller,
        experiment,
        late_cycles,
        lateness,
        dropped_log_messages,
        dropped_mqtt_messages,
        fault,
    } = seen;
    let mm = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.0} mm"));
    let wanted = monitor.wanted_mm.map_or_else(String::new, |mm| format!(" (asked for {mm:.0})"));
    let flown = experiment.as_deref().map_or_else(String::new, |name| format!("   experiment {name}"));
    let numbers = format!(
        "position {}   setpoint {}{wanted}   duty {:.2} %   {}{flown}",
        mm(cycle.position_mm),
        mm(cycle.setpoint_mm),
        cycle.duty_percent,
        controller.name().replace('_', " ")
    );
    let late = format!(
        "late {late_cycles}; half within {:.0} µs, 99 % within {:.0} µs, all within {:.0} µs; lost {dropped_log_messages} log, {dropped_mqtt_messages} MQTT",
        lateness.p50_us, lateness.p99_us, lateness.max_us
    );
    let alarm = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);
    let fault =
        fault.as_ref().map_or_else(|| Line::from("no fault"), |fault| Line::styled(format!("FAULT {fault}"), alarm));
    vec![Line::from(numbers), Line::from(late), fault]
}
