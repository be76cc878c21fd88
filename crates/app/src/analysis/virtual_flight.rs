//! Virtual flights: a model flown in virtual time by a controller, its cycles kept in memory.
//!
//! The controller is that of a config, on the rig that [`simulate`](crate::commands::simulate) flies. Where a config
//! holds a plant alone, it is a slow PID computed from the model, on a rig without chips:
//!
//! ```text
//! ÿ = K·u − a·ẏ, u = K_p·(e + T_d·ė)      the loop crosses over at ω = 0.35/τ, at most 3 rad/s
//! T_d = 1/z, z = max(a, ω/3)              the zero cancels the drag, or leads by 72° where there is little drag
//! K_p = ω·√(ω² + a²) / (K·√(1 + ω²/z²))   τ: lags, delays and 1.5 periods together
//! ```
//!
//! It is slower where the sensor's noise would move the duty by more than a fifth of its range. Such a crossover loses
//! 20° of phase to the lags; the integral only has to find hover.
//! Source: loop shaping, Åström & Murray, *Feedback Systems*, "Frequency Domain Design".

use crate::flight::Flight;
use crate::flight::experiment::Experiment;
use crate::flight::outside::Recorder;
use crate::flight::pilot::{Orders, Pilot, Signals, reading_period_s};
use crate::flight::vocabulary::{Cycle, Event, Fault};
use crate::log::reader::LoadedLog;
use config::{Loop, Rig, Safety, Tables};
use control::compensation::Compensation;
use control::controller::{Controllers, Kind};
use control::observer::Observer;
use control::pid::{DerivativeOn, Pid};
use control::regulator::Regulator;
use plant::Model;
use rig::{Direct, simulated_in_virtual_time};
use std::sync::atomic::AtomicBool;

/// Crossover of the slow loop times its lags, and the largest crossover, rad/s.
const BESIDE_LAGS: f64 = 0.35;
const FASTEST_PER_S: f64 = 3.0;
/// The integral of the slow loop is slower than its crossover by this factor.
const INTEGRAL: f64 = 10.0;
/// N of the slow loop, and the share of the duty's range that the sensor's noise may take through it, 1 sigma.
const DERIVATIVE_N: f64 = 10.0;
const NOISE_SHARE: f64 = 0.2;
/// Largest acceleration that the slow loop may command, pipe lengths per second squared.
const HARDEST_PIPES_PER_S2: f64 = 4.0;

/// A rig and a controller that can fly any model.
#[derive(Clone, Debug)]
pub struct Desk {
    /// The chips around the plant; `None`: unknown.
    rig: Option<Rig>,
    table: Loop,
    controllers: Controllers,
    observer: Option<Observer>,
    compensation: Compensation,
    /// The limits of every flight.
    pub safety: Safety,
}

/// The result of a flight.
#[derive(Clone, Debug, Default)]
pub struct Flown {
    /// Its control periods.
    pub cycles: Vec<Cycle>,
    /// The fault that ended it.
    pub fault: Option<Fault>,
}

impl Recorder for Flown {
    fn cycle(&mut self, cycle: &Cycle) {
        self.cycles.push(*cycle);
    }

    fn event(&mut self, _: &Event) {}
}

impl Desk {
    /// The controllers of a config. `None`: it has none that can fly.
    #[must_use]
    pub fn of(tables: &Tables) -> Option<Self> {
        let desk = Self {
            rig: tables.rig.clone(),
            table: tables.r#loop?,
            controllers: tables.controller.clone()?,
            observer: tables.observer,
            compensation: tables.compensation.clone()?,
            safety: tables.safety?,
        };
        desk.regulator().is_some().then_some(desk)
    }

    /// The controller that flew a log: that of the config which the log holds, or else of the config at hand.
    #[must_use]
    pub fn that_flew(log: &LoadedLog, tables: &Tables) -> Option<Self> {
        let held = log.config_toml.as_deref().and_then(|text| toml::from_str::<Tables>(text).ok());
        held.filter(|held| held.check().is_ok()).as_ref().and_then(Self::of).or_else(|| Self::of(tables))
    }

    /// The compensation between this controller and the fan.
    #[must_use]
    pub const fn compensation(&self) -> &Compensation {
        &self.compensation
    }

    /// A slow controller for a rig of which only `model` and the time between readings are known. `None`: its hover is
    /// not a possible duty.
    #[must_use]
    pub fn gentle(model: &Model, period_s: f64) -> Option<Self> {
        let hover = model.hover_duty_percent;
        let room = hover.min(100.0 - hover);
        if room <= 0.0 || !(0.001..=1.0).contains(&period_s) {
            return None;
        }
        let (gain, pipe_mm) = (model.gain_mm_per_s2_per_percent, model.pipe_length_mm);
        let reach = (HARDEST_PIPES_PER_S2 * pipe_mm / gain).clamp(0.05 * room, 0.95 * room);
        let safety = Safety {
            setpoint_min_mm: model.pipe_bottom_mm + 0.1 * pipe_mm,
            setpoint_max_mm: model.pipe_bottom_mm + 0.9 * pipe_mm,
            duty_min_percent: hover - reach,
            duty_max_percent: hover + reach,
            coast_s: 0.3,
            stall_s: 0.5,
            stuck: None,
        };
        let fast = (BESIDE_LAGS / slowness_s(model, period_s)).min(FASTEST_PER_S);
        let noisy = gentle_pid(model, fast).kp_per_mm * (1.0 + DERIVATIVE_N) * model.noise.sensor_mm;
        let pid = gentle_pid(model, fast * (NOISE_SHARE * reach / noisy).min(1.0));
        let table = Loop { period_s, late_after_s: period_s };
        let (controllers, compensation) = (Controllers::only_pid(pid), Compensation::bare(hover));
        Some(Self { rig: None, table, controllers, observer: None, compensation, safety })
    }

    /// The same with all gains of the controllers multiplied. `None`: the active one has no gain.
    #[must_use]
    pub fn with_gain(&self, ratio: f64) -> Option<Self> {
        let has_gain = self.controllers.first().is_some_and(|kind| !matches!(kind, Kind::Mpc | Kind::OpenLoop));
        has_gain.then(|| Self { controllers: self.controllers.scaled(ratio), ..self.clone() })
    }

    /// Makes the controller a proportional one, for tests against closed forms.
    #[cfg(test)]
    pub(crate) fn set_proportional(&mut self, kp_per_mm: f64) {
        let pid = Pid::new(kp_per_mm, f64::INFINITY, 0.0, DERIVATIVE_N, DerivativeOn::Measurement);
        self.controllers = Controllers::only_pid(pid);
        self.safety = Safety { duty_min_percent: 0.0, duty_max_percent: 100.0, ..self.safety };
    }

    /// Time from one cycle to the next, seconds.
    #[must_use]
    pub const fn period_s(&self) -> f64 {
        self.table.period_s
    }

    /// Flies a rig that behaves as `model` through `experiment`, which must have an end.
    #[must_use]
    pub fn fly(&self, model: &Model, experiment: &Experiment, seed: u64) -> Flown {
        let mut flown = Flown::default();
        // Every constructor has already made a regulator of these tables.
        let Some(regulator) = self.regulator() else { return flown };
        let pilot = Pilot::new(Orders {
            regulator,
            compensation: self.compensation.clone(),
            safety: self.safety,
            experiment: experiment.clone(),
            reading_period_s: self.reading_period_s(),
            signals: self.rig.as_ref().map(Signals::from).unwrap_or_default(),
            top_mm: self.rig.as_ref().map_or(model.pipe_mm().1, |rig| rig.sensor_to_bottom_mm),
        });
        let stop = AtomicBool::new(false);
        let outcome = match &self.rig {
            // Emulated chips always answer: a rig that does not start gives a flight without cycles.
            Some(rig) => simulated_in_virtual_time(model, rig, seed)
                .map(|mut rig| Flight::new(&mut rig, pilot, &self.table, &mut flown, None).fly(f64::INFINITY, &stop))
                .ok(),
            None => {
                let mut rig = Direct::new(model, seed);
                Some(Flight::new(&mut rig, pilot, &self.table, &mut flown, None).fly(f64::INFINITY, &stop))
            }
        };
        flown.fault = outcome.and_then(|outcome| outcome.fault);
        flown
    }

    fn regulator(&self) -> Option<Regulator> {
        Regulator::new(self.controllers.clone(), self.observer.as_ref(), self.reading_period_s()).ok()
    }

    /// The period of the loop or of the sensor, whichever is longer.
    fn reading_period_s(&self) -> f64 {
        if self.rig.is_some() { reading_period_s(&self.table) } else { self.table.period_s }
    }
}

/// The gains whose loop crosses over at `omega`, rad/s.
fn gentle_pid(model: &Model, omega: f64) -> Pid {
    let zero = model.drag_per_s.max(omega / 3.0);
    let gain = model.gain_mm_per_s2_per_percent;
    let kp_per_mm = omega * omega.hypot(model.drag_per_s) / (gain * 1.0_f64.hypot(omega / zero));
    Pid::new(kp_per_mm, INTEGRAL / omega, zero.recip(), DERIVATIVE_N, DerivativeOn::Measurement)
}

/// Total lag from duty to ball, seconds: lags, delays and the loop's own period.
fn slowness_s(model: &Model, period_s: f64) -> f64 {
    model.effects.latest_s() + model.effects.hold().map_or(0.0, |stale| stale.hold_s) + 1.5 * period_s
}
