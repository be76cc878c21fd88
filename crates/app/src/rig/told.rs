//! The setpoint, from the loop to an emulated world past the bus: no chip carries it, and effects may depend on it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The last setpoint that was told; a clone shares it.
#[derive(Clone, Debug)]
pub(super) struct Told(Arc<AtomicU64>);

/// Nothing was told.
impl Default for Told {
    fn default() -> Self {
        Self(Arc::new(AtomicU64::new(f64::NAN.to_bits())))
    }
}

impl Told {
    /// Tells a setpoint, mm, or that there is none.
    pub(super) fn tell(&self, setpoint_mm: Option<f64>) {
        self.0.store(setpoint_mm.unwrap_or(f64::NAN).to_bits(), Ordering::Relaxed);
    }

    /// The setpoint, mm.
    pub(super) fn setpoint_mm(&self) -> Option<f64> {
        Some(f64::from_bits(self.0.load(Ordering::Relaxed))).filter(|setpoint_mm| setpoint_mm.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::Told;

    #[test]
    fn a_clone_hears_what_was_told_and_that_nothing_is() {
        let (told, heard) = {
            let told = Told::default();
            (told.clone(), told)
        };
        assert_eq!(heard.setpoint_mm(), None);
        told.tell(Some(250.0));
        assert_eq!(heard.setpoint_mm(), Some(250.0));
        told.tell(None);
        assert_eq!(heard.setpoint_mm(), None);
    }
}
