//! For tests of the search: a rig whose effect is not in the catalogue, and the options of a search for few effects.

use crate::options::Options;
use crate::tests_support::model;
use plant::{Definition, DefinitionTable, Effects, Model, ParameterTable, Stage};

/// Options of a search for these effects alone, without a formula: few are sought, because that is quicker.
pub(crate) fn seeking(sought: &[&str]) -> Options {
    let others = Effects::CATALOGUE.iter().map(|entry| entry.name).filter(|name| !sought.contains(name));
    Options { without: others.map(str::to_owned).collect(), without_formula: true, ..Options::default() }
}

/// A rig with a force of this size and form that no effect of the catalogue has.
pub(super) fn with_force(adds: &str, size: f64) -> Model {
    let range =
        ParameterTable { neutral: Some(0.0), value: None, scale: None, low: -500.0, high: 500.0, unit: String::new() };
    let table = DefinitionTable {
        stage: Stage::Air,
        adds: adds.into(),
        looks: String::new(),
        mend: String::new(),
        parameters: [("size".into(), range)].into(),
        states: [].into(),
    };
    let mut rig = model();
    rig.effects.written.define(Definition::new("strange_force", &table).unwrap());
    rig.effects.set("strange_force", &[size]);
    rig
}
