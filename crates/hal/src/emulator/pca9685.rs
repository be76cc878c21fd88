//! The PCA9685's registers, and what they make of the output of channel 0.
//!
//! ```text
//! fraction = 0                          asleep, or full-off, or output-enable is high
//!          = 1                          full-on
//!          = (off − on) mod 4096 / 4096
//! ```
//!
//! Kept from the datasheet: PRE_SCALE is deaf while awake and at least 3, a write without auto-increment stays at its
//! register, full-off wins over full-on, outputs change at the stop condition.
//! Left out: sub-addresses, general-call reset, inverted outputs, and the RESTART bit. After waking, the outputs come
//! back at once; the chip would wait for a write. That is the stricter judge of a driver that must not start the fan.

use super::world::{Chip, World};

/// Where its address pins put it.
pub(super) const ADDRESS: u8 = 0x40;
const MODE1: u8 = 0x00;
const AUTO_INCREMENT: u8 = 0x20;
const SLEEP: u8 = 0x10;
const LED0_ON_L: u8 = 0x06;
const ALL_LED_ON_L: u8 = 0xFA;
const ALL_LED_OFF_H: u8 = 0xFD;
const PRE_SCALE: u8 = 0xFE;
/// The same bit in ON_H (full on) and OFF_H (full off).
const FULL: u8 = 0x10;
const CHANNELS: u8 = 16;

pub(super) struct Pca9685 {
    registers: [u8; 256],
    index: u8,
    fraction: f64,
    /// Output-enable is high. The pin is wired to ground unless something drives it.
    disabled: bool,
}

impl Default for Pca9685 {
    /// As after power-on: asleep, every channel full off, 200 Hz.
    fn default() -> Self {
        let mut registers = [0; 256];
        registers[usize::from(MODE1)] = 0x11;
        registers[0x01] = 0x04;
        registers[usize::from(PRE_SCALE)] = 0x1E;
        for channel in 0..CHANNELS {
            registers[usize::from(LED0_ON_L + 4 * channel + 3)] = FULL;
        }
        Self { registers, index: 0, fraction: 0.0, disabled: false }
    }
}

impl Pca9685 {
    fn is_set(&self, bit: u8) -> bool {
        self.registers[usize::from(MODE1)] & bit != 0
    }

    fn step(&mut self) {
        if self.is_set(AUTO_INCREMENT) {
            self.index = self.index.wrapping_add(1);
        }
    }

    fn output(&self) -> f64 {
        let [on_l, on_h, off_l, off_h] = [0, 1, 2, 3].map(|i| self.registers[usize::from(LED0_ON_L) + i]);
        let on = u16::from_le_bytes([on_l, on_h & 0x0F]);
        let off = u16::from_le_bytes([off_l, off_h & 0x0F]);
        match () {
            () if self.disabled || self.is_set(SLEEP) || off_h & FULL != 0 => 0.0,
            () if on_h & FULL != 0 => 1.0,
            () => f64::from(off.wrapping_sub(on) % 4096) / 4096.0,
        }
    }
}

impl Chip for Pca9685 {
    fn address(&self) -> Option<u8> {
        Some(ADDRESS)
    }

    fn pin(&mut self, high: bool, world: &mut dyn World) {
        self.disabled = high;
        self.end(world);
    }

    fn power_cycle(&mut self) {
        *self = Self { disabled: self.disabled, ..Self::default() };
    }

    fn begin(&mut self, _: &mut dyn World) -> bool {
        true
    }

    fn select(&mut self, index: u8) {
        self.index = index;
    }

    fn put(&mut self, byte: u8, _: &mut dyn World) {
        match self.index {
            PRE_SCALE if self.is_set(SLEEP) => self.registers[usize::from(PRE_SCALE)] = byte.max(3),
            PRE_SCALE => {}
            ALL_LED_ON_L..=ALL_LED_OFF_H => {
                for channel in 0..CHANNELS {
                    let register = LED0_ON_L + 4 * channel + (self.index - ALL_LED_ON_L);
                    self.registers[usize::from(register)] = byte;
                }
            }
            index => self.registers[usize::from(index)] = byte,
        }
        self.step();
    }

    fn get(&mut self) -> u8 {
        let byte = self.registers[usize::from(self.index)];
        self.step();
        byte
    }

    fn end(&mut self, world: &mut dyn World) {
        let fraction = self.output();
        if fraction.to_bits() != self.fraction.to_bits() {
            self.fraction = fraction;
            world.pwm(fraction);
        }
    }
}
