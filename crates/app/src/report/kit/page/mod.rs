//! A report as one page: no other file, no network, readable without its script.
//!
//! The template library escapes all inserted text, and a policy in the page's head allows only its own script, by its
//! hash. Names of files and configs from others therefore cannot act as markup or script.

pub mod figure;
pub mod made;
pub mod parts;
pub mod record;
pub mod stretch;

use super::palette;
use crate::files;
use base64::prelude::{BASE64_STANDARD, Engine};
use made::Made;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use record::Record;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

pub const STYLE: &str = include_str!("../../../../assets/page.css");
const SCRIPT: &str = include_str!("../../../../assets/page.js");
pub const CHART_STYLE: &str = include_str!("../../../../assets/uplot/uPlot.min.css");
pub const CHART_SCRIPT: &str = include_str!("../../../../assets/uplot/uPlot.iife.min.js");

/// How a page begins, and the mark of its program: only such a file is replaced. The mark stands in the first so many
/// bytes.
const BEGINNING: &str = "<!DOCTYPE html>";
const MAKER: &str = "<meta name=\"generator\" content=\"airball ";
const WITHIN: u64 = 2048;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The file cannot be written.
    #[error("cannot write the page {}: {source}; check its folder", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file of this name exists and is not a page of this program.
    #[error("{} exists and is no page that airball wrote; it is kept: give the page another name", path.display())]
    Taken {
        /// The file.
        path: PathBuf,
    },
    /// The plotting library failed.
    #[error(transparent)]
    Draw(#[from] super::plot::PlotError),
}

/// Refuses a page's name that another file has: a config, a log, somebody's own page; and a folder that cannot take it.
/// An older page of this program may be replaced.
///
/// # Errors
/// [`PageError`] names the file.
pub fn may_write(path: &Path) -> Result<(), PageError> {
    let can_be_made = || files::may_be_made(path).map_err(|source| PageError::Write { path: path.to_owned(), source });
    let Ok(file) = File::open(path) else { return can_be_made() };
    let mut head = Vec::new();
    let read = file.take(WITHIN).read_to_end(&mut head);
    let text = String::from_utf8_lossy(&head);
    let is_ours = read.is_ok() && text.starts_with(BEGINNING) && text.contains(MAKER);
    if is_ours { can_be_made() } else { Err(PageError::Taken { path: path.to_owned() }) }
}

/// Writes a page.
///
/// # Errors
/// [`PageError`] names the file.
pub fn write(path: &Path, page: &str) -> Result<(), PageError> {
    may_write(path)?;
    files::write(path, page.as_bytes()).map_err(|source| PageError::Write { path: path.to_owned(), source })
}

/// A part of a page with a heading for the table of contents.
pub struct Section {
    pub id: &'static str,
    pub heading: &'static str,
    pub body: Markup,
    /// Whether the heading is beside the body, as with a column of words.
    pub beside: bool,
}

impl Section {
    /// Figures and tables across the page.
    pub const fn across(id: &'static str, heading: &'static str, body: Markup) -> Self {
        Self { id, heading, body, beside: false }
    }

    /// Words.
    pub const fn words(id: &'static str, heading: &'static str, body: Markup) -> Self {
        Self { id, heading, body, beside: true }
    }
}

/// The content of a page.
pub struct Page<'a> {
    /// The subject of the page, in a word or two.
    pub kind: &'static str,
    /// Its sources: logs, config.
    pub from: Vec<String>,
    /// How it was made.
    pub made: &'a Made,
    /// The answer, in a sentence: the page's heading and title.
    pub answer: &'a str,
    /// The part below the answer.
    pub first: Markup,
    pub sections: Vec<Section>,
    pub record: &'a Record,
}

impl Page<'_> {
    /// The page as HTML.
    pub fn render(&self) -> String {
        let script = format!("{CHART_SCRIPT}\n{SCRIPT}");
        let style = format!("{}{CHART_STYLE}\n{STYLE}", palette::stylesheet());
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="generator" content=(concat!("airball ", env!("CARGO_PKG_VERSION")));
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta http-equiv="Content-Security-Policy" content=(policy(&script));
                    title { (self.answer) " – airball " (self.kind) }
                    style { (PreEscaped(style)) }
                }
                body {
                    a.skip href="#main" { "Skip to the answer" }
                    header.top { (self.top()) }
                    main #main { (self.main()) }
                    footer { (footer()) }
                    // Inside a script only `<` can begin markup, which the record writes as an escape.
                    script type="application/json" id="series" { (PreEscaped(self.record.json(&self.made.words))) }
                    script { (PreEscaped(script)) }
                }
            }
        };
        self.made.words.of_markup(&page.into_string())
    }

    /// The part that is seen first, without the sections below it and without a script.
    pub fn render_first(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'";
                    style { (PreEscaped(format!("{}\n{STYLE}", palette::stylesheet()))) }
                }
                body { main { h1 { (self.answer) } (self.first) } }
            }
        };
        self.made.words.of_markup(&page.into_string())
    }

    fn top(&self) -> Markup {
        html! {
            p.brand { strong { "airball" } " " (self.kind) }
            p.from { @for from in self.from.iter().chain(self.made.sources()) { span { (from) } } }
            (self.made.head())
        }
    }

    fn main(&self) -> Markup {
        html! {
            h1 { (self.answer) }
            (self.first)
            nav aria-label="Sections of this page" {
                ul { @for section in &self.sections { li { a href=(format!("#{}", section.id)) { (section.heading) } } } }
            }
            @for section in &self.sections {
                section id=(section.id) class=[section.beside.then_some("beside")] aria-labelledby=(format!("{}-heading", section.id)) {
                    h2 id=(format!("{}-heading", section.id)) { (section.heading) }
                    div.body { (section.body) }
                }
            }
        }
    }
}

fn footer() -> Markup {
    html! {
        p {
            "This page needs no network and contains all that it shows. Charts that zoom: uPlot, © Leon Sorokin, MIT \
             licence."
        }
    }
}

/// A policy that allows this script only, and no resource from elsewhere.
fn policy(script: &str) -> String {
    let hash = hash_of(script);
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{hash}'; base-uri 'none'; form-action 'none'"
    )
}

/// The hash of a script as a policy writes it.
pub fn hash_of(script: &str) -> String {
    BASE64_STANDARD.encode(Sha256::digest(script.as_bytes()))
}

#[cfg(test)]
mod tests;
