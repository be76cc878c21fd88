//! Measurements of rig quantities from the recording of an experiment, with 90 % intervals.
//!
//! ```text
//! noise_floor   a ball at rest                      → standard deviation of one reading
//! two_ends      a ball at the bottom and at the top → offset and scale of the sensor
//! jumps         constant duties from rest           → force at each duty, fan lag
//! dead_zone     the forces of those jumps           → edges of the dead zone
//! critical      steps at rising gains               → critical gain; at falling integral times, critical time
//! ```
//!
//! None of them uses a model of the rig. Only the drag of the ball is given for the jumps, and the travel for the ends.

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

use critical::Varied;

#[cfg(test)]
mod tests;

/// Why a record gives no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// No stretch with constant duty and the ball at rest.
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
    /// The forces have one sign only.
    #[error(
        "{below} jumps went down and {above} up beyond doubt; each edge needs {needed}: is the hover duty of the \
         config, {middle_percent:.2} % being the middle of the jumps, far off?"
    )]
    OneSided {
        /// Jumps with a force downward.
        below: usize,
        /// Jumps with a force upward.
        above: usize,
        /// Smallest number on each side.
        needed: usize,
        /// Mean duty of the jumps, percent.
        middle_percent: f64,
    },
    /// No step has an oscillation after it.
    #[error(
        "no step under a proportional-integral law is followed by an oscillation, and at least {needed} are needed; fly \
         {}, or {} than this log has", what.experiment(), what.further()
    )]
    NoSwing {
        /// What the steps vary.
        what: Varied,
        /// Smallest number of steps.
        needed: usize,
    },
    /// The loop was not near its critical gain.
    #[error(
        "{found} steps under a proportional-integral law show an oscillation between {slowest:.2} and {fastest:.2} 1/s \
         of growth, too few, or not on both sides of zero; at least {needed} near it are needed: fly {} as well", what.further()
    )]
    NotCritical {
        /// What the steps vary.
        what: Varied,
        /// Usable steps.
        found: usize,
        /// Smallest number of steps.
        needed: usize,
        /// Smallest growth rate, 1/s.
        slowest: f64,
        /// Largest growth rate, 1/s.
        fastest: f64,
    },
    /// The estimation of the lag did not converge.
    #[error("no lag of the fan explains the jumps; are the ends of the pipe too near, or readings missing?")]
    NoFit,
}
