//! The clock of an emulated world in virtual time.

use hal::Clock;
use hal::emulator::{EmulatedBus, World};

/// The clock of an emulated world in virtual time: sleeping advances the world.
pub struct WorldClock<W: World>(pub EmulatedBus<W>);

/// A clone is a handle of the same world.
impl<W: World> Clone for WorldClock<W> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<W: World> Clock for WorldClock<W> {
    fn now_s(&self) -> f64 {
        self.0.with_world(|world| world.now_s())
    }

    fn sleep_until_s(&self, t_s: f64) {
        self.0.with_world(|world| {
            let ahead = t_s - world.now_s();
            if ahead > 0.0 {
                world.elapse_s(ahead);
            }
        });
    }
}
