//! A diagnosis as a document for programs (`airball.diagnosis/1`).

use super::left_over::left_over;
use super::logs::{Logs, sentences};
use super::patch::patch;
use super::stages::{StageEntry, stages};
use crate::analysis::closed_loop::ClosedLoop;
use crate::analysis::next_experiment::{Advice, Next};
use diagnose::{Band, Change, Closed, Diagnosis, Free, Gap, Named, Place, Verdict};
use plant::Model;
use serde::Serialize;
use std::collections::BTreeMap;

/// A place or a band is wrong by more than chance when its p-value, over all that were looked at, is below this.
pub const SIGNIFICANT: f64 = 0.05;
/// Places that a document lists at most.
const MOST_PLACES: usize = 8;

/// The document that `diagnose --json` writes.
#[derive(Debug, Serialize)]
pub struct DiagnosisDocument {
    schema: &'static str,
    verdict: Verdict,
    effects: Vec<EffectEntry>,
    parameters: BTreeMap<&'static str, ParameterEntry>,
    gap: GapEntry,
    r#where: WhereEntry,
    check: CheckEntry,
    next_experiment: Option<Next>,
    version: &'static str,
    config_patch: String,
}

#[derive(Debug, Serialize)]
struct EffectEntry {
    name: &'static str,
    change: Change,
    probability: f64,
    indistinguishable_from: Vec<&'static str>,
    parameters: BTreeMap<&'static str, Interval>,
}

/// A value with its 90 % interval; `null` ends where the record does not determine it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Interval {
    pub value: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

#[derive(Debug, Serialize)]
pub struct ParameterEntry {
    pub nominal: f64,
    #[serde(flatten)]
    pub interval: Interval,
}

#[derive(Debug, Serialize)]
struct GapEntry {
    horizons_s: [f64; 3],
    nominal_mm: [Option<f64>; 3],
    refitted_mm: [Option<f64>; 3],
    mended_mm: [Option<f64>; 3],
    floor_mm: [Option<f64>; 3],
    stay_put_mm: [Option<f64>; 3],
    free_run_10s_mm: BTreeMap<&'static str, Option<f64>>,
    closed_loop: ClosedLoop,
    closed: Option<Closed>,
}

#[derive(Debug, Serialize)]
struct WhereEntry {
    stage: Vec<StageEntry>,
    regions: Vec<Place>,
    frequency_hz: Option<Band>,
}

#[derive(Debug, Serialize)]
struct CheckEntry {
    logs: usize,
    duration_s: f64,
    findings: Vec<String>,
}

impl DiagnosisDocument {
    /// The document of a diagnosis of a rig that was believed to be `belief`, with its closed loop, what to fly next, and
    /// the stages before the plant.
    #[must_use]
    pub fn of(found: &Diagnosis, belief: &Model, closed_loop: &ClosedLoop, advice: &Advice, logs: &Logs<'_>) -> Self {
        let known = found.intervals();
        Self {
            schema: "airball.diagnosis/1",
            verdict: found.verdict,
            effects: found.effects.iter().map(|named| effect(named, found, &known)).collect(),
            parameters: parameters(found, belief, &known),
            gap: gap(found, *closed_loop),
            r#where: WhereEntry {
                stage: stages(found, logs),
                regions: regions(found),
                frequency_hz: found.band.filter(|_| found.verdict != Verdict::NoGap),
            },
            check: CheckEntry {
                logs: logs.names.len(),
                duration_s: logs.duration_s,
                findings: sentences(found, advice, logs).into_iter().chain(left_over(found)).collect(),
            },
            next_experiment: advice.experiment.clone(),
            version: env!("CARGO_PKG_VERSION"),
            config_patch: patch(found),
        }
    }
}

/// A number's interval among those of the diagnosis.
fn interval(value: f64, known: &[(Free, f64, f64)], wanted: impl Fn(&Free) -> bool) -> Interval {
    let ends = known.iter().find(|(free, ..)| wanted(free)).filter(|(_, low, high)| (high - low).is_finite());
    Interval { value, low: ends.map(|ends| ends.1), high: ends.map(|ends| ends.2) }
}

/// The numbers of an effect that was found.
pub fn effect_intervals(
    named: &Named,
    found: &Diagnosis,
    known: &[(Free, f64, f64)],
) -> BTreeMap<&'static str, Interval> {
    let entry = named.candidate.entry;
    let values = found.mended.model.effects.values(entry.name).unwrap_or_default();
    let parameters = entry.params.iter().zip(&values).enumerate().map(|(at, (param, value))| {
        let mine =
            |free: &Free| matches!(free, Free::Effect { name, index, .. } if *name == entry.name && *index == at);
        (param.name, interval(*value, known, mine))
    });
    parameters.collect()
}

fn effect(named: &Named, found: &Diagnosis, known: &[(Free, f64, f64)]) -> EffectEntry {
    EffectEntry {
        name: named.candidate.entry.name,
        change: named.change,
        probability: named.probability,
        indistinguishable_from: named.indistinguishable_from.clone(),
        parameters: effect_intervals(named, found, known),
    }
}

/// Gain, drag and hover: what was believed, and what the mended model has.
pub fn parameters(
    found: &Diagnosis,
    belief: &Model,
    known: &[(Free, f64, f64)],
) -> BTreeMap<&'static str, ParameterEntry> {
    let number = |free: Free| {
        let of = |model: &Model| free.value(model).unwrap_or(f64::NAN);
        ParameterEntry {
            nominal: of(belief),
            interval: interval(of(&found.mended.model), known, |other| *other == free),
        }
    };
    BTreeMap::from([
        ("gain_mm_per_s2_per_percent", number(Free::Gain)),
        ("drag_per_s", number(Free::Drag)),
        ("hover_duty_percent", number(Free::Hover)),
    ])
}

fn gap(found: &Diagnosis, closed_loop: ClosedLoop) -> GapEntry {
    let [nominal, refitted, mended] = &found.gaps;
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
        closed: found.closed,
    }
}

/// The places where the refitted belief is significantly wrong, the most significant first.
#[must_use]
pub fn regions(found: &Diagnosis) -> Vec<Place> {
    found.places.iter().filter(|place| place.p_value < SIGNIFICANT).take(MOST_PLACES).cloned().collect()
}
