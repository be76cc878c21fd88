//! The watchdog of the loop: a thread that checks whether cycles still run, and informs the guard and the service
//! manager.
//!
//! The loop only counts: one atomic addition a cycle, and no system call. This thread reads the count every 50 ms. It
//! sends a message only when the count has changed, so that a hanging loop sends none although its process lives: the
//! guard then turns the fan off, and systemd, whose watchdog gets no message either, ends and restarts the service.
//! Messages for systemd are sent by a thread of their own, because a manager that does not read would block the sender.

use crate::bench::{Guard, GuardError};
use sd_notify::NotifyState;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Time between two checks: a tenth of the shortest usual `stall_s`.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// How much longer than a period and `stall_s` a guard waits, seconds: two checks. A loop whose fan the guard has
/// turned off is then certainly beyond its own limit when it resumes, and does not fly on.
pub const SLACK_S: f64 = 0.1;

/// The thread. Dropped without [`Watch::finish`], it makes the guard turn the fan off.
pub struct Watch {
    end: Sender<bool>,
    thread: JoinHandle<Result<(), GuardError>>,
}

impl Watch {
    /// Watches `pulse`, the number of cycles so far. Without its guard a flight does not go on: `land` is then set.
    ///
    /// # Errors
    /// The guard is gone, or the system could not start a thread.
    pub fn start(mut guard: Option<Guard>, pulse: Arc<AtomicU32>, land: Arc<AtomicBool>) -> Result<Self, GuardError> {
        // The guard must be active before the first duty, not one check after it.
        guard.as_mut().map_or(Ok(()), Guard::beat)?;
        let (end, ended) = channel();
        let watched = Watched { guard, pulse, land, manager: service_manager()? };
        let thread = thread::Builder::new().name("watch".into()).spawn(move || watched.watch(&ended))?;
        Ok(Self { end, thread })
    }

    /// Ends the watch. `landed`: the fan is known to be off; otherwise the guard turns it off.
    ///
    /// # Errors
    /// [`GuardError::Lost`] where the flight was without a guard at its end.
    pub fn finish(self, landed: bool) -> Result<(), GuardError> {
        // A thread that is gone has dropped its guard, which then turns the fan off anyway.
        let _ = self.end.send(landed);
        self.thread.join().unwrap_or(Err(GuardError::Lost))
    }
}

struct Watched {
    guard: Option<Guard>,
    pulse: Arc<AtomicU32>,
    land: Arc<AtomicBool>,
    manager: SyncSender<Word>,
}

/// A message to the service manager.
enum Word {
    Flying,
    Stopping,
}

impl Watched {
    fn watch(mut self, ended: &Receiver<bool>) -> Result<(), GuardError> {
        let mut seen = 0;
        loop {
            match ended.recv_timeout(LOOK_EVERY) {
                Err(RecvTimeoutError::Timeout) => {}
                Ok(true) => {
                    self.tell(Word::Stopping);
                    return self.guard.map_or(Ok(()), Guard::landed);
                }
                Ok(false) => return self.guard.map_or(Ok(()), Guard::failed),
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            let now = self.pulse.load(Ordering::Relaxed);
            if now == seen {
                continue;
            }
            self.tell(Word::Flying);
            seen = now;
            if let Some(lost) = self.guard.as_mut().and_then(|guard| guard.beat().err()) {
                self.land.store(true, Ordering::Relaxed);
                return Err(lost);
            }
        }
    }

    /// A manager that is still busy with the last message gets the next one.
    fn tell(&self, word: Word) {
        let _ = self.manager.try_send(word);
    }
}

/// The thread that sends to the service manager, where there is one.
fn service_manager() -> io::Result<SyncSender<Word>> {
    let (manager, words) = sync_channel(1);
    thread::Builder::new().name("notify".into()).spawn(move || {
        for word in words {
            // The service is ready when it flies. A repeated message has no effect. A missing manager does not matter
            // to the flight.
            let _ = match word {
                Word::Flying => sd_notify::notify(&[NotifyState::Ready, NotifyState::Watchdog]),
                Word::Stopping => sd_notify::notify(&[NotifyState::Stopping]),
            };
        }
    })?;
    Ok(manager)
}
