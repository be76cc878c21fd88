//! The description of a rig: the retained message on `about`, with limits, units and names for pages and monitors.

use crate::flight::experiment::offers::Offer;
use config::{Safety, Tables};
use control::controller::Kind;
use control::numbers::{Numbers, Parameter, Values};
use control::pid::Pid;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The name and version of the message.
const SCHEMA: &str = "airball.about/1";

/// The message.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// `airball.about/1`.
    pub schema: String,
    /// Version of the program that runs the flight.
    pub version: String,
    /// The rig's name in topics.
    pub rig: String,
    /// Whether it is the simulated rig.
    pub simulated: bool,
    /// Period of the cycles, seconds.
    pub period_s: f64,
    /// Possible positions of the ball, mm.
    pub position_mm: Range,
    /// Safe setpoints, mm.
    pub setpoint_mm: Range,
    /// Safe duties in flight, percent.
    pub duty_percent: Range,
    /// The believed hover duty, percent.
    pub hover_duty_percent: f64,
    /// The names of the controllers.
    pub controllers: Vec<String>,
    /// The gains of the PID; empty where there is no PID.
    pub gains: Vec<Gain>,
    /// All numbers that can be set; empty as of a program that cannot.
    #[serde(default)]
    pub numbers: Vec<Number>,
    /// The experiments that can be started.
    pub experiments: Vec<Offered>,
}

/// A range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

/// A gain that can be set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// Its key in `set/gains`.
    pub name: String,
    /// Its symbol.
    pub symbol: String,
    /// Its unit.
    pub unit: String,
    /// The smallest.
    pub min: f64,
    /// The largest; null: no limit.
    pub max: Option<f64>,
}

/// A number that can be set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Its name in `set/numbers`: table and key of the config.
    pub name: String,
    /// Its unit; empty: none.
    pub unit: String,
    /// The smallest.
    pub min: f64,
    /// The largest; null: no limit.
    pub max: Option<f64>,
    /// What it may say, where it is no number.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<String>,
    /// As the flight began; null: infinite.
    pub value: NumberOrWord,
    /// Whether it is there only once a switch has added its table.
    #[serde(default, skip_serializing_if = "is_false")]
    pub absent: bool,
}

/// A value as JSON has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum NumberOrWord {
    /// A number; null: infinite.
    Number(Option<f64>),
    /// A word.
    Word(String),
}

impl NumberOrWord {
    /// The value of a parameter.
    pub(super) fn of(parameter: &Parameter, value: f64) -> Self {
        match parameter.word(value) {
            Some(word) => Self::Word(word.to_owned()),
            None => Self::Number(value.is_finite().then_some(value)),
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks with a reference")]
const fn is_false(flag: &bool) -> bool {
    !*flag
}

/// An experiment that can be started.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offered {
    /// Its name in `set/experiment`.
    pub name: String,
    /// Its purpose.
    pub title: String,
    /// Its longest duration, seconds.
    pub duration_s: f64,
}

impl About {
    /// The message for the tables of a flight and its offers. `None` where a table of a flight is missing.
    #[must_use]
    pub fn of(tables: &Tables, offers: &[Offer], simulated: bool) -> Option<Self> {
        let rig = tables.rig.as_ref()?;
        let Safety { setpoint_min_mm, setpoint_max_mm, duty_min_percent, duty_max_percent, .. } = tables.safety?;
        let compensation = tables.compensation.as_ref()?;
        let controllers = tables.controller.as_ref()?;
        let there = Kind::ALL.into_iter().filter(|kind| controllers.has(*kind));
        Some(Self {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            rig: rig.name.clone(),
            simulated,
            period_s: tables.r#loop?.period_s,
            position_mm: Range { min: 0.0, max: rig.sensor_to_bottom_mm },
            setpoint_mm: Range { min: setpoint_min_mm, max: setpoint_max_mm },
            duty_percent: Range { min: duty_min_percent, max: duty_max_percent },
            hover_duty_percent: compensation.hover_duty_percent,
            controllers: there.map(|kind| kind.name().to_owned()).collect(),
            gains: if controllers.pid.is_some() { gains(compensation.predistortion.is_some()) } else { Vec::new() },
            numbers: numbers(
                &Numbers {
                    controllers: controllers.clone(),
                    observer: tables.observer,
                    compensation: compensation.clone(),
                },
                tables.safety?,
            ),
            experiments: offers.iter().map(Offered::from).collect(),
        })
    }

    /// The values of its numbers.
    pub(super) fn values(&self) -> Values {
        Parameter::ALL.map(|parameter| {
            let number = self.numbers.iter().find(|number| number.name == parameter.name && !number.absent)?;
            match &number.value {
                NumberOrWord::Number(value) => Some(value.unwrap_or(f64::INFINITY)),
                NumberOrWord::Word(word) => parameter.value_of(word),
            }
        })
    }

    /// The message as published.
    #[must_use]
    pub fn json(&self) -> String {
        // Plain values always serialise.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// The gains with their units: with predistortion the control value is an acceleration.
fn gains(predistorted: bool) -> Vec<Gain> {
    let per_mm = if predistorted { "mm/s² per mm" } else { "%/mm" };
    let words = [("K_p", per_mm), ("T_i", "s"), ("T_d", "s")];
    let gain = |((name, min, max), (symbol, unit)): ((&str, f64, f64), (&str, &str))| Gain {
        name: name.into(),
        symbol: symbol.into(),
        unit: unit.into(),
        min,
        max: max.is_finite().then_some(max),
    };
    Pid::BOUNDS.into_iter().zip(words).map(gain).collect()
}

/// All numbers that are there or that a switch can add, with unit and bounds, and all words.
fn numbers(there: &Numbers, safety: Safety) -> Vec<Number> {
    let control = if there.compensation.predistortion.is_some() { "mm/s²" } else { "%" };
    let number = |(parameter, value): (&Parameter, Option<f64>)| {
        let (min, max) = match value {
            Some(_) => parameter.bounds(there)?,
            None => parameter.bounds_if_added(there).filter(|_| parameter.words.is_empty())?,
        };
        // Hover is safe within the duties of a flight.
        let of_hover = parameter.name == "compensation.hover_duty_percent";
        let (min, max) = if of_hover { (safety.duty_min_percent, safety.duty_max_percent) } else { (min, max) };
        Some(Number {
            name: parameter.name.into(),
            unit: parameter.unit.replace('u', control),
            min,
            max: max.is_finite().then_some(max),
            words: parameter.words.iter().map(|word| (*word).to_owned()).collect(),
            value: value.map_or(NumberOrWord::Number(None), |value| NumberOrWord::of(parameter, value)),
            absent: value.is_none(),
        })
    };
    Parameter::ALL.iter().zip(there.values()).filter_map(number).collect()
}

/// The message on `numbers`: each by its name.
pub(super) fn in_force(values: &Values) -> String {
    let there =
        Parameter::ALL.iter().zip(values).filter_map(|(one, value)| Some((one.name, NumberOrWord::of(one, (*value)?))));
    serde_json::to_string(&there.collect::<BTreeMap<_, _>>()).unwrap_or_default()
}

impl From<&Offer> for Offered {
    fn from(Offer { name, experiment }: &Offer) -> Self {
        Self { name: name.to_string(), title: experiment.title.clone(), duration_s: experiment.duration_s() }
    }
}

#[cfg(test)]
mod tests {
    use super::About;
    use crate::flight::experiment::offers::offers;
    use config::Config;
    use std::path::Path;

    #[test]
    fn it_says_the_limits_of_the_config_the_controllers_and_the_gains_with_their_units() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let tables = Config::read(&root.join("config.toml"), &[]).unwrap().tables;
        let safety = tables.safety.unwrap();
        let about = About::of(&tables, &offers(&[], &safety).unwrap(), true).unwrap();
        assert_eq!((about.setpoint_mm.min, about.setpoint_mm.max), (safety.setpoint_min_mm, safety.setpoint_max_mm));
        assert_eq!(about.controllers, ["pid", "cascade", "state_feedback", "lqg", "mpc", "open_loop"]);
        let gains: Vec<_> = about.gains.iter().map(|gain| (gain.name.as_str(), gain.unit.as_str(), gain.max)).collect();
        assert_eq!(gains, [("kp_per_mm", "%/mm", Some(1e3)), ("ti_s", "s", None), ("td_s", "s", Some(1e3))]);
        assert_eq!((about.experiments[0].name.as_str(), about.experiments[0].duration_s), ("steps", 60.0));
        assert_eq!(serde_json::from_str::<About>(&about.json()).unwrap(), about);
    }
}
