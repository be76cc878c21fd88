//! The pages of the book, and the parts of Markdown that are checked: links, headings, included files.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use system_tests::root;

/// The folder of the pages.
pub(crate) fn book() -> PathBuf {
    root().join("docs/book/src")
}

/// The text of a page's file.
pub(crate) fn read(page: &str) -> String {
    fs::read_to_string(book().join(page)).unwrap()
}

/// All pages.
pub(crate) fn pages() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![book()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.extension() {
                _ if path.is_dir() => folders.push(path),
                Some(extension) if extension == "md" => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    found
}

/// A page with what it includes.
pub(crate) fn expanded(page: &Path) -> String {
    let text = fs::read_to_string(page).unwrap();
    let mut parts = text.split("{{#include ");
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (file, rest) = part.split_once("}}").unwrap();
        let included = page.parent().unwrap().join(file.trim());
        let included = fs::read_to_string(&included).unwrap_or_else(|error| panic!("{}: {error}", included.display()));
        whole.push_str(&included);
        whole.push_str(rest);
    }
    whole
}

/// The lines that are prose: those outside of fenced blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut fenced = false;
    text.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    })
}

/// The targets of the links and pictures of a page.
pub(crate) fn links(text: &str) -> Vec<String> {
    let of = |line: &str| {
        let without_code: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
        let ends = without_code.split("](").skip(1).filter_map(|rest| rest.split(')').next().map(str::to_owned));
        ends.collect::<Vec<_>>()
    };
    prose(text).flat_map(of).collect()
}

/// The names by which the headings of a page are linked to.
pub(crate) fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let name = |heading: &str| {
        let letters = heading.chars().filter(|c| c.is_alphanumeric() || " _-".contains(*c));
        letters.collect::<String>().to_lowercase().replace(' ', "-")
    };
    headings.map(name).collect()
}
