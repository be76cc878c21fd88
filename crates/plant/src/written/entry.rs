//! The entry of a written effect, as those of the catalogue are: its sizes and where a search for it starts.

use super::intern;
use super::table::{DefinitionTable, ParameterTable};
use crate::acts::Summary;
use crate::effect::{Entry, Form, Neutral, Param, Scale, Start};

/// The entry that a search reads.
pub(super) fn entry(name: &str, table: &DefinitionTable) -> Entry {
    let parameters: Vec<&ParameterTable> = table.parameters.values().collect();
    let param = |(name, parameter): (&String, &ParameterTable)| Param {
        name: intern::text(name),
        min: parameter.low,
        max: parameter.high,
        neutral: match parameter.neutral {
            Some(neutral) => Neutral::At(neutral),
            None => Neutral::Any(parameter.value.unwrap_or(parameter.low)),
        },
        scale: if parameter.neutral.is_some() { Scale::Value } else { Scale::Height(scale(parameter)) },
    };
    let at = |steps: f64, share: Option<f64>| -> &'static [f64] {
        intern::list(parameters.iter().map(|parameter| size(parameter, steps, share)).collect())
    };
    let mut starts = Vec::new();
    // From the value itself and from the quarters of its range. The diagnosis scans the range as well.
    let has_value = parameters.iter().any(|parameter| parameter.value.is_some());
    for share in [None, Some(0.25), Some(0.75)].into_iter().take(if has_value { 3 } else { 1 }) {
        starts.extend([1.0, -1.0].map(|side| at(side, share)));
    }
    // Both sides are one where the bounds end at the neutral value.
    starts.dedup();
    Entry {
        name: intern::text(name),
        stage: table.stage,
        article: "a ",
        params: intern::list(table.parameters.iter().map(param).collect()),
        sizes: intern::list(vec![at(1.0, None), at(3.0, None)]),
        start: Start::Values(intern::list(starts)),
        form: Form::Approximate,
        in_a_log: intern::text(&table.looks),
        mend: intern::text(&table.mend),
        acts: Summary::written(!table.states.is_empty()),
        ..Entry::PLAIN
    }
}

/// A typical change of a parameter.
fn scale(parameter: &ParameterTable) -> f64 {
    parameter.scale.unwrap_or(0.1 * (parameter.high - parameter.low))
}

/// A parameter so many scales from neutral, on the other side where the bounds end before; or a value at this share of
/// its range, or as it is given.
fn size(parameter: &ParameterTable, steps: f64, share: Option<f64>) -> f64 {
    let ParameterTable { low, high, .. } = *parameter;
    let step = steps * scale(parameter);
    match (parameter.neutral, share) {
        (Some(neutral), _) if (low..=high).contains(&(neutral + step)) => neutral + step,
        (Some(neutral), _) => (neutral - step).clamp(low, high),
        (None, Some(share)) => low + share * (high - low),
        (None, None) => parameter.value.unwrap_or(low),
    }
}
