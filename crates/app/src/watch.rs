//! Who watches the loop: a thread that looks whether cycles still run, and tells the guard and the service manager.
//!
//! The loop only counts: one atomic addition a cycle, and no system call. This thread looks at the count every 50 ms. It
//! passes a word on only when the count has moved, so that a loop that hangs falls silent although its process lives:
//! the guard then turns the fan off, and systemd, whose watchdog is not fed either, ends and restarts the service.

use crate::rig::{Guard, GuardError};
use sd_notify::NotifyState;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Between two looks: a tenth of the shortest usual `stall_s`.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// The thread. Dropped without [`Watch::finish`], it leaves the guard to turn the fan off.
pub struct Watch {
    end: Sender<bool>,
    thread: JoinHandle<Result<(), GuardError>>,
}

impl Watch {
    /// Watches `pulse`, the number of cycles so far. Without its guard a flight does not go on: `land` is then set.
    ///
    /// # Errors
    /// The system had no thread to give.
    pub fn start(guard: Option<Guard>, pulse: Arc<AtomicU32>, land: Arc<AtomicBool>) -> io::Result<Self> {
        let (end, ended) = channel();
        let thread =
            thread::Builder::new().name("watch".into()).spawn(move || Watched { guard, pulse, land }.watch(&ended))?;
        Ok(Self { end, thread })
    }

    /// Ends the watch. `landed`: the fan is known to be off; otherwise the guard turns it off.
    ///
    /// # Errors
    /// [`GuardError::Lost`] where the flight was without a guard at its end.
    pub fn finish(self, landed: bool) -> Result<(), GuardError> {
        // A thread that is gone has dropped its guard, which does what is right without being told.
        let _ = self.end.send(landed);
        self.thread.join().unwrap_or(Err(GuardError::Lost))
    }
}

struct Watched {
    guard: Option<Guard>,
    pulse: Arc<AtomicU32>,
    land: Arc<AtomicBool>,
}

impl Watched {
    fn watch(mut self, ended: &Receiver<bool>) -> Result<(), GuardError> {
        let mut seen = 0;
        loop {
            match ended.recv_timeout(LOOK_EVERY) {
                Err(RecvTimeoutError::Timeout) => {}
                Ok(true) => {
                    tell(&[NotifyState::Stopping]);
                    return self.guard.map_or(Ok(()), Guard::landed);
                }
                Ok(false) => return self.guard.map_or(Ok(()), Guard::failed),
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            let now = self.pulse.load(Ordering::Relaxed);
            if now == seen {
                continue;
            }
            // Ready is who flies. Said again it changes nothing.
            tell(&[NotifyState::Ready, NotifyState::Watchdog]);
            seen = now;
            if let Some(lost) = self.guard.as_mut().and_then(|guard| guard.beat().err()) {
                self.land.store(true, Ordering::Relaxed);
                return Err(lost);
            }
        }
    }
}

/// Tells the service manager, where there is one. One that does not listen does not matter to the flight.
fn tell(state: &[NotifyState<'_>]) {
    let _ = sd_notify::notify(state);
}
