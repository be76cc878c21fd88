//! The parts of all reports: pages, pictures, tables and colours.

pub mod about;
pub mod page;
pub mod palette;
pub mod patch;
pub mod plot;
pub mod table;
pub mod words;
