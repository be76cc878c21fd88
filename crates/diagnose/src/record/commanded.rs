//! The recorded duty as the acceleration that it commands.

use crate::record::recording::Recording;
use plant::{Actuator, Model};

/// The commanded acceleration when each duty is written, mm/s².
pub(crate) fn commanded(model: &Model, recording: &Recording) -> Vec<f64> {
    let writes = recording.writes();
    let mut actuator = Actuator::new(model, writes.first().map_or(0.0, |first| first.duty_percent));
    let start_s = writes.first().map_or(0.0, |first| first.time_s);
    let at_write = writes.iter().map(|write| {
        actuator.set_setpoint(write.setpoint_mm);
        actuator.write(model, write.time_s - start_s, write.duty_percent);
        actuator.commanded(model, write.time_s - start_s)
    });
    at_write.collect()
}
