//! From the instantiation to the end: `fmi2Instantiate`, the initialization, steps, `fmi2Reset`, `fmi2FreeInstance`.

use crate::component::{Held, Teller, with};
use crate::types::{Boolean, Callbacks, Component, Status, Text};
use fmu::{Instance, folder};
use std::ffi::{CStr, CString};
use std::panic::catch_unwind;
use std::ptr::null_mut;

/// Co-simulation, among the kinds of FMU.
const CO_SIMULATION: i32 = 1;

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> Text {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> Text {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetDebugLogging(_: Component, _: Boolean, _: usize, _: *const Text) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Instantiate(
    name: Text,
    kind: i32,
    _guid: Text,
    resources: Text,
    callbacks: *const Callbacks,
    _visible: Boolean,
    _logging: Boolean,
) -> Component {
    // SAFETY: the caller gives texts that end with a zero, and its functions, or null.
    let (name, resources, callbacks) = unsafe { (text(name), text(resources), callbacks.as_ref()) };
    let teller = Teller {
        name: CString::new(name).unwrap_or_default(),
        logger: callbacks.and_then(|callbacks| callbacks.logger),
        environment: callbacks.map_or(null_mut(), |callbacks| callbacks.environment),
    };
    if kind != CO_SIMULATION {
        teller.tell("this FMU is for co-simulation alone");
        return null_mut();
    }
    let made = catch_unwind(|| Instance::new(&folder(&resources)));
    match made {
        Ok(Ok(instance)) => Box::into_raw(Box::new(Held { instance, teller })).cast(),
        Ok(Err(error)) => {
            teller.tell(&error.to_string());
            null_mut()
        }
        Err(_) => {
            teller.tell("the FMU could not be read; please report this");
            null_mut()
        }
    }
}

/// A text of the caller; nothing where it is null.
unsafe fn text(pointer: Text) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: as the caller of this function promises.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2FreeInstance(component: Component) {
    if !component.is_null() {
        // SAFETY: the caller hands back what `fmi2Instantiate` gave it, once.
        drop(unsafe { Box::from_raw(component.cast::<Held>()) });
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetupExperiment(c: Component, _: Boolean, _: f64, start_s: f64, _: Boolean, _: f64) -> Status {
    with(c, |held| held.instance.begin_at(start_s))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2EnterInitializationMode(component: Component) -> Status {
    with(component, |_| Ok(()))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2ExitInitializationMode(component: Component) -> Status {
    with(component, |held| held.instance.start())
}

#[unsafe(no_mangle)]
extern "C" fn fmi2DoStep(component: Component, time_s: f64, step_s: f64, _no_set_before: Boolean) -> Status {
    with(component, |held| held.instance.step(time_s, step_s))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2Terminate(component: Component) -> Status {
    with(component, |_| Ok(()))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2Reset(component: Component) -> Status {
    with(component, |held| {
        held.instance.reset();
        Ok(())
    })
}
