//! The names that the formulas of one definition may use, each at its place among the values of an evaluation.

use super::scope::{STATE, is_variable, variables};
use super::table::{DefinitionError, DefinitionTable, check_count_of_states};
use super::text::shown;
use crate::effect::Stage;
use crate::motion::OWN_STATES;
use formula::{Formula, Mistake, MistakeKind, is_free_name};
use std::ops::Range;

/// The names of a definition's formulas, with their bounds.
pub(super) struct Names<'a> {
    stage: Stage,
    names: Vec<&'a str>,
    /// The bounds of their values, in the same order.
    pub(super) bounds: Vec<[f64; 2]>,
    states: Range<usize>,
    /// The place of the first parameter.
    parameters: usize,
}

impl<'a> Names<'a> {
    pub(super) fn of(table: &'a DefinitionTable) -> Result<Self, DefinitionError> {
        let has_states = table.stage != Stage::Actuator;
        let (mut names, mut bounds): (Vec<&str>, Vec<[f64; 2]>) = variables(table.stage).iter().copied().unzip();
        let variables = names.len();
        check_count_of_states(table, has_states)?;
        let mut states: Vec<&str> = table.states.keys().map(String::as_str).collect();
        for state in &states {
            check_new(state, &names, "states")?;
        }
        let count = states.len();
        // An effect without states has places for them, too, so that every one is evaluated alike.
        states.resize(if has_states { OWN_STATES } else { 0 }, "");
        bounds.resize(bounds.len() + states.len(), STATE);
        names.extend(states);
        let parameters = names.len();
        for (name, parameter) in &table.parameters {
            check_new(name, &names, "parameters")?;
            names.push(name);
            bounds.push([parameter.low, parameter.high]);
        }
        Ok(Self { stage: table.stage, names, bounds, states: variables..variables + count, parameters })
    }

    /// The same names with none for the own states.
    pub(super) fn without_states(&self) -> Self {
        let mut names = self.names.clone();
        names[self.states.clone()].fill("");
        Self { names, bounds: self.bounds.clone(), states: self.states.clone(), ..*self }
    }

    pub(super) fn place(&self, name: &str) -> usize {
        self.names.iter().position(|known| *known == name).unwrap_or(usize::MAX)
    }

    /// Reads a formula, which must have a value wherever its names are within their bounds.
    pub(super) fn formula(&self, key: &str, text: &str) -> Result<Formula, DefinitionError> {
        let bounds: Vec<(f64, f64)> = self.bounds.iter().map(|[low, high]| (*low, *high)).collect();
        let read = Formula::parse(text, &self.names).and_then(|formula| formula.range(&bounds).map(|_| formula));
        read.map_err(|mistake| {
            let message = self.not_here(&mistake).unwrap_or_else(|| mistake.to_string());
            DefinitionError { key: key.into(), message: format!("`{}`, {message}", shown(text)) }
        })
    }

    /// What is wrong with a name that other stages know.
    fn not_here(&self, mistake: &Mistake) -> Option<String> {
        let MistakeKind::UnknownVariable { name, names, .. } = &mistake.kind else { return None };
        is_variable(name).then(|| {
            let (column, stage, known) = (mistake.column, self.stage.name(), names.join(", "));
            format!("column {column}: the stage {stage} does not know `{name}`; there are {known}")
        })
    }

    /// Checks that every parameter and every state occurs.
    pub(super) fn all_used(&self, adds: &Formula, states: &[[Formula; 2]]) -> Result<(), DefinitionError> {
        let formulas = || std::iter::once(adds).chain(states.iter().flatten());
        let own = self.states.clone().chain(self.parameters..self.names.len());
        let unused = own.into_iter().find(|place| !formulas().any(|formula| formula.uses(*place)));
        match unused {
            Some(place) => Err(DefinitionError {
                key: String::new(),
                message: format!("`{}` occurs in no formula; use it in `adds`, or remove it", self.names[place]),
            }),
            None => Ok(()),
        }
    }
}

/// Checks that a formula may use a new name beside those that it has.
fn check_new(name: &str, names: &[&str], table: &str) -> Result<(), DefinitionError> {
    if is_free_name(name) && !names.contains(&name) {
        return Ok(());
    }
    let message = format!("`{}` is a name that formulas have already; choose another", shown(name));
    Err(DefinitionError { key: format!("{table}.{name}"), message })
}
