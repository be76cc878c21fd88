//! The world of the campaign: the plant behind emulated chips, a ball that can be lost or jam, and a record of the fan.

use super::faults::{Case, Mishap, SLOW_BY_S};
use control::Duty;
use embedded_hal::i2c::ErrorKind;
use hal::emulator::{EmulatedBus, EmulatedI2c, World};
use rig::{Chips, PlantWorld, Rig, Sighting, WorldClock};
use std::cell::Cell;

/// The plant before the fault.
pub(super) struct Scene {
    pub(super) plant: PlantWorld,
    pub(super) mishap: Option<Mishap>,
    last_mm: Option<f64>,
    /// Times of the fan's changes, with the new fraction.
    pub(super) fan: Vec<(f64, f64)>,
}

impl Scene {
    pub(super) fn new(plant: PlantWorld) -> Self {
        Self { plant, mishap: None, last_mm: None, fan: Vec::new() }
    }

    /// The fraction that the fan gets now, 0 to 1.
    pub(super) fn fan_now(&self) -> f64 {
        self.fan.last().map_or(0.0, |(_, fraction)| *fraction)
    }
}

impl World for Scene {
    fn now_s(&self) -> f64 {
        self.plant.now_s()
    }

    fn elapse_s(&mut self, seconds: f64) {
        self.plant.elapse_s(seconds);
    }

    fn measure_mm(&mut self, at_s: f64) -> Option<f64> {
        let now_mm = self.plant.measure_mm(at_s);
        let shown_mm = match self.mishap {
            Some(Mishap::BallLost) => None,
            Some(Mishap::BallStuck | Mishap::SensorFrozen) => self.last_mm,
            _ => now_mm,
        };
        self.last_mm = shown_mm;
        shown_mm
    }

    fn measure_second_mm(&mut self, at_s: f64) -> Option<f64> {
        let now_mm = self.plant.measure_second_mm(at_s);
        match self.mishap {
            Some(Mishap::BallLost) => None,
            Some(Mishap::SecondOff { mm }) => now_mm.map(|now_mm| now_mm + mm),
            _ => now_mm,
        }
    }

    fn edge_s(&mut self) -> Option<f64> {
        let edge_s = self.plant.edge_s();
        edge_s.filter(|_| !matches!(self.mishap, Some(Mishap::FanStalled | Mishap::TachometerCut)))
    }

    fn pwm(&mut self, fraction: f64) {
        self.fan.push((self.now_s(), fraction));
        self.plant.pwm(if self.mishap == Some(Mishap::FanStalled) { 0.0 } else { fraction });
    }
}

pub(super) type Bus = EmulatedBus<Scene>;
type Wired = Chips<EmulatedI2c<Scene>, EmulatedI2c<Scene>, WorldClock<Scene>>;

/// The rig, with the fault at its time.
pub(super) struct Struck {
    pub(super) rig: Wired,
    pub(super) bus: Bus,
    pub(super) case: Case,
    pub(super) at_s: f64,
    /// Transactions from there to the first affected one, so that it may be any of a cycle.
    pub(super) skip: u64,
    /// Time of the fault.
    pub(super) struck_s: Cell<Option<f64>>,
    /// Time of the latest cycle's reading.
    pub(super) looked_s: Cell<f64>,
}

impl Struck {
    fn strike(&self) {
        self.case.spoil(&self.bus, self.skip);
        if self.case.mishap == Mishap::Power {
            self.bus.power_cycle();
        }
        if let Mishap::Doubtful { sensors } = self.case.mishap {
            sensors.iter().for_each(|sensor| self.bus.doubt(*sensor, Some(4)));
        }
        self.bus.with_world(|scene| scene.mishap = Some(self.case.mishap));
        if self.case.mishap == Mishap::FanStalled {
            self.bus.with_world(|scene| scene.plant.pwm(0.0));
        }
        if let Mishap::Pause { seconds } = self.case.mishap {
            self.bus.with_world(|scene| scene.elapse_s(seconds));
        }
    }
}

impl Rig for Struck {
    fn now_s(&self) -> f64 {
        self.rig.now_s()
    }

    fn sleep_until_s(&self, t_s: f64) {
        self.rig.sleep_until_s(t_s);
        if t_s >= self.at_s && self.struck_s.get().is_none() {
            self.struck_s.set(Some(self.rig.now_s()));
            self.strike();
        }
        if self.struck_s.get().is_some() && self.case.mishap == Mishap::Slow {
            self.bus.with_world(|scene| scene.elapse_s(SLOW_BY_S));
        }
    }

    fn align(&mut self) -> Result<(), ErrorKind> {
        self.rig.align()
    }

    fn position(&mut self) -> Result<Sighting, ErrorKind> {
        self.looked_s.set(self.rig.now_s());
        self.rig.position()
    }

    fn second_position(&mut self) -> Option<Result<Sighting, ErrorKind>> {
        self.rig.second_position()
    }

    fn fan_rpm(&mut self) -> Option<f64> {
        self.rig.fan_rpm()
    }

    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind> {
        self.rig.drive(duty)
    }
}
