//! The document of a comparison, from two logs or from the documents of two diagnoses.

use crate::analysis::lateness_change::LatenessChange;
use diagnose::NumberChange;
use serde::Serialize;
use serde_json::Value;

/// How the schema of a diagnosis begins.
const DIAGNOSIS: &str = "airball.diagnosis/";
/// The verdict of a record that cannot answer.
pub const CANNOT_ANSWER: &str = "insufficient_data";
/// What stands before a believed effect that a diagnosis did not find.
pub const ABSENT: &str = "no ";
/// Half of a 90 % interval, standard deviations.
pub(super) const OF_90_PERCENT: f64 = 1.645;

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SideEntry {
    /// The name of its file.
    pub name: String,
    /// The verdict of its diagnosis.
    pub verdict: String,
    /// The effects that were named, with their probability.
    pub effects: Vec<(String, f64)>,
    /// Forecast error of the belief 1 s ahead, mm.
    pub error_mm: Option<f64>,
    /// Overshoot of the steps of the setpoint, percent.
    pub overshoot_percent: Option<f64>,
    /// Their settling time, seconds.
    pub settling_s: Option<f64>,
}

/// The document that `compare --json` writes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Name and version of this document.
    pub schema: &'static str,
    /// The rig before and after.
    pub sides: [SideEntry; 2],
    /// The numbers, with whether each changed beyond chance.
    pub numbers: Vec<NumberChange>,
    /// Whether base parameters and noises changed beyond chance, all taken together; `null` for diagnoses.
    pub is_together_beyond_chance: Option<bool>,
    /// Whether the numbers are of one model, with the effects of both sides; otherwise of the models of two diagnoses.
    pub of_one_model: bool,
    /// Forecast errors 1 s ahead, mm: on the record before, then on that after, each of the model of before and that of
    /// after; of logs only.
    pub error_mm: Option<[[Option<f64>; 2]; 2]>,
    /// How late the cycles began; of flights of this program only.
    pub lateness: Option<LatenessChange>,
}

/// Why a document is none of a diagnosis.
#[derive(Debug, thiserror::Error)]
#[error("{name} is no diagnosis as JSON: {why}; `airball diagnose LOG --json` writes one")]
pub struct NoDiagnosis {
    name: String,
    why: String,
}

impl SideEntry {
    /// Whether the record of the diagnosis cannot answer.
    #[must_use]
    pub fn cannot_answer(&self) -> bool {
        self.verdict == CANNOT_ANSWER
    }

    /// Of the document of a diagnosis.
    ///
    /// # Errors
    /// Another document, or none.
    pub fn of_document(name: &str, text: &str) -> Result<(Self, Value), NoDiagnosis> {
        let refused = |why: String| NoDiagnosis { name: name.into(), why };
        let document: Value = serde_json::from_str(text).map_err(|error| refused(error.to_string()))?;
        let schema = document["schema"].as_str().unwrap_or("none");
        if !schema.starts_with(DIAGNOSIS) {
            return Err(refused(format!("its schema is {schema}")));
        }
        let effect = |one: &Value| {
            let absent = if one["change"] == "removed" { ABSENT } else { "" };
            Some((format!("{absent}{}", one["name"].as_str()?), one["probability"].as_f64()?))
        };
        let effects =
            document["effects"].as_array().map_or_else(Vec::new, |all| all.iter().filter_map(effect).collect());
        let looped = &document["gap"]["closed_loop"];
        let side = Self {
            name: name.into(),
            verdict: document["verdict"].as_str().unwrap_or_default().to_owned(),
            effects,
            error_mm: document["gap"]["nominal_mm"][2].as_f64(),
            overshoot_percent: looped["overshoot_percent"]["recorded"].as_f64(),
            settling_s: looped["settling_s"]["recorded"].as_f64(),
        };
        Ok((side, document))
    }
}

impl Comparison {
    /// Of two diagnoses: the numbers that both have.
    #[must_use]
    pub fn of_documents(sides: [SideEntry; 2], documents: &[Value; 2]) -> Self {
        let mut numbers = in_both("", documents.each_ref().map(|document| &document["parameters"]));
        let effect = |document: &Value, name: &str| {
            let all = document["effects"].as_array().cloned().unwrap_or_default();
            all.into_iter().find(|one| one["name"] == name).map(|one| one["parameters"].clone()).unwrap_or_default()
        };
        for (name, _) in &sides[0].effects {
            let both = documents.each_ref().map(|document| effect(document, name));
            numbers.extend(in_both(name, both.each_ref()));
        }
        NumberChange::judge(&mut numbers);
        Self {
            schema: "airball.compare/1",
            sides,
            numbers,
            is_together_beyond_chance: None,
            of_one_model: false,
            error_mm: None,
            lateness: None,
        }
    }

    /// The effects that only one side names: name, and whether it is the one before.
    pub fn only_one_side(&self) -> impl Iterator<Item = (&str, bool)> {
        let lacks = |side: &SideEntry, name: &str| side.effects.iter().all(|(other, _)| other != name);
        let [before, after] = &self.sides;
        let gone = before.effects.iter().filter(move |(name, _)| lacks(after, name));
        let new = after.effects.iter().filter(move |(name, _)| lacks(before, name));
        gone.map(|(name, _)| (name.as_str(), true)).chain(new.map(|(name, _)| (name.as_str(), false)))
    }
}

/// The numbers that both tables have with an interval.
fn in_both(table: &str, tables: [&Value; 2]) -> Vec<NumberChange> {
    let estimate = |value: &Value| {
        let [low, high] = ["low", "high"].map(|end| value[end].as_f64());
        let deviation = low.zip(high).map(|(low, high)| (high - low) / (2.0 * OF_90_PERCENT));
        Some((value["value"].as_f64()?, deviation))
    };
    let number = |(key, value): (&String, &Value)| {
        let (before, a) = estimate(value)?;
        let (after, b) = estimate(&tables[1][key])?;
        Some(NumberChange::new(table, key, [before, after], [a, b]))
    };
    tables[0].as_object().into_iter().flatten().filter_map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::{Comparison, SideEntry};

    fn side(gain: f64, zone: Option<f64>) -> String {
        let effect = |edge: f64| {
            format!(
                r#"{{"name":"dead_zone","probability":0.97,"parameters":{{"upper_percent":{{"value":{edge},"low":{},"high":{}}}}}}}"#,
                edge - 0.05,
                edge + 0.05
            )
        };
        format!(
            r#"{{"schema":"airball.diagnosis/2","verdict":"effect","effects":[{}],"gap":{{"nominal_mm":[1,2,{gain}]}},
            "parameters":{{"gain_mm_per_s2_per_percent":{{"value":{gain},"low":{},"high":{}}},"drag_per_s":{{"value":2,"low":null,"high":null}}}}}}"#,
            zone.map_or(String::new(), effect),
            gain - 5.0,
            gain + 5.0
        )
    }

    fn compared(before: &str, after: &str) -> Comparison {
        let (a, before) = SideEntry::of_document("a.json", before).unwrap();
        let (b, after) = SideEntry::of_document("b.json", after).unwrap();
        Comparison::of_documents([a, b], &[before, after])
    }

    #[test]
    fn numbers_of_two_diagnoses_are_compared_by_their_intervals_and_effects_of_one_side_are_named() {
        let found = compared(&side(200.0, Some(0.3)), &side(240.0, Some(0.31)));
        let beyond: Vec<&str> =
            found.numbers.iter().filter(|one| one.is_beyond_chance).map(|one| one.key.as_str()).collect();
        assert_eq!(beyond, ["gain_mm_per_s2_per_percent"]);
        // A number without an interval is listed and never judged.
        assert!(found.numbers.iter().any(|one| one.key == "drag_per_s" && one.deviation.is_none()));
        let found = compared(&side(200.0, Some(0.3)), &side(202.0, None));
        assert_eq!(found.only_one_side().collect::<Vec<_>>(), [("dead_zone", true)]);
    }

    #[test]
    fn another_document_is_refused_by_its_schema() {
        let error = SideEntry::of_document("x.json", r#"{"schema":"airball.replay/1"}"#).unwrap_err();
        assert!(error.to_string().contains("its schema is airball.replay/1"), "{error}");
    }
}
