//! A replay: the gap between model and record, in words and as a page.

pub mod gap;
pub mod page;
pub mod plot;
