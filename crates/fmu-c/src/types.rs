//! The types of the standard's headers.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// An instance, as its caller holds it.
pub(crate) type Component = *mut c_void;
/// A state, as its caller holds it.
pub(crate) type FmuState = *mut c_void;
/// The reference of a variable.
pub(crate) type Reference = c_uint;
/// 0 or 1.
pub(crate) type Boolean = c_int;
/// A text that ends with a zero.
pub(crate) type Text = *const c_char;

/// The result of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub(crate) enum Status {
    /// Done.
    Ok = 0,
    /// Done, but look.
    #[expect(dead_code, reason = "of the standard")]
    Warning = 1,
    /// Not done.
    Discard = 2,
    /// Not done; the instance can be reset.
    Error = 3,
}

/// The caller's function for messages: environment, name of the instance, status, category, text, and what the text
/// refers to, which is nothing here.
pub(crate) type Logger = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, ...);

/// The caller's functions. Memory is taken from Rust, which the standard allows.
#[repr(C)]
pub(crate) struct Callbacks {
    /// For messages.
    pub(crate) logger: Option<Logger>,
    /// Memory for calls.
    pub(crate) allocate: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Its end.
    pub(crate) free: Option<unsafe extern "C" fn(*mut c_void)>,
    /// For asynchronous steps.
    pub(crate) finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    /// Handed to the logger.
    pub(crate) environment: *mut c_void,
}
