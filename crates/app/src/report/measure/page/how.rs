//! Details of a measurement: jump by jump, step by step, band by band.

use crate::analysis::measurement::{Calibration, Found, Steps};
use crate::analysis::step_response::Step;
use crate::report::kit::page::parts::words;
use crate::report::measure::words::{Rows, bands, forces, swings};
use diagnose::measure::critical::Critical;
use diagnose::measure::jumps::Jumps;
use diagnose::measure::noise_floor::NoiseFloor;
use maud::{Markup, html};

pub(super) fn body(found: &Found) -> Markup {
    match found {
        Found::DeadZone { jumps, .. } | Found::ForceCurve { jumps, .. } => of_jumps(jumps),
        Found::CriticalGain(critical) => of_swings(critical),
        Found::Steps(steps) => of_steps(steps),
        Found::NoiseFloor(floor) => of_floor(floor),
        Found::Calibration(calibration) => of_ends(calibration),
    }
}

fn of_jumps(jumps: &Jumps) -> Markup {
    let Rows { heads, rows } = forces(jumps);
    html! {
        p {
            (format!("The fan held a duty, {} times, and the ball went from where it was. Way and time give the force, for a ball with the \
                      config's drag of {} 1/s; the fan's lag is found from all jumps together. The last column leaves it out, as the \
                      classical formula does: short jumps then look weak.", jumps.jumps.len(), jumps.drag_per_s))
        }
        p {
            "The edges are where straight lines through the forces below and above, near hover, cross zero; each side is found by itself."
        }
        (words("Jump by jump", &heads, &rows))
    }
}

fn of_swings(found: &Critical) -> Markup {
    let Rows { heads, rows } = swings(found);
    html! {
        p {
            "The setpoint stepped under rising gains, and each step was followed by a swing that grew or died. The critical gain is where the "
            "growth crosses zero. It holds for swings of this size: a dead zone lets small ones live, a limit large ones die."
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
            "Each jump of the setpoint is a step, the take-off left out. The overshoot is the largest excursion beyond the new setpoint as a share "
            "of the jump; a step has settled when the ball stays within 5 % of the jump for a second."
        }
        (words("Step by step", &heads, &steps.each.iter().map(row).collect::<Vec<_>>()))
    }
}

fn of_floor(floor: &NoiseFloor) -> Markup {
    html! {
        p {
            (format!("The ball lay at {:.1} mm while the sensor went on reading. Noise is what a line over time leaves of the readings, without \
                      what rounding adds. Neighbours that resemble each other count for less, so that the interval is honest.", floor.position_mm))
        }
    }
}

fn of_ends(found: &Calibration) -> Markup {
    let Rows { heads, rows } = bands(found);
    html! {
        p {
            "The ball lay at the bottom, then the fan held it at the top, a known way above. The first says where the sensor's zero is, both "
            "together by what its distances must be multiplied. The bands are what a loop does not notice."
        }
        (words("What must hold", &heads, &rows))
    }
}
