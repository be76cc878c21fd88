//! Output for people, by subject: words, documents, pictures and pages. Their common parts are in [`kit`].

pub mod compare;
pub mod design;
pub mod diagnosis;
pub mod each;
pub mod first_belief;
pub mod flight;
pub mod identify;
pub mod kit;
pub mod live;
pub mod measure;
pub mod replay;
