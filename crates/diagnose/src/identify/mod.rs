//! Identification of a plant of two or three poles from a record.

pub(crate) mod grey_box;
pub(crate) mod open_loop;
pub mod relay;
pub(crate) mod residual_tests;
pub mod transient;
pub(crate) mod validation;
