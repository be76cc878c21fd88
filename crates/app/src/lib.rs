//! The application: everything around control law, plant and diagnosis. See ARCHITECTURE.md.
//!
//! Its layers, each of which uses only those before it: `bench`, `flight`, `log` and `mqtt`, `analysis`, `report`,
//! `commands`, and `program` and `library` on top. Public is what the binary, the Python package, the fuzz targets and
//! the book use.

// The modules are private: in them, `pub` is for the other modules, and their documentation is for developers.
#![allow(unreachable_pub, rustdoc::private_intra_doc_links)]

mod analysis;
mod bench;
pub mod cli;
pub mod commands;
mod export_fmu;
mod files;
mod flight;
#[cfg(test)]
mod fmu_tests;
pub mod library;
mod locked;
mod log;
mod mqtt;
pub mod program;
mod report;
mod standard_error;
pub mod started;
mod wrapped;

pub use config::ConfigError;

/// Parsers of foreign bytes, for the fuzz targets, and what these need to process the results.
pub mod fuzzing {
    /// The emulated bus behind its socket.
    pub use crate::bench::serve;
    /// A programme, and the pilot that flies it.
    pub use crate::flight::experiment::Experiment;
    pub use crate::flight::pilot::{Orders, Pilot, Seen};
    /// Foreign records, and the logs of flights: read, recovered, written again, exported and summarised.
    pub use crate::log::export::csv as export_csv;
    pub use crate::log::flight::parse as parse_flight;
    pub use crate::log::reader::parse as parse_record;
    pub use crate::log::recover::{copy as copy_flight, header as header_of};
    pub use crate::log::writer::LogWriter;
    pub use crate::mqtt::parse::{Asked, parse as parse_message};
    pub use crate::report::flight::summary::Summary;
    /// Topics of a broker, and the content of a message on one of them.
    pub use config::topics::{ORIGINAL_SETPOINT, Topics};
    /// Tables of a config, and the parser of their text.
    pub use config::{Tables, parse_text};
}

/// For the gallery of the book.
pub mod book {
    /// The next flight after a diagnosis.
    pub use crate::analysis::next_experiment::{Advice, advise};
    /// A controller that flies a model in memory.
    pub use crate::analysis::virtual_flight::{Desk, Flown};
    /// An experiment.
    pub use crate::flight::experiment::Experiment;
    /// A cycle as a row of a recording.
    pub use crate::log::reader::sample;
    /// A diagnosis in words and as a picture.
    pub use crate::report::diagnosis::{next::words as advice_words, plot::small_diagnosis, words::words};
    /// Two flights in one picture.
    pub use crate::report::flight::plot::two_flights;
    /// Names and numbers as they are printed.
    pub use crate::report::kit::page::parts::{number, spoken, stage};
    /// The config of the shown rig.
    pub use config::{Config, ConfigError, Tables};
}
