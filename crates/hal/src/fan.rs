//! The PCA9685 that drives the fan: a counter runs from 0 to 4095, the output is on from one count to another.
//!
//! ```text
//! f = 25 MHz / (4096 · (prescale + 1))      prescale 3..255, so 1526 Hz down to 24 Hz
//! duty = count / 4096                       count 0..4096
//! ```
//!
//! The 25 MHz are the chip's own oscillator, several per cent off from part to part: so is the frequency, but not the
//! duty. The chip has no watchdog. It holds the last duty when the program dies: see [`fan_off`].
//!
//! The `pwm-pca9685` crate sets the chip up. Duties are written past it, because it cannot read: each is read back, so
//! that a bus on which nothing arrives, or a chip that has lost its power for a moment, is found in the same cycle.

use control::Duty;
use embedded_hal::i2c::I2c;
use pwm_pca9685::{Channel, Error as DriverError, Pca9685};

const ADDRESS: u8 = 0x40;
const FAN: Channel = Channel::C0;
const OSCILLATOR_HZ: f64 = 25e6;
const COUNTS: u16 = 4096;
const PRE_SCALE: u8 = 0xFE;
/// First of the four registers of channel 0: the counts at which it goes on and off, low byte first.
const LED0_ON_L: u8 = 0x06;
const LED0_OFF_L: u8 = 0x08;
const LED0_OFF_H: u8 = 0x09;
/// The same bit in ON_H (full on) and OFF_H (full off).
const FULL: u8 = 0x10;

/// Why the fan does not obey.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FanError<E> {
    /// The bus failed. The fan keeps its last duty.
    #[error("I2C {0:?} at the fan driver (0x40), the fan keeps its last duty; check the wiring, the power and the bus")]
    Bus(E),
    /// The chip did not take the PWM frequency.
    #[error(
        "fan driver 0x40 holds prescale {found} after {asked} was written; check that it is a PCA9685, power-cycle it"
    )]
    PrescaleIgnored {
        /// What we wrote.
        asked: u8,
        /// What it holds.
        found: u8,
    },
    /// The chip does not hold the duty that was written.
    #[error(
        "fan driver 0x40 holds {found:02x?} in the registers of its channel after {asked:02x?} was written; \
         check the bus for stuck lines and the chip for a supply that fails"
    )]
    DutyIgnored {
        /// ON and OFF, as they were written.
        asked: [u8; 4],
        /// What it holds.
        found: [u8; 4],
    },
    /// The chip does not hold the bit that turns its channel off.
    #[error(
        "fan driver 0x40 holds {found:02x} in register {LED0_OFF_H:02x} of its channel after {FULL:02x}, fully off, was \
         written; check the bus for stuck lines and the chip for a supply that fails"
    )]
    OffIgnored {
        /// What it holds.
        found: u8,
    },
    /// The driver crate did not accept a value that is within the limits of the chip.
    #[error("the pwm-pca9685 crate refused a valid count or prescale; check the version of that crate")]
    DriverRefused,
}

impl<E> From<DriverError<E>> for FanError<E> {
    fn from(error: DriverError<E>) -> Self {
        match error {
            DriverError::I2C(error) => Self::Bus(error),
            DriverError::InvalidInputData => Self::DriverRefused,
        }
    }
}

/// A fan on channel 0 of a PCA9685.
pub struct Fan<I> {
    i2c: I,
    prescale: u8,
}

impl<I: I2c> Fan<I> {
    /// Sets the chip up with the fan off, also when a killed program left it running.
    ///
    /// The frequency is the nearest that the chip can do; [`Self::frequency_hz`] tells which. The oscillator needs
    /// 0.5 ms from here until duties are exact (datasheet).
    ///
    /// # Errors
    /// The bus failed, or what answers does not hold its frequency.
    pub fn start(mut i2c: I, frequency_hz: f64) -> Result<Self, FanError<I::Error>> {
        fan_off(&mut i2c).map_err(FanError::Bus)?;
        let prescale = nearest_prescale(frequency_hz);
        let mut driver = new_driver(i2c)?;
        // The chip takes a prescale only while asleep, and the driver believes that it is.
        driver.disable()?;
        driver.set_prescale(prescale)?;
        let mut driver = verified(driver, prescale)?;
        driver.enable()?;
        // Off again, now through the driver: it switches auto-increment on, so each later duty is one transaction.
        driver.set_channel_full_off(FAN)?;
        Ok(Self { i2c: driver.destroy(), prescale })
    }

    /// Drives the fan. Returns the duty as the chip holds it, the nearest 1/4096.
    ///
    /// # Errors
    /// The bus failed, or the chip does not hold what was written.
    pub fn drive(&mut self, duty: Duty) -> Result<Duty, FanError<I::Error>> {
        let count = count(duty);
        match count {
            0 => self.off()?,
            1..COUNTS => {
                let [low, high] = count.to_le_bytes();
                self.write(&[LED0_ON_L, 0, 0, low, high])?;
                self.holds([0, 0, low, high])?;
            }
            _ => {
                // Full-off wins over full-on: it is cleared last, so that the output jumps to 100 % and nowhere else.
                self.write(&[LED0_ON_L, 0, FULL])?;
                self.write(&[LED0_OFF_L, 0, 0])?;
                self.holds([0, FULL, 0, 0])?;
            }
        }
        Ok(Duty::clamped(f64::from(count) / f64::from(COUNTS) * 100.0))
    }

    /// Stops the fan.
    ///
    /// # Errors
    /// The bus failed, or the chip does not hold what was written. The fan keeps its last duty.
    pub fn off(&mut self) -> Result<(), FanError<I::Error>> {
        stop(&mut self.i2c)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), FanError<I::Error>> {
        self.i2c.write(ADDRESS, bytes).map_err(FanError::Bus)
    }

    fn holds(&mut self, asked: [u8; 4]) -> Result<(), FanError<I::Error>> {
        let mut found = [0; 4];
        self.i2c.write_read(ADDRESS, &[LED0_ON_L], &mut found).map_err(FanError::Bus)?;
        if found == asked { Ok(()) } else { Err(FanError::DutyIgnored { asked, found }) }
    }

    /// The PWM frequency in force, at the nominal oscillator.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        OSCILLATOR_HZ / (f64::from(COUNTS) * (f64::from(self.prescale) + 1.0))
    }
}

/// Stops the fan in one transaction of one register, whatever state the chip is in and a killed program left it in.
///
/// Sets the full-off bit of channel 0, which wins over everything else and does not need auto-increment.
///
/// # Errors
/// The bus failed. The fan keeps its last duty.
pub fn fan_off<I: I2c>(mut i2c: I) -> Result<(), I::Error> {
    i2c.write(ADDRESS, &[LED0_OFF_H, FULL])
}

/// [`fan_off`], with a check that the chip has accepted it: for callers that must be certain, in any state of the chip.
///
/// # Errors
/// The bus failed, or the chip does not hold the bit. The fan keeps its last duty.
pub fn stop<I: I2c>(mut i2c: I) -> Result<(), FanError<I::Error>> {
    fan_off(&mut i2c).map_err(FanError::Bus)?;
    let mut found = [0];
    i2c.write_read(ADDRESS, &[LED0_OFF_H], &mut found).map_err(FanError::Bus)?;
    match found {
        // All bits high is a bus that is stuck, not a register: three of them are reserved and read 0.
        [found] if found & FULL != 0 && found != 0xFF => Ok(()),
        [found] => Err(FanError::OffIgnored { found }),
    }
}

fn new_driver<I: I2c>(i2c: I) -> Result<Pca9685<I>, FanError<I::Error>> {
    Ok(Pca9685::new(i2c, ADDRESS)?)
}

/// Reads the prescale back past the driver, which cannot. Like the chip, the new driver starts asleep.
fn verified<I: I2c>(driver: Pca9685<I>, asked: u8) -> Result<Pca9685<I>, FanError<I::Error>> {
    let mut i2c = driver.destroy();
    let mut found = [0];
    i2c.write_read(ADDRESS, &[PRE_SCALE], &mut found).map_err(FanError::Bus)?;
    match found {
        [found] if found != asked => Err(FanError::PrescaleIgnored { asked, found }),
        _ => new_driver(i2c),
    }
}

/// Nonsense (zero, negative, not a number) gives a limit of the chip, not an error: it only changes the sound.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 3 to 255 here")]
fn nearest_prescale(frequency_hz: f64) -> u8 {
    let exact = (OSCILLATOR_HZ / (f64::from(COUNTS) * frequency_hz) - 1.0).round();
    if exact >= 3.0 { exact.min(255.0) as u8 } else { 3 }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a duty is within 0 to 100 %")]
fn count(duty: Duty) -> u16 {
    (duty.percent() / 100.0 * f64::from(COUNTS)).round() as u16
}
