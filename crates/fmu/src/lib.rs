//! The simulated rig as an FMU: a unit of FMI 2.0 for co-simulation, which Simulink, OpenModelica and FMPy step.
//!
//! ```text
//! rig.fmu = modelDescription.xml, binaries/linux64/airball.so and binaries/win64/airball.dll, resources/model.toml
//! input   duty, setpoint    output   reading, true motion, speed of the fan    parameter   every number of [plant]
//! ```
//!
//! The libraries (`crates/fmu-c`) are the same in every FMU: what they simulate is in the resources. Source: the FMI
//! standard 2.0.

mod archive;
mod description;
mod instance;
mod platform;
mod resources;
mod variables;

pub use archive::{ArchiveError, archive};
pub use instance::{Instance, InstanceError, State};
pub use platform::Platform;
pub use resources::folder;
pub use variables::{
    BALL, DUTY, FAN, FRESH, HELD, Kind, NOISE, POSITION, RPM, Role, SEED, SETPOINT, VELOCITY, Variable, variables,
};

/// The name of the file with the tables of the rig, in the resources.
pub const MODEL: &str = "model.toml";

/// The name of the library in the FMU, without its ending.
const IDENTIFIER: &str = "airball";
