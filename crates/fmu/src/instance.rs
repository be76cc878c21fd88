//! A running FMU: parameters and inputs in, steps, outputs out.

use super::variables::{
    BALL, DUTY, FAN, FRESH, HELD, Kind, NOISE, POSITION, RPM, Role, SEED, SETPOINT, VELOCITY, Variable, variables,
    with_values,
};
use super::{MODEL, period_s};
use config::{Config, ConfigError};
use plant::Model;
use rig::{Seen, Stepped};
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Table, Value};

/// Communication points that are closer than this to a deadline of the loop are that deadline, seconds.
const HAIR_S: f64 = 1e-7;

/// A step that begins further than this from the end of the last one, in its own length, leaves time out; sums of steps
/// round far less.
const APART: f64 = 0.01;

/// Why a call of an FMU failed.
#[derive(Debug, thiserror::Error)]
pub enum InstanceError {
    /// The config in the resources, or a parameter.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The config has no model.
    #[error("the resources hold no table [plant]; export the FMU again")]
    NoModel,
    /// There is no such variable.
    #[error("there is no {kind} variable with the reference {reference}")]
    Unknown {
        /// The type that was asked for.
        kind: &'static str,
        /// The reference.
        reference: u32,
    },
    /// A parameter after the start, or an output.
    #[error("{name} cannot be set {when}")]
    Fixed {
        /// The variable.
        name: String,
        /// When, or why.
        when: &'static str,
    },
    /// A value that is no number.
    #[error("{name} is {value}, not a finite number")]
    NotFinite {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
    },
    /// A call before or after its time.
    #[error("a step to {until_s} s is not possible: {why}")]
    Step {
        /// The end of the step.
        until_s: f64,
        /// What is wrong.
        why: String,
    },
    /// The rig does not start with these parameters.
    #[error("the rig does not start: {0}")]
    Start(String),
}

/// A step that was made: its deadline, and the inputs of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Made {
    deadline_s: f64,
    duty_percent: f64,
    setpoint_mm: Option<f64>,
}

/// The state of an instance: what was set and done. The rig itself follows from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    values: BTreeMap<u32, f64>,
    is_started: bool,
    /// The time of the importer at which the flight begins.
    begins_s: f64,
    /// Time since then.
    time_s: f64,
    made: Vec<Made>,
}

/// An instance of an FMU.
pub struct Instance {
    config: Config,
    model: Model,
    variables: BTreeMap<u32, Variable>,
    state: State,
    rig: Option<Stepped>,
}

impl Instance {
    /// An instance of what is in the folder of the resources.
    ///
    /// # Errors
    /// A config that is not there, not sound, or without a model.
    pub fn new(resources: &Path) -> Result<Self, InstanceError> {
        let config = Config::read(&resources.join(MODEL), &[])?;
        let model = config.tables.plant.clone().ok_or(InstanceError::NoModel)?;
        let variables = variables(&model).into_iter().map(|one| (one.reference, one)).collect();
        Ok(Self { config, model, variables, state: State::default(), rig: None })
    }

    /// Its state before the first call.
    pub fn reset(&mut self) {
        self.state = State::default();
        self.rig = None;
    }

    /// Sets the time at which the first step begins; without it that is 0.
    ///
    /// # Errors
    /// After the start, or a time that is not finite.
    pub fn begin_at(&mut self, begins_s: f64) -> Result<(), InstanceError> {
        if self.state.is_started {
            return Err(InstanceError::Fixed { name: "startTime".into(), when: "after the initialization" });
        }
        if !begins_s.is_finite() {
            return Err(InstanceError::NotFinite { name: "startTime".into(), value: begins_s });
        }
        self.state.begins_s = begins_s;
        Ok(())
    }

    /// A copy of its state.
    #[must_use]
    pub fn state(&self) -> State {
        self.state.clone()
    }

    /// Takes a state back: the rig flies again what it had flown then.
    ///
    /// # Errors
    /// A state of another FMU.
    pub fn set_state(&mut self, state: &State) -> Result<(), InstanceError> {
        self.rig = None;
        self.state = State { is_started: false, time_s: 0.0, made: Vec::new(), ..state.clone() };
        if state.is_started {
            self.start()?;
        }
        state.made.iter().try_for_each(|made| self.fly(*made))?;
        self.state = state.clone();
        Ok(())
    }

    fn variable(&self, reference: u32, kind: Kind) -> Result<&Variable, InstanceError> {
        let name = match kind {
            Kind::Real => "real",
            Kind::Integer => "integer",
            Kind::Boolean => "boolean",
        };
        let unknown = InstanceError::Unknown { kind: name, reference };
        self.variables.get(&reference).filter(|variable| variable.kind == kind).ok_or(unknown)
    }

    /// The value of a variable; a boolean as 0 or 1.
    ///
    /// # Errors
    /// There is no such variable of this type.
    pub fn get(&self, reference: u32, kind: Kind) -> Result<f64, InstanceError> {
        let variable = self.variable(reference, kind)?;
        let seen = self.rig.as_ref().map(Stepped::seen).filter(|_| variable.role == Role::Output);
        Ok(match seen {
            Some(seen) => output(seen, reference),
            None => self.value(variable),
        })
    }

    fn value(&self, variable: &Variable) -> f64 {
        self.state.values.get(&variable.reference).copied().unwrap_or(variable.start)
    }

    /// Sets an input, or before the start a parameter.
    ///
    /// # Errors
    /// There is no such variable of this type, or not now, or a value that is not finite.
    pub fn set(&mut self, reference: u32, kind: Kind, value: f64) -> Result<(), InstanceError> {
        let variable = self.variable(reference, kind)?;
        let name = || variable.name.clone();
        match variable.role {
            Role::Output => return Err(InstanceError::Fixed { name: name(), when: "as it is an output" }),
            Role::Parameter if self.state.is_started => {
                return Err(InstanceError::Fixed { name: name(), when: "after the initialization" });
            }
            Role::Input | Role::Parameter if !value.is_finite() => {
                return Err(InstanceError::NotFinite { name: name(), value });
            }
            Role::Input | Role::Parameter => {}
        }
        self.state.values.insert(reference, value);
        Ok(())
    }

    /// Ends the initialization: the rig with the parameters that were set, at time 0.
    ///
    /// # Errors
    /// A parameter outside its bounds.
    pub fn start(&mut self) -> Result<(), InstanceError> {
        let config = self.config.patched("the parameters of the FMU", &self.patch())?;
        let model = config.tables.plant.as_ref().ok_or(InstanceError::NoModel)?;
        let seed = self.state.values.get(&SEED).copied().unwrap_or(1.0);
        #[expect(clippy::cast_possible_truncation, reason = "it was set as an integer of 32 bits")]
        let seed = (seed as i64).unsigned_abs();
        let rig = Stepped::start(model, config.tables.rig.as_ref(), period_s(&self.config), seed);
        self.rig = Some(rig.map_err(|error| InstanceError::Start(error.to_string()))?);
        self.state.is_started = true;
        Ok(())
    }

    /// The parameters that were set, as a patch of the config.
    fn patch(&self) -> String {
        let set = |name: &str| {
            let variable = self.variables.values().find(|variable| variable.name == name)?;
            self.state.values.get(&variable.reference).copied()
        };
        let quiet = self.state.values.get(&NOISE).is_some_and(|on| *on == 0.0);
        let value = |name: &str| if quiet && name.starts_with("plant.noise.") { Some(0.0) } else { set(name) };
        let model = Value::Table(Table::try_from(&self.model).unwrap_or_default());
        let table = Table::from_iter([("plant".to_owned(), with_values("plant", &model, &value))]);
        toml::to_string(&table).unwrap_or_default()
    }

    /// Flies with the inputs that were set, from a communication point for `step_s`.
    ///
    /// # Errors
    /// A step before the start, or one that does not go on in time from where the last one ended.
    pub fn step(&mut self, from_s: f64, step_s: f64) -> Result<(), InstanceError> {
        let until_s = from_s + step_s - self.state.begins_s;
        let refused = |why: &str| Err(InstanceError::Step { until_s: from_s + step_s, why: why.into() });
        if !self.state.is_started {
            return refused("the initialization has not ended");
        }
        let now_s = self.state.begins_s + self.state.time_s;
        if !until_s.is_finite() || until_s <= self.state.time_s {
            return refused(&format!("the time is {now_s} s already"));
        }
        if (from_s - now_s).abs() > APART * step_s {
            return refused(&format!("it begins at {from_s} s, and the time is {now_s} s"));
        }
        // The deadlines of the loop by its own formula, so that the times are the same to the last bit.
        let on_grid = (until_s / period_s(&self.config)).round() * period_s(&self.config);
        let deadline_s = if (on_grid - until_s).abs() < HAIR_S { on_grid } else { until_s };
        let value = |reference| self.state.values.get(&reference).copied();
        let made = Made { deadline_s, duty_percent: value(DUTY).unwrap_or_default(), setpoint_mm: value(SETPOINT) };
        self.fly(made)?;
        self.state.time_s = until_s;
        self.state.made.push(made);
        Ok(())
    }

    fn fly(&mut self, made: Made) -> Result<(), InstanceError> {
        let failed = |why: String| InstanceError::Step { until_s: made.deadline_s, why };
        let rig = self.rig.as_mut().ok_or_else(|| failed("the initialization has not ended".into()))?;
        let flown = rig.step(made.deadline_s, made.duty_percent, made.setpoint_mm);
        flown.map_err(|kind| failed(format!("error {kind:?} of the emulated bus")))
    }
}

fn output(seen: &Seen, reference: u32) -> f64 {
    match reference {
        POSITION => seen.position_mm.unwrap_or_default(),
        BALL => seen.motion.position_mm,
        VELOCITY => seen.motion.velocity_mm_per_s,
        FAN => seen.motion.fan_mm_per_s2,
        RPM => seen.fan_rpm.unwrap_or_default(),
        HELD => seen.duty_percent,
        FRESH => f64::from(u8::from(seen.is_fresh)),
        _ => 0.0,
    }
}
