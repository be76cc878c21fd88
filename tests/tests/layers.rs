//! The folders of a crate are layers: there is no import cycle between them, direct or indirect.
//!
//! The sources decide: the `use` lines, and paths in code from `crate::` or `super::`. Tests may import everything:
//! files named `tests.rs`, `…_tests.rs` or `tests_support.rs`, folders named `tests`, and the item that follows a
//! `#[cfg(test)]`.

#[path = "layers/imports.rs"]
mod imports;

use imports::Imports;
use std::fs;
use std::path::Path;
use system_tests::root;

/// Fails with the cycles of a crate's top-level modules, each with a file for every import.
fn has_no_circle(src: &Path) {
    has_no_circle_within(src, &[]);
}

/// The same for the submodules of one of its modules, which is given by its path.
fn has_no_circle_within(src: &Path, module: &[&str]) {
    let circles = Imports::within(src, module).circles();
    assert!(circles.is_empty(), "{} {}: {}", src.display(), module.join("::"), circles.join("; "));
}

#[test]
fn no_two_folders_of_the_application_import_each_other() {
    has_no_circle(&root().join("crates/app/src"));
}

#[test]
fn no_two_folders_of_the_diagnosis_import_each_other() {
    has_no_circle(&root().join("crates/diagnose/src"));
}

#[test]
fn the_folders_of_the_diagnosis_follow_the_path_of_the_data() {
    let imports = Imports::read(&root().join("crates/diagnose/src"));
    let path = ["record", "filter", "fit", "residual", "select", "answer"];
    for (at, to) in path.iter().enumerate() {
        for from in &path[at + 1..] {
            assert!(!imports.has(to, from), "{to} imports {from}, which comes after it");
        }
    }
    assert!(imports.has("filter", "record") && imports.has("answer", "select"), "{imports:?}");
}

#[test]
fn no_two_subjects_of_a_report_import_each_other_and_the_kit_imports_none() {
    let src = root().join("crates/app/src");
    has_no_circle_within(&src, &["report"]);
    let imports = Imports::within(&src, &["report"]);
    assert!(imports.has("diagnosis", "kit") && imports.has("identify", "design"), "{imports:?}");
    assert!(!["diagnosis", "design", "identify", "measure"].iter().any(|subject| imports.has("kit", subject)));
}

#[test]
fn the_folders_of_the_application_are_seen_with_their_imports() {
    let imports = Imports::read(&root().join("crates/app/src"));
    for (from, to) in [("flight", "bench"), ("report", "analysis"), ("commands", "report")] {
        assert!(imports.has(from, to), "{from} → {to} is missing: {imports:?}");
    }
}

/// A synthetic crate with these files.
fn made_up(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

#[test]
fn a_circle_is_named_with_a_file_for_every_arrow() {
    let folder = made_up(&[
        ("lib.rs", "mod a;\nmod b;\nmod c;\nmod d;\n"),
        ("a/mod.rs", "use crate::{\n    b::{self, Thing},\n    d,\n};\n"),
        ("b.rs", "fn f() { super::c::g() }\n"),
        ("c/mod.rs", "mod deep;\n"),
        ("c/deep/mod.rs", "pub use super::super::a::Other;\n"),
        ("d.rs", "//! See [`crate::a`].\n\n/* use crate::a; */ const WORDS: &str = \"crate::a\";\n"),
    ]);
    assert_eq!(Imports::read(folder.path()).circles(), ["a → b (a/mod.rs), b → c (b.rs), c → a (c/deep/mod.rs)"]);
}

#[test]
fn tests_may_import_what_they_like() {
    let test = "use crate::a::Thing;\n";
    let folder = made_up(&[
        ("a.rs", "use crate::b::Thing;\n"),
        ("b/mod.rs", "#[cfg(test)]\nmod campaign;\n#[cfg(test)]\nmod tests {\n    use crate::a::Thing;\n}\n"),
        (
            "b/one.rs",
            "#[cfg(test)]\npub(crate) use crate::a::Thing;\n\n#[cfg(test)]\nmod tests {\n    use crate::a;\n}\n",
        ),
        ("b/campaign/mod.rs", test),
        ("b/campaign/deep.rs", test),
        ("b/tests.rs", test),
        ("b/tests/deep.rs", test),
        ("b/link_tests.rs", test),
        ("b/tests_support.rs", test),
    ]);
    assert_eq!(Imports::read(folder.path()).circles(), [""; 0]);
    fs::write(folder.path().join("b/one.rs"), "#[cfg(test)]\nmod tests;\n\nuse crate::a::Thing;\n").unwrap();
    assert_eq!(Imports::read(folder.path()).circles(), ["a → b (a.rs), b → a (b/one.rs)"]);
}
