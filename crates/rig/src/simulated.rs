//! The simulated rig: the plant behind emulated chips, so that it is flown with the drivers of the bench.

use super::chips::{Chips, Wiring};
use super::clock::WorldClock;
use super::direct::motion_at;
use super::error::StartError;
use super::lines::Lines;
use super::pulses::Pulses;
use super::shared_setpoint::SharedSetpoint;
use embedded_hal::i2c::ErrorKind;
use hal::Clock;
use hal::emulator::{EmulatedBus, EmulatedI2c, World};
use plant::{Model, Motion, Normal, Simulator};

/// Stream number of the second sensor's noise; the simulator's are below.
const SECOND_STREAM: u64 = 4;

/// The plant behind the chips.
pub struct PlantWorld {
    simulator: Simulator,
    second: Option<SecondBeam>,
    pulses: Option<Pulses>,
    fan_percent: f64,
    sensor_to_bottom_mm: f64,
    sensor_scale: f64,
    time: Time,
    /// The setpoint of the loop that flies it.
    setpoint: SharedSetpoint,
}

/// The second sensor: the true position of the ball, with noise. The sensor effects of the model apply to the first.
struct SecondBeam {
    table: config::SecondSensor,
    sigma_mm: f64,
    noise: Normal,
}

/// The time of the world.
enum Time {
    /// Virtual time: it advances when the bus is busy or the loop sleeps.
    Virtual(f64),
    /// Real time.
    Real(Box<dyn Clock + Send>),
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
            // A transaction takes its time, as on a real bus: the driver waits by counting transactions.
            Time::Real(clock) => clock.sleep_until_s(clock.now_s() + seconds),
        }
    }

    fn measure_mm(&mut self, at_s: f64) -> Option<f64> {
        self.simulator.advance_to(at_s);
        Some((self.sensor_to_bottom_mm - self.simulator.reading_mm()) / self.sensor_scale)
    }

    fn measure_second_mm(&mut self, at_s: f64) -> Option<f64> {
        self.simulator.advance_to(at_s);
        let ball_mm = self.simulator.motion().position_mm;
        let second = self.second.as_mut()?;
        Some(second.table.distance_mm(ball_mm + second.sigma_mm * second.noise.draw()))
    }

    fn edge_s(&mut self) -> Option<f64> {
        let now_s = self.now_s();
        self.pulses.as_mut()?.next_edge_s(now_s)
    }

    fn pwm(&mut self, fraction: f64) {
        let now_s = self.now_s();
        self.simulator.advance_to(now_s);
        self.fan_percent = 100.0 * fraction;
        self.simulator.set_setpoint(self.setpoint.get());
        self.simulator.drive(self.fan_percent);
        if let Some(pulses) = &mut self.pulses {
            pulses.drive(now_s, self.fan_percent);
        }
    }
}

impl PlantWorld {
    /// The plant at time 0, whose time advances when the bus is busy or a clock sleeps.
    #[must_use]
    pub fn in_virtual_time(model: &Model, rig: &config::Rig, seed: u64) -> Self {
        world(model, rig, seed, Time::Virtual(0.0))
    }

    /// The true motion of the ball now.
    #[must_use]
    pub fn motion_now(&self) -> Motion {
        motion_at(&self.simulator, self.now_s())
    }

    /// The duty that the fan gets, percent.
    #[must_use]
    pub const fn fan_percent(&self) -> f64 {
        self.fan_percent
    }
}

/// A simulated rig with clock `C`.
pub type SimulatedRig<C> = Chips<EmulatedI2c<PlantWorld>, EmulatedI2c<PlantWorld>, C>;

/// Why a simulated rig does not start: its chips answer as real ones do, so only the config can be wrong.
pub type SimulatedStartError = StartError<ErrorKind, ErrorKind>;

/// A simulated rig in real time, which is that of the clock.
///
/// # Errors
/// As [`Chips::start`].
pub fn simulated_in_real_time<C: Clock + Clone + Send + 'static>(
    model: &Model,
    rig: &config::Rig,
    seed: u64,
    clock: C,
) -> Result<SimulatedRig<C>, SimulatedStartError> {
    let world = world(model, rig, seed, Time::Real(Box::new(clock.clone())));
    start_in(world, |_| clock, rig).map(|(rig, _)| rig)
}

/// The bus of a simulated rig in real time, for other drivers of its chips.
#[must_use]
pub fn emulated_bus(
    model: &Model,
    rig: &config::Rig,
    seed: u64,
    clock: impl Clock + Send + 'static,
) -> EmulatedBus<PlantWorld> {
    with_signals(EmulatedBus::new(world(model, rig, seed, Time::Real(Box::new(clock)))), rig)
}

/// The bus with the signals of `[rig]`.
#[must_use]
pub fn with_signals<W: World>(bus: EmulatedBus<W>, rig: &config::Rig) -> EmulatedBus<W> {
    let bus = if rig.second_sensor.is_some() { bus.with_second_sensor() } else { bus };
    if rig.output_enable.is_some() {
        // The pin is wired to a line that is not driven yet, with its pull-up.
        drop(bus.output_enable());
    }
    bus
}

/// Wires the chips of an emulated rig and starts them.
///
/// # Errors
/// As [`Chips::start`].
pub fn start<W: World + 'static, C: Clock + Clone>(
    bus: &EmulatedBus<W>,
    clock: C,
    rig: &config::Rig,
) -> Result<Chips<EmulatedI2c<W>, EmulatedI2c<W>, C>, SimulatedStartError> {
    let second = rig.second_sensor.map(|_| bus.handle());
    let wiring = Wiring { sensor: bus.handle(), second, fan: bus.handle(), lines: Lines::emulated(bus, rig) };
    Chips::start(wiring, clock, rig)
}

/// A simulated rig in virtual time, which advances only when a clock sleeps: bit-exact for one seed.
///
/// # Errors
/// As [`Chips::start`].
pub fn simulated_in_virtual_time(
    model: &Model,
    rig: &config::Rig,
    seed: u64,
) -> Result<SimulatedRig<WorldClock<PlantWorld>>, SimulatedStartError> {
    with_world_in_virtual_time(model, rig, seed).map(|(rig, _)| rig)
}

/// The same, and a handle of its bus.
///
/// # Errors
/// As [`Chips::start`].
pub(super) fn with_world_in_virtual_time(
    model: &Model,
    rig: &config::Rig,
    seed: u64,
) -> Result<(SimulatedRig<WorldClock<PlantWorld>>, EmulatedBus<PlantWorld>), SimulatedStartError> {
    start_in(PlantWorld::in_virtual_time(model, rig, seed), |bus| WorldClock(bus.clone()), rig)
}

/// Starts the chips of `[rig]` in a world, by a clock that may be that of their bus.
fn start_in<C: Clock + Clone>(
    world: PlantWorld,
    clock: impl FnOnce(&EmulatedBus<PlantWorld>) -> C,
    rig: &config::Rig,
) -> Result<(SimulatedRig<C>, EmulatedBus<PlantWorld>), SimulatedStartError> {
    let setpoint = world.setpoint.clone();
    let bus = with_signals(EmulatedBus::new(world), rig);
    Ok((start(&bus, clock(&bus), rig)?.with_setpoint(setpoint), bus))
}

fn world(model: &Model, rig: &config::Rig, seed: u64, time: Time) -> PlantWorld {
    PlantWorld {
        simulator: Simulator::new(model.clone(), seed),
        second: rig.second_sensor.map(|table| SecondBeam {
            table,
            sigma_mm: model.noise.sensor_mm,
            noise: Normal::new(seed, SECOND_STREAM),
        }),
        pulses: rig.tachometer.map(|table| Pulses::new(model, &table)),
        fan_percent: 0.0,
        sensor_to_bottom_mm: rig.sensor_to_bottom_mm,
        sensor_scale: rig.sensor_scale,
        time,
        setpoint: SharedSetpoint::default(),
    }
}
