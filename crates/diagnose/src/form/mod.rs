//! The form of an unexplained force: the smallest sum of terms that predicts stretches of the record that it was not
//! fitted to.
//!
//! ```text
//! a = Σ c_i·φ_i(x, v, u, memory)        φ: see `dictionary`; at most four terms
//! ```
//!
//! Each term is chosen by the held-out log-likelihood of a linear regression of the innovations, see `selection`. The
//! sum is then an effect like those that a user writes, and is fitted with all other parameters of the model. It states
//! the shape of what is missing, not its nature.

mod dictionary;
mod selection;

use crate::fit::estimate::Fit;
use crate::fit::parameter::{Parameter, parameters_of_effect};
use crate::residual::score_test::{FilterRun, QUIETER, quieter};
use crate::select::search::Search;
use crate::thresholds::FORM_OF_THE_UNEXPLAINED;
use dictionary::{FormTerm, Scales, dictionary};
use plant::{Definition, DefinitionTable, Model, ParameterTable, Stage, StateTable};
use rayon::prelude::*;
use selection::{Regression, Selected};
use std::collections::BTreeMap;

/// The name of the effect that has the form.
const NAME: &str = "unexplained_force";

/// The form of the unexplained force.
#[derive(Clone, Debug)]
pub struct Form {
    /// The effect that has it.
    pub definition: &'static Definition,
    /// Its terms in words, in the order of its parameters.
    pub terms: Vec<&'static str>,
    /// Held-out log-likelihood gain over the model without it, nats.
    pub held_out_gain: f64,
}

/// The parameters that are fitted beside the coefficients. Gain and drag stay: a sum of terms could take their place.
const BESIDE: [Parameter; 3] = [Parameter::Hover, Parameter::SensorNoise, Parameter::AirNoise];

/// The form of the force that `model` lacks, and the fit with it; `None`: no sum of terms predicts what it was not
/// fitted to.
pub(crate) fn form(search: &Search<'_>, model: &Model) -> Option<(Form, Fit)> {
    let problem = &search.problem;
    let fit = &problem.fit(model, &BESIDE);
    let rows = |row: usize| problem.folds.counts(row);
    let runs = [1.0, QUIETER[0], QUIETER[1]].map(|share| FilterRun::of(problem, quieter(fit, share), &rows));
    let scales = Scales::of(search.problem.recording, &fit.model)?;
    let most = plant::OWN_STATES - fit.model.effects.own_states();
    let terms = dictionary(&scales);
    let chosen = runs.par_iter().map(|run| {
        let (chosen, gain) = Regression::of(problem, run, &terms).selected(&terms, most);
        (chosen, run.log_likelihood() + gain)
    });
    let (chosen, _) = chosen.filter(|(chosen, _)| !chosen.is_empty()).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (form, with) = fitted(search, fit, &terms, &chosen)?;
    let held_out_gain = search.held_out_total(&with) - search.held_out_total(fit);
    (held_out_gain >= FORM_OF_THE_UNEXPLAINED).then_some((Form { held_out_gain, ..form }, with))
}

/// The fit with these terms; the gain of the form is not known yet.
fn fitted(search: &Search<'_>, fit: &Fit, terms: &[FormTerm], chosen: &[Selected]) -> Option<(Form, Fit)> {
    let used: Vec<&FormTerm> = chosen.iter().map(|one| &terms[one.term]).collect();
    let definition = Definition::new(NAME, &table(&used, chosen)).ok()?;
    let mut effects = fit.model.effects.clone();
    effects.written.define(definition);
    let values: Vec<f64> = chosen.iter().map(|one| one.coefficient).collect();
    effects.set(NAME, &values);
    let model = Model { effects, ..fit.model.clone() };
    model.check().ok()?;
    let own = parameters_of_effect(definition.entry(), &values);
    let parameters: Vec<_> = fit.parameters.iter().copied().chain(own).collect();
    let fit = search.problem.fit(&model, &parameters);
    let form = Form { definition, terms: used.iter().map(|term| term.words).collect(), held_out_gain: 0.0 };
    Some((form, fit))
}

/// The table of the effect that is the sum of these terms, with parameters `c1`, `c2` … in mm/s².
fn table(used: &[&FormTerm], chosen: &[Selected]) -> DefinitionTable {
    let (mut adds, mut states, mut parameters) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
    for (number, (term, one)) in (1..).zip(used.iter().zip(chosen)) {
        let state = format!("s{}", states.len() + 1);
        if let Some(memory) = &term.memory {
            let rate = format!("({} - {state}) / {}", memory.of, memory.time_constant_s);
            states.insert(state.clone(), StateTable { rate, start: memory.of.clone() });
        }
        adds.push(format!("c{number} * {}", term.value.replace(dictionary::MEMORY, &state)));
        let high = (100.0 * one.coefficient.abs()).clamp(1.0, 1e9);
        parameters.insert(
            format!("c{number}"),
            ParameterTable {
                neutral: Some(0.0),
                value: None,
                scale: Some((0.5 * one.coefficient.abs()).clamp(1e-6, high)),
                low: -high,
                high,
                unit: "mm/s2".into(),
            },
        );
    }
    DefinitionTable {
        stage: Stage::Air,
        adds: adds.join(" + "),
        looks: "no effect of the catalogue has this form".into(),
        mend: "look for what depends on the variables of the formula".into(),
        parameters,
        states,
    }
}
