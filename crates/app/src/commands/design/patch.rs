//! A design as a config patch: the tables that make the designed controller fly.

use crate::analysis::loop_margins::Closing;
use crate::report::design::words::Feedback;
use crate::report::kit::patch::rounded;
use anyhow::{Result, anyhow};
use config::Tables;
use control::controller::{Controllers, Kind};
use control::design::law::{Gains, Weights};
use control::inputs::Source;
use control::observer::Observer;
use control::pid::{DerivativeOn, Pid};
use control::state_feedback::StateFeedback;
use toml::Value;

/// The patch of a controller. Keys that a design does not set, such as limits of rates and integrals, keep the config's
/// values.
///
/// # Errors
/// Numbers that TOML cannot hold.
pub(super) fn of(closing: &Closing, feedback: Option<&Feedback>) -> Result<String> {
    match (closing, feedback) {
        (Closing::Lqg(observed), _) => {
            let set = Controllers { active: Some(Kind::Lqg), lqg: Some(observed.feedback), ..Controllers::default() };
            written(&Tables { controller: Some(set), observer: Some(observed.observer), ..Tables::default() })
        }
        (Closing::Pid(..), Some(feedback)) => written(&controllers(Controllers {
            active: Some(Kind::StateFeedback),
            state_feedback: Some(StateFeedback {
                position_per_mm: feedback.gain[0],
                velocity_s_per_mm: feedback.gain[1],
                setpoint_per_mm: Some(feedback.setpoint_gain),
                velocity: Source::Filter,
                integral: feedback.integral,
            }),
            ..Controllers::default()
        })),
        (Closing::Pid(gains, weights), None) => pid(gains, weights),
    }
}

/// The patch of an observer.
///
/// # Errors
/// Numbers that TOML cannot hold.
pub(super) fn of_observer(observer: Observer) -> Result<String> {
    written(&Tables { observer: Some(observer), ..Tables::default() })
}

fn pid(gains: &Gains, weights: &Weights) -> Result<String> {
    let Gains { kp_per_mm, ti_s, td_s, derivative_n } = *gains;
    let on = if weights.derivative > 0.0 { DerivativeOn::Error } else { DerivativeOn::Measurement };
    let law = Pid::new(kp_per_mm, ti_s, td_s, derivative_n, on);
    let tables = controllers(Controllers { active: Some(Kind::Pid), ..Controllers::only_pid(law) });
    let mut patch = toml::Table::try_from(&tables)?;
    // A weight of 1 is left out of a config; here it must override another one.
    let table = patch.get_mut("controller").and_then(|table| table.get_mut("pid")).and_then(Value::as_table_mut);
    let table = table.ok_or_else(|| anyhow!("the patch has no table of the PID; please report it"))?;
    table.insert("setpoint_weight".into(), Value::Float(weights.setpoint));
    Ok(rounded(&toml::to_string(&patch)?))
}

fn controllers(set: Controllers) -> Tables {
    Tables { controller: Some(set), ..Tables::default() }
}

fn written(tables: &Tables) -> Result<String> {
    Ok(rounded(&toml::to_string(tables)?))
}
