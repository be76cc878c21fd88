//! Identification of a plant of two or three poles from a record: by the likelihood, by the overshoot of the loop, by a
//! relay.

mod by_forecasts;
mod forms;
mod gravity;
pub(crate) mod grey_box;
mod initial;
mod input_outlier;
pub(crate) mod open_loop;
mod relay;
pub(crate) mod residual_tests;
mod rest;
pub(crate) mod transient;
pub(crate) mod validation;

pub use grey_box::{GreyBox, ParameterEstimate, Poles, TooLittle, better};
pub use initial::{Initial, NoPlant, NoUse, initial};
pub use open_loop::OpenLoop;
pub use relay::{Oscillation, oscillation};
pub use residual_tests::{ResidualTests, Test};
pub use transient::fan_pole::fan_lag_s;
pub use transient::peak::first_peak;
pub use transient::second_order::{Transient, TwoPoles};
pub use transient::steps::{Pulse, Rejected, pulses};
pub use transient::sweep::{NoSweep, OfGain, Sweep};
pub use validation::{HeldOut, Percent};
