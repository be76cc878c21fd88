//! The application: everything around control law, plant and diagnosis. See ARCHITECTURE.md.
//!
//! Its layers, each of which knows only those before it: `config`, `rig`, `flight`, `log` and `mqtt`, `analysis`,
//! `report`, `commands`. Public is what the binary runs, and what the fuzz targets and the book are made with.

// The modules are private: in them, `pub` is for the other modules, and their documentation is for who works on them.
#![allow(unreachable_pub, rustdoc::private_intra_doc_links)]

mod analysis;
pub mod cli;
pub mod commands;
mod config;
mod flight;
mod log;
mod mqtt;
mod report;
mod rig;

pub use config::ConfigError;

/// What reads other people's bytes, for the fuzz targets, and what these need to go on with them.
pub mod fuzzing {
    /// Topics of a broker, and what a message on one of them asks for.
    pub use crate::config::topics::{ORIGINAL_SETPOINT, Topics};
    /// Tables of a config, and the text that they are read from.
    pub use crate::config::{Tables, parse_text};
    /// What a programme may be, and the pilot that flies it.
    pub use crate::flight::experiment::Experiment;
    pub use crate::flight::pilot::{Orders, Pilot, Seen, Signals};
    /// Records of anybody, and the logs of flights: read, recovered, written again, exported and summed up.
    pub use crate::log::export::csv as export_csv;
    pub use crate::log::flight::parse as parse_flight;
    pub use crate::log::reader::parse as parse_record;
    pub use crate::log::recover::{copy as copy_flight, header as header_of};
    pub use crate::log::writer::LogWriter;
    pub use crate::mqtt::parse::{Asked, parse as parse_message};
    pub use crate::report::flight::summary::Summary;
    /// The emulated bus behind its socket.
    pub use crate::rig::serve;
}

/// What the gallery of the book is made with.
pub mod book {
    /// What a diagnosis advises to fly next.
    pub use crate::analysis::next_experiment::{Advice, advise};
    /// A controller that flies a model in memory.
    pub use crate::analysis::virtual_flight::{Desk, Flown};
    /// The config of the rig that is shown.
    pub use crate::config::{Config, ConfigError, Tables};
    /// What is flown.
    pub use crate::flight::experiment::Experiment;
    /// A cycle as a diagnosis reads it.
    pub use crate::log::reader::sample;
    /// A diagnosis in words and as a picture.
    pub use crate::report::diagnosis::{next::words as advice_words, plot::small_diagnosis, words::words};
    /// Two flights in one picture.
    pub use crate::report::flight::plot::two_flights;
    /// Names and numbers as they are printed.
    pub use crate::report::kit::page::parts::{chance, number, spoken, stage};
}
