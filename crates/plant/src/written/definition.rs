//! A written effect that was read: its entry and its formulas.

use super::entry::entry;
use super::gradient::UsedStates;
use super::intern;
use super::names::Names;
use super::scope::{ALL_BUT_PARAMETERS, SETPOINT, STATES};
use super::table::{DefinitionError, DefinitionTable, check_name, check_parameters};
use super::text::shown;
use crate::effect::{Entry, Stage};
use crate::motion::OWN_STATES;
use formula::Formula;

/// A written effect that was read and checked.
#[derive(Debug)]
pub struct Definition {
    entry: Entry,
    table: DefinitionTable,
    adds: Formula,
    states: Vec<[Formula; 2]>,
    /// The states that `adds` uses, and those that each rate uses.
    adds_uses: UsedStates,
    rates_use: Vec<UsedStates>,
    motion_is_linear: bool,
    uses_time: bool,
    moves_with_time: bool,
    /// The first formula that uses the setpoint: its key and text, and the column.
    setpoint: Option<(String, String, usize)>,
}

// Equal definitions share one place.
impl PartialEq for Definition {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Definition {
    /// Reads and checks a definition.
    ///
    /// # Errors
    /// [`DefinitionError`] names the first key that is wrong.
    pub fn new(name: &str, table: &DefinitionTable) -> Result<&'static Self, DefinitionError> {
        if let Some(known) = intern::known(|known| known.entry.name == name && known.table == *table) {
            return Ok(known);
        }
        check_name(name)?;
        check_parameters(table)?;
        let names = Names::of(table)?;
        let adds = names.formula("adds", &table.adds)?;
        let mut states = Vec::new();
        for (state, formulas) in &table.states {
            let rate = names.formula(&format!("states.{state}.rate"), &formulas.rate)?;
            states.push([rate, names.without_states().formula(&format!("states.{state}.start"), &formulas.start)?]);
        }
        names.all_used(&adds, &states)?;
        let force = Some(&adds).filter(|_| matches!(table.stage, Stage::Air | Stage::Ball));
        let mut moves = force.into_iter().chain(states.iter().map(|[rate, _]| rate));
        let moves_with_time = moves.clone().any(|one| one.uses(names.place("t")));
        let definition = Self {
            motion_is_linear: moves.all(|one| one.is_affine_in(&ALL_BUT_PARAMETERS)),
            uses_time: adds.uses(names.place("t")),
            moves_with_time,
            setpoint: setpoint_use(table, &names, &adds, &states),
            entry: entry(name, table),
            table: table.clone(),
            adds_uses: UsedStates::of(&adds),
            rates_use: states.iter().map(|[rate, _]| UsedStates::of(rate)).collect(),
            adds,
            states,
        };
        definition.vanishes(&names.bounds)?;
        Ok(intern::keep(definition))
    }

    /// Its entry, as the catalogue has them.
    #[must_use]
    pub const fn entry(&self) -> &Entry {
        &self.entry
    }

    /// The table that it was read from.
    #[must_use]
    pub const fn table(&self) -> &DefinitionTable {
        &self.table
    }

    /// What is wrong where the setpoint is not known, and `why` it is not. `None`: nothing, as no formula uses it.
    #[must_use]
    pub fn without_setpoint(&self, why: &str) -> Option<DefinitionError> {
        let (key, text, column) = self.setpoint.clone()?;
        let message = format!("`{}`, column {column}: `{SETPOINT}` is not known: {why}", shown(&text));
        Some(DefinitionError { key, message })
    }

    pub(super) const fn stage(&self) -> Stage {
        self.entry.stage
    }

    pub(super) fn adds(&self, values: &[f64]) -> f64 {
        self.adds.value(values)
    }

    /// The directional derivative of what it adds, along `towards`.
    pub(super) fn adds_along(&self, values: &[f64], towards: &[f64]) -> f64 {
        // To find that none of the variables that move occurs takes less time than to evaluate the formula.
        let moves = towards.iter().enumerate().any(|(variable, speed)| *speed != 0.0 && self.adds.uses(variable));
        if moves { self.adds.dual(values, towards).1 } else { 0.0 }
    }

    /// What it adds, and the derivatives of that by the states.
    pub(super) fn adds_with_slopes(&self, values: &[f64]) -> (f64, [f64; STATES]) {
        self.adds_uses.value_and_slopes(&self.adds, values)
    }

    pub(super) const fn uses_time(&self) -> bool {
        self.uses_time
    }

    /// Whether its force or the rate of a state changes with the time itself.
    pub(super) const fn moves_with_time(&self) -> bool {
        self.moves_with_time
    }

    /// Whether its force and the rates of its states are linear in what moves.
    pub(super) const fn motion_is_linear(&self) -> bool {
        self.motion_is_linear
    }

    pub(super) const fn states(&self) -> usize {
        self.states.len()
    }

    pub(super) fn rates(&self, values: &[f64]) -> [f64; OWN_STATES] {
        std::array::from_fn(|state| self.states.get(state).map_or(0.0, |[rate, _]| rate.value(values)))
    }

    /// The rates, and the derivatives of each by the states.
    pub(super) fn rates_with_slopes(&self, values: &[f64]) -> [(f64, [f64; STATES]); OWN_STATES] {
        std::array::from_fn(|state| {
            let rate = self.states.get(state).zip(self.rates_use.get(state));
            rate.map_or_else(Default::default, |([rate, _], uses)| uses.value_and_slopes(rate, values))
        })
    }

    pub(super) fn start(&self, values: &[f64]) -> [f64; OWN_STATES] {
        std::array::from_fn(|state| self.states.get(state).map_or(0.0, |[_, start]| start.value(values)))
    }

    /// Checks at some points within `bounds` that the effect adds nothing where its parameters are neutral. The points
    /// are multiples of two irrational numbers without their whole part (Weyl's sequence), so that none is a round value
    /// at which a formula may be 0 by chance.
    fn vanishes(&self, bounds: &[[f64; 2]]) -> Result<(), DefinitionError> {
        let own = bounds.len() - self.table.parameters.len();
        let neutral = |at: usize| self.table.parameters.values().nth(at - own).and_then(|param| param.neutral);
        for point in 1..=32_u32 {
            let at = |(index, [low, high]): (usize, &[f64; 2])| {
                let share = (f64::from(point) * 0.618_033_988_749 + index as f64 * 0.754_877_666).fract();
                // The values of a rig lie within some hundreds.
                let (low, high) = if index < own { (low.max(-1e3), high.min(1e3)) } else { (*low, *high) };
                (index >= own).then(|| neutral(index)).flatten().unwrap_or(low + share * (high - low))
            };
            let values: Vec<f64> = bounds.iter().enumerate().map(at).collect();
            let value = self.adds.value(&values);
            if value != 0.0 {
                return Err(DefinitionError {
                    key: "adds".into(),
                    message: format!(
                        "the formula gives {value} where every parameter with a neutral value is neutral, and must give \
                         0 there; multiply it by a parameter with `neutral = 0`, or give another neutral value"
                    ),
                });
            }
        }
        Ok(())
    }
}

/// Key, text and column of the first use of the setpoint.
fn setpoint_use(
    table: &DefinitionTable,
    names: &Names<'_>,
    adds: &Formula,
    states: &[[Formula; 2]],
) -> Option<(String, String, usize)> {
    let of_states = table.states.keys().zip(states).flat_map(|(name, formulas)| {
        let keys = ["rate", "start"].map(|key| format!("states.{name}.{key}"));
        keys.into_iter().zip(formulas)
    });
    let mut all = std::iter::once(("adds".to_owned(), adds)).chain(of_states);
    let place = names.place(SETPOINT);
    all.find_map(|(key, formula)| Some((key, formula.text().to_owned(), formula.column_of(place)?)))
}
