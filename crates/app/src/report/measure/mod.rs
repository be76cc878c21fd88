//! A measurement on a rig: in words, as a picture and as a page.

pub mod page;
pub mod plot;
pub mod words;
