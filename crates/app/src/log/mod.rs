//! What a flight leaves behind, and how it is read again.
pub mod record;
