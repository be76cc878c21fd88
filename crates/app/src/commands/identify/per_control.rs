//! A plant as the controller has it: from its control value instead of the duty, and so with predistortion and
//! compensation inside.

use crate::commands::diagnosing::Asked;
use ::diagnose::identify::{GreyBox, ParameterEstimate};
use ::diagnose::{Finding, Recording, Sample};
use anyhow::{Result, anyhow, bail};
use control::Duty;
use control::compensation::Compensator;
use plant::{Effects, Model};

/// The logs with the control value of each duty in its place, and the believed plant from there on.
///
/// # Errors
/// A config without compensation.
pub(super) fn by_control(asked: &mut Asked) -> Result<()> {
    let Some(compensation) = asked.compensation().cloned() else {
        bail!("the control value of a duty needs the table [compensation] of the config that was flown; add it")
    };
    let stage = compensation.start();
    let believed = &asked.belief;
    let gain = believed.gain_mm_per_s2_per_percent;
    asked.belief = Model {
        gain_mm_per_s2_per_percent: if compensation.predistortion.is_some() { 1.0 } else { gain },
        hover_duty_percent: 0.0,
        effects: Effects::default().with_fan_lag(believed.effects.fan_lag_s()),
        ..believed.clone()
    };
    for (log, name) in asked.logs.iter_mut().zip(&asked.names) {
        log.recording = controlled(&log.recording, &stage, name)?;
    }
    for (recording, name) in asked.recordings.iter_mut().zip(&asked.names) {
        *recording = controlled(recording, &stage, name)?;
    }
    Ok(())
}

/// The rows with the control value that gives each duty: what an experiment adds to the duty is then in it.
fn controlled(recording: &Recording, stage: &Compensator, name: &str) -> Result<Recording> {
    let turned = |row: &Sample| Sample { duty_percent: stage.control(Duty::clamped(row.duty_percent)), ..*row };
    let rows = recording.samples().iter().map(turned).collect();
    Recording::new(rows).map_err(|error| anyhow!("{name}, by its control values: {error}"))
}

/// Whether a finding is about the unit of a duty, which the control value has not.
pub(super) const fn is_of_duty(finding: &Finding) -> bool {
    matches!(finding, Finding::DutyBeyondPercent { .. } | Finding::DutyFarBelowHover { .. } | Finding::FractionalDuty)
}

/// The estimates by the names that they have from the control value on.
pub(super) fn renamed(found: &mut [GreyBox]) {
    for estimate in found.iter_mut().flat_map(|one| &mut one.estimates) {
        estimate.name = match estimate.name {
            "gain_mm_per_s2_per_percent" => "gain_mm_per_s2_per_control",
            "hover_duty_percent" => "hover_control",
            other => other,
        };
    }
}

/// The estimates as what an observer believes.
pub(super) fn patch(origin: &str, estimates: &[ParameterEstimate]) -> String {
    let key = |name| match name {
        "gain_mm_per_s2_per_control" | "drag_per_s" => Some(name),
        "fan_lag.time_constant_s" => Some("fan_lag_s"),
        _ => None,
    };
    let lines = estimates.iter().filter_map(|one| Some(format!("{} = {:?}\n", key(one.name)?, one.value)));
    format!("# {origin}; from the control value.\n[observer.believed]\n{}", lines.collect::<String>())
}
