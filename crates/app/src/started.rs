//! How the program was started: its arguments, and how a second process of it is started.
//!
//! The binary is started by itself; from Python an interpreter runs it, and the arguments of the process are that
//! interpreter's.

use std::ffi::OsString;
use std::sync::OnceLock;

/// Another program that runs this one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Host {
    /// The name by which a process of it is started.
    pub name: OsString,
    /// Its arguments before those of this program.
    pub before: Vec<OsString>,
    /// The arguments of this program, without a name.
    pub arguments: Vec<OsString>,
}

static HOST: OnceLock<Host> = OnceLock::new();

/// Says that this program runs inside another one. The first call counts.
pub fn by(host: Host) {
    let _ = HOST.set(host);
}

/// Name and arguments of this program.
pub fn arguments() -> Vec<OsString> {
    match HOST.get() {
        Some(host) => std::iter::once(OsString::from("airball")).chain(host.arguments.iter().cloned()).collect(),
        None => std::env::args_os().collect(),
    }
}

/// The same in words; what is no text is shown with marks.
pub fn words() -> Vec<String> {
    arguments().into_iter().map(|word| word.to_string_lossy().into_owned()).collect()
}

/// Name of a second process of this program, and the arguments before its own.
pub fn again() -> (OsString, Vec<OsString>) {
    HOST.get().map_or_else(|| ("airball".into(), Vec::new()), |host| (host.name.clone(), host.before.clone()))
}
