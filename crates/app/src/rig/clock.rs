//! The two clocks of a rig: the system's monotonic one, and the one of an emulated world in virtual time.

use hal::Clock;
use hal::emulator::{EmulatedBus, World};
use nix::sys::time::TimeSpec;
use nix::time::{ClockId, ClockNanosleepFlags, clock_gettime, clock_nanosleep};
use std::time::Duration;

/// The system's monotonic clock, relative to its creation. Sleeps to absolute times.
#[derive(Clone, Copy, Debug)]
pub struct Monotonic {
    start: Duration,
}

impl Monotonic {
    /// A clock that starts now.
    #[must_use]
    pub fn start() -> Self {
        Self { start: monotonic() }
    }

    /// This clock's time at the time `monotonic` of the system's monotonic clock.
    #[must_use]
    pub fn seconds_at(&self, monotonic: Duration) -> f64 {
        monotonic.saturating_sub(self.start).as_secs_f64()
    }
}

/// Time of the system's monotonic clock. Every Linux has it: a failure would give time 0, which waits for nothing.
fn monotonic() -> Duration {
    clock_gettime(ClockId::CLOCK_MONOTONIC).map_or(Duration::ZERO, Duration::from)
}

impl Clock for Monotonic {
    fn now_s(&self) -> f64 {
        self.seconds_at(monotonic())
    }

    fn sleep_until_s(&self, t_s: f64) {
        let ahead = Duration::try_from_secs_f64(t_s).unwrap_or_default();
        let wake = TimeSpec::from(self.start.saturating_add(ahead));
        // A signal interrupts the sleep; the deadline remains.
        while clock_nanosleep(ClockId::CLOCK_MONOTONIC, ClockNanosleepFlags::TIMER_ABSTIME, &wake)
            == Err(nix::errno::Errno::EINTR)
        {}
    }
}

/// The clock of an emulated world in virtual time: sleeping advances the world.
pub struct WorldClock<W: World>(pub(crate) EmulatedBus<W>);

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
