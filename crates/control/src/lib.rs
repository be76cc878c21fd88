//! Control law of the ball-in-pipe rig, in the order of the signal path: [`waveform`] → [`feed_forward`] →
//! [`controller`] → [`compensation`] → duty, and position → [`filter`] / [`observer`] → estimate. [`regulator`] joins
//! what lies between a reading and a control value.
//!
//! `no_std`, no allocation. Nothing here reads a clock, a bus or a file: samples and times come in,
//! commands go out. Mathematics comes from `libm` only, so that every target computes the same bits.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod believed;
mod box_qp;
pub mod cascade;
pub mod check;
pub mod compensation;
pub mod controller;
pub mod design;
pub mod dither;
pub mod feed_forward;
pub mod filter;
pub mod inputs;
pub mod kalman;
mod limits;
pub mod mpc;
pub mod numbers;
pub mod observer;
pub mod pid;
pub mod predistortion;
pub mod regulator;
pub mod schedule;
pub mod state_feedback;
mod units;
pub mod waveform;

pub use check::OutOfRange;
pub use limits::Limits;
pub use units::{Duty, Millimetres};
