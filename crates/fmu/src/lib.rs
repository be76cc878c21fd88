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

use config::Config;

pub use archive::{ArchiveError, archive};
pub use instance::{Instance, InstanceError, State};
pub use platform::Platform;
pub use resources::folder;
pub use variables::{
    BALL, DUTY, FAN, FRESH, HELD, Kind, NOISE, POSITION, RPM, Role, SEED, SETPOINT, VELOCITY, Variable, variables,
};

/// The name of the file with the tables of the rig, in the resources.
pub const MODEL: &str = "model.toml";

/// Period of the loop where the config has none, seconds: the shortest timing budget of a VL53L0X.
const USUAL_PERIOD_S: f64 = 0.02;

/// Period of the loop of a config, seconds.
fn period_s(config: &Config) -> f64 {
    config.tables.r#loop.map_or(USUAL_PERIOD_S, |table| table.period_s)
}

/// The name of the library in the FMU, without its ending.
const IDENTIFIER: &str = "airball";
