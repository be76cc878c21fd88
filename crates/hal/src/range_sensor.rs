//! The VL53L0X at the top of the pipe: a laser pulse goes down to the ball and back, the chip counts the photons.
//!
//! ```text
//! distance = c · t / 2        whole millimetres, one every timing budget of 20 ms, averaged over that time
//! ```
//!
//! The `vl53l0x` crate knows the registers; this file stops what it does not: endless polling and panics
//! (`DeadlineI2c`), numbers that mean "no target", a sensor still busy for a program that was killed.
//! Its timed mode writes the period byte by byte in the wrong order, so only the back-to-back mode is used.
//!
//! The crate does not read the range status either, which says whether the distance is one: `WithStatus` does.
//!
//! Leaves out the signal strength.

use control::Millimetres;
use embedded_hal::i2c::I2c;
use vl53l0x::VL53L0x;

use crate::clock::Clock;
use crate::deadline::{Deadline, DeadlineError, DeadlineI2c};
use crate::range_status::{LastStatus, RangeStatus, WithStatus};

/// Time for one measurement, microseconds: the shortest that the driver accepts, so 50 readings per second.
pub const BUDGET_US: u32 = 20_000;

/// Where every VL53L0X answers after power-on.
pub(crate) const ADDRESS: u8 = 0x29;
const MODEL_ID: u8 = 0xEE;
/// Time for one `poll`. It takes 0.6 ms; after a whole budget the reading would have been overwritten.
const POLL_ALLOWED_S: f64 = 0.020;
/// Pause between two polls while waiting: short against the budget, long against the 0.1 ms that a poll takes.
const POLL_EVERY_S: f64 = 0.001;
/// How long the chip is held in reset, and how often we look whether it is back. It boots in 1.2 ms (datasheet).
const RESET_STEP_S: f64 = 0.002;
/// After that the chip is used as it is; the driver then reports its error.
pub(crate) const RESET_ALLOWED_S: f64 = 0.050;
/// From here on a "distance" is a code: 8190 and 8191 mean no target, 65535 is a bus that is stuck high.
const FIRST_CODE_MM: u16 = 8190;

/// One reading of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Distance from the sensor down to the ball.
    Distance(Millimetres),
    /// The sensor works and saw nothing.
    NoTarget {
        /// The number it gave instead of a distance.
        reported_mm: u16,
    },
    /// The sensor gave a distance and does not vouch for it.
    Doubtful {
        /// The sensor's status of it.
        status: RangeStatus,
        /// The distance.
        reported_mm: u16,
    },
}

impl Range {
    /// What the sensor means by the number `reported_mm` with this status.
    #[must_use]
    pub fn reported(reported_mm: u16, status: RangeStatus) -> Self {
        match reported_mm {
            0 | FIRST_CODE_MM.. => Self::NoTarget { reported_mm },
            _ if status.is_valid() => Self::Distance(Millimetres(f64::from(reported_mm))),
            _ => Self::Doubtful { status, reported_mm },
        }
    }
}

/// Why there is no reading.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RangeError<E> {
    /// The bus failed.
    #[error("I2C {error:?} at the range sensor ({address:#04x}); check its wiring, its power and the bus number")]
    Bus {
        /// Where the sensor is.
        address: u8,
        /// The error of the bus.
        error: E,
    },
    /// Something else answers at the address of the sensor.
    #[error(
        "device {address:#04x} answered model id {found:#04x}, a VL53L0X answers 0xEE; check what is wired to the bus"
    )]
    WrongDevice {
        /// Where it answered.
        address: u8,
        /// What it answered.
        found: u8,
    },
    /// The sensor answers, but not in time.
    #[error("range sensor not ready within {allowed_s} s; check the bus for stuck lines, then power-cycle the sensor")]
    Slow {
        /// The time it had.
        allowed_s: f64,
    },
    /// A register does not hold what was written to it.
    #[error(
        "register {register:#04x} of the range sensor reads {read:#04x} after {wrote:#04x} was written; \
         check for a stuck or noisy bus: pull-ups, cable length, bus speed"
    )]
    Garbage {
        /// The register, on page 0.
        register: u8,
        /// What was written.
        wrote: u8,
        /// What it reads.
        read: u8,
    },
    /// The sensor does not take the timing budget.
    #[error("range sensor refused a timing budget of {asked_us} us; power-cycle it and check that it is a VL53L0X")]
    BudgetRefused {
        /// What we asked for.
        asked_us: u32,
    },
    /// The sensor answers "no new measurement" and nothing else.
    #[error("no new range for {waited_s:.3} s; the sensor answers but does not measure: restart, then power-cycle it")]
    Silent {
        /// How long we waited.
        waited_s: f64,
    },
}

/// A VL53L0X that measures back to back.
pub struct RangeSensor<I: I2c, C: Clock> {
    driver: VL53L0x<WithStatus<DeadlineI2c<I, C>>>,
    status: LastStatus,
    deadline: Deadline,
    clock: C,
    address: u8,
}

impl<I: I2c, C: Clock + Clone> RangeSensor<I, C> {
    /// Resets, checks and calibrates the sensor and lets it range. Takes at most `allowed_s`, e.g. 1.0 s.
    ///
    /// # Errors
    /// Anything but a working VL53L0X. Never panics, whatever the bus answers.
    pub fn start(i2c: I, clock: C, allowed_s: f64) -> Result<Self, RangeError<I::Error>> {
        let mut sensor = Self::prepare(i2c, clock, allowed_s)?;
        sensor.begin(allowed_s)?;
        Ok(sensor)
    }

    /// The same up to where it ranges: [`Self::range`] lets two sensors begin together.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn prepare(i2c: I, clock: C, allowed_s: f64) -> Result<Self, RangeError<I::Error>> {
        let deadline = Deadline::at(clock.now_s() + allowed_s);
        let mut bus = DeadlineI2c::new(i2c, clock.clone(), deadline.clone());
        reset(&mut bus, &clock, deadline.at_s()).map_err(|error| describe(error.into(), ADDRESS, allowed_s))?;
        Self::calibrate(bus, deadline, clock, ADDRESS, allowed_s)
    }

    /// The same of a sensor that has just come out of reset and been moved to `address`.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn prepare_at(address: u8, i2c: I, clock: C, allowed_s: f64) -> Result<Self, RangeError<I::Error>> {
        let deadline = Deadline::at(clock.now_s() + allowed_s);
        let bus = DeadlineI2c::new(i2c, clock.clone(), deadline.clone());
        Self::calibrate(bus, deadline, clock, address, allowed_s)
    }

    fn calibrate(
        bus: DeadlineI2c<I, C>,
        deadline: Deadline,
        clock: C,
        address: u8,
        allowed_s: f64,
    ) -> Result<Self, RangeError<I::Error>> {
        let describe = |error| describe(error, address, allowed_s);
        let status = LastStatus::default();
        let bus = WithStatus::new(bus, status.clone());
        let mut driver = VL53L0x::with_address(bus, address).map_err(describe)?;
        let accepted = driver.set_measurement_timing_budget(BUDGET_US).map_err(|error| describe(error.into()))?;
        if !accepted {
            return Err(RangeError::BudgetRefused { asked_us: BUDGET_US });
        }
        Ok(Self { driver, status, deadline, clock, address })
    }

    /// Lets the sensor range from now on. Takes at most `allowed_s`.
    ///
    /// # Errors
    /// The bus failed or was too slow.
    pub fn range(&mut self, allowed_s: f64) -> Result<(), RangeError<I::Error>> {
        self.deadline.move_to(self.clock.now_s() + allowed_s);
        self.begin(allowed_s)
    }

    fn begin(&mut self, allowed_s: f64) -> Result<(), RangeError<I::Error>> {
        self.driver.start_continuous(0).map_err(|error| describe(error.into(), self.address, allowed_s))
    }

    /// The new reading, or `None` when there is none yet. Does not wait.
    ///
    /// # Errors
    /// The bus failed or was too slow.
    pub fn poll(&mut self) -> Result<Option<Range>, RangeError<I::Error>> {
        self.deadline.move_to(self.clock.now_s() + POLL_ALLOWED_S);
        match self.driver.read_range_mm() {
            Ok(reported_mm) => Ok(Some(Range::reported(reported_mm, self.status.get()))),
            Err(nb::Error::WouldBlock) => Ok(None),
            Err(nb::Error::Other(error)) => Err(describe(error, self.address, POLL_ALLOWED_S)),
        }
    }

    /// The next reading. Sleeps between polls, for `timeout_s` at most.
    ///
    /// # Errors
    /// As [`Self::poll`], and [`RangeError::Silent`] after the timeout.
    pub fn wait(&mut self, timeout_s: f64) -> Result<Range, RangeError<I::Error>> {
        let start_s = self.clock.now_s();
        loop {
            if let Some(range) = self.poll()? {
                return Ok(range);
            }
            let now_s = self.clock.now_s();
            let waited_s = now_s - start_s;
            if waited_s >= timeout_s {
                return Err(RangeError::Silent { waited_s });
            }
            self.clock.sleep_until_s((now_s + POLL_EVERY_S).min(start_s + timeout_s));
        }
    }
}

/// Puts the chip in the state after power-on, whatever a killed program left: ranging, on another register page, or
/// half way through its calibration. The sequence is that of ST's `VL53L0X_ResetDevice`.
///
/// While it boots the chip does not acknowledge, so from the reset on errors are left to the driver's own first read.
pub(crate) fn reset<I: I2c>(bus: &mut I, clock: &impl Clock, deadline_s: f64) -> Result<(), I::Error> {
    const SELECT_PAGE_0: [u8; 2] = [0xFF, 0x00];
    const SOFT_RESET: u8 = 0xBF;
    const MODEL_ID_REGISTER: u8 = 0xC0;

    bus.write(ADDRESS, &SELECT_PAGE_0)?;
    bus.write(ADDRESS, &[SOFT_RESET, 0x00])?;
    let until_s = deadline_s.min(clock.now_s() + RESET_ALLOWED_S);
    while clock.now_s() < until_s {
        clock.sleep_until_s(clock.now_s() + RESET_STEP_S);
        let mut found = [0];
        let _ = bus.write(ADDRESS, &[SOFT_RESET, 0x01]);
        let _ = bus.write_read(ADDRESS, &[MODEL_ID_REGISTER], &mut found);
        if found == [MODEL_ID] {
            break;
        }
    }
    Ok(())
}

fn describe<E>(error: vl53l0x::Error<DeadlineError<E>>, address: u8, allowed_s: f64) -> RangeError<E> {
    use vl53l0x::Error as Driver;
    match error {
        Driver::InvalidDevice(found) | Driver::InvalidAddress(found) => RangeError::WrongDevice { address, found },
        Driver::Timeout | Driver::BusError(DeadlineError::DeadlinePassed { .. }) => RangeError::Slow { allowed_s },
        Driver::BusError(DeadlineError::Bus(error)) => RangeError::Bus { address, error },
        Driver::BusError(DeadlineError::Garbage { register, wrote, read }) => {
            RangeError::Garbage { register, wrote, read }
        }
    }
}
