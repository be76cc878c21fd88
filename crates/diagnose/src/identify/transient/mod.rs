//! The transient method: a plant from the overshoot of its closed loop.

pub mod fan_pole;
pub(crate) mod peak;
pub mod second_order;
pub(crate) mod steps;
pub(crate) mod sweep;
