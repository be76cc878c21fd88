//! An instance with its caller's logger, behind the pointer that the caller holds.

use crate::types::{Component, Logger, Status};
use fmu::{Instance, InstanceError};
use std::ffi::{CString, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An instance and whom it tells what is wrong.
pub(crate) struct Held {
    pub(crate) instance: Instance,
    pub(crate) teller: Teller,
}

/// The caller's logger.
pub(crate) struct Teller {
    pub(crate) name: CString,
    pub(crate) logger: Option<Logger>,
    pub(crate) environment: *mut c_void,
}

impl Teller {
    /// Tells an error.
    pub(crate) fn tell(&self, text: &str) {
        let Some(logger) = self.logger else { return };
        // A percent sign would be one of a format.
        let text = CString::new(text.replace('\0', "").replace('%', "%%")).unwrap_or_default();
        // SAFETY: the caller gave this function for calls of this kind; the texts live during the call.
        unsafe {
            logger(self.environment, self.name.as_ptr(), Status::Error, c"logStatusError".as_ptr(), text.as_ptr());
        }
    }
}

/// Does something with an instance. An error is told; a panic becomes one.
pub(crate) fn with(component: Component, act: impl FnOnce(&mut Held) -> Result<(), InstanceError>) -> Status {
    // SAFETY: the caller hands over what `fmi2Instantiate` gave it, and uses an instance from one thread at a time, as
    // the standard asks; null is refused.
    let Some(held) = (unsafe { component.cast::<Held>().as_mut() }) else { return Status::Error };
    match catch_unwind(AssertUnwindSafe(|| act(held))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(error)) => {
            held.teller.tell(&error.to_string());
            Status::Error
        }
        Err(_) => {
            held.teller.tell("the simulation broke off; please report this");
            Status::Error
        }
    }
}
