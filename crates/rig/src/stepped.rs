//! A simulated rig whose loop is somebody else's: it takes a duty, flies to the next deadline and is read there.
//!
//! ```text
//! start: align → sleep to deadline 0 → read          step: write the duty → sleep to the deadline → read
//! ```
//!
//! That is a cycle of `airball`'s flight cut between reading and writing. Fed with the duties of a flight it gives that
//! flight's readings, to the last bit.

use super::clock::WorldClock;
use super::direct::Direct;
use super::simulated::{PlantWorld, SimulatedRig, SimulatedStartError, with_world_in_virtual_time};
use super::{Rig, Sighting};
use control::{Duty, Millimetres};
use embedded_hal::i2c::ErrorKind;
use hal::emulator::EmulatedBus;
use plant::{Model, Motion};

/// What is read and known at a deadline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// The position by the sensor, mm; the last one, where there is no new one. Absent before the first.
    pub position_mm: Option<f64>,
    /// Whether it is new.
    pub is_fresh: bool,
    /// The position by the second sensor, mm, where it is new.
    pub position2_mm: Option<f64>,
    /// The speed of the fan, rpm, where there is a tachometer.
    pub fan_rpm: Option<f64>,
    /// The duty as the chip holds it, percent.
    pub duty_percent: f64,
    /// Where the ball really is, and how it moves.
    pub motion: Motion,
}

/// A rig with chips, and the bus that they are on; or one without.
enum Kind {
    Chips(Box<SimulatedRig<WorldClock<PlantWorld>>>, EmulatedBus<PlantWorld>),
    Direct(Box<Direct>),
}

/// A simulated rig in virtual time, between two steps.
pub struct Stepped {
    kind: Kind,
    start_s: f64,
    seen: Seen,
}

impl Stepped {
    /// A rig at its deadline 0. `table`: the wiring of its chips; without one, the plant is read and driven directly.
    ///
    /// # Errors
    /// Chips that the config does not allow.
    pub fn start(
        model: &Model,
        table: Option<&config::Rig>,
        period_s: f64,
        seed: u64,
    ) -> Result<Self, SimulatedStartError> {
        let kind = match table {
            Some(table) => {
                let (chips, bus) = with_world_in_virtual_time(model, table, seed)?;
                Kind::Chips(Box::new(chips), bus)
            }
            None => Kind::Direct(Box::new(Direct::new(model, seed))),
        };
        let mut stepped = Self { kind, start_s: 0.0, seen: Seen::default() };
        // A silent sensor is seen in the readings, as in a flight.
        let _ = stepped.rig().align();
        stepped.start_s = stepped.rig().now_s() + period_s;
        stepped.look(0.0);
        Ok(stepped)
    }

    /// What was seen at the last deadline.
    #[must_use]
    pub const fn seen(&self) -> &Seen {
        &self.seen
    }

    /// Writes a duty, percent, and flies to a deadline, seconds after deadline 0. `setpoint_mm`: for effects that
    /// depend on it.
    ///
    /// # Errors
    /// The error of the emulated bus.
    pub fn step(&mut self, deadline_s: f64, duty_percent: f64, setpoint_mm: Option<f64>) -> Result<(), ErrorKind> {
        self.rig().set_setpoint(setpoint_mm);
        self.seen.duty_percent = self.rig().drive(Duty::clamped(duty_percent))?.percent();
        self.look(deadline_s);
        Ok(())
    }

    fn look(&mut self, deadline_s: f64) {
        let at_s = self.start_s + deadline_s;
        self.rig().sleep_until_s(at_s);
        let position = self.rig().position();
        self.seen.is_fresh = false;
        if let Ok(Sighting::Ball(Millimetres(position_mm))) = position {
            (self.seen.position_mm, self.seen.is_fresh) = (Some(position_mm), true);
        }
        self.seen.position2_mm = match self.rig().second_position() {
            Some(Ok(Sighting::Ball(Millimetres(position_mm)))) => Some(position_mm),
            _ => None,
        };
        self.seen.fan_rpm = self.rig().fan_rpm();
        self.seen.motion = match &self.kind {
            Kind::Chips(_, bus) => bus.with_world(|world| world.motion_now()),
            Kind::Direct(direct) => direct.motion_now(),
        };
    }

    fn rig(&mut self) -> &mut dyn Rig {
        match &mut self.kind {
            Kind::Chips(chips, _) => chips.as_mut(),
            Kind::Direct(direct) => direct.as_mut(),
        }
    }
}
