//! The simulated rig as an FMU: a unit of FMI 2.0 for co-simulation, which Simulink, OpenModelica and FMPy step.
//!
//! ```text
//! rig.fmu = modelDescription.xml, binaries/linux64/airball.so (crates/fmu), resources/model.toml
//! input   duty, setpoint    output   reading, true motion, speed of the fan    parameter   every number of [plant]
//! ```
//!
//! The library is the same in every FMU: what it simulates is in the resources. Source: the FMI standard 2.0.

mod description;
mod export;
mod instance;
mod variables;

#[cfg(test)]
mod tests;

pub use export::{ExportError, LIBRARY, export};
pub use instance::{Instance, InstanceError, State};
pub use variables::{Kind, Role, Variable};

/// The name of the file with the tables of the rig, in the resources.
const MODEL: &str = "model.toml";
