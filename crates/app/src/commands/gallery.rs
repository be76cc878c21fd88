//! `airball gallery`: every effect of the catalogue, flown, drawn and diagnosed, as pages.

use super::{say, write};
use crate::analysis::virtual_flight::Desk;
use crate::cli::GalleryArgs;
use crate::config::Config;
use crate::gallery::{Exhibit, Gallery, page};
use crate::report::diagnosis::document::regions;
use crate::report::diagnosis::plot::small_diagnosis;
use crate::report::kit::plot;
use anyhow::{Context, Result, bail};
use plant::{Effects, Entry};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Makes the pages.
///
/// # Errors
/// A config that is not sound or cannot fly, a flight that ended early, a file that cannot be written or is no page of a gallery.
pub fn gallery(args: &GalleryArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.patch)?;
    let model = config.need("gallery", "plant", |tables| tables.plant.as_ref())?;
    let gallery = Gallery::new(Desk::of(&config.tables), model, args.seed)?;
    let out = &args.out;
    std::fs::create_dir_all(out)
        .with_context(|| format!("cannot make the folder {}; check the permissions", out.display()))?;
    let wanted = |entry: &&Entry| args.only.is_empty() || args.only.iter().any(|name| name == entry.name);
    let entries: Vec<&Entry> = Effects::CATALOGUE.iter().filter(wanted).collect();
    let exhibits = entries.into_par_iter().map(|entry| show(&gallery, entry, out)).collect::<Result<Vec<Exhibit>>>()?;
    if args.only.is_empty() {
        write_page(out.join("README.md"), &page::list(&exhibits))?;
    }
    say(format_args!("gallery   {} effects in {}", exhibits.len(), out.display()))
}

/// Flies one effect and writes its page and pictures.
fn show(gallery: &Gallery, entry: &Entry, out: &Path) -> Result<Exhibit> {
    let exhibit = gallery.exhibit(entry)?;
    let file = |what: &str| out.join(format!("{}{what}", entry.name));
    write_page(file(".md"), &page::page(&exhibit))?;
    plot::two_flights(&file("-flight.svg"), &exhibit.with.cycles, &exhibit.without.cycles)?;
    small_diagnosis(&file("-force.svg"), &exhibit.picture, &regions(&exhibit.found))?;
    Ok(exhibit)
}

/// Writes a page, unless something that is none has its name.
fn write_page(path: PathBuf, text: &str) -> Result<()> {
    match std::fs::read_to_string(&path) {
        Ok(old) if !old.starts_with(page::MARK) => {
            bail!("{} exists and is no page of a gallery; it is kept: give --out another folder", path.display())
        }
        _ => write("page", &path, text),
    }
}
