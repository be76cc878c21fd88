//! Why a rig does not start.

use hal::{FanError, RangeError, SeparateError};

/// Why a rig does not start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StartError<S, P> {
    /// The range sensor.
    #[error(transparent)]
    Sensor(RangeError<S>),
    /// The two range sensors cannot be given different addresses.
    #[error(transparent)]
    Separate(SeparateError<S>),
    /// The second range sensor.
    #[error("second range sensor: {0}")]
    Second(RangeError<S>),
    /// The fan driver.
    #[error(transparent)]
    Fan(FanError<P>),
}
