//! The binary `gallery`: every effect of the catalogue, flown, drawn and diagnosed, as pages of the book.

mod gallery;
mod page;
#[cfg(test)]
mod tests;

use airball::book::{Config, ConfigError, Desk, small_diagnosis, two_flights};
use airball::cli::ConfigArgs;
use airball::commands::{Usage, reader_is_gone, with_causes};
use anyhow::{Context, Result, anyhow, bail};
use clap::Parser;
use gallery::Exhibit;
use plant::Entry;
use rayon::prelude::*;
use std::io::{Write, stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Show what each effect of the catalogue does to a flight: pages with pictures, and what a diagnosis says of it
#[derive(Debug, Parser)]
#[command(name = "gallery", version, max_term_width = 100, args_override_self = true)]
struct Gallery {
    /// Which config: the rig that is shown, and its controller.
    #[command(flatten)]
    config: ConfigArgs,
    /// Write the pages (Markdown) and pictures (SVG) here; older ones are replaced
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Show this effect alone; may be given again
    #[arg(long, value_name = "EFFECT")]
    only: Vec<String>,
    /// Seed of the simulated rig's noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

fn main() -> ExitCode {
    match make(&Gallery::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if reader_is_gone(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // A closed standard error is not a failure.
            let _ = writeln!(stderr().lock(), "gallery: {}", with_causes(&error));
            if error.is::<ConfigError>() || error.is::<Usage>() { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}

/// Makes the pages. Fails where the config is not sound or cannot fly, a flight ended early, or a file cannot be
/// written or is not a page of a gallery.
fn make(args: &Gallery) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.over())?;
    let model = config.need("gallery", "plant", |tables| tables.plant.as_ref())?;
    let gallery = gallery::Gallery::new(Desk::of(&config.tables), model, args.seed)?;
    let out = &args.out;
    std::fs::create_dir_all(out)
        .with_context(|| format!("cannot make the folder {}; check the permissions", out.display()))?;
    if let Some(unknown) = args.only.iter().find(|name| model.effects.entry(name).is_none()) {
        let known: Vec<&str> = model.effects.catalogue().map(|entry| entry.name).collect();
        let message = format!("--only {unknown}: there is no such effect; known are {}", known.join(", "));
        return Err(Usage(message).into());
    }
    let wanted = |entry: &&Entry| args.only.is_empty() || args.only.iter().any(|name| name == entry.name);
    let entries: Vec<&Entry> = model.effects.catalogue().filter(wanted).collect();
    let exhibits = entries.into_par_iter().map(|entry| show(&gallery, entry, out)).collect::<Result<Vec<Exhibit>>>()?;
    if args.only.is_empty() {
        write_page(out.join("README.md"), &page::list(&exhibits))?;
    }
    Ok(writeln!(stdout().lock(), "gallery   {} effects in {}", exhibits.len(), out.display())?)
}

/// Flies one effect and writes its page and pictures.
fn show(gallery: &gallery::Gallery, entry: &Entry, out: &Path) -> Result<Exhibit> {
    let exhibit = gallery.exhibit(entry)?;
    let file = |what: &str| out.join(format!("{}{what}", entry.name));
    write_page(file(".md"), &page::page(&exhibit))?;
    two_flights(&file("-flight.svg"), &exhibit.with.cycles, &exhibit.without.cycles)?;
    small_diagnosis(&file("-force.svg"), &exhibit.picture, &exhibit.found.regions())?;
    Ok(exhibit)
}

/// Writes a page, unless another kind of file has its name.
fn write_page(path: PathBuf, text: &str) -> Result<()> {
    match std::fs::read_to_string(&path) {
        Ok(old) if !old.starts_with(page::MARK) => {
            bail!("{} exists and is no page of a gallery; it is kept: give --out another folder", path.display())
        }
        _ => std::fs::write(&path, text)
            .map_err(|error| anyhow!("cannot write the page {}: {error}; check the folder", path.display())),
    }
}
