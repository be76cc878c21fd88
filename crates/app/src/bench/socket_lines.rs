//! The emulated rig's lines over the socket of its bus, at addresses that no I2C chip can have.
//!
//! ```text
//! 0x80, 0x81   write a level: XSHUT, output-enable       held by a handle until it is closed, then a pull-up has it
//! 0x82         read 9 bytes: whether there is an edge, and how long ago it came, seconds, low byte first
//! ```

use super::clock::Monotonic;
use super::socket::SocketBus;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, Operation};
use hal::emulator::{EmulatedBus, EmulatedEdges, EmulatedI2c, EmulatedLine, World};
use hal::{Clock, Edges};
use std::io;
use std::path::Path;

const XSHUT: u8 = 0x80;
const OUTPUT_ENABLE: u8 = 0x81;
const TACHOMETER: u8 = 0x82;

/// A line that can be driven over the socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// Of the second sensor.
    Xshut,
    /// Of the fan driver.
    OutputEnable,
}

/// One of the lines, high at first.
pub(super) struct SocketLine {
    bus: SocketBus,
    address: u8,
}

impl SocketLine {
    pub(super) fn open(path: &Path, line: Line) -> io::Result<Self> {
        let address = match line {
            Line::Xshut => XSHUT,
            Line::OutputEnable => OUTPUT_ENABLE,
        };
        let mut line = Self { bus: SocketBus::open(path)?, address };
        line.set_high().map_err(|_| io::ErrorKind::NotConnected)?;
        Ok(line)
    }

    fn set(&mut self, level: u8) -> Result<(), digital::ErrorKind> {
        self.bus.write(self.address, &[level]).map_err(|_| digital::ErrorKind::Other)
    }
}

impl digital::ErrorType for SocketLine {
    type Error = digital::ErrorKind;
}

impl OutputPin for SocketLine {
    fn set_low(&mut self) -> Result<(), digital::ErrorKind> {
        self.set(0)
    }

    fn set_high(&mut self) -> Result<(), digital::ErrorKind> {
        self.set(1)
    }
}

/// The tachometer over the socket.
pub(super) struct SocketEdges {
    bus: SocketBus,
    clock: Monotonic,
}

impl SocketEdges {
    pub(super) fn open(path: &Path, clock: Monotonic) -> io::Result<Self> {
        Ok(Self { bus: SocketBus::open(path)?, clock })
    }
}

impl Edges for SocketEdges {
    fn next_edge_s(&mut self) -> Option<f64> {
        let mut answer = [0; 9];
        self.bus.read(TACHOMETER, &mut answer).ok()?;
        let [1, ago_s @ ..] = answer else { return None };
        Some(self.clock.now_s() - f64::from_le_bytes(ago_s))
    }
}

/// The bus, and the lines that a handle of the socket drives.
pub struct Served<W: World> {
    bus: EmulatedBus<W>,
    i2c: EmulatedI2c<W>,
    edges: EmulatedEdges<W>,
    xshut: Option<EmulatedLine<W>>,
    output_enable: Option<EmulatedLine<W>>,
}

impl<W: World> Served<W> {
    /// A handle that drives no line yet.
    #[must_use]
    pub fn new(bus: &EmulatedBus<W>) -> Self {
        Self { bus: bus.clone(), i2c: bus.handle(), edges: bus.edges(), xshut: None, output_enable: None }
    }

    fn edge(&mut self, answer: &mut [u8]) -> Result<(), ErrorKind> {
        let edge_s = self.edges.next_edge_s();
        let now_s = self.bus.with_world(|world| world.now_s());
        let [is_there, ago_s @ ..] = answer else { return Err(ErrorKind::Other) };
        *is_there = u8::from(edge_s.is_some());
        let bytes = (now_s - edge_s.unwrap_or(now_s)).to_le_bytes();
        ago_s.iter_mut().zip(bytes).for_each(|(to, from)| *to = from);
        Ok(())
    }
}

impl<W: World> ErrorType for Served<W> {
    type Error = ErrorKind;
}

impl<W: World> I2c for Served<W> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let line = match (address, &mut *operations) {
            (TACHOMETER, [Operation::Read(answer)]) => return self.edge(answer),
            (XSHUT, _) => self.xshut.get_or_insert_with(|| self.bus.xshut()),
            (OUTPUT_ENABLE, _) => self.output_enable.get_or_insert_with(|| self.bus.output_enable()),
            _ => return self.i2c.transaction(address, operations),
        };
        let [Operation::Write(level)] = operations else { return Err(ErrorKind::Other) };
        line.set_state((level.first() == Some(&1)).into()).map_err(|_| ErrorKind::Other)
    }
}

#[cfg(test)]
mod tests {
    use super::{Line, Served, SocketLine};
    use crate::bench::{Monotonic, bench, serve};
    use config::Bus;
    use control::Duty;
    use embedded_hal::digital::OutputPin;
    use hal::emulator::EmulatedBus;
    use rig::{Rig, Sighting, emulated_bus};
    use std::os::unix::net::UnixListener;
    use std::path::Path;
    use std::thread;
    use std::time::{Duration, Instant};

    type World = rig::PlantWorld;

    fn served(socket: &Path) -> EmulatedBus<World> {
        let tables = crate::flight::rich();
        let bus = emulated_bus(&tables.plant.unwrap(), &tables.rig.unwrap(), 1, Monotonic::start());
        let (listener, shared) = (UnixListener::bind(socket).unwrap(), bus.clone());
        thread::spawn(move || {
            for handle in listener.incoming() {
                let handle_of = shared.clone();
                thread::spawn(move || serve(handle.unwrap(), Served::new(&handle_of), || {}));
            }
        });
        bus
    }

    /// Waits until a condition holds.
    fn comes(mut is_there: impl FnMut() -> bool) -> bool {
        let patience = Instant::now() + Duration::from_secs(30);
        while Instant::now() < patience {
            if is_there() {
                return true;
            }
            thread::sleep(Duration::from_millis(5));
        }
        false
    }

    fn fan(bus: &EmulatedBus<World>) -> f64 {
        bus.with_world(|world| world.fan_percent())
    }

    #[test]
    fn a_bench_over_the_socket_has_both_sensors_the_speed_and_its_outputs() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("rig.sock");
        let bus = served(&socket);
        let table = Bus { device: format!("unix:{}", socket.display()) };
        let (wanted, mut started) = (crate::flight::rich().rig.unwrap(), None);
        // On a busy machine a start may take longer than allowed.
        let starts = comes(|| {
            started = bench(&table, &wanted).ok();
            started.is_some()
        });
        let mut rig = started.filter(|_| starts).unwrap();
        rig.drive(Duty::clamped(25.0)).unwrap();
        assert!((fan(&bus) - 25.0).abs() < 0.02);
        assert!(comes(|| rig.fan_rpm().unwrap() > 1000.0), "no speed");
        assert!(comes(|| matches!(rig.position(), Ok(Sighting::Ball(_)))), "the first sees nothing");
        assert!(comes(|| matches!(rig.second_position(), Some(Ok(Sighting::Ball(_))))), "the second sees nothing");
        drop(rig);
        assert_eq!(fan(&bus), 0.0);
    }

    #[test]
    fn outputs_whose_line_is_given_back_are_off_though_nobody_wrote_to_the_bus() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("rig.sock");
        let bus = served(&socket);
        hal::Fan::start(bus.handle(), 1526.0).unwrap().drive(Duty::clamped(25.0)).unwrap();
        assert_eq!(fan(&bus), 0.0, "nobody holds the line");
        let mut line = SocketLine::open(&socket, Line::OutputEnable).unwrap();
        line.set_low().unwrap();
        assert!(fan(&bus) > 24.9);
        drop(line);
        assert!(comes(|| fan(&bus) == 0.0));
    }
}
