//! What a person reads and looks at, by subject: words, documents, pictures and pages. What they are made of is in
//! [`kit`].

pub mod design;
pub mod diagnosis;
pub mod flight;
pub mod identify;
pub mod kit;
pub mod live;
pub mod measure;
pub mod replay;
