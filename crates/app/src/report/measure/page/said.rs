//! A measurement in words: the answer, the caption of its figure, the next step.

use super::Report;
use crate::analysis::measurement::{Calibration, Found, Steps};
use crate::report::kit::page::made::shell_word;
use crate::report::measure::words::{BLIND, given, readings, settled, verdict_of_zone};
use diagnose::measure::critical::{Critical, CriticalTime};
use diagnose::measure::dead_zone::DeadZone;
use maud::{Markup, html};

/// The name of the patch file on the page.
pub(super) const PATCH: &str = "measured.toml";

/// The answer in a sentence.
pub(super) fn answer(found: &Found) -> String {
    match found {
        Found::DeadZone { zone, .. } => of_zone(zone),
        Found::ForceCurve { zone, .. } => format!(
            "1 % of duty gives {:.0} mm/s² below hover and {:.0} mm/s² above",
            zone.gain_below.value, zone.gain_above.value
        ),
        Found::CriticalGain(Critical { kp_per_mm, .. }) => {
            format!("The critical gain is {:.4} per mm: above it the loop is unstable", kp_per_mm.value)
        }
        Found::CriticalTime(CriticalTime { ti_s, .. }) => {
            format!("The critical integral time is {:.3} s: below it the loop is unstable", ti_s.value)
        }
        Found::Steps(steps) => of_steps(steps),
        Found::NoiseFloor(floor) => format!("The noise of a reading is {:.2} mm (1σ)", floor.sensor_mm.value),
        Found::Calibration(calibration) => of_calibration(calibration),
    }
}

fn of_zone(zone: &DeadZone) -> String {
    let (lower, upper) = (zone.lower_duty_percent, zone.upper_duty_percent);
    if upper.low > lower.high {
        format!(
            "Dead zone: between {:.2} and {:.2} % of duty the ball neither rises nor falls",
            lower.value, upper.value
        )
    } else {
        "No significant dead zone".into()
    }
}

fn of_steps(steps: &Steps) -> String {
    let overshoot = steps.overshoot_percent.map(|percent| format!("overshoots a step by {:.0} %", percent.value));
    let settling = steps.settling_s.map(|s| format!("settles in {:.1} s", s.value));
    match (overshoot, settling) {
        (Some(overshoot), Some(settling)) => format!("The ball {overshoot} and {settling}"),
        (Some(overshoot), None) => format!("The ball {overshoot}, and too few steps settle to give a settling time"),
        (None, _) => format!("{} steps are too few for a mean", steps.steps),
    }
}

fn of_calibration(found: &Calibration) -> String {
    let failed: Vec<&str> =
        found.bands.iter().filter(|band| !band.pass && band.value.is_some()).map(|band| band.name).collect();
    match (failed.is_empty(), found.sensor_scale) {
        (true, Some(_)) => "The sensor passes: zero, scale and noise are within their limits".into(),
        (true, None) => "The zero of the sensor passes; its scale cannot be measured".into(),
        (false, _) if failed.iter().all(|name| name.starts_with("noise")) => {
            "The sensor is too noisy for a control loop".into()
        }
        (false, _) => "The sensor is off; the patch corrects it".into(),
    }
}

/// A sentence on the result.
pub(super) fn lede(found: &Found) -> String {
    match found {
        Found::DeadZone { zone, jumps } | Found::ForceCurve { zone, jumps } => verdict_of_zone(zone, jumps),
        Found::CriticalGain(Critical { ti_s, omega, swings, .. }) => format!(
            "From {} steps under PI control with T_i = {ti_s:.1} s; there the loop oscillates at {omega:.2} rad/s.",
            swings.len()
        ),
        Found::CriticalTime(CriticalTime { kp_per_mm, omega, swings, .. }) => format!(
            "From {} steps under PI control with K_p = {kp_per_mm:.4} per mm; there the loop oscillates at {omega:.2} \
             rad/s.",
            swings.len()
        ),
        Found::Steps(steps) => settled(steps),
        Found::NoiseFloor(floor) => readings(floor),
        Found::Calibration(found) => found.sensor_scale.map_or_else(
            || BLIND.into(),
            |_| "From the ball at rest at the bottom and at the top, a known distance apart.".into(),
        ),
    }
}

/// The caption of the figure.
pub(super) const fn figure(found: &Found) -> &'static str {
    match found {
        Found::DeadZone { .. } | Found::ForceCurve { .. } => {
            "Force over duty: a cross for each jump, and the fitted lines from the edges of the dead zone"
        }
        Found::CriticalGain(_) => {
            "Growth rate of the oscillation over the gain: a cross for each step; its zero is the critical gain"
        }
        Found::CriticalTime(_) => {
            "Growth rate of the oscillation over the integral time: a cross for each step; its zero is the critical one"
        }
        Found::Steps(_) => "Every step over the time since it began, relative to its size",
        Found::NoiseFloor(_) | Found::Calibration(_) => "Histogram of the readings, 1 mm wide",
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
        Found::Steps(_) => "The config has no keys for step metrics: there is no patch.",
        Found::CriticalTime(_) => "The config has no key for a critical integral time: there is no patch.",
        Found::CriticalGain(_) => {
            "No fan lag gives the model of the config this critical gain, or the config has no model: there is no \
             patch."
        }
        _ => "The config has no table for this measurement: there is no patch.",
    }
}

/// What to do next.
pub(super) fn next(report: &Report<'_>) -> Markup {
    let line = |words: &str, typed: &str| html! { li { (words) ": " (report.made.then(typed)) "." } };
    let ti_s = |critical: &Critical| (critical.kp_per_mm.value, critical.ti_s);
    html! {
        ul {
            @match report.found {
                Found::DeadZone { .. } | Found::ForceCurve { .. } => {
                    (line("Measure the effect of the correction", &format!("airball measure steps --patch {PATCH}")))
                    (line("Correct the simulator, and compare it with a flight", &format!("airball replay LOG --patch \
                         {PATCH}")))
                }
                Found::CriticalGain(critical) => {
                    @let (gain, ti_s) = ti_s(critical);
                    (line("Find the fan lag for this critical gain", &format!("airball identify third-pole \
                         --critical-gain {gain:.5} --integral-time {ti_s:.1} --sampled")))
                    (line("Design with a margin", "airball design pid --patch measured.toml"))
                }
                Found::CriticalTime(_) => {
                    (line("Compare with the model", "airball identify third-pole"))
                    (line("Measure the simulator in the same way", "airball measure critical-time --virtual"))
                }
                Found::Steps(_) => {
                    (line("Measure the simulator in the same way", &format!("airball measure {} --virtual", report.what)))
                    (line("Find what separates the two", &format!("airball diagnose {} --html report.html", shell_word(report.log))))
                    (line("Design another loop", "airball design pid --patch-out gains.toml"))
                }
                Found::NoiseFloor(_) => {
                    (line("Design the observer for this noise", &format!("airball design observer --patch {PATCH} --patch-out observer.toml")))
                    (line("Calibrate zero and scale", "airball measure calibration"))
                }
                Found::Calibration(_) => {
                    (line("Measure again with the patch: it should pass", &format!("airball measure calibration \
                         --patch {PATCH}")))
                    (line("Measure the noise alone", "airball measure noise-floor"))
                }
            }
        }
    }
}

/// Terms on the page.
pub(super) fn words(found: &Found) -> Vec<(&'static str, &'static str)> {
    let own: &[(&str, &str)] = match found {
        Found::DeadZone { .. } | Found::ForceCurve { .. } => &[
            (
                "force",
                "Force of the fan beyond the one that holds the ball still, divided by the mass of the ball, mm/s², \
                 upward.",
            ),
            ("dead zone", "The range of duties about hover in which the force does not change."),
            ("fan lag", "Time constant of the air speed after a step of the duty (63 % rise time)."),
        ],
        Found::CriticalTime(_) => &[
            ("growth", "Exponential growth rate of the oscillation, 1/s; negative if it decays."),
            ("critical integral time", "The integral time at which the loop is marginally stable."),
        ],
        Found::CriticalGain(_) => &[
            ("growth", "Exponential growth rate of the oscillation, 1/s; negative if it decays."),
            ("critical gain", "The proportional gain at which the loop is marginally stable."),
        ],
        Found::Steps(_) => &[(
            "overshoot, settling",
            "From the moving mean of five readings, so that a single noisy reading does not decide.",
        )],
        Found::NoiseFloor(_) => &[
            ("1σ", "Standard deviation: two readings in three are nearer than this to the true value."),
            ("drift", "Slope of the readings over time while the ball lies still."),
        ],
        Found::Calibration(_) => &[
            (
                "sensor to bottom",
                "The sensor's distance to a ball at the bottom: position is this minus the scaled distance.",
            ),
            ("scale", "Factor on the distances of the sensor."),
        ],
    };
    own.iter().copied().chain([("90 % interval", "It contains the true value nine times in ten.")]).collect()
}
