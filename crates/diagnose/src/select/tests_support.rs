//! A rig for tests whose effect is not in the catalogue.

use crate::tests_support::model;
use plant::{Definition, DefinitionTable, Model, ParameterTable, Stage};

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
