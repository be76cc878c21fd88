//! A config, and what the package knows without one.

use crate::errors::OrRaise;
use airball::library;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A config that has been read and checked.
#[pyclass(frozen, module = "airball._airball", from_py_object)]
#[derive(Clone)]
pub(crate) struct Belief(pub(crate) library::Belief);

#[pymethods]
impl Belief {
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, patches: Vec<PathBuf>) -> PyResult<Self> {
        library::Belief::read(&path, &patches).map(Self).or_raise(py)
    }

    #[staticmethod]
    fn of_texts(py: Python<'_>, texts: Vec<(String, String)>) -> PyResult<Self> {
        library::Belief::of_texts(texts).map(Self).or_raise(py)
    }

    fn texts(&self) -> Vec<(String, String)> {
        self.0.texts()
    }

    fn patched(&self, py: Python<'_>, name: &str, text: &str) -> PyResult<Self> {
        self.0.patched(name, text).map(Self).or_raise(py)
    }

    fn to_toml(&self) -> String {
        self.0.to_toml()
    }

    /// The table `[plant]` as JSON; none where the config has no model.
    fn plant(&self) -> Option<String> {
        self.0.model().and_then(|model| serde_json::to_string(model).ok())
    }

    /// Gain, drag, gradient, lag of the fan, lag of the sensor and delay of the linear part, and the effects that it
    /// leaves out.
    fn linear(&self) -> Option<([f64; 6], Vec<&'static str>)> {
        let model = self.0.model()?;
        let plant = model.linear();
        let numbers =
            [plant.gain, plant.drag_per_s, plant.gradient_per_s2, plant.fan_lag_s, plant.sensor_lag_s, plant.delay_s];
        Some((numbers, model.not_linear()))
    }

    fn export_fmu(&self, py: Python<'_>, folder: PathBuf, out: PathBuf) -> PyResult<()> {
        library::export_fmu(&self.0, &folder, &out).or_raise(py)
    }

    #[getter]
    fn period_s(&self) -> Option<f64> {
        self.0.period_s()
    }

    #[getter]
    fn name(&self) -> String {
        self.0.name()
    }
}

/// The effects of the catalogue and the names of their parameters.
#[pyfunction]
pub(crate) fn catalogue() -> Vec<(&'static str, Vec<&'static str>)> {
    let parameters = |entry: &plant::Entry| entry.params.iter().map(|param| param.name).collect();
    plant::Effects::CATALOGUE.iter().map(|entry| (entry.name, parameters(entry))).collect()
}

/// The config of the project.
#[pyfunction]
pub(crate) const fn example() -> &'static str {
    include_str!("../../../config.toml")
}

/// The title of an experiment; empty where the text has none.
#[pyfunction]
pub(crate) fn experiment_title(text: &str) -> String {
    let table: toml::Table = text.parse().unwrap_or_default();
    table.get("title").and_then(toml::Value::as_str).unwrap_or_default().to_owned()
}

/// The experiments of the project: names and texts.
#[pyfunction]
pub(crate) fn experiments() -> Vec<(&'static str, &'static str)> {
    macro_rules! files {
        ($($name:literal),*) => { vec![$(($name, include_str!(concat!("../../../experiments/", $name, ".toml")))),*] };
    }
    files![
        "calibration",
        "critical-gain",
        "critical-time",
        "dead-zone",
        "force-curve",
        "gain-pulses",
        "gallery",
        "identify",
        "noise-floor",
        "open-loop",
        "relay",
        "slow-ramp",
        "square",
        "steps"
    ]
}
