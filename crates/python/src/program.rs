//! The command line.

use airball::started::{Host, by};
use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the program `airball` and returns its exit status. `interpreter`: what starts Python, for the process that
/// guards the fan.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, interpreter: OsString, arguments: Vec<OsString>) -> u8 {
    let before = ["-I", "-m", "airball"].map(OsString::from).to_vec();
    by(Host { name: interpreter, before, arguments });
    py.detach(airball::program::status)
}
