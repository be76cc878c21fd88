//! The secret truth and the published belief: the files of a case, and the hash of the truth.

use crate::case::{Case, Departure};
use crate::catalogue::{Effect, find, inside};
use crate::mixture::Kind;
use crate::programme::Programme;
use crate::rig::{Base, LENGTH_MM, PSD, SENSOR_MM};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// The truth of a set. The hash of its file is published before the diagnoses, the file after them.
#[derive(Serialize)]
pub(crate) struct Truth<'a> {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Random text, so that the hash reveals nothing about the rest.
    pub(crate) salt: String,
    /// The seed of the set.
    pub(crate) seed: &'a str,
    /// The arguments that reproduce it.
    pub(crate) drawn_with: String,
    /// The cases in order.
    pub(crate) cases: Vec<CaseTruth>,
}

/// The truth of one case.
#[derive(Serialize)]
pub(crate) struct CaseTruth {
    case: String,
    kind: Kind,
    /// The effects that a diagnosis should name, or find unexplained.
    effects: Vec<DepartureTruth>,
    /// Base parameters that are far from the belief.
    moved: Vec<&'static str>,
    base: Base,
    /// All effects of the rig, believed or not.
    rig_effects: Vec<Effect>,
    belief: Base,
    believed_effects: Vec<Effect>,
    programme: Programme,
}

#[derive(Serialize)]
struct DepartureTruth {
    #[serde(flatten)]
    departure: Departure,
    stage: &'static str,
    inside_catalogue: bool,
}

impl CaseTruth {
    /// The complete truth of a case.
    pub(crate) fn new(name: String, case: &Case) -> Self {
        let departure = |departure: &Departure| DepartureTruth {
            departure: departure.clone(),
            stage: find(departure.name).map_or("unknown", |(stage, _)| stage),
            inside_catalogue: inside(departure.name),
        };
        Self {
            case: name,
            kind: case.kind,
            effects: case.departures.iter().map(departure).collect(),
            moved: case.moved.clone(),
            base: case.base,
            rig_effects: case.effects.clone(),
            belief: case.belief,
            believed_effects: case.believed.clone(),
            programme: case.programme.clone(),
        }
    }
}

/// SHA-256 as hexadecimal digits.
pub(crate) fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// The belief as the project's config.
pub(crate) fn belief(case: &Case) -> String {
    let base = case.belief;
    let mut text = format!(
        "[plant]\ngain_mm_per_s2_per_percent = {:.3}\ndrag_per_s = {:.4}\nhover_duty_percent = {:.3}\n\
         pipe_length_mm = {LENGTH_MM:.1}\n\n[plant.noise]\nsensor_mm = {SENSOR_MM:.2}\nacceleration_psd_mm2_per_s3 = {PSD:.1}\n",
        base.gain_mm_per_s2_per_percent, base.drag_per_s, base.hover_duty_percent
    );
    for effect in &case.believed {
        let _ = writeln!(text, "\n[plant.effects.{}]", effect.name);
        for (name, value) in &effect.parameters {
            let _ = writeln!(text, "{name} = {value:.4}");
        }
    }
    text
}
