//! The size of the gap: forecast errors, and the share of them that a model closes.

pub(crate) mod bootstrap;
pub(crate) mod divergence;
pub(crate) mod forecast_error;
pub(crate) mod share_closed;
