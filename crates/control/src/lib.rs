//! Control law of the ball-in-pipe rig, in the order of the signal path:
//! [`waveform`] → [`pid`] → [`compensation`] → duty, and position → [`kalman`] / [`filter`] → estimate.
//!
//! `no_std`, no allocation. Nothing here reads a clock, a bus or a file: samples and times come in,
//! commands go out. Mathematics comes from `libm` only, so that every target computes the same bits.
#![no_std]

pub mod check;
pub mod compensation;
pub mod filter;
pub mod kalman;
pub mod pid;
mod units;
pub mod waveform;

pub use check::OutOfRange;
pub use units::{Duty, Millimetres};
