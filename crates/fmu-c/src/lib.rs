//! The C interface of FMI 2.0 for co-simulation, over [`fmu::Instance`].
//!
//! Every function that the standard names is there; those of what an instance cannot do (derivatives, serialized
//! states, asynchronous steps) return an error, as the standard asks. Nothing unwinds into the caller.
//! Source: FMI specification 2.0, chapters 2.1 and 4.2.

mod component;
mod lifecycle;
mod refused;
mod states;
mod types;
mod values;
