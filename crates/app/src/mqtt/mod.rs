//! MQTT: commands in, replies and state out, during a flight.
//!
//! | topic | direction | payload |
//! |---|---|---|
//! | `airball/<rig>/set/setpoint_mm` | in | a number: `300` |
//! | `airball/<rig>/set/gains` | in | JSON, changed together: `{"kp_per_mm":0.01,"ti_s":3}` |
//! | `airball/<rig>/set/numbers` | in | JSON, changed together: `{"lqg.fan":0.7,"observer.sensor_mm":3}`; or `undo` |
//! | `airball/<rig>/set/controller` | in | `pid`, `cascade`, `state_feedback`, `lqg`, `mpc` or `open_loop` |
//! | `airball/<rig>/set/mode` | in | `stop`, `fly` or `programme` |
//! | `airball/<rig>/set/experiment` | in | an experiment of the list in `about`: flown once, then the programme |
//! | `airball/<rig>/set/stream` | in | `full`: every cycle on `cycles` for 5 s, ask again before; `off` |
//! | `airball/<rig>/reply` | out | JSON: what is in force, or why a command was refused |
//! | `airball/<rig>/state` | out, 10 Hz | JSON: the latest cycle, the gains, the counts |
//! | `airball/<rig>/cycles` | out, 10 Hz, when asked | JSON: `cycles` since the last message, `dropped`: lost ones |
//! | `airball/<rig>/about` | out, retained | JSON (`airball.about/1`): limits, units, controllers, gains, experiments |
//! | `airball/<rig>/numbers` | out, retained | JSON: all numbers that `set/numbers` can change, as they are |
//! | `airball/<rig>/critical_kp_per_mm` | out, retained | the K_p at which the model's PID loop loses stability, or `null` |
//! | `airball/<rig>/claim` | both | JSON: who flies this name, to others who would |
//! | `airball/<rig>/status` | out, retained | `online`, or `offline` by last will |
//! | `airball/<rig>/fault` | out, retained | JSON: the last fault that ended a flight, `at`, `fault`, `log`, `acknowledged` |
//! | `ball/parameters/reference` | in | the original rig's name of `set/setpoint_mm` |
//! | `ball/parameters/PID` | in | the original rig's name of `set/gains`: K_p, T_i and T_d |
//! | `ball/measures/position` | out, 10 Hz | the original rig's position, a number in mm |
//!
//! Two threads are between the loop and the broker, so that neither can block the loop:
//!
//! ```text
//!            commands (ring)            ┌─────────┐   subscriptions
//!        ┌──────────────────────────────┤ network ├◀──────────────────┐
//!        ▼                              └────┬────┘                   │
//!   loop │ Mailbox                           │ what was refused     broker
//!        │                              ┌────▼──────┐                 │
//!        └─────────────────────────────▶│ publisher ├────────────────▶┘
//!            answers, states (rings)    └───────────┘   try_publish
//! ```
//!
//! Commands, replies, `status` and `fault` go with QoS 1 (at least once), states with QoS 0.
//!
//! The loop's side never blocks and never allocates: a full ring drops and counts. A command for which the ring is full
//! is answered as busy, except a stop, which is never lost. The connection to a missing broker is tried again, at most
//! every five seconds, for as long as the link exists; the flight goes on. A *retained* command is refused: it was
//! meant for another time, and `fly` must not start the fan of a rig that has just been switched on.

pub mod about;
mod claim;
mod count;
mod credentials;
mod hearing;
mod line;
pub mod link;
pub mod local;
mod mailbox;
pub mod message;
pub mod monitor;
mod network;
mod outage;
pub mod owner;
pub mod parse;
mod publisher;
pub mod remote;
pub mod seen;
mod stream;
pub mod tls;

pub use about::About;
pub use count::Counts;
pub(crate) use credentials::exposures;
pub use link::Link;
#[cfg(test)]
pub use mailbox::Mailbox;

#[cfg(test)]
mod flood_tests;
#[cfg(test)]
mod link_support;
#[cfg(test)]
mod link_tests;
#[cfg(test)]
mod test_broker;
#[cfg(test)]
mod tls_tests;
