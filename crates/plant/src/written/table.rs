//! The table of a written effect in a config file, and what must hold for it before its formulas are read.

use super::scope::MOST_PARAMETERS;
use super::text::shown;
use crate::effect::Stage;
use crate::effects::Effects;
use crate::motion::OWN_STATES;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `[effect.NAME]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DefinitionTable {
    /// Where it acts.
    pub stage: Stage,
    /// What it adds: percent of duty in the actuator, mm/s² in the air and at the ball, mm in the sensor.
    pub adds: String,
    /// How a log shows it.
    #[serde(default)]
    pub looks: String,
    /// How to correct it on a rig.
    #[serde(default)]
    pub mend: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, ParameterTable>,
    /// Its own states.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub states: BTreeMap<String, StateTable>,
}

/// A parameter. It has a neutral value, at which the effect does nothing, or a value that matters only while another
/// parameter is not neutral.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterTable {
    /// The value at which the effect does nothing, the others that have one being neutral too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub neutral: Option<f64>,
    /// The value from which a search starts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// A typical size of a change; without it a tenth of the range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
    /// Its unit, for people.
    #[serde(default)]
    pub unit: String,
}

/// A state of first order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateTable {
    /// Its derivative by time.
    pub rate: String,
    /// Its value where everything has been constant for ever; without it 0.
    #[serde(default = "zero")]
    pub start: String,
}

fn zero() -> String {
    "0".to_owned()
}

/// What is wrong with a definition.
#[derive(Clone, Debug, PartialEq)]
pub struct DefinitionError {
    /// The key within `[effect.NAME]`, dotted; empty: the table itself.
    pub key: String,
    /// What is wrong there, with the column of a formula, and what to do.
    pub message: String,
}

pub(super) fn check_name(name: &str) -> Result<(), DefinitionError> {
    let wrong = |message: String| Err(DefinitionError { key: String::new(), message });
    let plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_';
    if !name.starts_with(|first: char| first.is_ascii_lowercase()) || !name.chars().all(plain) || name.len() > 40 {
        let name = shown(name);
        return wrong(format!("`{name}` is no name of an effect; use up to 40 of a-z, 0-9 and _, a letter first"));
    }
    if Effects::built_in(name).is_some() {
        return wrong(format!("`{name}` is an effect of the catalogue; choose another name"));
    }
    Ok(())
}

pub(super) fn check_count_of_states(table: &DefinitionTable, may_have: bool) -> Result<(), DefinitionError> {
    let (count, most) = (table.states.len(), if may_have { OWN_STATES } else { 0 });
    if count <= most {
        return Ok(());
    }
    let message = format!("{count} states, and at this stage an effect has at most {most}");
    Err(DefinitionError { key: "states".into(), message })
}

pub(super) fn check_parameters(table: &DefinitionTable) -> Result<(), DefinitionError> {
    let wrong = |key: &str, message: String| Err(DefinitionError { key: key.into(), message });
    let count = table.parameters.len();
    if count > MOST_PARAMETERS {
        return wrong("parameters", format!("{count} parameters, and an effect has at most {MOST_PARAMETERS}"));
    }
    if table.parameters.values().all(|parameter| parameter.neutral.is_none()) {
        return wrong(
            "parameters",
            "no parameter has a neutral value, at which the effect does nothing; give one `neutral = 0.0`".into(),
        );
    }
    for (name, parameter) in &table.parameters {
        check_parameter(parameter).map_err(|message| DefinitionError { key: format!("parameters.{name}"), message })?;
    }
    Ok(())
}

fn check_parameter(parameter: &ParameterTable) -> Result<(), String> {
    let ParameterTable { low, high, scale, .. } = parameter;
    let start = match (parameter.neutral, parameter.value) {
        (Some(start), None) | (None, Some(start)) => start,
        _ => return Err("give either `neutral`, at which the effect does nothing, or `value`; not both".into()),
    };
    // Beyond this, products of a formula would overflow.
    if !(low.abs() <= 1e9 && high.abs() <= 1e9 && low < high) {
        return Err(format!("low = {low} and high = {high}; both must lie within ±1e9, low below high"));
    }
    if !(*low..=*high).contains(&start) {
        return Err(format!("{start} is not within {low} to {high}; move it or the bounds"));
    }
    match scale {
        Some(scale) if !(*scale > 0.0 && *scale <= high - low) => {
            Err(format!("scale = {scale} must be above 0 and at most {}, the range", high - low))
        }
        _ => Ok(()),
    }
}
