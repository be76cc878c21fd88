//! Any transactions on the emulated bus, also by way of its socket: answered or refused, and the fan's share of time is one.
#![no_main]

use airball::fuzzing::serve;
use embedded_hal::i2c::{I2c, Operation};
use hal::emulator::{EmulatedBus, World};
use libfuzzer_sys::fuzz_target;
use std::io::Write;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;

/// Time as the wire takes it, and a ball where the time says.
#[derive(Default)]
struct Desk(f64);

impl World for Desk {
    fn now_s(&self) -> f64 {
        self.0
    }
    fn elapse_s(&mut self, seconds: f64) {
        self.0 += seconds;
    }
    fn measure_mm(&mut self, at_s: f64) -> Option<f64> {
        (at_s.sin() > -0.5).then_some(1e4 * at_s.sin())
    }
    fn pwm(&mut self, fraction: f64) {
        assert!((0.0..=1.0).contains(&fraction), "{fraction}");
    }
}

// Records of three bytes and what is written: address, bytes to write, bytes to read.
fuzz_target!(|bytes: &[u8]| {
    let bus = EmulatedBus::new(Desk::default());
    let (mut handle, mut rest) = (bus.handle(), bytes);
    while let [address, write, read, more @ ..] = rest {
        let (written, later) = more.split_at(more.len().min(usize::from(*write)));
        let mut answer = vec![0; usize::from(*read)];
        let address = [0x29, 0x40, *address][usize::from(*address) % 3];
        let _ = handle.transaction(address, &mut [Operation::Write(written), Operation::Read(&mut answer)]);
        rest = later;
    }
    let (mut near, far) = UnixStream::pair().expect("a socket pair");
    if bytes.len() < 4096 && near.write_all(bytes).is_ok() && near.shutdown(Shutdown::Write).is_ok() {
        let _ = near.set_nonblocking(true);
        let _ = far.set_write_timeout(Some(std::time::Duration::from_millis(5)));
        let _ = serve(far, bus.handle(), || {});
    }
});
