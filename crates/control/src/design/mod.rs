//! Design: from a linear plant to the gains of a controller, and from a loop to its margins.
//!
//! - [`plant`] → [`law`] (PID, or [`lqg`]) → loop: [`margins`], [`critical`], [`step`]
//! - [`plant`] → gains: [`placement`] (PID), [`ackermann`] and [`riccati`] (state feedback, observer), [`relay`] (PID
//!   from an oscillation)
//!
//! Everything is done with small polynomials and small matrices on the stack, in continuous time (s) and for the
//! sampled loop (δ = z − 1). Control value in percent of duty about hover (or mm/s² where the fan is linearised),
//! position in mm, frequency in rad/s, time in s.

pub mod ackermann;
pub mod critical;
pub mod discretise;
mod error;
pub mod law;
pub mod lqg;
pub mod margins;
pub mod placement;
pub mod plant;
pub mod polynomial;
pub mod relay;
pub mod riccati;
pub mod step;
pub mod transfer;

pub use error::DesignError;
pub use nalgebra::Complex;
pub use plant::Linear;
pub use polynomial::Polynomial;
pub use transfer::{Plane, Transfer};
