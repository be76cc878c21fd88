//! A measurement in words: the answer, the caption of its figure, the next step.

use super::Report;
use crate::analysis::measurement::{Calibration, Found, Steps};
use crate::report::kit::page::parts::command;
use crate::report::measure::words::{BLIND, given, readings, settled, verdict_of_zone};
use diagnose::measure::critical::Critical;
use diagnose::measure::dead_zone::DeadZone;
use maud::{Markup, html};

/// The name of the patch file on the page.
pub(super) const PATCH: &str = "measured.toml";

/// The answer in a sentence.
pub(super) fn answer(found: &Found) -> String {
    match found {
        Found::DeadZone { zone, .. } => of_zone(zone),
        Found::ForceCurve { zone, .. } => format!(
            "A percent of duty gives {:.0} mm/s² below hover and {:.0} mm/s² above",
            zone.gain_below.value, zone.gain_above.value
        ),
        Found::CriticalGain(Critical { kp_per_mm, .. }) => {
            format!("From a gain of {:.4} per mm on, the loop no longer comes to rest", kp_per_mm.value)
        }
        Found::Steps(steps) => of_steps(steps),
        Found::NoiseFloor(floor) => format!("One reading of the sensor errs by {:.2} mm", floor.sensor_mm.value),
        Found::Calibration(calibration) => of_calibration(calibration),
    }
}

fn of_zone(zone: &DeadZone) -> String {
    let (lower, upper) = (zone.lower_duty_percent, zone.upper_duty_percent);
    if upper.low > lower.high {
        format!(
            "Between {:.2} and {:.2} % of duty the ball neither rises nor falls: a dead zone",
            lower.value, upper.value
        )
    } else {
        "The fan shows no dead zone beyond doubt".into()
    }
}

fn of_steps(steps: &Steps) -> String {
    let overshoot = steps.overshoot_percent.map(|percent| format!("overshoots a step by {:.0} %", percent.value));
    let settling = steps.settling_s.map(|s| format!("settles in {:.1} s", s.value));
    match (overshoot, settling) {
        (Some(overshoot), Some(settling)) => format!("The ball {overshoot} and {settling}"),
        (Some(overshoot), None) => format!("The ball {overshoot}, and too seldom settles to say how fast"),
        (None, _) => format!("{} steps are too few for a mean", steps.steps),
    }
}

fn of_calibration(found: &Calibration) -> String {
    let failed: Vec<&str> =
        found.bands.iter().filter(|band| !band.pass && band.value.is_some()).map(|band| band.name).collect();
    match (failed.is_empty(), found.sensor_scale) {
        (true, Some(_)) => "The sensor passes: zero, scale and noise lie in their bands".into(),
        (true, None) => "The sensor's zero passes, and its scale cannot be told".into(),
        (false, _) if failed.iter().all(|name| name.starts_with("noise")) => {
            "The sensor's readings are noisier than a loop should bear".into()
        }
        (false, _) => "The sensor is off, and the patch mends it".into(),
    }
}

/// A sentence on the result.
pub(super) fn lede(found: &Found) -> String {
    match found {
        Found::DeadZone { zone, jumps } | Found::ForceCurve { zone, jumps } => verdict_of_zone(zone, jumps),
        Found::CriticalGain(Critical { ti_s, omega, swings, .. }) => format!(
            "By {} steps under a proportional-integral law with T_i = {ti_s:.1} s and no derivative; the swing there is of {omega:.2} rad/s.",
            swings.len()
        ),
        Found::Steps(steps) => settled(steps),
        Found::NoiseFloor(floor) => readings(floor),
        Found::Calibration(found) => found.sensor_scale.map_or_else(
            || BLIND.into(),
            |_| "By the ball at rest at the bottom and at the top, a known way apart.".into(),
        ),
    }
}

/// The caption of the figure.
pub(super) const fn figure(found: &Found) -> &'static str {
    match found {
        Found::DeadZone { .. } | Found::ForceCurve { .. } => {
            "Force over duty: each jump a cross, and the lines from the edges of the dead zone"
        }
        Found::CriticalGain(_) => {
            "Growth of the swing over the gain: each step a cross; where it crosses zero, the critical gain"
        }
        Found::Steps(_) => "Every step over its own time, as a share of its jump",
        Found::NoiseFloor(_) | Found::Calibration(_) => "How often each reading came, by the millimetre",
    }
}

/// The assumptions of the numbers.
pub(super) fn beside(found: &Found) -> Vec<String> {
    match found {
        Found::DeadZone { jumps, .. } | Found::ForceCurve { jumps, .. } => vec![given(jumps)],
        _ => vec![],
    }
}

/// Why there is no patch.
pub(super) const fn no_patch(found: &Found) -> &'static str {
    match found {
        Found::Steps(_) => "Step metrics are no numbers of a config: there is nothing to patch.",
        Found::CriticalGain(_) => {
            "No lag of the fan gives the model of the config this critical gain, or the config has no model: there is nothing to patch."
        }
        _ => "The config has no table that holds what was measured: there is nothing to patch.",
    }
}

/// What to do next.
pub(super) fn next(report: &Report<'_>) -> Markup {
    let line = |words: &str, typed: &str| html! { li { (words) ": " (command(typed)) "." } };
    let ti_s = |critical: &Critical| (critical.kp_per_mm.value, critical.ti_s);
    html! {
        ul {
            @match report.found {
                Found::DeadZone { .. } | Found::ForceCurve { .. } => {
                    (line("See what the correction is worth", &format!("airball measure steps --patch {PATCH}")))
                    (line("Let the simulator have it, and look at the gap of a flight", &format!("airball replay LOG --patch {PATCH}")))
                }
                Found::CriticalGain(critical) => {
                    @let (gain, ti_s) = ti_s(critical);
                    (line("See what a model with this gain foretells", &format!("airball identify third-pole --critical-gain {gain:.5} --integral-time {ti_s:.1} --sampled")))
                    (line("Design with a margin to it", "airball design pid --patch measured.toml"))
                }
                Found::Steps(_) => {
                    (line("Set the simulator beside it", &format!("airball measure {} --virtual", report.what)))
                    (line("Ask what separates the two", &format!("airball diagnose {} --html report.html", shell_word(report.log))))
                    (line("Design another loop", "airball design pid --patch-out gains.toml"))
                }
                Found::NoiseFloor(_) => {
                    (line("Design the observer for this noise", &format!("airball design observer --patch {PATCH} --patch-out observer.toml")))
                    (line("Calibrate zero and scale", "airball measure calibration"))
                }
                Found::Calibration(_) => {
                    (line("Measure again with the patch: the bands should pass", &format!("airball measure calibration --patch {PATCH}")))
                    (line("Measure the noise by itself", "airball measure noise-floor"))
                }
            }
        }
    }
}

/// A file's name as the shell reads it, where it has no special characters; else a placeholder.
fn shell_word(name: &str) -> &str {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    if name.chars().all(plain) { name } else { "LOG" }
}

/// Terms on the page.
pub(super) fn words(found: &Found) -> Vec<(&'static str, &'static str)> {
    let own: &[(&str, &str)] = match found {
        Found::DeadZone { .. } | Found::ForceCurve { .. } => &[
            ("force", "By the ball's mass, mm/s², upward; what the fan adds to what holds the ball still."),
            ("dead zone", "Duties about hover at which the force does not answer."),
            ("lag of the fan", "The time in which the air comes within a third of the speed that it is told."),
        ],
        Found::CriticalGain(_) => &[
            ("growth", "By which factor a second the swing grows, as a logarithm; below zero it dies."),
            ("critical gain", "The proportional gain at which the loop swings for ever."),
        ],
        Found::Steps(_) => {
            &[("overshoot, settling", "On the mean of five readings, so that one noisy reading decides nothing.")]
        }
        Found::NoiseFloor(_) => &[
            ("1σ", "Two readings in three are nearer than this to what is right."),
            ("drift", "How the readings wander while the ball lies still."),
        ],
        Found::Calibration(_) => &[
            (
                "sensor to bottom",
                "The sensor's distance to a ball at the bottom: position is this minus the scaled distance.",
            ),
            ("scale", "By what the sensor's distances are multiplied."),
        ],
    };
    own.iter().copied().chain([("90 % interval", "It holds the value nine times in ten.")]).collect()
}
