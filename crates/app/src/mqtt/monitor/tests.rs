//! Tests of the monitor's data, commands and screen.

use super::Monitor;
use super::keys::Deed;
use super::view::draw;
use crate::flight::last_fault::LastFault;
use crate::flight::vocabulary::{Cycle, Mode};
use crate::mqtt::About;
use crate::mqtt::about::Range;
use crate::mqtt::remote::Heard;
use crate::mqtt::seen::{Said, Seen};
use config::topics::Quantity;
use control::controller::Kind;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use std::time::{Duration, Instant};

fn seen(time_s: f64, position_mm: f64) -> Seen {
    let cycle = Cycle {
        time_s,
        period_s: 0.02,
        lateness_s: 0.0,
        mode: Mode::Flying,
        setpoint_mm: Some(300.0),
        control_percent: None,
        control_mm_per_s2: None,
        commanded_duty_percent: 21.4,
        duty_percent: 21.37,
        position_mm: Some(position_mm),
        position2_mm: None,
        fan_rpm: None,
        fresh: true,
        velocity_mm_per_s: None,
        estimated_position_mm: None,
        estimated_fan_percent: None,
        estimated_disturbance_percent: None,
        innovation_mm: None,
        innovation_test_ratio: None,
    };
    Seen {
        cycle,
        controller: Kind::StateFeedback,
        experiment: Some("steps".into()),
        late_cycles: 7,
        lateness: crate::flight::lateness::Quantiles { p99_us: 200.0, ..Default::default() },
        dropped_log_messages: 0,
        dropped_mqtt_messages: 0,
        fault: None,
    }
}

fn monitor() -> Monitor {
    let mut monitor = Monitor::of("rig1");
    let about = About {
        position_mm: Range { min: 0.0, max: 583.0 },
        setpoint_mm: Range { min: 30.0, max: 550.0 },
        duty_percent: Range { min: 10.0, max: 40.0 },
        ..About::default()
    };
    monitor.hear(Heard::Connected);
    monitor.hear(Heard::Online(true));
    monitor.hear(Heard::About(Box::new(about)));
    for k in 0..100 {
        let time_s = 0.1 * f64::from(k);
        monitor.hear(Heard::State(Box::new(seen(time_s, 290.0 + time_s))));
    }
    monitor
}

/// The screen as text, line by line.
fn screen(monitor: &Monitor, width: u16, height: u16) -> Vec<String> {
    screen_at(Instant::now(), monitor, width, height)
}

fn screen_at(now: Instant, monitor: &Monitor, width: u16, height: u16) -> Vec<String> {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(frame, monitor, now)).unwrap();
    let buffer = terminal.backend().buffer();
    let row = |y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(row).collect()
}

#[test]
fn the_screen_has_the_mode_the_numbers_the_lateness_and_a_line_that_moves() {
    let drawn = screen(&monitor(), 100, 30);
    let text = drawn.join("\n");
    for word in ["rig1", "flying", "online", "position 300 mm", "setpoint 300 mm", "duty 21.37 %", "state feedback"] {
        assert!(text.contains(word), "{word}:\n{text}");
    }
    for word in ["experiment steps", "late 7;", "99 % within 200 µs", "no fault", "583 mm", "space STOP"] {
        assert!(text.contains(word), "{word}:\n{text}");
    }
    let dots = text.chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count();
    assert!(dots > 10, "{dots} cells of the charts are drawn:\n{text}");
}

#[test]
fn a_small_terminal_and_one_that_knows_nothing_are_drawn_without_a_panic() {
    for (width, height) in [(1, 1), (20, 5), (40, 12), (200, 60)] {
        let _ = screen(&monitor(), width, height);
        let _ = screen(&Monitor::of("rig1"), width, height);
    }
    assert!(screen(&Monitor::of("rig1"), 80, 24).join("\n").contains("nothing heard of the rig yet"));
}

#[test]
fn a_fault_a_lost_broker_and_a_rig_that_is_off_are_said_in_words() {
    let mut monitor = monitor();
    let fault = Some("no new range for 0.30 s".to_owned());
    monitor.hear(Heard::State(Box::new(Seen { fault, ..seen(11.0, 300.0) })));
    let (at, stuck) = (String::from("2026-01-02T03:04:05Z"), LastFault::now("stuck".into(), None));
    monitor.hear(Heard::Fault(LastFault { at, ..stuck }));
    let passed = LastFault::now("of last week".into(), None).acknowledged().unwrap();
    monitor.hear(Heard::Fault(passed));
    let drawn = screen(&monitor, 100, 30).join("\n");
    assert!(
        drawn.contains("FAULT no new range for 0.30 s") && drawn.contains("2026-01-02T03:04:05Z: stuck"),
        "{drawn}"
    );
    let later = Instant::now() + Duration::from_secs(5);
    assert!(screen_at(later, &monitor, 100, 30)[0].contains("rig silent"));
    monitor.hear(Heard::Online(false));
    assert!(screen(&monitor, 100, 30)[0].contains("rig offline"));
    monitor.hear(Heard::Lost("Connection refused".into()));
    assert!(screen(&monitor, 100, 30)[0].contains("no broker: Connection refused"));
}

#[test]
fn nudges_add_up_before_the_rig_has_answered_and_stay_within_its_limits() {
    let mut monitor = monitor();
    assert_eq!(monitor.command(Deed::Nudge(5.0)), Some((Quantity::Setpoint, "305".into())));
    assert_eq!(monitor.command(Deed::Nudge(50.0)), Some((Quantity::Setpoint, "355".into())));
    assert_eq!(monitor.command(Deed::Nudge(500.0)), Some((Quantity::Setpoint, "550".into())));
    let refused = Said { topic: "set/setpoint_mm".into(), accepted: false, reason: Some("busy".into()) };
    monitor.hear(Heard::Reply(refused));
    assert_eq!(monitor.command(Deed::Nudge(-5.0)), Some((Quantity::Setpoint, "295".into())));
    assert!(screen(&monitor, 100, 30).join("\n").contains("setpoint_mm: busy"));
}

#[test]
fn no_setpoint_is_guessed_before_the_rig_has_said_its_own_and_a_stop_needs_none() {
    let mut monitor = Monitor::of("rig1");
    assert_eq!(monitor.command(Deed::Nudge(5.0)), None);
    assert_eq!(monitor.command(Deed::STOP), Some((Quantity::Mode, "stop".into())));
    monitor.unsent(Deed::STOP);
    assert!(screen(&monitor, 100, 30).join("\n").contains("Switch off the fan's supply"));
}

#[test]
fn the_line_for_scripts_says_the_same() {
    assert_eq!(Monitor::of("rig1").line(), None);
    let line = monitor().line().unwrap();
    for word in ["flying", "position 300 mm", "setpoint 300 mm", "duty 21.37 %", "7 late", "no fault"] {
        assert!(line.contains(word), "{word}: {line}");
    }
}

#[test]
fn a_new_flight_begins_a_new_picture() {
    let mut monitor = monitor();
    monitor.hear(Heard::State(Box::new(seen(0.0, 10.0))));
    assert_eq!(monitor.past.len(), 1);
}

#[test]
fn a_question_mark_shows_the_keys_and_an_unknown_key_is_told_so() {
    let mut monitor = Monitor::of("rig1");
    assert_eq!(monitor.command(Deed::Help), None);
    assert!(monitor.word.contains("space or s stops the fan"), "{}", monitor.word);
    assert_eq!(monitor.command(Deed::Unknown('x')), None);
    assert_eq!(monitor.word, "the key x does nothing; ? shows the keys");
}
