//! Details of a measurement: jump by jump, step by step, band by band.

use crate::analysis::measurement::{Calibration, Found, Steps};
use crate::analysis::step_response::Step;
use crate::report::kit::page::parts::words;
use crate::report::measure::words::{Rows, bands, forces, swings};
use diagnose::measure::critical::Swing;
use diagnose::measure::jumps::Jumps;
use diagnose::measure::noise_floor::NoiseFloor;
use maud::{Markup, html};

pub(super) fn body(found: &Found) -> Markup {
    match found {
        Found::DeadZone { jumps, .. } | Found::ForceCurve { jumps, .. } => of_jumps(jumps),
        Found::CriticalGain(critical) => of_swings(&critical.swings, "rising gains", "gain"),
        Found::CriticalTime(critical) => of_swings(&critical.swings, "falling integral times", "integral time"),
        Found::Steps(steps) => of_steps(steps),
        Found::NoiseFloor(floor) => of_floor(floor),
        Found::Calibration(calibration) => of_ends(calibration),
    }
}

fn of_jumps(jumps: &Jumps) -> Markup {
    let Rows { heads, rows } = forces(jumps);
    html! {
        p {
            (format!("The fan held a constant duty, {} times, and the ball moved from rest. Distance and time give the \
                 force, for a ball with the config's drag of {} 1/s; the fan lag is fitted to all jumps together. The \
                 last column ignores the lag, as the classical formula does: short jumps then look \
                 weak.", jumps.jumps.len(), jumps.drag_per_s))
        }
        p {
            "The edges are where straight lines through the forces below and above hover cross zero. Each side is \
             fitted on its own."
        }
        (words("Jump by jump", &heads, &rows))
    }
}

fn of_swings(steps: &[Swing], varied: &str, critical: &str) -> Markup {
    let Rows { heads, rows } = swings(steps);
    html! {
        p {
            "The setpoint stepped under " (varied) ", and after each step the oscillation grew or decayed. The \
                 critical " (critical) " \
                 is where the "
            "growth rate crosses zero. It holds for oscillations of this amplitude: a dead zone sustains small ones, a \
             limit of the duty damps large ones."
        }
        (words("Step by step", &heads, &rows))
    }
}

fn of_steps(steps: &Steps) -> Markup {
    let row = |step: &Step| {
        [
            format!("{:.1} s", step.time_s),
            format!("{:.0} to {:.0} mm", step.from_mm, step.to_mm),
            format!("{:.1} %", step.overshoot_percent),
            step.peak_s.map_or_else(|| "none".into(), |s| format!("{s:.2} s")),
            step.settling_s.map_or_else(|| "not".into(), |s| format!("{s:.2} s")),
        ]
    };
    let heads = ["step at", "jump", "overshoot", "first peak", "settled to ±5 %"];
    html! {
        p {
            "Every step of the setpoint counts, except the take-off. The overshoot is the largest excursion beyond the \
             new setpoint, relative "
            "to the step; a step has settled when the ball stays within 5 % of the step for 1 s."
        }
        (words("Step by step", &heads, &steps.each.iter().map(row).collect::<Vec<_>>()))
    }
}

fn of_floor(floor: &NoiseFloor) -> Markup {
    html! {
        p {
            (format!("The ball lay at {:.1} mm. The noise is the scatter of the readings about a straight line over \
                 time, without the part of rounding. Correlated readings count for less in the \
                 interval.", floor.position_mm))
        }
    }
}

fn of_ends(found: &Calibration) -> Markup {
    let Rows { heads, rows } = bands(found);
    html! {
        p {
            "The ball lay at the bottom, then the fan held it at the top, a known distance above. The first gives the \
             zero of the sensor, both "
            "together its scale. Errors within the limits do not disturb a control loop."
        }
        (words("Limits", &heads, &rows))
    }
}
