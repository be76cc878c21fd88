//! The emulated rig's lines beside the bus: XSHUT of the second sensor, output-enable of the fan driver, the
//! tachometer.

use super::bus::{EmulatedBus, FAN, SECOND};
use super::world::World;
use crate::tachometer::Edges;
use embedded_hal::digital::{ErrorKind, ErrorType, OutputPin};

/// A line that a handle drives. When no handle does, a pull-up holds it high, as it should on a rig.
pub struct EmulatedLine<W: World> {
    bus: EmulatedBus<W>,
    socket: usize,
}

impl<W: World> EmulatedBus<W> {
    /// XSHUT of the second sensor, high.
    #[must_use]
    pub fn xshut(&self) -> EmulatedLine<W> {
        EmulatedLine::driven(self, SECOND)
    }

    /// Output-enable of the fan driver, high: its outputs are off. Before, the pin was wired to ground.
    #[must_use]
    pub fn output_enable(&self) -> EmulatedLine<W> {
        EmulatedLine::driven(self, FAN)
    }

    /// The fan's tachometer.
    #[must_use]
    pub fn edges(&self) -> EmulatedEdges<W> {
        EmulatedEdges { bus: self.clone() }
    }
}

impl<W: World> EmulatedLine<W> {
    fn driven(bus: &EmulatedBus<W>, socket: usize) -> Self {
        bus.set_pin(socket, true);
        Self { bus: bus.clone(), socket }
    }
}

impl<W: World> ErrorType for EmulatedLine<W> {
    type Error = ErrorKind;
}

impl<W: World> OutputPin for EmulatedLine<W> {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        self.bus.set_pin(self.socket, false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), ErrorKind> {
        self.bus.set_pin(self.socket, true);
        Ok(())
    }
}

impl<W: World> Drop for EmulatedLine<W> {
    fn drop(&mut self) {
        self.bus.set_pin(self.socket, true);
    }
}

/// The emulated tachometer's edges.
pub struct EmulatedEdges<W> {
    bus: EmulatedBus<W>,
}

impl<W: World> Edges for EmulatedEdges<W> {
    fn next_edge_s(&mut self) -> Option<f64> {
        self.bus.with_world(|world| world.edge_s())
    }
}
