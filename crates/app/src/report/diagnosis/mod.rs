//! A diagnosis: in words, as a document, as a picture and as a page.

pub mod closed_loop;
pub mod document;
pub mod left_over;
pub mod logs;
pub mod mend;
pub mod missing_force;
pub mod next;
pub mod page;
pub mod patch;
pub mod plot;
pub mod stages;
pub mod words;
