//! A design of the loop: in words, as a picture and as a page.

pub mod critical_gain;
pub mod observer;
pub mod page;
pub mod plot;
pub mod pole_map;
pub mod words;
