//! Effects that a user wrote, for tests of the filter.

use plant::{Definition, DefinitionTable, Model, ParameterTable, Stage, StateTable};

/// `model` with an effect of this stage that adds `adds`. Its parameter `k` is neutral at 0; a state `s` has a rate and
/// a value at rest.
pub(crate) fn with_written(mut model: Model, stage: Stage, adds: &str, s: Option<[&str; 2]>, k: f64) -> Model {
    let parameter =
        ParameterTable { neutral: Some(0.0), value: None, scale: None, low: -100.0, high: 100.0, unit: String::new() };
    let state = s.map(|[rate, start]| ("s".to_owned(), StateTable { rate: rate.into(), start: start.into() }));
    let table = DefinitionTable {
        stage,
        adds: adds.into(),
        looks: String::new(),
        mend: String::new(),
        parameters: [("k".to_owned(), parameter)].into(),
        states: state.into_iter().collect(),
    };
    model.effects.written.define(Definition::new("of_a_test", &table).unwrap());
    assert!(model.effects.set("of_a_test", &[k]));
    model
}
