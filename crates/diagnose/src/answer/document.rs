//! A diagnosis as a machine-readable document (`airball.diagnosis/2`).

use crate::answer::closed_loop::{ClosedLoop, NextExperiment};
use crate::answer::diagnosis::Diagnosis;
use crate::answer::formula::FormulaTerm;
use crate::answer::ladder::{Rest, Rung};
use crate::answer::stages::StageShare;
use crate::answer::verdict::Verdict;
use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::gap::forecast_error::Gap;
use crate::gap::share_closed::Closed;
use crate::record::source_columns::SourceColumns;
use crate::residual::location::Place;
use crate::residual::spectrum::Band;
use crate::select::odds::Evidence;
use crate::select::stepwise::{Change, NamedEffect};
use crate::thresholds::SIGNIFICANT;
use plant::{Entry, Model};
use serde::Serialize;
use std::collections::BTreeMap;

/// Largest number of places in a document.
const MOST_PLACES: usize = 8;

/// What a document contains besides the diagnosis. Everything may be empty.
#[derive(Clone, Debug, Default)]
pub struct Context {
    /// The names of the logs, in the order of the recordings. Messages name the log if there are several.
    pub names: Vec<String>,
    /// The columns that they were read from.
    pub columns: SourceColumns,
    /// Their total length, seconds.
    pub duration_s: f64,
    /// Stages before the plant (`controller`, `timing`) that deviated from the config, and the nats of that deviation.
    pub deviations: Vec<(&'static str, f64)>,
    /// Further findings, as sentences.
    pub findings: Vec<String>,
    /// The closed loop before and after the correction of the model.
    pub closed_loop: Option<ClosedLoop>,
    /// The recommended next experiment.
    pub next_experiment: Option<NextExperiment>,
}

/// The document.
#[derive(Clone, Debug, Serialize)]
pub struct Document {
    schema: &'static str,
    verdict: Verdict,
    effects: Vec<EffectEntry>,
    parameters: BTreeMap<&'static str, ParameterEntry>,
    gap: GapEntry,
    ladder: Vec<Rung>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    formula: Vec<FormulaTerm>,
    rest: Rest,
    r#where: WhereEntry,
    check: CheckEntry,
    next_experiment: Option<NextExperiment>,
    version: &'static str,
    config_patch: String,
    #[serde(skip)]
    sentences: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct EffectEntry {
    name: &'static str,
    change: Change,
    probability: f64,
    evidence: Evidence,
    indistinguishable_from: Vec<&'static str>,
    parameters: BTreeMap<&'static str, Interval>,
}

/// A value with its 90 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The value.
    pub value: f64,
    /// Lower end; `None` if it is not identifiable.
    pub low: Option<f64>,
    /// Upper end; `None` if it is not identifiable.
    pub high: Option<f64>,
    /// The bound of the possible values on this record, if the value lies at it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_bound: Option<f64>,
}

/// A base parameter: believed and found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ParameterEntry {
    /// The believed value.
    pub nominal: f64,
    /// The value of the mended model.
    #[serde(flatten)]
    pub interval: Interval,
}

#[derive(Clone, Debug, Serialize)]
struct GapEntry {
    horizons_s: [f64; 3],
    nominal_mm: [Option<f64>; 3],
    refitted_mm: [Option<f64>; 3],
    mended_mm: [Option<f64>; 3],
    floor_mm: [Option<f64>; 3],
    stay_put_mm: [Option<f64>; 3],
    free_run_10s_mm: BTreeMap<&'static str, Option<f64>>,
    closed_loop: Option<ClosedLoop>,
    closed: Option<Closed>,
}

#[derive(Clone, Debug, Serialize)]
struct WhereEntry {
    stage: Vec<StageShare>,
    regions: Vec<Place>,
    frequency_hz: Option<Band>,
}

#[derive(Clone, Debug, Serialize)]
struct CheckEntry {
    logs: usize,
    duration_s: f64,
    findings: Vec<String>,
}

impl Document {
    /// The verdict in a sentence, then one sentence for each effect and for the residual.
    #[must_use]
    pub fn sentences(&self) -> &[String] {
        &self.sentences
    }

    /// The mended model as a config patch (TOML); empty if nothing changes.
    #[must_use]
    pub fn config_patch(&self) -> &str {
        &self.config_patch
    }
}

impl Diagnosis {
    /// The document of this diagnosis; `belief`: the believed model.
    #[must_use]
    pub fn document(&self, belief: &Model, context: &Context) -> Document {
        Document {
            schema: "airball.diagnosis/2",
            verdict: self.verdict,
            effects: self.effects.iter().map(|named| self.effect_entry(named)).collect(),
            parameters: self.base_parameters(belief),
            gap: self.gap_entry(context.closed_loop),
            ladder: self.ladder.clone(),
            formula: self.formula_terms(),
            rest: self.rest,
            r#where: WhereEntry {
                stage: self.stage_shares(&context.deviations),
                regions: self.regions(),
                frequency_hz: self.band.filter(|_| self.verdict != Verdict::NoGap),
            },
            check: CheckEntry {
                logs: context.names.len(),
                duration_s: context.duration_s,
                findings: self.findings_in_words(context),
            },
            next_experiment: context.next_experiment.clone(),
            version: env!("CARGO_PKG_VERSION"),
            config_patch: self.patch_toml(),
            sentences: self.sentences(),
        }
    }

    /// The places where the refitted belief is significantly wrong, the most significant first.
    #[must_use]
    pub fn regions(&self) -> Vec<Place> {
        self.places.iter().filter(|place| place.p_value < SIGNIFICANT).take(MOST_PLACES).cloned().collect()
    }

    /// Gain, drag and hover by their keys of the config: believed and mended.
    #[must_use]
    pub fn base_parameters(&self, belief: &Model) -> BTreeMap<&'static str, ParameterEntry> {
        let known = self.intervals();
        let entry = |parameter: Parameter| {
            let of = |model| parameter.value(model).unwrap_or(f64::NAN);
            let found = known.iter().find(|(other, ..)| *other == parameter);
            ParameterEntry { nominal: of(belief), interval: self.with_ends(parameter, of(&self.mended.model), found) }
        };
        [Parameter::Gain, Parameter::Drag, Parameter::Hover].into_iter().map(|one| (one.key(), entry(one))).collect()
    }

    /// The parameters of an effect that was found, by their keys of the config.
    #[must_use]
    pub fn effect_parameters(&self, named: &NamedEffect) -> BTreeMap<&'static str, Interval> {
        self.parameters_of(named.candidate.entry)
    }

    /// The parameters of an effect of the mended model, or of a named one that it lacks.
    pub(super) fn parameters_of(&self, entry: &'static Entry) -> BTreeMap<&'static str, Interval> {
        let own = |fit: &Fit| fit.model.effects.values(entry.name);
        let values = own(&self.mended).or_else(|| own(&self.with_effects)).unwrap_or_default();
        let known = self.intervals();
        let parameters = entry.params.iter().zip(&values).enumerate().map(|(index, (param, value))| {
            let parameter = Parameter::Effect { entry, index, size: 1.0 };
            let found = known.iter().find(|(one, ..)| one.index_in(entry.name) == Some(index));
            (param.name, self.with_ends(parameter, *value, found))
        });
        parameters.collect()
    }

    fn with_ends(&self, parameter: Parameter, value: f64, known: Option<&(Parameter, f64, f64)>) -> Interval {
        let answers = self.verdict != Verdict::InsufficientData;
        let at_bound = self.bounds.active(parameter, &self.mended.model).filter(|_| answers);
        let ends = known.filter(|(_, low, high)| (high - low).is_finite());
        Interval { value, low: ends.map(|ends| ends.1), high: ends.map(|ends| ends.2), at_bound }
    }

    fn effect_entry(&self, named: &NamedEffect) -> EffectEntry {
        EffectEntry {
            name: named.candidate.entry.name,
            change: named.change,
            probability: named.probability,
            evidence: named.evidence,
            indistinguishable_from: named.indistinguishable_from.clone(),
            parameters: self.effect_parameters(named),
        }
    }

    fn gap_entry(&self, closed_loop: Option<ClosedLoop>) -> GapEntry {
        let [nominal, refitted, mended] = &self.gaps;
        let free = |gap: &Gap| gap.free_run_10s_mm;
        GapEntry {
            horizons_s: nominal.horizons_s,
            nominal_mm: nominal.error_mm,
            refitted_mm: refitted.error_mm,
            mended_mm: mended.error_mm,
            floor_mm: mended.floor_mm,
            stay_put_mm: nominal.stay_put_mm,
            free_run_10s_mm: BTreeMap::from([
                ("nominal", free(nominal)),
                ("refitted", free(refitted)),
                ("mended", free(mended)),
                ("floor", mended.floor_free_run_10s_mm),
            ]),
            closed_loop,
            closed: self.closed,
        }
    }

    /// The findings of each log, with its name if there are several, the findings of the context, and the residual in
    /// words.
    fn findings_in_words(&self, context: &Context) -> Vec<String> {
        let several = context.names.len() > 1;
        let of_rows = self.findings.iter().map(|noted| {
            let name = context.names.get(noted.flight).map_or("", String::as_str);
            let said = noted.finding.in_columns(&context.columns);
            if several { format!("{name}: {said}") } else { said }
        });
        of_rows.chain(context.findings.iter().cloned()).chain(self.residual_in_words()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Context;
    use crate::tests_support::{model, record};
    use crate::{Options, diagnose};
    use plant::{Effects, Model};

    #[test]
    fn a_document_without_any_context_says_verdict_effects_and_patch() {
        let belief = Model { effects: Effects::default(), drag_per_s: 1.95, ..model() };
        let found = diagnose(&belief, &record(&model(), 1, 60), &Options::default());
        let document = found.document(&belief, &Context::default());
        assert!(document.config_patch().contains("[plant.effects."), "{}", document.config_patch());
        assert!(document.sentences()[0].starts_with("The rig has "), "{:?}", document.sentences());
        assert_eq!(document.sentences().len(), 1 + found.effects.len(), "{:?}", document.sentences());
        // The check of the record is that of the diagnosis; nothing was said beside it.
        assert_eq!(document.check.findings.len(), found.findings.len());
        assert!(document.next_experiment.is_none() && document.gap.closed_loop.is_none());
    }
}
