//! The guard: a separate process that turns the fan off when the loop is gone, for every kind of end.
//!
//! ```text
//! loop ── a socket pair: '.' cycles run, 'L' the fan is off, 'F' the fan is not off ──▶ guard ──▶ its own bus handle
//! ```
//!
//! The kernel closes the loop's end of the socket when the loop dies, `kill -9` included; no message of the loop is
//! needed for that. The guard's standard output is a copy of the lock on the bus: no other process can fly before the
//! guard has ended.

use super::enable_line::EnableLine;
use crate::started;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command};
use std::time::Duration;

const READY: u8 = b'R';
const BEAT: u8 = b'.';
const LANDED: u8 = b'L';
const FAILED: u8 = b'F';
/// How long the guard may take to start.
const START_ALLOWED: Duration = Duration::from_secs(5);

/// Why there is no guard.
#[derive(Debug, thiserror::Error)]
pub enum GuardError {
    /// The system did not start it.
    #[error("the guard that turns the fan off after a crash cannot be started: {0}; the fan was not started")]
    Start(#[from] io::Error),
    /// It started and was not ready in time.
    #[error("the guard that turns the fan off after a crash was not ready in 5 s; the fan was not started, try again")]
    NotReady,
    /// It ended in flight.
    #[error(
        "the guard that turns the fan off after a crash ended in flight, so the ball was landed; see who killed it"
    )]
    Lost,
}

/// The loop's side of the connection to its guard. Dropped without [`Guard::landed`], it makes the guard turn the fan
/// off.
pub struct Guard {
    process: Child,
    line: UnixStream,
}

impl Guard {
    /// Starts a guard of the fan on `bus` and returns when it watches. It reacts when no message comes for `stall_s`
    /// seconds, and writes the reason to `last_fault`.
    ///
    /// # Errors
    /// [`GuardError`]: the system could not start a process, or it does not answer.
    pub fn start(
        bus: &config::Bus,
        enable: Option<&EnableLine>,
        stall_s: f64,
        last_fault: Option<&Path>,
        claim: &File,
    ) -> Result<Self, GuardError> {
        let (mut line, far) = UnixStream::pair()?;
        // The running file itself, even if another version has been installed over it.
        let mut command = Command::new("/proc/self/exe");
        let (name, before) = started::again();
        command.arg0(name).args(before).args(["guard", "--device", &bus.device, "--stall", &stall_s.to_string()]);
        if let Some(enable) = enable {
            command.args(["--output-enable", &enable.to_string()]);
        }
        if let Some(path) = last_fault {
            command.arg("--last-fault").arg(path);
        }
        command.stdin(OwnedFd::from(far)).stdout(claim.try_clone()?);
        // A process group of its own, so that Ctrl-C reaches the loop alone.
        let process = command.process_group(0).spawn()?;
        // This also drops our copy of the guard's end: if the guard fails, the connection closes.
        drop(command);
        line.set_read_timeout(Some(START_ALLOWED))?;
        let mut word = [0];
        match line.read(&mut word) {
            Ok(1) if word == [READY] => Ok(Self { process, line }),
            _ => Err(GuardError::NotReady),
        }
    }

    /// Reports that cycles run.
    ///
    /// # Errors
    /// [`GuardError::Lost`].
    pub fn beat(&mut self) -> Result<(), GuardError> {
        self.line.write_all(&[BEAT]).map_err(|_| GuardError::Lost)
    }

    /// Reports that the fan could not be turned off. The guard goes on trying after the end of this program.
    ///
    /// # Errors
    /// [`GuardError::Lost`] where it ended before.
    pub fn failed(mut self) -> Result<(), GuardError> {
        self.line.write_all(&[FAILED]).map_err(|_| GuardError::Lost)
    }

    /// Reports that the fan is known to be off, and waits for the guard to end.
    ///
    /// # Errors
    /// [`GuardError::Lost`] where it ended before.
    pub fn landed(mut self) -> Result<(), GuardError> {
        self.line.write_all(&[LANDED]).map_err(|_| GuardError::Lost)?;
        match self.process.wait() {
            Ok(status) if status.success() => Ok(()),
            _ => Err(GuardError::Lost),
        }
    }
}

/// A message of the loop to its guard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// Cycles run.
    Beat,
    /// The fan is off, as intended.
    Landed,
    /// The loop could not turn the fan off, and reported it.
    Failed,
    /// No message for the time that a loop may stall.
    Silence,
    /// The loop is dead.
    Gone,
}

/// The guard's side of the connection.
pub struct Ward {
    line: UnixStream,
}

impl Ward {
    /// Takes the connection that [`Guard::start`] put on standard input, and confirms it.
    ///
    /// # Errors
    /// What the system reported: standard input is not such a connection.
    pub fn on_standard_input(stall: Duration) -> io::Result<Self> {
        let mut line = UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?);
        line.set_read_timeout(Some(stall))?;
        line.write_all(&[READY])?;
        Ok(Self { line })
    }

    /// Waits for the next message.
    pub fn hear(&mut self) -> Heard {
        let mut words = [0; 64];
        loop {
            return match self.line.read(&mut words) {
                Ok(0) => Heard::Gone,
                Ok(count) if words[..count].contains(&LANDED) => Heard::Landed,
                Ok(count) if words[..count].contains(&FAILED) => Heard::Failed,
                Ok(_) => Heard::Beat,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Heard::Silence,
                Err(_) => Heard::Gone,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{BEAT, Heard, LANDED, Ward};
    use std::io::Write;
    use std::os::unix::net::UnixStream;
    use std::time::Duration;

    fn ward() -> (UnixStream, Ward) {
        let (near, line) = UnixStream::pair().unwrap();
        line.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
        (near, Ward { line })
    }

    #[test]
    fn a_loop_that_dies_is_gone_and_one_that_says_nothing_is_silent() {
        let (mut near, mut ward) = ward();
        assert_eq!(ward.hear(), Heard::Silence);
        near.write_all(&[BEAT, BEAT]).unwrap();
        assert_eq!((ward.hear(), ward.hear()), (Heard::Beat, Heard::Silence));
        drop(near);
        assert_eq!(ward.hear(), Heard::Gone);
    }

    #[test]
    fn a_landing_is_heard_among_beats_that_came_before_it() {
        let (mut near, mut ward) = ward();
        near.write_all(&[BEAT, BEAT, LANDED]).unwrap();
        drop(near);
        assert_eq!((ward.hear(), ward.hear()), (Heard::Landed, Heard::Gone));
    }
}
