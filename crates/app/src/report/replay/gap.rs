//! The gap as a table, with a sentence on its meaning.

use crate::report::kit::table::{empty, in_words};
use config::words::Words;
use diagnose::{Gap, Recording};
use serde::Serialize;

/// A model whose error is below this multiple of the noise floor is as good as noise allows.
pub const AS_GOOD_AS_NOISE: f64 = 1.1;

/// Errors whose ratio is below this are alike.
const ALIKE: f64 = 1.02;

/// The document that `replay --json` writes.
#[derive(Clone, Debug, Serialize)]
pub struct ReplayDocument<'a> {
    /// Name and version of this document.
    pub schema: &'static str,
    /// The gap.
    #[serde(flatten)]
    pub gap: &'a Gap,
    /// The gap of the second model, where one was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<&'a Gap>,
}

impl<'a> ReplayDocument<'a> {
    /// The document of a gap.
    #[must_use]
    pub const fn of(gap: &'a Gap, against: Option<&'a Gap>) -> Self {
        Self { schema: "airball.replay/1", gap, against }
    }
}

/// The gap as a table in the words of the rig: one row per horizon.
#[must_use]
pub fn table(gap: &Gap, rig: &Words) -> String {
    let mut table = empty(["forecast ahead", "model", "the ball stays put", "noise alone", "model / noise"]);
    for (h, horizon) in gap.horizons_s.iter().enumerate() {
        let (error, floor) = (gap.error_mm[h], gap.floor_mm[h]);
        table.add_row([format!("{horizon} s"), mm(error), mm(gap.stay_put_mm[h]), mm(floor), ratio(error, floor)]);
    }
    let (error, floor) = (gap.free_run_10s_mm, gap.floor_free_run_10s_mm);
    table.add_row(["free run, 10 s".into(), mm(error), String::new(), mm(floor), ratio(error, floor)]);
    in_words(&table, rig)
}

/// Which of two models is nearer to the record 1 s ahead, in a sentence.
#[must_use]
pub fn nearer(gap: &Gap, against: &Gap, patch: &str) -> String {
    match (gap.error_mm[2], against.error_mm[2]) {
        (Some(own), Some(other)) => format!(
            "1 s ahead the error of the model is {own:.1} mm, and {other:.1} mm with {patch}: {}.",
            match other / own {
                ratio if ratio < ALIKE.recip() => "the patch forecasts this record better",
                ratio if ratio > ALIKE => "the patch forecasts this record worse",
                _ => "both forecast this record alike",
            }
        ),
        _ => "The record is too short to compare the two models.".into(),
    }
}

/// The meaning of the table, in a sentence that ends with the next step; `is_mistaken`: units, signs or columns are
/// wrong.
#[must_use]
pub fn sentence(gap: &Gap, recording: &Recording, is_mistaken: bool) -> String {
    if is_mistaken {
        return "These errors say nothing about the model: units, signs or columns are wrong. Correct them as said \
                above."
            .into();
    }
    let ahead = gap.horizons_s[2];
    let (Some(error), Some(floor), Some(stay_put)) = (gap.error_mm[2], gap.floor_mm[2], gap.stay_put_mm[2]) else {
        let (rows, duration_s) = (recording.samples().len(), recording.duration_s());
        return format!(
            "No two readings are 1 s apart ({rows} rows in {duration_s:.1} s): record at least 30 s with a moving \
             setpoint, or, if time is not in seconds but, for instance, in milliseconds, write [import] time_s = \
             {{ column = \"NAME\", scale = 0.001 }}."
        );
    };
    if error < AS_GOOD_AS_NOISE * floor {
        return format!(
            "{ahead} s ahead the error of the model is {error:.1} mm; noise alone gives {floor:.1} mm: this record \
             shows no gap at that horizon."
        );
    }
    let beside = if error < stay_put { "" } else { ", so the model is of no use at that horizon" };
    format!(
        "{ahead} s ahead the error of the model is {error:.1} mm; noise alone gives {floor:.1} mm, and \"the ball \
         stays put\" {stay_put:.1} mm{beside}. The model lacks an effect, or its parameters or noise are wrong: \
         `airball diagnose` finds which."
    )
}

fn mm(value: Option<f64>) -> String {
    value.map_or("none".into(), |value| format!("{value:.2} mm"))
}

fn ratio(error: Option<f64>, floor: Option<f64>) -> String {
    error.zip(floor).map_or(String::new(), |(error, floor)| format!("{:.2}", error / floor))
}
