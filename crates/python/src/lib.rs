//! The native half of the Python package `airball`: thin classes over `airball::library`.
//!
//! What a user sees, its words and its checks of arrays are in `python/airball`; here values cross between the two
//! languages, work runs without Python's lock, and Ctrl-C ends it.

mod belief;
mod errors;
mod interrupt;
mod log;
mod program;
mod results;

use pyo3::prelude::*;

/// The module `airball._airball`.
#[pymodule]
mod _airball {
    #[pymodule_export]
    use super::belief::{Belief, catalogue, example, experiment_title, experiments};
    #[pymodule_export]
    use super::log::{Flown, Log, simulate};
    #[pymodule_export]
    use super::program::main;
    #[pymodule_export]
    use super::results::{Diagnosed, design, diagnose_logs, identify, is_log, propose, replay, summarise, tell_apart};

    /// The version of the package, which is that of the program.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
