//! What a record leaves open for lack of excitation, and the models that represent possible missing effects.

use super::Rival;
use diagnose::{Diagnosis, Recording, Verdict, in_free_flight};
use plant::{Effects, Entry, Model};

/// A record has little information if its free flight is shorter than this, seconds, or the ball moves by less than
/// this share of its travel.
const SHORT_S: f64 = 30.0;
const NARROW: f64 = 0.1;
/// The name of the belief among the alternatives.
pub(super) const AS_BELIEVED: &str = "the model as believed";

/// The open question, in a sentence; `None` where another flight would add no information.
pub(super) fn question(found: &Diagnosis, recording: &Recording, belief: &Model) -> Option<String> {
    let open = matches!(found.verdict, Verdict::InsufficientData | Verdict::NoGap | Verdict::Unexplained);
    let counts = in_free_flight(belief, recording);
    let samples = recording.samples();
    let mut heights: Vec<f64> =
        samples.iter().zip(&counts).filter(|(_, counts)| **counts).filter_map(|(s, _)| s.position_mm).collect();
    heights.sort_by(f64::total_cmp);
    let free_s = recording.duration_s() * heights.len() as f64 / samples.len().max(1) as f64;
    let (bottom, top) = belief.ends_mm();
    let at = |share: usize| heights.get(heights.len().saturating_sub(1) * share / 100).copied().unwrap_or_default();
    let spread_mm = at(95) - at(5);
    let thin = free_s < SHORT_S || spread_mm < NARROW * (top - bottom);
    (open && (thin || found.verdict == Verdict::InsufficientData)).then(|| {
        format!(
            "This record asks little of the rig: {free_s:.0} s in free flight, within {spread_mm:.0} mm of the {:.0} \
             mm of pipe in the config.",
            top - bottom
        )
    })
}

/// The belief, and the belief with one more effect each, which a flight should be able to show.
pub(super) fn stand_ins(belief: &Model) -> Vec<Rival> {
    let with = |entry: &&'static Entry| {
        let mut model = belief.clone();
        if model.effects.values(entry.name).is_some() {
            return None;
        }
        model.effects.set(entry.name, entry.sizes.last()?);
        model.check().is_ok().then_some((entry.name, model))
    };
    let mut stand_ins: Vec<&Entry> =
        Effects::CATALOGUE.iter().filter(|entry| entry.represents_its_stage.is_some()).collect();
    stand_ins.sort_by_key(|entry| entry.represents_its_stage);
    std::iter::once((AS_BELIEVED, belief.clone())).chain(stand_ins.iter().filter_map(with)).collect()
}
