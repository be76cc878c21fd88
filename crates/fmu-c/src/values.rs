//! Values of variables: `fmi2Get…` and `fmi2Set…`.

use crate::component::with;
use crate::types::{Boolean, Component, Reference, Status, Text};
use fmu::{InstanceError, Kind};
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// What the caller gives: as many references as values.
unsafe fn references<'a>(references: *const Reference, count: usize) -> &'a [Reference] {
    // SAFETY: the caller promises so many references; none where the pointer is null.
    if references.is_null() { &[] } else { unsafe { from_raw_parts(references, count) } }
}

/// Gets values, each by `of`.
unsafe fn get<T>(
    c: Component,
    which: *const Reference,
    count: usize,
    to: *mut T,
    kind: Kind,
    of: fn(f64) -> T,
) -> Status {
    // SAFETY: the caller promises room for so many values.
    let (which, to) = unsafe {
        if to.is_null() {
            return if count == 0 { Status::Ok } else { Status::Error };
        }
        (references(which, count), from_raw_parts_mut(to, count))
    };
    with(c, |held| {
        for (reference, value) in which.iter().zip(to) {
            *value = of(held.instance.get(*reference, kind)?);
        }
        Ok(())
    })
}

/// Sets values, each by `of`.
unsafe fn set<T: Copy>(
    c: Component,
    which: *const Reference,
    count: usize,
    from: *const T,
    kind: Kind,
    of: fn(T) -> f64,
) -> Status {
    // SAFETY: the caller promises so many values.
    let (which, from) = unsafe {
        if from.is_null() {
            return if count == 0 { Status::Ok } else { Status::Error };
        }
        (references(which, count), from_raw_parts(from, count))
    };
    with(c, |held| which.iter().zip(from).try_for_each(|(which, value)| held.instance.set(*which, kind, of(*value))))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetReal(c: Component, which: *const Reference, count: usize, to: *mut f64) -> Status {
    // SAFETY: as the caller promises.
    unsafe { get(c, which, count, to, Kind::Real, |value| value) }
}

#[expect(clippy::cast_possible_truncation, reason = "it was set as an integer of 32 bits, or is one of the config")]
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetInteger(c: Component, which: *const Reference, count: usize, to: *mut i32) -> Status {
    // SAFETY: as the caller promises.
    unsafe { get(c, which, count, to, Kind::Integer, |value| value as i32) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetBoolean(c: Component, which: *const Reference, count: usize, to: *mut Boolean) -> Status {
    // SAFETY: as the caller promises.
    unsafe { get(c, which, count, to, Kind::Boolean, |value| Boolean::from(value != 0.0)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetReal(c: Component, which: *const Reference, count: usize, from: *const f64) -> Status {
    // SAFETY: as the caller promises.
    unsafe { set(c, which, count, from, Kind::Real, |value| value) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetInteger(c: Component, which: *const Reference, count: usize, from: *const i32) -> Status {
    // SAFETY: as the caller promises.
    unsafe { set(c, which, count, from, Kind::Integer, f64::from) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetBoolean(
    c: Component,
    which: *const Reference,
    count: usize,
    from: *const Boolean,
) -> Status {
    // SAFETY: as the caller promises.
    unsafe { set(c, which, count, from, Kind::Boolean, |value| f64::from(u8::from(value != 0))) }
}

/// There is no variable that is a text.
fn no_text(c: Component, count: usize) -> Status {
    let unknown = InstanceError::Unknown { kind: "text", reference: 0 };
    if count == 0 { Status::Ok } else { with(c, |_| Err(unknown)) }
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetString(c: Component, _: *const Reference, count: usize, _: *mut Text) -> Status {
    no_text(c, count)
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetString(c: Component, _: *const Reference, count: usize, _: *const Text) -> Status {
    no_text(c, count)
}
