//! The emulated rig of a test: `airball emulate` on a socket, and its output about the fan.

use crate::{Bench, eventually};
use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;

/// An emulated rig in a process of its own, ended with the test.
pub struct Emulated {
    process: Child,
    fan: Arc<Mutex<f64>>,
}

impl Emulated {
    /// Serves a bus in the bench's directory, and makes its config fly it, with longer timeouts for a busy machine.
    #[must_use]
    pub fn on(bench: &Bench) -> Self {
        let config = bench.read("config.toml").replace("/dev/i2c-1", "unix:rig.sock");
        let patient = config.replace("stall_s = 0.5 ", "stall_s = 3.0 ").replace("coast_s = 0.3 ", "coast_s = 3.0 ");
        assert_ne!(patient, config);
        bench.write("config.toml", patient);
        let mut command = bench.airball(&["emulate", "--socket", "rig.sock"]);
        let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
        let (said, fan) = (BufReader::new(process.stdout.take().unwrap()), Arc::new(Mutex::new(0.0)));
        let heard = Arc::clone(&fan);
        thread::spawn(move || {
            for line in said.lines().map_while(Result::ok) {
                let percent = line.split_whitespace().nth_back(1).and_then(|word| word.parse().ok());
                *heard.lock().unwrap() = percent.unwrap_or(0.0);
            }
        });
        eventually("the bus is served", || bench.path("rig.sock").exists().then_some(()));
        Self { process, fan }
    }

    /// Waits until the fan's duty, in percent, satisfies `is`.
    pub fn until(&self, what: &str, is: impl Fn(f64) -> bool) {
        eventually(what, || is(*self.fan.lock().unwrap()).then_some(()));
    }

    /// Waits for the fan to lift the ball.
    pub fn until_it_flies(&self) {
        self.until("the fan blows", |percent| percent > 15.0);
    }

    /// Waits for the fan to be off.
    pub fn until_it_is_off(&self) {
        self.until("the fan is off", |percent| percent == 0.0);
    }
}

impl Drop for Emulated {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
