//! Analyses of a recorded flight besides its diagnosis, and virtual flights of a model.

pub mod closed_loop;
pub mod critical_kp;
pub mod first_belief;
pub mod lateness_change;
pub mod log_errors;
pub mod loop_deviations;
pub mod loop_margins;
pub mod measurement;
pub mod next_experiment;
pub mod sensitivity;
pub mod step_response;
pub mod virtual_flight;
