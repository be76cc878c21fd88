//! A shape as a written effect: its formula, with parameters whose bounds follow from what the record shows.

use super::signals::{Seen, rounded};
use crate::record::units::four_digits;
use plant::{Definition, DefinitionTable, ParameterTable, Stage, StateTable};
use std::collections::BTreeMap;

/// The knots of a curve within the range seen.
pub(super) const KNOTS: u32 = 5;
/// Bounds of a size, in units of its scale: four times what the duty does.
const MOST: f64 = 40.0;

/// A shape.
pub(super) struct Shape {
    stage: Stage,
    name: &'static str,
    words: &'static str,
    adds: String,
    parameters: BTreeMap<String, ParameterTable>,
    states: BTreeMap<String, StateTable>,
}

/// A polygon over a signal: a change of slope at each knot.
pub(super) fn curve(signal: &str, Seen { middle, half }: Seen) -> String {
    let at = |k: u32| middle + half * (2.0 * f64::from(k) / f64::from(KNOTS + 1) - 1.0);
    (1..=KNOTS).map(|k| format!("a{k} * max(0, {signal} - {})", number(at(k)))).collect::<Vec<_>>().join(" + ")
}

/// A wave over a signal.
pub(super) fn ripple(signal: &str) -> String {
    format!("a * sin(2 * pi * {signal} / wave) + b * cos(2 * pi * {signal} / wave)")
}

/// A bound as a patch writes the numbers within it, so that a number at its bound is not outside it there.
fn to_six_digits(bound: f64) -> f64 {
    format!("{bound:.5e}").parse().unwrap_or(bound)
}

/// A number to four digits, as a formula has it.
pub(super) fn number(value: f64) -> String {
    let text = four_digits(value);
    if value < 0.0 { format!("({text})") } else { text }
}

impl Shape {
    pub(super) fn new(name: &'static str, stage: Stage, words: &'static str, adds: String) -> Self {
        Self { stage, name, words, adds, parameters: BTreeMap::new(), states: BTreeMap::new() }
    }

    /// At another stage.
    pub(super) fn at(self, stage: Stage) -> Self {
        Self { stage, ..self }
    }

    /// With sizes that are 0 where the shape does nothing.
    pub(super) fn sized(mut self, names: &[&str], scale: f64, unit: &str) -> Self {
        let most = to_six_digits(MOST * scale);
        let (neutral, scale, unit) = (Some(0.0), Some(scale), unit.to_owned());
        let size = ParameterTable { neutral, value: None, scale, low: -most, high: most, unit };
        self.parameters.extend(names.iter().map(|name| ((*name).to_owned(), size.clone())));
        self
    }

    /// With a size for each of these knots.
    pub(super) fn sized_curve(self, knots: impl Iterator<Item = u32>, scale: f64, unit: &str) -> Self {
        let names: Vec<String> = knots.map(|k| format!("a{k}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        self.sized(&names, scale, unit)
    }

    /// With a parameter that matters only while a size is not 0.
    pub(super) fn free(self, name: &str, value: f64, bounds: [f64; 2], unit: &str) -> Self {
        self.free_in_steps(name, (value, None), bounds, unit)
    }

    /// The same with the distance between the places where it is tried; `None`: equal ratios.
    fn free_in_steps(mut self, name: &str, (value, scale): (f64, Option<f64>), bounds: [f64; 2], unit: &str) -> Self {
        let [low, high] = bounds.map(to_six_digits);
        let table = ParameterTable {
            neutral: None,
            value: Some(value.clamp(low, high)),
            scale,
            low,
            high,
            unit: unit.to_owned(),
        };
        self.parameters.insert(name.to_owned(), table);
        self
    }

    /// At a height within those seen, and of some width.
    pub(super) fn placed(self, Seen { middle, half }: Seen) -> Self {
        self.free("width", 0.2 * half, [0.02 * half, half], "mm").free_in_steps(
            "centre",
            (middle, Some(0.1 * half)),
            [middle - half, middle + half],
            "mm",
        )
    }

    /// Of a wave length from a tenth of half the range to the whole.
    pub(super) fn waved(self, Seen { half, .. }: Seen, unit: &str) -> Self {
        let steps = (0.5 * half, Some(rounded(0.02 * half)));
        self.free_in_steps("wave", steps, [0.1 * half, 2.0 * half], unit)
    }

    /// With a state `s` that follows a signal with a time constant.
    pub(super) fn lagging(self, of: &str, time: Seen) -> Self {
        let most_s = (0.5 * time.half).max(0.2);
        self.free("tau", 0.5, [0.05, most_s], "s").state("s", &format!("({of} - s) / tau"), of)
    }

    /// With a state.
    pub(super) fn state(mut self, name: &str, rate: &str, start: &str) -> Self {
        self.states.insert(name.to_owned(), StateTable { rate: rate.to_owned(), start: start.to_owned() });
        self
    }

    /// Its definition; `None` where the numbers of a record make none.
    pub(super) fn definition(self) -> Option<&'static Definition> {
        let Self { name, stage, words, adds, parameters, states } = self;
        let (looks, mend) = (words.to_owned(), String::new());
        Definition::new(name, &DefinitionTable { stage, adds, looks, mend, parameters, states }).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::Shape;
    use plant::Stage;

    // The patch of a diagnosis was refused: width = 1 was below 1.0000000000000002.
    #[test]
    fn a_number_at_its_bound_lies_within_it_after_a_patch_rounds_it_to_six_digits() {
        for tenths in 1..=2000 {
            let half = f64::from(tenths) / 10.0;
            let shape = Shape::new("formula_any", Stage::Ball, "a friction", "-a * tanh(v / width)".into())
                .sized(&["a"], 0.1 * half, "mm/s2")
                .free("width", half, [0.1 * 0.1 * half, half / 3.0], "mm/s");
            for (name, table) in &shape.parameters {
                for bound in [table.low, table.high] {
                    let written: f64 = format!("{bound:.5e}").parse().unwrap();
                    assert!((table.low..=table.high).contains(&written), "{name} = {written}: {table:?}");
                }
            }
        }
    }
}
