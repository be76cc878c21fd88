//! The setpoint that the loop and an emulated world share: no chip carries it, and effects may depend on it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The setpoint in force; clones share it.
#[derive(Clone, Debug)]
pub(super) struct SharedSetpoint(Arc<AtomicU64>);

/// There is no setpoint yet.
impl Default for SharedSetpoint {
    fn default() -> Self {
        Self(Arc::new(AtomicU64::new(f64::NAN.to_bits())))
    }
}

impl SharedSetpoint {
    /// Sets the setpoint, mm.
    pub(super) fn set(&self, setpoint_mm: Option<f64>) {
        self.0.store(setpoint_mm.unwrap_or(f64::NAN).to_bits(), Ordering::Relaxed);
    }

    /// The setpoint, mm.
    pub(super) fn get(&self) -> Option<f64> {
        Some(f64::from_bits(self.0.load(Ordering::Relaxed))).filter(|setpoint_mm| setpoint_mm.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::SharedSetpoint;

    #[test]
    fn a_clone_has_the_setpoint_that_was_set_and_none_where_there_is_none() {
        let setpoint = SharedSetpoint::default();
        let shared = setpoint.clone();
        assert_eq!(shared.get(), None);
        setpoint.set(Some(250.0));
        assert_eq!(shared.get(), Some(250.0));
        setpoint.set(None);
        assert_eq!(shared.get(), None);
    }
}
