//! Measurements: a recording of an experiment in, what it says of the rig out, with 90 % intervals.
//!
//! ```text
//! noise_floor   a ball at rest                      → deviation of one reading
//! two_ends      a ball at the bottom and at the top → offset and scale of the sensor
//! jumps         duties held from rest               → force at each duty, lag of the fan
//! dead_zone     the forces of those jumps           → where the force begins, up and down
//! critical      steps under rising gains            → the gain at which the loop no longer comes to rest
//! ```
//!
//! None of them knows a model of the rig; the drag of the ball alone is given for the jumps, the travel for the ends.

pub mod critical;
pub mod dead_zone;
mod glide;
mod hold;
mod interval;
pub mod jumps;
pub mod noise_floor;
mod optimum;
pub mod timed_jump;
pub mod two_ends;

pub use interval::Estimate;

#[cfg(test)]
mod tests;

/// Why a record says nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// No stretch with the fan driven and the ball at rest.
    #[error("{found} readings of a ball at rest, with the fan driven without control; at least {needed} are needed")]
    NoRest {
        /// Readings found.
        found: usize,
        /// Readings needed.
        needed: usize,
    },
    /// The ball was not at both ends.
    #[error(
        "the ball was at {lowest_mm:.0} mm with the lowest duty and at {highest_mm:.0} mm with the highest, which are \
         not two ends of a pipe; give the fan more duty or more time"
    )]
    NotAtTheEnds {
        /// Mean position with the lowest duty, mm.
        lowest_mm: f64,
        /// Mean position with the highest duty, mm.
        highest_mm: f64,
    },
    /// Too few jumps.
    #[error(
        "{found} jumps of at least {shortest_s} s with the duty held and no setpoint, which are too few; at least \
         {needed} are needed"
    )]
    FewJumps {
        /// Jumps found.
        found: usize,
        /// Jumps needed.
        needed: usize,
        /// Shortest jump that counts, seconds.
        shortest_s: f64,
    },
    /// The forces lie on one side only.
    #[error(
        "{below} jumps went down and {above} up beyond doubt; each edge needs {needed}: is the hover duty of the \
         config, {middle_percent:.2} % being the middle of the jumps, far off?"
    )]
    OneSided {
        /// Jumps with a force downward.
        below: usize,
        /// Jumps with a force upward.
        above: usize,
        /// Needed on each side.
        needed: usize,
        /// Mean duty of the jumps, percent.
        middle_percent: f64,
    },
    /// No step was followed by an oscillation.
    #[error(
        "no step under a proportional-integral law is followed by an oscillation, and at least {needed} are needed; fly \
         experiments/critical-gain.toml, or higher gains than this log has"
    )]
    NoSwing {
        /// Needed.
        needed: usize,
    },
    /// The loop was not near its critical gain.
    #[error(
        "{found} steps under a proportional-integral law show an oscillation between {slowest:.2} and {fastest:.2} 1/s \
         of growth, too few, or not on both sides of zero; at least {needed} near it are needed: raise the last gain"
    )]
    NotCritical {
        /// Usable steps.
        found: usize,
        /// Needed.
        needed: usize,
        /// Smallest growth, 1/s.
        slowest: f64,
        /// Largest growth, 1/s.
        fastest: f64,
    },
    /// The search for the lag did not end.
    #[error("no lag of the fan explains the jumps; are the ends of the pipe too near, or readings missing?")]
    NoFit,
}
