//! The simulated rig: the plant behind emulated chips, so that the drivers that fly the bench fly it too.

use super::chips::{Chips, StartError};
use super::clock::{Monotonic, WorldClock};
use crate::config;
use embedded_hal::i2c::ErrorKind;
use hal::Clock;
use hal::emulator::{EmulatedBus, EmulatedI2c, World};
use plant::{Model, Simulator};

/// The plant, as the chips see it.
pub struct PlantWorld {
    simulator: Simulator,
    fan_percent: f64,
    sensor_to_bottom_mm: f64,
    sensor_scale: f64,
    time: Time,
}

/// Whose time the world lives in.
enum Time {
    /// Its own: it moves when the bus is busy or the loop sleeps.
    Virtual(f64),
    /// Everybody's.
    Real(Monotonic),
}

impl World for PlantWorld {
    fn now_s(&self) -> f64 {
        match &self.time {
            Time::Virtual(now_s) => *now_s,
            Time::Real(clock) => clock.now_s(),
        }
    }

    fn elapse_s(&mut self, seconds: f64) {
        match &mut self.time {
            Time::Virtual(now_s) => *now_s += seconds,
            // A transaction takes its time, as on a real bus: the driver's waits are counts of transactions.
            Time::Real(clock) => clock.sleep_until_s(clock.now_s() + seconds),
        }
    }

    fn measure_mm(&mut self, at_s: f64) -> Option<f64> {
        self.simulator.advance_to(at_s);
        Some((self.sensor_to_bottom_mm - self.simulator.reading_mm()) / self.sensor_scale)
    }

    fn pwm(&mut self, fraction: f64) {
        self.simulator.advance_to(self.now_s());
        self.fan_percent = 100.0 * fraction;
        self.simulator.drive(self.fan_percent);
    }
}

impl PlantWorld {
    /// The plant at time 0, whose time moves when the bus is busy or somebody waits.
    #[must_use]
    pub fn in_virtual_time(model: &Model, rig: &config::Rig, seed: u64) -> Self {
        world(model, rig, seed, Time::Virtual(0.0))
    }

    /// The duty that the fan gets, percent.
    #[must_use]
    pub const fn fan_percent(&self) -> f64 {
        self.fan_percent
    }
}

/// A simulated rig with clock `C`.
pub type SimulatedRig<C> = Chips<EmulatedI2c<PlantWorld>, EmulatedI2c<PlantWorld>, C>;

/// Why a simulated rig does not start: its chips answer as real ones do, so it can only be the config.
pub type SimulatedStartError = StartError<ErrorKind, ErrorKind>;

/// A simulated rig that lives in everybody's time.
///
/// # Errors
/// As [`Chips::start`].
pub fn simulated_in_real_time(
    model: &Model,
    rig: &config::Rig,
    seed: u64,
) -> Result<SimulatedRig<Monotonic>, SimulatedStartError> {
    let clock = Monotonic::start();
    let bus = emulated_bus(model, rig, seed, clock);
    Chips::start((bus.handle(), bus.handle()), clock, rig.sensor_to_bottom_mm, rig.fan_pwm_hz)
        .map(|chips| chips.scaled(rig.sensor_scale))
}

/// The bus of a simulated rig that lives in everybody's time, for whoever wants to drive its chips.
#[must_use]
pub fn emulated_bus(model: &Model, rig: &config::Rig, seed: u64, clock: Monotonic) -> EmulatedBus<PlantWorld> {
    EmulatedBus::new(world(model, rig, seed, Time::Real(clock)))
}

/// A simulated rig whose time moves only when somebody waits: bit-exact for one seed.
///
/// # Errors
/// As [`Chips::start`].
pub fn simulated_in_virtual_time(
    model: &Model,
    rig: &config::Rig,
    seed: u64,
) -> Result<SimulatedRig<WorldClock<PlantWorld>>, SimulatedStartError> {
    let bus = EmulatedBus::new(PlantWorld::in_virtual_time(model, rig, seed));
    let clock = WorldClock(bus.clone());
    Chips::start((bus.handle(), bus.handle()), clock, rig.sensor_to_bottom_mm, rig.fan_pwm_hz)
        .map(|chips| chips.scaled(rig.sensor_scale))
}

fn world(model: &Model, rig: &config::Rig, seed: u64, time: Time) -> PlantWorld {
    PlantWorld {
        simulator: Simulator::new(model.clone(), seed),
        fan_percent: 0.0,
        sensor_to_bottom_mm: rig.sensor_to_bottom_mm,
        sensor_scale: rig.sensor_scale,
        time,
    }
}
