//! The sealed truth and the belief that is handed out: what is written about a case, and the hash that binds it.

use crate::case::{Case, Departure};
use crate::catalogue::{Effect, find, inside};
use crate::mixture::Kind;
use crate::programme::Programme;
use crate::rig::{Base, LENGTH_MM, PSD, SENSOR_MM};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// The truth of a set. Its file's hash is published before, the file after.
#[derive(Serialize)]
pub(crate) struct Truth<'a> {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Makes the hash say nothing about the rest.
    pub(crate) salt: String,
    /// What the set was drawn from.
    pub(crate) seed: &'a str,
    /// The arguments that draw it again.
    pub(crate) drawn_with: String,
    /// The cases in order.
    pub(crate) cases: Vec<CaseTruth>,
}

/// The truth of one case.
#[derive(Serialize)]
pub(crate) struct CaseTruth {
    case: String,
    kind: Kind,
    /// What a diagnosis should name, or find unexplained.
    effects: Vec<DepartureTruth>,
    /// Base parameters that are far from the belief.
    moved: Vec<&'static str>,
    base: Base,
    /// Everything that acts, known to the owner or not.
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
    /// All that is known of a case.
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
