//! The transient method: a plant from the overshoot of its closed loop.

pub(crate) mod fan_pole;
pub(crate) mod peak;
pub(crate) mod second_order;
pub(crate) mod steps;
pub(crate) mod sweep;
