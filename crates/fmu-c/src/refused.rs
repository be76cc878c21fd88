//! What the description of the FMU says that it cannot do. A caller that asks nevertheless is refused.

use crate::types::{Boolean, Component, FmuState, Reference, Status, Text};
use std::ffi::c_char;

#[unsafe(no_mangle)]
extern "C" fn fmi2SerializedFMUstateSize(_: Component, _: FmuState, _: *mut usize) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SerializeFMUstate(_: Component, _: FmuState, _: *mut c_char, _: usize) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2DeSerializeFMUstate(_: Component, _: *const c_char, _: usize, _: *mut FmuState) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetDirectionalDerivative(
    _: Component,
    _: *const Reference,
    _: usize,
    _: *const Reference,
    _: usize,
    _: *const f64,
    _: *mut f64,
) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetRealInputDerivatives(
    _: Component,
    _: *const Reference,
    _: usize,
    _: *const i32,
    _: *const f64,
) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetRealOutputDerivatives(
    _: Component,
    _: *const Reference,
    _: usize,
    _: *const i32,
    _: *mut f64,
) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2CancelStep(_: Component) -> Status {
    Status::Error
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetStatus(_: Component, _: i32, _: *mut Status) -> Status {
    Status::Discard
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetRealStatus(_: Component, _: i32, _: *mut f64) -> Status {
    Status::Discard
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetIntegerStatus(_: Component, _: i32, _: *mut i32) -> Status {
    Status::Discard
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetBooleanStatus(_: Component, _: i32, _: *mut Boolean) -> Status {
    Status::Discard
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetStringStatus(_: Component, _: i32, _: *mut Text) -> Status {
    Status::Discard
}
