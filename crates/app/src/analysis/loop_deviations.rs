//! Deviations of the loop from its config, before the duty reaches the fan: the stages controller and timing.
//!
//! ```text
//! controller   the duty by the configured law on the logged setpoints and readings, against the duty as logged
//! timing       the duty as logged, written at each deadline instead of `lateness_s` after it
//! ```
//!
//! Both are differences between two duties. Their worth is the log-likelihood that the readings lose when the mended
//! model gets the wrong duty ([`diagnose::kl_divergence`]): nats, as for the effects. Only a log of this program holds
//! its config and its lateness. The law is followed from take-off to the first change of gains, open loop, fault or
//! lost cycle. An excitation is in no log, so that a difference means nothing where an experiment was flown.

use crate::flight::command::Command;
use crate::flight::experiment::Experiment;
use crate::flight::pilot::{Orders, Pilot, Seen, Senses};
use crate::flight::vocabulary::{Cycle, Mode};
use crate::log::reader::{LoadedLog, sample};
use config::{Reference, Tables};
use control::waveform::Waveform;
use diagnose::thresholds::FIRST_EFFECT;
use diagnose::{Recording, Sample, kl_divergence};
use plant::Model;

/// Duties that differ by less are equal, percent: a 244th of the chip's resolution, 100/4096.
const EQUAL_PERCENT: f64 = 1e-4;

/// A stage before the plant where the loop deviated.
#[derive(Clone, Debug, PartialEq)]
pub struct Upstream {
    /// `controller` or `timing`.
    pub name: &'static str,
    /// Its log-likelihood gain, nats.
    pub nats: f64,
    /// What was found, with its numbers, and what to do.
    pub finding: String,
}

/// The stages before the plant where the loop of `log` deviated from its config, in the order of the signal path.
#[must_use]
pub fn upstream(log: &LoadedLog, model: &Model) -> Vec<Upstream> {
    let Some(tables) = log.config_toml.as_deref().and_then(|text| toml::from_str::<Tables>(text).ok()) else {
        return Vec::new();
    };
    let found = [controller(log, &tables, model), timing(log, &tables, model)];
    found.into_iter().flatten().filter(|stage| stage.nats >= FIRST_EFFECT).collect()
}

fn controller(log: &LoadedLog, tables: &Tables, model: &Model) -> Option<Upstream> {
    let cycles = under_the_law(log);
    let duties = duties_by_the_law(cycles, tables)?;
    let off: Vec<f64> = cycles.iter().zip(&duties).map(|(cycle, duty)| duty - cycle.commanded_duty_percent).collect();
    let worst = off.iter().fold(0.0, |worst: f64, off| worst.max(off.abs()));
    let excited = log.about.command.as_deref().is_some_and(|command| command.contains("--experiment"));
    if worst < EQUAL_PERCENT || excited {
        return None;
    }
    let flown = Recording::new(cycles.iter().map(sample).collect()).ok()?;
    let law = flown.samples().iter().zip(&off).map(|(s, off)| Sample { duty_percent: s.duty_percent + off, ..*s });
    let nats = kl_divergence(model, &flown, &Recording::new(law.collect()).ok()?);
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let finding = format!(
        "the controller in the log's config does not give the duty that was logged: {rms:.2} % rms over {} cycles, {worst:.2} % at \
         worst; compare its [controller] and [compensation] with what flew",
        off.len()
    );
    Some(Upstream { name: "controller", nats, finding })
}

/// The cycles from the first to the last one under the law of the config.
fn under_the_law(log: &LoadedLog) -> &[Cycle] {
    let until_s = log.law_changes_at_s();
    let goes_on = |k: usize, cycle: &Cycle| {
        let follows = k.checked_sub(1).is_none_or(|before| {
            let step_s = cycle.time_s - log.cycles[before].time_s;
            (step_s - cycle.period_s).abs() < 0.5 * cycle.period_s
        });
        let lawful = match cycle.mode {
            // After the end of a programme there is no setpoint.
            Mode::Flying => cycle.setpoint_mm.is_some(),
            Mode::Waiting | Mode::Coasting => true,
            Mode::OpenLoop | Mode::Stopped => false,
        };
        follows && lawful && cycle.time_s < until_s
    };
    let end = log.cycles.iter().enumerate().position(|(k, cycle)| !goes_on(k, cycle));
    &log.cycles[..end.unwrap_or(log.cycles.len())]
}

/// The duty that the configured law commands in each cycle, percent. `None`: the config has no law.
fn duties_by_the_law(cycles: &[Cycle], tables: &Tables) -> Option<Vec<f64>> {
    let first_mm = cycles.iter().find_map(|cycle| cycle.setpoint_mm)?;
    let hold = Reference { setpoint_mm: Waveform::Constant { value: first_mm } };
    let mut pilot = Pilot::new(Orders::of(tables, Experiment::of_reference(&hold)).ok()?);
    let two = tables.rig.as_ref().is_some_and(|rig| rig.second_sensor.is_some());
    let duty = |cycle: &Cycle| {
        if let Some(setpoint_mm) = cycle.setpoint_mm {
            pilot.command(Command::Setpoint(setpoint_mm)).ok()?;
        }
        let seen = |position_mm: Option<f64>| position_mm.map_or(Seen::Nothing(None), Seen::Ball);
        let senses = Senses {
            ball: seen(cycle.position_mm.filter(|_| cycle.fresh)),
            second: two.then(|| seen(cycle.position2_mm)),
            fan_rpm: cycle.fan_rpm,
        };
        Some(pilot.decide(cycle.time_s, senses).duty.percent())
    };
    cycles.iter().map(duty).collect()
}

fn timing(log: &LoadedLog, tables: &Tables, model: &Model) -> Option<Upstream> {
    let late_after_s = tables.r#loop?.late_after_s;
    let late = log.cycles.iter().filter(|cycle| cycle.lateness_s > late_after_s).count();
    let worst_s = log.cycles.iter().fold(0.0, |worst: f64, cycle| worst.max(cycle.lateness_s));
    if late == 0 {
        return None;
    }
    let nats = kl_divergence(model, &log.recording, &Recording::new(punctual(&log.cycles)).ok()?);
    let finding = format!(
        "{late} of {} cycles began more than {:.1} ms after their deadline, the worst {:.1} ms: the simulator keeps its deadlines; \
         take load from the computer, or lengthen loop.period_s",
        log.cycles.len(),
        1e3 * late_after_s,
        1e3 * worst_s
    );
    Some(Upstream { name: "timing", nats, finding })
}

/// The rows of the log with each duty written at the deadline of its cycle.
fn punctual(cycles: &[Cycle]) -> Vec<Sample> {
    let mut last_s = f64::NEG_INFINITY;
    let rows = cycles.iter().flat_map(|cycle| {
        let read = sample(cycle);
        let deadline_s = (read.time_s - cycle.lateness_s).max(last_s);
        last_s = read.time_s;
        [Sample { time_s: deadline_s, position_mm: None, position2_mm: None, fan_rpm: None, ..read }, read]
    });
    rows.collect()
}

#[cfg(test)]
mod tests;
