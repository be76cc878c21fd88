//! The emulated wires: addresses, time per bit, faults.
//!
//! ```text
//! time = (9 · bytes + starts + stop) / f_bus       9 bits per byte, the address counts at every start
//! ```
//!
//! A poll of the sensor takes 0.10 ms at 400 kHz, a new duty 0.14 ms.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

use super::fault::{Fault, Injection};
use super::pca9685::{ADDRESS as FAN_ADDRESS, Pca9685};
use super::vl53l0x::Vl53l0x;
use super::world::{Chip, World};

/// The usual fast mode of I2C.
const BUS_HZ: f64 = 400_000.0;

/// A bus with a VL53L0X at 0x29 and a PCA9685 at 0x40, wired to a world, and perhaps a second VL53L0X. Clones are the
/// same bus.
pub struct EmulatedBus<W> {
    shared: Arc<Mutex<Shared<W>>>,
}

struct Shared<W> {
    world: W,
    bus_hz: f64,
    /// The first sensor, then [`FAN`], and [`SECOND`] where there is one.
    sockets: Vec<Socket>,
}

/// Sockets of the chips; the first sensor's is 0.
pub(super) const FAN: usize = 1;
pub(super) const SECOND: usize = 2;

/// A chip on the bus, and the state of its wires.
struct Socket {
    chip: Box<dyn Chip>,
    transactions: u64,
    bytes_spoilt: u64,
    injections: Vec<Injection>,
}

impl<W> Clone for EmulatedBus<W> {
    fn clone(&self) -> Self {
        Self { shared: Arc::clone(&self.shared) }
    }
}

impl<W: World> EmulatedBus<W> {
    /// Both chips as after power-on, at 400 kHz.
    pub fn new(world: W) -> Self {
        Self::at_bus_hz(world, BUS_HZ)
    }

    /// Both chips as after power-on, at a bus clock of `bus_hz`.
    pub fn at_bus_hz(world: W, bus_hz: f64) -> Self {
        let sockets = vec![Socket::new(Box::new(Vl53l0x::first())), Socket::new(Box::new(Pca9685::default()))];
        Self { shared: Arc::new(Mutex::new(Shared { world, bus_hz, sockets })) }
    }

    /// The same with a second VL53L0X, as after power-on: it answers at 0x29 as well.
    #[must_use]
    pub fn with_second_sensor(self) -> Self {
        self.lock().sockets.insert(SECOND, Socket::new(Box::new(Vl53l0x::second())));
        self
    }

    /// Sets the pin of the chip in this socket.
    pub(super) fn set_pin(&self, socket: usize, high: bool) {
        let Shared { world, sockets, .. } = &mut *self.lock();
        if let Some(socket) = sockets.get_mut(socket) {
            socket.chip.pin(high, world);
        }
    }

    /// A handle for one driver, as an open device file is on Linux.
    #[must_use]
    pub fn handle(&self) -> EmulatedI2c<W> {
        EmulatedI2c { bus: self.clone() }
    }

    /// Looks at the world, or changes it.
    pub fn with_world<R>(&self, look: impl FnOnce(&mut W) -> R) -> R {
        look(&mut self.lock().world)
    }

    /// Transactions sent to the chip at `address` so far, also those that failed.
    #[must_use]
    pub fn transactions(&self, address: u8) -> u64 {
        self.lock().socket(address).map_or(0, |socket| socket.transactions)
    }

    /// Spoils the transactions `during` of the chip at `address`, counted like [`Self::transactions`].
    pub fn inject(&self, address: u8, fault: Fault, during: Range<u64>) {
        self.add(address, Injection { fault, during, register: None });
    }

    /// The same, only of transactions that begin at `register`.
    pub fn inject_at(&self, address: u8, register: u8, fault: Fault, during: Range<u64>) {
        self.add(address, Injection { fault, during, register: Some(register) });
    }

    fn add(&self, address: u8, injection: Injection) {
        if let Some(socket) = self.lock().socket(address) {
            socket.injections.push(injection);
        }
    }

    /// The range sensor at `address` gives every distance with this range status (0 to 15; 11 is valid) from now on, as
    /// one does that gets too little light back; `None`: with its own. Where no range sensor is, nothing happens.
    pub fn doubt(&self, address: u8, status: Option<u8>) {
        if let Some(socket) = self.lock().socket(address) {
            socket.chip.doubt(status);
        }
    }

    /// Takes the power of all chips away for a moment: their registers are as after power-on.
    pub fn power_cycle(&self) {
        let mut shared = self.lock();
        shared.sockets.iter_mut().for_each(|socket| socket.chip.power_cycle());
        shared.world.pwm(0.0);
    }

    /// Repairs all wires.
    pub fn repair(&self) {
        self.lock().sockets.iter_mut().for_each(|socket| socket.injections.clear());
    }

    /// A panic elsewhere does not break the wires.
    fn lock(&self) -> MutexGuard<'_, Shared<W>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W: World> Shared<W> {
    fn socket(&mut self, address: u8) -> Option<&mut Socket> {
        self.sockets.iter_mut().find(|socket| socket.chip.address() == Some(address))
    }

    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        self.world.elapse_s(bits(operations) / self.bus_hz);
        if self.sockets.len() > SECOND && address != FAN_ADDRESS {
            self.catch_up();
        }
        let Self { world, sockets, .. } = self;
        let mut there = sockets.iter_mut().filter(|socket| socket.chip.address() == Some(address));
        let socket = there.next().ok_or(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address))?;
        match there.next() {
            None => socket.transaction(operations, world),
            Some(other) => both(socket, other, operations, world),
        }
    }

    /// Lets two sensors end what should have ended by now in the order of time, as their world is asked.
    fn catch_up(&mut self) {
        let Self { world, sockets, .. } = self;
        let now_s = world.now_s();
        loop {
            let ends_s = |socket: &Socket| socket.chip.ends_s().unwrap_or(f64::INFINITY);
            let Some(next) = sockets.iter_mut().min_by(|a, b| ends_s(a).total_cmp(&ends_s(b))) else { return };
            if ends_s(next) > now_s {
                return;
            }
            next.chip.end_one(world);
        }
    }
}

/// Two chips at one address: both receive a write, and a bit that either drives low reads low.
fn both(
    one: &mut Socket,
    other: &mut Socket,
    operations: &mut [Operation<'_>],
    world: &mut dyn World,
) -> Result<(), ErrorKind> {
    one.transaction(operations, world)?;
    let of_one: Vec<Vec<u8>> = read(operations).map(|bytes| bytes.to_vec()).collect();
    other.transaction(operations, world)?;
    for (bytes, of_one) in read(operations).zip(of_one) {
        bytes.iter_mut().zip(of_one).for_each(|(byte, of_one)| *byte &= of_one);
    }
    Ok(())
}

/// What the operations read.
fn read<'a>(operations: &'a mut [Operation<'_>]) -> impl Iterator<Item = &'a mut [u8]> {
    operations.iter_mut().filter_map(|operation| match operation {
        Operation::Read(bytes) => Some(&mut **bytes),
        Operation::Write(_) => None,
    })
}

impl Socket {
    fn new(chip: Box<dyn Chip>) -> Self {
        Self { chip, transactions: 0, bytes_spoilt: 0, injections: Vec::new() }
    }

    fn transaction(&mut self, operations: &mut [Operation<'_>], world: &mut dyn World) -> Result<(), ErrorKind> {
        let n = self.transactions;
        self.transactions += 1;
        let fault = self.injections.iter().find(|injection| injection.hits(n, operations)).map(|hit| hit.fault);
        if let Some(Fault::Timeout { seconds }) = fault {
            world.elapse_s(seconds);
        }
        if let Some(error) = fault.and_then(Fault::error) {
            return Err(error);
        }
        if fault.is_none_or(Fault::delivers) {
            self.transfer(operations, world)?;
        }
        if let Some(fault) = fault {
            self.distort(operations, fault);
        }
        Ok(())
    }

    fn transfer(&mut self, operations: &mut [Operation<'_>], world: &mut dyn World) -> Result<(), ErrorKind> {
        if !self.chip.begin(world) {
            return Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
        }
        // Writes in a row are one write: only the first byte of all is an index.
        let mut selected = false;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    for &byte in *bytes {
                        if selected {
                            self.chip.put(byte, world)
                        } else {
                            self.chip.select(byte)
                        }
                        selected = true;
                    }
                }
                Operation::Read(bytes) => {
                    bytes.fill_with(|| self.chip.get());
                    selected = false;
                }
            }
        }
        self.chip.end(world);
        Ok(())
    }

    fn distort(&mut self, operations: &mut [Operation<'_>], fault: Fault) {
        for byte in read(operations).flatten() {
            *byte = fault.distort(*byte, self.bytes_spoilt);
            self.bytes_spoilt += 1;
        }
    }
}

/// One driver's handle of an [`EmulatedBus`].
pub struct EmulatedI2c<W> {
    bus: EmulatedBus<W>,
}

impl<W> ErrorType for EmulatedI2c<W> {
    type Error = ErrorKind;
}

impl<W: World> I2c for EmulatedI2c<W> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        self.bus.lock().transaction(address, operations)
    }
}

/// Bits on the wire: a start and an address per change of direction, nine bits per byte, one stop.
fn bits(operations: &[Operation<'_>]) -> f64 {
    let mut bits = 1.0;
    let mut last_is_read = None;
    for operation in operations {
        let (is_read, bytes) = match operation {
            Operation::Write(bytes) => (false, bytes.len()),
            Operation::Read(bytes) => (true, bytes.len()),
        };
        if last_is_read.replace(is_read) != Some(is_read) {
            bits += 10.0;
        }
        bits += 9.0 * bytes as f64;
    }
    bits
}
