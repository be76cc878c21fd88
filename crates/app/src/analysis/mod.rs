//! What a recorded flight says beyond its diagnosis, and what a model does in the same flight.

pub mod closed_loop;
pub mod loop_deviations;
pub mod loop_margins;
pub mod measurement;
pub mod next_experiment;
pub mod step_response;
pub mod virtual_flight;
