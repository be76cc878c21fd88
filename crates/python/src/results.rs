//! Diagnoses, identifications, designs and replays.

use crate::belief::Belief;
use crate::interrupt::{Stop, interruptible};
use crate::log::Log;
use airball::library::{self, FreeRunPoints, Made, Options, Progress, ProgressStep};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A diagnosis.
#[pyclass(frozen, module = "airball._airball")]
pub(crate) struct Diagnosed(Arc<library::Diagnosed>);

#[pymethods]
impl Diagnosed {
    fn document(&self) -> &str {
        self.0.document()
    }

    fn words(&self) -> String {
        self.0.words()
    }

    fn patch(&self) -> String {
        self.0.patch()
    }

    fn next_experiment(&self) -> Option<&str> {
        self.0.next_experiment()
    }

    fn page(&self, py: Python<'_>, command: Vec<String>) -> PyResult<String> {
        let found = Arc::clone(&self.0);
        interruptible(py, &Stop::default(), |_| Ok(()), move || Ok(found.page(&command)))
    }

    fn write_page(&self, py: Python<'_>, path: PathBuf, command: Vec<String>) -> PyResult<()> {
        let found = Arc::clone(&self.0);
        interruptible(py, &Stop::default(), |_| Ok(()), move || found.write_page(&path, &command))
    }

    fn first_screen(&self, py: Python<'_>) -> PyResult<String> {
        let found = Arc::clone(&self.0);
        interruptible(py, &Stop::default(), |_| Ok(()), move || Ok(found.first_screen()))
    }

    /// The columns of a picture, by name.
    fn picture<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = Arc::clone(&self.0);
        let picture = interruptible(py, &Stop::default(), |_| Ok(()), move || Ok(found.picture()))?;
        let columns = PyDict::new(py);
        let rows = picture.recording.samples();
        let array = |numbers: Vec<f64>| numbers.into_pyarray(py);
        columns.set_item("time_s", array(rows.iter().map(|row| row.time_s).collect()))?;
        columns.set_item("duty_percent", array(rows.iter().map(|row| row.duty_percent).collect()))?;
        let positions = rows.iter().map(|row| row.position_mm.unwrap_or(f64::NAN)).collect();
        columns.set_item("position_mm", array(positions))?;
        for (name, runs) in [("believed", picture.nominal), ("mended", picture.mended)] {
            columns.set_item(name, of_runs(py, runs)?)?;
        }
        let missing = &picture.missing;
        columns.set_item("force_time_s", array(missing.iter().map(|one| one.time_s).collect()))?;
        columns.set_item("force_mm_per_s2", array(missing.iter().map(|one| one.force_mm_per_s2).collect()))?;
        columns.set_item("force_sigma_mm_per_s2", array(missing.iter().map(|one| one.sigma_mm_per_s2).collect()))?;
        Ok(columns)
    }
}

/// Rows, positions and the numbers of the runs.
fn of_runs(py: Python<'_>, points: FreeRunPoints) -> PyResult<Bound<'_, PyDict>> {
    let whole = |numbers: Vec<usize>| -> Bound<'_, PyArray1<usize>> { numbers.into_pyarray(py) };
    let columns = PyDict::new(py);
    columns.set_item("row", whole(points.rows))?;
    columns.set_item("run", whole(points.runs))?;
    columns.set_item("position_mm", points.position_mm.into_pyarray(py))?;
    Ok(columns)
}

/// How far a diagnosis is.
#[derive(Default)]
struct Count {
    made: AtomicUsize,
    planned: AtomicUsize,
    step: Mutex<&'static str>,
}

/// Diagnoses logs of one rig. `progress` is called with fits made, fits planned and the step in words.
#[pyfunction]
#[pyo3(name = "diagnose")]
pub(crate) fn diagnose_logs(
    py: Python<'_>,
    belief: &Belief,
    logs: Vec<Log>,
    without: Vec<String>,
    without_formula: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Diagnosed> {
    let (count, stop) = (Arc::new(Count::default()), Stop::default());
    let (counted, stops) = (Arc::clone(&count), stop.clone());
    let heard = Progress::new(move |step| {
        stops.here();
        match step {
            ProgressStep::Planned(fits) => counted.planned.fetch_add(fits, Ordering::Relaxed),
            ProgressStep::Made => counted.made.fetch_add(1, Ordering::Relaxed),
        };
    });
    let (belief, named) = (belief.0.clone(), Arc::clone(&count));
    let begun = stop.clone();
    let work = move || {
        let options = Options { progress: heard, without, without_formula, ..Options::default() };
        let logs: Vec<_> = logs.into_iter().map(|log| log.0).collect();
        let step = |words| {
            begun.here();
            *named.step.lock().unwrap_or_else(PoisonError::into_inner) = words;
        };
        Ok(Arc::new(library::Diagnosed::new(&belief, &logs, &options, &step)?))
    };
    let look = |py: Python<'_>| {
        let Some(who) = &progress else { return Ok(()) };
        let step = *count.step.lock().unwrap_or_else(PoisonError::into_inner);
        let [made, planned] = [&count.made, &count.planned].map(|count| count.load(Ordering::Relaxed));
        who.call1(py, (made, planned, step)).map(drop)
    };
    interruptible(py, &stop, look, work).map(Diagnosed)
}

/// Document, words, patch and notes.
type Told = (String, String, String, Vec<String>);

fn told(made: Made) -> Told {
    (made.document, made.words, made.patch, made.notes)
}

/// Identifies a plant from logs, with these flags of `airball identify grey-box`.
#[pyfunction]
pub(crate) fn identify(py: Python<'_>, belief: &Belief, logs: Vec<Log>, flags: Vec<String>) -> PyResult<Told> {
    let belief = belief.0.clone();
    let logs: Vec<_> = logs.into_iter().map(|log| log.0).collect();
    let work = move || library::identify(&belief, &logs, &flags);
    interruptible(py, &Stop::default(), |_| Ok(()), work).map(told)
}

/// Designs by a method of `airball design`, with its flags.
#[pyfunction]
pub(crate) fn design(py: Python<'_>, belief: &Belief, method: String, flags: Vec<String>) -> PyResult<Told> {
    let belief = belief.0.clone();
    let work = move || library::design(&belief, &method, &flags);
    interruptible(py, &Stop::default(), |_| Ok(()), work).map(told)
}

/// Compares forecasts of the model with a log.
#[pyfunction]
pub(crate) fn replay(py: Python<'_>, belief: &Belief, log: &Log) -> PyResult<Told> {
    let (belief, log) = (belief.0.clone(), log.0.clone());
    interruptible(py, &Stop::default(), |_| Ok(()), move || library::replay(&belief, &log)).map(told)
}

/// Proposes a config for logs of a rig that has none, and writes it, with these flags of `airball init`.
#[pyfunction]
pub(crate) fn propose(
    py: Python<'_>,
    logs: Vec<String>,
    out: PathBuf,
    flags: Vec<String>,
) -> PyResult<(Vec<String>, Vec<String>)> {
    interruptible(py, &Stop::default(), |_| Ok(()), move || library::propose(&logs, &out, &flags))
}

/// Logs by the names that tell them apart, and their files.
#[pyfunction]
pub(crate) fn tell_apart(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Vec<(String, PathBuf)>> {
    interruptible(py, &Stop::default(), |_| Ok(()), move || library::tell_apart(&paths))
}

/// Whether a file of this name in a folder is a log.
#[pyfunction]
pub(crate) fn is_log(name: &str) -> bool {
    library::is_log(name)
}

/// Writes the table and the page of the reports in a folder on logs of these names. Returns the numbers of diagnoses
/// and of errors.
#[pyfunction]
pub(crate) fn summarise(py: Python<'_>, names: Vec<String>, out: PathBuf) -> PyResult<[usize; 3]> {
    interruptible(py, &Stop::default(), |_| Ok(()), move || library::summarise(&names, &out))
}
