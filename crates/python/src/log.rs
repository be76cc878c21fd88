//! Logs: read, made of arrays, or of a simulated flight. Columns become arrays without a copy.

use crate::belief::Belief;
use crate::errors::OrRaise;
use crate::interrupt::{Stop, interruptible};
use airball::library::{self, Programme, Sample};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use std::path::PathBuf;

/// A log.
#[pyclass(frozen, module = "airball._airball", from_py_object)]
#[derive(Clone)]
pub(crate) struct Log(pub(crate) library::Log);

/// Numbers of Python, one per row.
type Column<'py> = PyReadonlyArray1<'py, f64>;

/// The number of a row, where it is one.
fn at(column: Option<&Column<'_>>, row: usize) -> Option<f64> {
    column?.get(row).copied().filter(|value| !value.is_nan())
}

#[pymethods]
impl Log {
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, belief: Option<&Belief>) -> PyResult<Self> {
        let belief = belief.map(|belief| belief.0.clone());
        let read = move || Ok(library::Log::read(&path, belief.as_ref())?);
        interruptible(py, &Stop::default(), |_| Ok(()), read).map(Self)
    }

    /// The same log under another name.
    fn named(&self, name: &str) -> Self {
        Self(self.0.clone().named(name))
    }

    /// Rows of columns of one length; not a number: none in this row.
    #[staticmethod]
    fn of_columns(
        py: Python<'_>,
        name: &str,
        needed: [Column<'_>; 3],
        others: [Option<Column<'_>>; 4],
    ) -> PyResult<Self> {
        let ([time, duty, position], [setpoint, control, fan, second]) = (needed, others);
        let rows = (0..time.len().unwrap_or(0)).map(|row| Sample {
            time_s: at(Some(&time), row).unwrap_or(f64::NAN),
            duty_percent: at(Some(&duty), row).unwrap_or(f64::NAN),
            position_mm: at(Some(&position), row),
            setpoint_mm: at(setpoint.as_ref(), row),
            control_percent: at(control.as_ref(), row),
            fan_rpm: at(fan.as_ref(), row),
            position2_mm: at(second.as_ref(), row),
        });
        library::Log::of_rows(name, rows.collect()).map(Self).or_raise(py)
    }

    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    #[getter]
    fn truncated(&self) -> Option<&str> {
        self.0.truncated()
    }

    /// Whether its rows are all that it holds: no events, no cycles, no config.
    #[getter]
    fn is_plain(&self) -> bool {
        self.0.is_plain()
    }

    fn __len__(&self) -> usize {
        self.0.recording().samples().len()
    }

    /// A column of the rows; not a number where a row has none.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray1<f64>>> {
        let of: fn(&Sample) -> Option<f64> = match name {
            "time_s" => |row| Some(row.time_s),
            "duty_percent" => |row| Some(row.duty_percent),
            "position_mm" => |row| row.position_mm,
            "setpoint_mm" => |row| row.setpoint_mm,
            "control_percent" => |row| row.control_percent,
            "fan_rpm" => |row| row.fan_rpm,
            "position2_mm" => |row| row.position2_mm,
            _ => return None,
        };
        let numbers = self.0.recording().samples().iter().map(|row| of(row).unwrap_or(f64::NAN));
        Some(numbers.collect::<Vec<f64>>().into_pyarray(py))
    }
}

/// A flight of the simulated rig.
#[pyclass(frozen, module = "airball._airball")]
pub(crate) struct Flown(library::Flown);

#[pymethods]
impl Flown {
    #[getter]
    fn log(&self) -> Log {
        Log(self.0.log.clone())
    }

    #[getter]
    fn fault(&self) -> Option<&str> {
        self.0.fault.as_deref()
    }

    fn columns(&self) -> Vec<&'static str> {
        library::Flown::columns().collect()
    }

    fn column<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.column(name).map(|numbers| numbers.into_pyarray(py))
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.0.save(&path).or_raise(py)
    }
}

/// Flies the simulated rig in virtual time: an experiment in a file, or its text, or else the config's reference.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    belief: &Belief,
    file: Option<PathBuf>,
    text: Option<String>,
    seed: u64,
    duration_s: Option<f64>,
) -> PyResult<Flown> {
    let (belief, stop) = (belief.0.clone(), Stop::default());
    let landing = stop.clone();
    let fly = move || {
        let programme = match (&file, &text) {
            (Some(path), _) => Programme::File(path),
            (None, Some(text)) => Programme::Text(text),
            (None, None) => Programme::Reference,
        };
        library::fly(&belief, programme, seed, duration_s, &landing.0)
    };
    interruptible(py, &stop, |_| Ok(()), fly).map(Flown)
}
