//! The secret truth and the published belief: the files of a case, and the hash of the truth.

use crate::case::{Case, Departure};
use crate::catalogue::{Effect, find, inside};
use crate::forms::clutter::PIECES;
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
    /// The small pieces that no model holds, each with the effect of the catalogue that it may rightly be called by.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    clutter: Vec<ClutterTruth>,
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

#[derive(Serialize)]
struct ClutterTruth {
    #[serde(flatten)]
    piece: Effect,
    kin: Option<&'static str>,
}

impl ClutterTruth {
    fn of(piece: &Effect) -> Self {
        let kin = PIECES.iter().find(|(name, _)| *name == piece.name).and_then(|(_, kin)| *kin);
        Self { piece: piece.clone(), kin }
    }
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
            clutter: case.clutter.iter().map(ClutterTruth::of).collect(),
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
    let (base, sensor_mm, psd) = (case.belief, SENSOR_MM * case.noise, PSD * case.noise.powi(2));
    let mut text = format!(
        "[plant]\ngain_mm_per_s2_per_percent = {:.3}\ndrag_per_s = {:.4}\nhover_duty_percent = {:.3}\n\
         pipe_length_mm = {LENGTH_MM:.1}\n\n[plant.noise]\nsensor_mm = {sensor_mm:.2}\nacceleration_psd_mm2_per_s3 = {psd:.1}\n",
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
