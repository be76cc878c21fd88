//! `airball diagnose`: what separates a log from a model.

use super::{note, say};
use crate::cli::DiagnoseArgs;
use crate::config::Config;
use crate::log::reader;
use crate::report::diagnosis::{DiagnosisDocument, patch, words};
use anyhow::{Result, anyhow};

/// Diagnoses a log and says what was found.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a patch that cannot be written.
pub fn diagnose(args: &DiagnoseArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.patch)?;
    let model = config.need("diagnose", "plant", |tables| tables.plant.as_ref())?;
    let log = reader::read(&args.log, config.tables.import.as_ref())?;
    if let Some(lost) = &log.truncated {
        note(format_args!("{}: {lost}", args.log.display()));
    }
    let found = diagnose::diagnose(model, &log.recording, &diagnose::Options::default());
    if let Some(path) = &args.patch_out {
        std::fs::write(path, patch(&found))
            .map_err(|error| anyhow!("cannot write the patch {}: {error}; check the folder", path.display()))?;
    }
    if args.json {
        return say(serde_json::to_string(&DiagnosisDocument::of(&found, model))?);
    }
    for finding in &found.findings {
        note(format_args!("{}: {finding}", args.log.display()));
    }
    say(words(&found))
}
