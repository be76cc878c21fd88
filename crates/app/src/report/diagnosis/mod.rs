//! A diagnosis: in words, as a picture and as a page. Its document, its sentences and its patch are those of the crate
//! `diagnose`.

pub mod closed_loop;
pub mod effect_plot;
mod ladder;
pub mod logs;
pub mod mend;
pub mod missing_force;
pub mod next;
pub mod page;
mod place;
pub mod plot;
mod sizes;
pub mod timeline;
pub mod words;
