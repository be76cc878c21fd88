//! Two records of a rig, before and after: what changed, as words, document and page.

pub mod document;
pub mod page;
pub mod words;
