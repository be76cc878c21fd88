//! The VL53L0X's registers, as far as a driver can tell: reset, start-up, calibration, ranging.
//!
//! Ranging back to back, a measurement ends every timing budget, whether anyone reads it or not. At its end the world
//! is asked once, the rounded distance replaces the last one, and "ready" stays set until the host clears it. So a host
//! that comes late gets the latest measurement, and one that comes too late misses some.
//!
//! Time is made up on each transaction: what should have ended since the last one ends now, in order.
//!
//! XSHUT low is a reset that takes the address as well; a soft reset leaves it, as ST's own driver expects of it.
//!
//! Left out: the timed mode, interrupt pins. Durations of start-up and calibration are invented
//! but of the right order.

use std::collections::BTreeMap;

use super::world::{Chip, World};

/// The address after power-on, and the register that holds it.
const ADDRESS: u8 = 0x29;
const DEVICE_ADDRESS: u8 = 0x8A;
const PAGE: u8 = 0xFF;
const SYSRANGE_START: u8 = 0x00;
const SEQUENCE_CONFIG: u8 = 0x01;
const INTERRUPT_CLEAR: u8 = 0x0B;
const INTERRUPT_STATUS: u8 = 0x13;
const RANGE_STATUS: u8 = 0x14;
const RANGE_MM: u8 = 0x1E;
const SOFT_RESET: u8 = 0xBF;
const MODEL_ID: u8 = 0xC0;
/// On page 7: writing 0 asks for the reference SPADs, non-zero is the answer.
const SPAD_READY: u8 = 0x83;

const NEW_SAMPLE: u8 = 0x04;
/// Range status, in bits 6 to 3 of its register: 11 is a good range, 4 is too little signal.
const GOOD: u8 = 11;
const NO_TARGET: u8 = 4;
const NO_TARGET_MM: u16 = 8190;

const BOOT_S: f64 = 0.0012;
const SPADS_S: f64 = 0.001;
const CALIBRATION_S: f64 = 0.005;

/// Registers that are not zero after power-on: page, register, value.
const POWER_ON: [(u8, u8, u8); 14] = [
    (0, SEQUENCE_CONFIG, 0xFF),
    (0, 0x84, 0x10),
    (0, DEVICE_ADDRESS, ADDRESS),
    (0, 0xB0, 0xFF),
    (0, 0xB1, 0xFF),
    (0, 0xB2, 0xFF),
    (0, 0xB3, 0xFF),
    (0, 0xB4, 0xFF),
    (0, 0xB5, 0xFF),
    (0, MODEL_ID, 0xEE),
    (0, 0xF8, 0x0A),
    (0, 0xF9, 0xC8),
    (1, 0x91, 0x3C),
    (7, 0x92, 0x85),
];

#[derive(Clone, Copy, PartialEq)]
enum Task {
    Calibration,
    SingleShot,
    BackToBack,
}

/// What a sensor looks at: [`World::measure_mm`], or the same of the second sensor.
type Beam = fn(&mut dyn World, f64) -> Option<f64>;

pub(super) struct Vl53l0x {
    beam: Beam,
    /// XSHUT is low.
    shut: bool,
    /// The status of every distance; it depends on the light and not on the chip, so that no reset changes it.
    doubt: Option<u8>,
    registers: BTreeMap<(u8, u8), u8>,
    page: u8,
    index: u8,
    in_reset: bool,
    booted_s: f64,
    spads_s: f64,
    /// What the chip is doing, and when that ends.
    task: Option<(Task, f64)>,
}

impl Vl53l0x {
    /// The sensor of every rig, as after power-on.
    pub(super) fn first() -> Self {
        Self::fresh(|world, at_s| world.measure_mm(at_s))
    }

    /// The second one.
    pub(super) fn second() -> Self {
        Self::fresh(|world, at_s| world.measure_second_mm(at_s))
    }

    fn fresh(beam: Beam) -> Self {
        let registers = POWER_ON.map(|(page, register, value)| ((page, register), value)).into();
        Self {
            beam,
            shut: false,
            doubt: None,
            registers,
            page: 0,
            index: 0,
            in_reset: false,
            booted_s: 0.0,
            spads_s: f64::INFINITY,
            task: None,
        }
    }

    /// The same chip with its registers as after power-on.
    fn emptied(&self) -> Self {
        Self { shut: self.shut, doubt: self.doubt, ..Self::fresh(self.beam) }
    }

    fn register(&self, page: u8, register: u8) -> u8 {
        self.registers.get(&(page, register)).copied().unwrap_or(0)
    }

    fn set(&mut self, register: u8, value: u8) {
        self.registers.insert((0, register), value);
    }

    /// A low bit empties the chip and holds it; a high one lets it boot.
    fn reset(&mut self, byte: u8, now_s: f64) {
        let release = byte & 0x01 != 0;
        if !release {
            let address = self.register(0, DEVICE_ADDRESS);
            *self = Self { in_reset: true, ..self.emptied() };
            self.set(DEVICE_ADDRESS, address);
        } else if self.in_reset {
            self.in_reset = false;
            self.booted_s = now_s + BOOT_S;
        }
    }

    /// Bit 1 starts ranging back to back. Bit 0 stops that, or starts one range or one calibration.
    fn start(&mut self, byte: u8, now_s: f64) {
        const RANGING_STEPS: u8 = 0xC0;
        let ranges = self.register(0, SEQUENCE_CONFIG) & RANGING_STEPS != 0;
        self.task = match (byte & 0x03, self.task) {
            (0, task) => task,
            (1, Some((Task::BackToBack, _))) => None,
            (1, _) if ranges => Some((Task::SingleShot, now_s + self.budget_s())),
            (1, _) => Some((Task::Calibration, now_s + CALIBRATION_S)),
            _ => Some((Task::BackToBack, now_s + self.budget_s())),
        };
    }

    /// Ends everything that should have ended by now.
    fn catch_up(&mut self, world: &mut dyn World) {
        let now_s = world.now_s();
        while self.ends_s().is_some_and(|end_s| end_s <= now_s) {
            self.end_one(world);
        }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=8189")]
    fn latch(&mut self, distance_mm: Option<f64>) {
        let (status, mm) = match distance_mm {
            Some(mm) if mm.is_finite() => (GOOD, mm.round().clamp(0.0, f64::from(NO_TARGET_MM - 1)) as u16),
            _ => (NO_TARGET, NO_TARGET_MM),
        };
        let [high, low] = mm.to_be_bytes();
        self.set(RANGE_STATUS, self.doubt.unwrap_or(status) << 3);
        self.set(RANGE_MM, high);
        self.set(RANGE_MM + 1, low);
    }

    /// The timing budget that the registers encode: the inverse of ST's `set_measurement_timing_budget`.
    ///
    /// The encoding resolves no finer than 0.04 ms and drops low bits, so the nearest whole millisecond is taken for
    /// what was asked. The oscillator of a real chip is off by more.
    fn budget_s(&self) -> f64 {
        const START_AND_END_US: f64 = 1320.0 + 960.0;
        let steps = self.register(0, SEQUENCE_CONFIG);
        let is_on = |bit: u8| steps & (1 << bit) != 0;
        let macro_period_us = |register| 2304.0 * 2.0 * (f64::from(self.register(0, register)) + 1.0) * 1.655e-3;
        let timeout = |high, low| f64::from(self.register(0, low)) * f64::from(self.register(0, high)).exp2() + 1.0;
        // ST rounds by half a period more.
        let us = |periods: f64, period_us: f64| (periods + 0.5) * period_us;

        let (pre_period, final_period) = (macro_period_us(0x50), macro_period_us(0x70));
        let pre_periods = timeout(0x51, 0x52);
        let final_periods = (timeout(0x71, 0x72) - if is_on(6) { pre_periods } else { 0.0 }).max(0.0);
        let signal_us = us(f64::from(self.register(0, 0x46)) + 1.0, pre_period);
        let budget_us = START_AND_END_US
            + if is_on(4) { signal_us + 590.0 } else { 0.0 }
            + match (is_on(3), is_on(2)) {
                (true, _) => 2.0 * signal_us + 690.0,
                (false, true) => signal_us + 660.0,
                (false, false) => 0.0,
            }
            + if is_on(6) { us(pre_periods, pre_period) + 660.0 } else { 0.0 }
            + if is_on(7) { us(final_periods, final_period) + 550.0 } else { 0.0 };
        (budget_us / 1000.0).round() / 1000.0
    }
}

impl Chip for Vl53l0x {
    fn address(&self) -> Option<u8> {
        (!self.shut).then(|| self.register(0, DEVICE_ADDRESS) & 0x7F)
    }

    fn pin(&mut self, high: bool, world: &mut dyn World) {
        let was_high = !self.shut;
        if high == was_high {
            return;
        }
        *self = Self { shut: !high, booted_s: world.now_s() + BOOT_S, ..self.emptied() };
    }

    fn power_cycle(&mut self) {
        *self = self.emptied();
    }

    fn doubt(&mut self, status: Option<u8>) {
        self.doubt = status;
    }

    fn ends_s(&self) -> Option<f64> {
        self.task.map(|(_, end_s)| end_s)
    }

    fn end_one(&mut self, world: &mut dyn World) {
        let Some((task, end_s)) = self.task.take() else { return };
        if task != Task::Calibration {
            self.latch((self.beam)(world, end_s));
        }
        if task == Task::BackToBack {
            self.task = Some((task, end_s + self.budget_s()));
        }
        self.set(INTERRUPT_STATUS, NEW_SAMPLE);
    }

    fn begin(&mut self, world: &mut dyn World) -> bool {
        self.catch_up(world);
        let now_s = world.now_s();
        if now_s >= self.spads_s {
            self.registers.insert((7, SPAD_READY), 1);
            self.spads_s = f64::INFINITY;
        }
        now_s >= self.booted_s
    }

    fn select(&mut self, index: u8) {
        self.index = index;
    }

    fn put(&mut self, byte: u8, world: &mut dyn World) {
        let now_s = world.now_s();
        let index = self.index;
        self.index = index.wrapping_add(1);
        match (self.page, index) {
            (0, SOFT_RESET) => self.reset(byte, now_s),
            _ if self.in_reset => {}
            (_, PAGE) => self.page = byte,
            (0, MODEL_ID) => {}
            (0, SYSRANGE_START) => self.start(byte, now_s),
            (0, INTERRUPT_CLEAR) => self.set(INTERRUPT_STATUS, 0),
            (7, SPAD_READY) if byte == 0 => {
                self.registers.insert((7, SPAD_READY), 0);
                self.spads_s = now_s + SPADS_S;
            }
            (page, _) => {
                self.registers.insert((page, index), byte);
            }
        }
    }

    fn get(&mut self) -> u8 {
        let index = self.index;
        self.index = index.wrapping_add(1);
        match index {
            _ if self.in_reset => 0,
            PAGE => self.page,
            _ => self.register(self.page, index),
        }
    }

    fn end(&mut self, _: &mut dyn World) {}
}
