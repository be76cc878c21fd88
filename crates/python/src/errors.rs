//! Errors of the program as exceptions of `airball.errors`, with the text of the command line.

use airball::library::{ConfigError, LogError, RecordingError, Usage, with_causes};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The exception of an error.
pub(crate) fn raised(py: Python<'_>, error: &anyhow::Error) -> PyErr {
    let class = if error.is::<ConfigError>() {
        "ConfigError"
    } else if error.is::<LogError>() {
        "LogError"
    } else if error.is::<RecordingError>() {
        "RecordingError"
    } else if error.is::<Usage>() {
        "UsageError"
    } else {
        "Error"
    };
    exception(py, class, with_causes(error))
}

/// An exception of `airball.errors` by the name of its class.
fn exception(py: Python<'_>, class: &str, text: String) -> PyErr {
    let made = py.import("airball.errors").and_then(|module| module.getattr(class)?.call1((text.clone(),)));
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(_) => PyRuntimeError::new_err(text),
    }
}

/// A result of the program as one of Python.
pub(crate) trait OrRaise<T> {
    /// The value, or the exception of the error.
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T, E: Into<anyhow::Error>> OrRaise<T> for Result<T, E> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| raised(py, &error.into()))
    }
}
