//! Why controllers cannot fly.

use crate::design::DesignError;
use core::fmt;

/// Why controllers cannot fly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unready {
    /// There is no controller to fly first.
    NoController,
    /// A table or key needs an observer that is not there.
    NoObserver {
        /// The table or key below `[controller]`.
        needed_by: &'static str,
    },
    /// The observer has no steady gain.
    Observer(DesignError),
    /// Model-predictive control has no plan.
    Plan,
}

impl fmt::Display for Unready {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoController => {
                f.write_str("there is no controller to fly first; give one a table, or let `active` name one that has it")
            }
            Self::NoObserver { needed_by } => {
                write!(f, "controller.{needed_by} needs an observer; add [observer], or take the velocity from the filter")
            }
            Self::Observer(error) => write!(f, "[observer] has no steady gain: {error}"),
            Self::Plan => f.write_str(
                "no plan can be made with [controller.mpc] and [observer.believed]: their numbers are too far apart; raise mpc.control",
            ),
        }
    }
}

impl core::error::Error for Unready {}
