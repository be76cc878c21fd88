//! The lines besides the bus.

use embedded_hal::digital::{ErrorKind, OutputPin};
use hal::Edges;
use hal::emulator::{EmulatedBus, World};

/// A line that the rig drives.
pub type Pin = Box<dyn OutputPin<Error = ErrorKind>>;

/// The lines of the tables of `[rig]`.
#[derive(Default)]
pub struct Lines {
    /// Edges of the fan's tachometer.
    pub edges: Option<Box<dyn Edges>>,
    /// XSHUT of the second sensor.
    pub xshut: Option<Pin>,
    /// Output-enable of the fan driver, high: its outputs are off.
    pub output_enable: Option<Pin>,
}

impl Lines {
    /// The lines of an emulated rig.
    pub(super) fn emulated<W: World + 'static>(bus: &EmulatedBus<W>, rig: &config::Rig) -> Self {
        Self {
            edges: rig.tachometer.map(|_| Box::new(bus.edges()) as Box<dyn Edges>),
            xshut: rig.second_sensor.map(|_| Box::new(bus.xshut()) as Pin),
            output_enable: rig.output_enable.map(|_| Box::new(bus.output_enable()) as Pin),
        }
    }
}
