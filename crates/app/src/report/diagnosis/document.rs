//! A diagnosis as a document for programs (`airball.diagnosis/1`), as words for people, and as a patch for the simulator.

use super::left_over::left_over;
use super::logs::{Logs, sentences};
use super::mend;
use super::stages::{StageEntry, stages};
use crate::analysis::closed_loop::ClosedLoop;
use crate::analysis::next_experiment::{Advice, Next};
use crate::report::kit::page::parts::places;
use control::compensation::Compensation;
use diagnose::{Band, Change, Closed, Diagnosis, Gap, NamedEffect, Parameter, Place, Verdict};
use plant::Model;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

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
    /// The document of a diagnosis of a rig that was believed to be `belief`, with its closed loop, what to fly next, and the stages
    /// before the plant.
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
fn interval(value: f64, known: &[(Parameter, f64, f64)], wanted: impl Fn(&Parameter) -> bool) -> Interval {
    let ends = known.iter().find(|(free, ..)| wanted(free)).filter(|(_, low, high)| (high - low).is_finite());
    Interval { value, low: ends.map(|ends| ends.1), high: ends.map(|ends| ends.2) }
}

/// The numbers of an effect that was found.
pub fn effect_intervals(
    named: &NamedEffect,
    found: &Diagnosis,
    known: &[(Parameter, f64, f64)],
) -> BTreeMap<&'static str, Interval> {
    let entry = named.candidate.entry;
    let values = found.mended.model.effects.values(entry.name).unwrap_or_default();
    let parameters = entry.params.iter().zip(&values).enumerate().map(|(at, (param, value))| {
        let mine =
            |free: &Parameter| matches!(free, Parameter::Effect { name, index, .. } if *name == entry.name && *index == at);
        (param.name, interval(*value, known, mine))
    });
    parameters.collect()
}

fn effect(named: &NamedEffect, found: &Diagnosis, known: &[(Parameter, f64, f64)]) -> EffectEntry {
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
    known: &[(Parameter, f64, f64)],
) -> BTreeMap<&'static str, ParameterEntry> {
    let number = |free: Parameter| {
        let of = |model: &Model| free.value(model).unwrap_or(f64::NAN);
        ParameterEntry {
            nominal: of(belief),
            interval: interval(of(&found.mended.model), known, |other| *other == free),
        }
    };
    BTreeMap::from([
        ("gain_mm_per_s2_per_percent", number(Parameter::Gain)),
        ("drag_per_s", number(Parameter::Drag)),
        ("hover_duty_percent", number(Parameter::Hover)),
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

/// The mended model as a patch that `simulate` and `replay` take; empty where nothing needs mending.
#[must_use]
pub fn patch(found: &Diagnosis) -> String {
    if matches!(found.verdict, Verdict::NoGap | Verdict::InsufficientData) {
        return String::new();
    }
    let model = &found.mended.model;
    let mut patch = String::from("[plant]\n");
    for (key, value) in [
        ("gain_mm_per_s2_per_percent", model.gain_mm_per_s2_per_percent),
        ("drag_per_s", model.drag_per_s),
        ("hover_duty_percent", model.hover_duty_percent),
    ] {
        // Writing to a string cannot fail.
        let _ = writeln!(patch, "{key} = {value:?}");
    }
    for entry in model.effects.present() {
        let _ = writeln!(patch, "\n[plant.effects.{}]", entry.name);
        for (param, value) in entry.params.iter().zip(model.effects.values(entry.name).unwrap_or_default()) {
            let _ = writeln!(patch, "{} = {value:?}", param.name);
        }
    }
    patch
}

/// The verdict in a sentence, then a line for each thing that was found. `compensation`: what was on in flight.
#[must_use]
pub fn words(found: &Diagnosis, compensation: Option<&Compensation>) -> String {
    let mut words = match found.verdict {
        Verdict::NoGap => "No gap: the model forecasts this record as well as noise allows.".to_owned(),
        Verdict::Parameters => {
            "Only base parameters moved; no effect is missing that this record could show.".to_owned()
        }
        Verdict::Effect => "The rig does something that the model lacks.".to_owned(),
        Verdict::Unexplained if !found.misfit.is_significant() => {
            "More effects at once than one record proves.".to_owned()
        }
        Verdict::Unexplained => "Something is left that no effect of the catalogue explains.".to_owned(),
        Verdict::InsufficientData => {
            "This record cannot answer, for the reasons above. Fly one with a moving setpoint, at least 30 s in free flight.".to_owned()
        }
    };
    let known = found.intervals();
    for named in &found.effects {
        let _ = write!(words, "\n{}", effect_in_words(named, found, &known, compensation));
    }
    for place in regions(found).iter().take(3) {
        let _ = write!(words, "\nwrong {} (p = {:.3})", place_in_words(place), place.p_value);
    }
    if let Some(shape) = left_over(found) {
        let _ = write!(words, "\n{shape}");
    }
    let [nominal, refitted, mended] = &found.gaps;
    let at = |gap: &Gap| gap.error_mm[2].map_or("–".into(), |mm| format!("{mm:.2}"));
    let floor = mended.floor_mm[2].map_or("–".into(), |mm| format!("{mm:.2}"));
    let _ = write!(
        words,
        "\nerror 1 s ahead, on stretches not fitted to: {} mm as believed, {} refitted, {} mended, {floor} by noise alone",
        at(nominal),
        at(refitted),
        at(mended)
    );
    if let Some(Closed { value, low, high }) = found.closed {
        let [value, low, high] = [value, low, high].map(whole_percent);
        let _ = write!(words, "\n{value} % of the gap is closed ({low} to {high} %)");
    }
    words
}

/// A line for an effect: how sure, what is to be done about it and its numbers with their 90 % intervals; below it what it looks like and how to mend
/// it, unless it is not there.
fn effect_in_words(
    named: &NamedEffect,
    found: &Diagnosis,
    known: &[(Parameter, f64, f64)],
    compensation: Option<&Compensation>,
) -> String {
    let entry = named.candidate.entry;
    let sure = format!("{:<22} {:.0} % sure   ", entry.name, 100.0 * named.probability);
    if named.change == Change::Removed {
        return format!("{sure}believed, and not there: leave it out of the model");
    }
    // As a config takes it: the page's minus is none.
    let plain = |value: f64| format!("{:.*}", places(value), value + 0.0);
    let with_interval = |(name, Interval { value, low, high }): (&str, Interval)| {
        let ends = low.zip(high).map(|(low, high)| format!(" ({} to {})", plain(low), plain(high)));
        format!("{name} = {}{}", plain(value), ends.unwrap_or_default())
    };
    let own = effect_intervals(named, found, known);
    let in_order = entry.params.iter().filter_map(|param| Some((param.name, *own.get(param.name)?)));
    let width = found.difference(&entry).map(|(difference, [value, low, high])| {
        (difference.name, Interval { value, low: Some(low), high: Some(high) })
    });
    let numbers: Vec<String> = in_order.chain(width).map(with_interval).collect();
    let retuned = if named.change == Change::Retuned { "retuned   " } else { "" };
    let twins = match &named.indistinguishable_from[..] {
        [] => String::new(),
        names => format!("   (cannot be told from {})", names.join(", ")),
    };
    let mend = mend::words(&entry, &found.mended.model, compensation);
    format!(
        "{sure}{retuned}{}{twins}\n{:22} in a log: {}\n{:22} mend: {mend}",
        numbers.join(", "),
        "",
        entry.in_a_log,
        ""
    )
}

/// A place as it stands behind "wrong".
fn place_in_words(place: &Place) -> String {
    match place.signal {
        "lag_s" => format!("{:.2} to {:.2} s after the duty moves", place.from, place.to),
        signal => format!("where {signal} is {:.1} to {:.1}", place.from, place.to),
    }
}

/// A share in whole percent; what rounds to 0 has no sign.
pub(crate) fn whole_percent(share: f64) -> String {
    format!("{:.0}", (100.0 * share).round() + 0.0)
}

#[cfg(test)]
mod tests {
    use super::whole_percent;

    #[test]
    fn a_share_that_rounds_to_nothing_has_no_sign() {
        assert_eq!([-0.004, 0.004, -0.006, 0.996].map(whole_percent), ["0", "0", "-1", "100"]);
    }
}
