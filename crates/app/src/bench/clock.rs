//! The system's monotonic clock.

use hal::Clock;
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
