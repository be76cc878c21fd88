//! Copies of an instance's state: `fmi2GetFMUstate`, `fmi2SetFMUstate`, `fmi2FreeFMUstate`.

use crate::component::with;
use crate::types::{Component, FmuState, Status};
use fmu::State;
use std::ptr::null_mut;

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetFMUstate(component: Component, state: *mut FmuState) -> Status {
    // SAFETY: the caller gives a place whose pointer is null or of an earlier state, which is replaced.
    let Some(place) = (unsafe { state.as_mut() }) else { return Status::Error };
    with(component, |held| {
        free(*place);
        *place = Box::into_raw(Box::new(held.instance.state())).cast();
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetFMUstate(component: Component, state: FmuState) -> Status {
    // SAFETY: the caller hands over what `fmi2GetFMUstate` gave it.
    let Some(state) = (unsafe { state.cast::<State>().as_ref() }) else { return Status::Error };
    with(component, |held| held.instance.set_state(state))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeFMUstate(_: Component, state: *mut FmuState) -> Status {
    // SAFETY: the caller gives the place of a state or of null.
    if let Some(place) = unsafe { state.as_mut() } {
        free(*place);
        *place = null_mut();
    }
    Status::Ok
}

fn free(state: FmuState) {
    if !state.is_null() {
        // SAFETY: it is from `fmi2GetFMUstate`, and its place is overwritten after this.
        drop(unsafe { Box::from_raw(state.cast::<State>()) });
    }
}
