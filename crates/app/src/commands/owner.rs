//! The program behind the link of a flight: keeps faults that a flight waits after, and knows its model.

use super::warn;
use crate::analysis::critical_kp::CriticalKp;
use crate::flight::last_fault::LastFault;
use crate::flight::pilot::Pilot;
use crate::flight::vocabulary::Fault;
use crate::locked::locked;
use crate::log::files::Files;
use crate::mqtt::owner::Owner;
use config::Tables;
use control::numbers::Values;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

/// What the loop's thread and the link's share.
#[derive(Clone)]
pub(super) struct FlightOwner {
    /// The file of the last fault; `None`: faults are not kept.
    kept: Option<PathBuf>,
    /// The log's files, once there is one.
    log: Arc<OnceLock<Files>>,
    /// The last fault that the flight waited after.
    waited: Arc<Mutex<Option<LastFault>>>,
    critical: Option<CriticalKp>,
}

impl FlightOwner {
    /// For a flight of this pilot.
    pub(super) fn new(tables: &Tables, pilot: &Pilot, kept: Option<&Path>) -> Self {
        let model = tables.plant.as_ref().zip(tables.r#loop);
        let critical = model.map(|(model, table)| CriticalKp::new(model, table.period_s, pilot.numbers().clone()));
        Self { kept: kept.map(Path::to_owned), log: Arc::default(), waited: Arc::default(), critical }
    }

    /// From now on faults name this log.
    pub(super) fn logs_to(&self, files: Files) {
        let _ = self.log.set(files);
    }

    /// The last fault that the flight waited after.
    pub(super) fn waited_after(&self) -> Option<LastFault> {
        locked(&self.waited).clone()
    }
}

impl Owner for FlightOwner {
    fn waits_after(&self, fault: Fault) -> LastFault {
        warn(format_args!("{fault}; the fan is off, and the flight waits for \"fly again\""));
        let fault = LastFault::now(fault.to_string(), self.log.get().map(Files::current).as_deref());
        if let Some(path) = &self.kept {
            keep(Some(path), &fault);
        }
        *locked(&self.waited) = Some(fault.clone());
        fault
    }

    fn critical_kp_per_mm(&self, numbers: &Values) -> Option<f64> {
        self.critical.as_ref()?.with(numbers)
    }
}

/// Keeps a fault over a restart. A disk that cannot be written is reported and causes no further fault.
pub(super) fn keep(kept: Option<&Path>, fault: &LastFault) {
    if let Some(path) = kept
        && let Err(error) = fault.keep(path)
    {
        warn(format_args!("the fault cannot be kept in {}: {error}; check [log] last_fault", path.display()));
    }
}
