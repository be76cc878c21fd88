//! Common parts of both range sensors.

use embedded_hal::i2c::{Error, ErrorKind};
use hal::RangeError;

/// How long a sensor may take to start, seconds: its driver needs 0.1 s at 100 kHz.
pub(super) const START_ALLOWED_S: f64 = 2.0;
/// How far beyond the pipe a reading may be and still count as the ball, mm: twelve times the sensor's noise.
pub(super) const BEYOND_PIPE_MM: f64 = 30.0;

/// A sensor's error as the loop gets it.
pub(super) fn kind<E: Error>(error: RangeError<E>) -> ErrorKind {
    match error {
        RangeError::Bus { error, .. } => error.kind(),
        _ => ErrorKind::Other,
    }
}
