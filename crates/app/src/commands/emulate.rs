//! `airball emulate`: a simulated rig in a process of its own, its bus on a socket.

use super::say;
use crate::bench::{Monotonic, Served, serve};
use crate::cli::EmulateArgs;
use crate::locked::locked;
use anyhow::{Context, Result};
use config::Config;
use hal::Clock;
use rig::emulated_bus;
use std::fs;
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::thread;

/// Serves the bus until a signal ends the process, and prints each change of the fan.
///
/// # Errors
/// A config that is not sound, a socket that cannot be made.
pub fn emulate(args: &EmulateArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.over())?;
    let model = config.need("emulate", "plant", |tables| tables.plant.as_ref())?;
    let rig = config.need("emulate", "rig", |tables| tables.rig.as_ref())?;
    config.refuse_setpoint("a rig behind a bus sees the duty alone; fly it with `airball run --sim`", |_| false)?;
    let clock = Monotonic::start();
    let bus = emulated_bus(model, rig, args.seed, clock);
    let listener = listen(&args.socket)?;
    say(format_args!("[bus] device = \"unix:{}\"", args.socket.display()))?;

    let said = Arc::new(Mutex::new(0.0));
    for handle in listener.incoming() {
        let (bus, said) = (bus.clone(), Arc::clone(&said));
        let after = move |bus: &hal::emulator::EmulatedBus<_>| {
            let percent = bus.with_world(|world: &mut rig::PlantWorld| world.fan_percent());
            let mut said = locked(&said);
            if *said != percent {
                *said = percent;
                // Nobody reads the output: the rig goes on.
                let _ = say(format_args!("{:9.3} s  fan {percent:.2} %", clock.now_s()));
            }
        };
        let handle = handle.context("the socket of the emulated bus failed")?;
        // A handle that breaks the protocol is closed; the others go on.
        thread::spawn(move || {
            let _ = serve(handle, Served::new(&bus), || after(&bus));
            // Lines that it drove return to their pull-ups.
            after(&bus);
        });
    }
    Ok(())
}

/// Replaces a socket that no process serves any more.
fn listen(path: &Path) -> Result<UnixListener> {
    let is_socket = fs::symlink_metadata(path).is_ok_and(|about| about.file_type().is_socket());
    let refused = |error: std::io::Error| error.kind() == std::io::ErrorKind::ConnectionRefused;
    // A plain file refuses a connection as well, and must not be replaced.
    if is_socket && UnixStream::connect(path).is_err_and(refused) {
        let _ = fs::remove_file(path);
    }
    UnixListener::bind(path).with_context(|| {
        format!("cannot serve at {}; is another rig emulated there? Name another --socket", path.display())
    })
}

#[cfg(test)]
mod tests {
    use super::listen;
    use std::fs;

    #[test]
    fn a_socket_that_nobody_serves_is_replaced_and_any_other_file_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("rig.sock");
        drop(listen(&socket).unwrap());
        drop(listen(&socket).unwrap());
        let file = folder.path().join("config.toml");
        fs::write(&file, "theirs").unwrap();
        assert!(listen(&file).is_err());
        assert_eq!(fs::read_to_string(&file).unwrap(), "theirs");
    }
}
