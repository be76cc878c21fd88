//! The book: its shown output is that of the program, and its links have targets.
//!
//! With `AIRBALL_BOOK=write` in the environment, shown output, the references of commands and keys and the gallery are
//! written instead of compared; `scripts/book --update` does that.

#[path = "book/bounds.rs"]
mod bounds;
#[path = "book/console.rs"]
mod console;
#[path = "book/keys.rs"]
mod keys;
#[path = "book/pages.rs"]
mod pages;

use bounds::Bounds;
use keys::Key;
use pages::{anchors, book, expanded, links, pages, read};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use system_tests::{Bench, root};

/// The keys of a config and the bounds of their numbers, requested once for all tests.
static KEYS: LazyLock<(Vec<Key>, Bounds)> = LazyLock::new(|| {
    let bench = Bench::default();
    let keys = keys::keys(&bench);
    let bounds = Bounds::ask(&bench, &keys);
    (keys, bounds)
});

/// Whether the pages are to be written.
fn writes() -> bool {
    std::env::var("AIRBALL_BOOK").is_ok_and(|word| word == "write")
}

/// Compares a page with its expected text, or writes it.
fn is_or_write(page: &Path, should: &str) {
    if writes() {
        fs::write(page, should).unwrap();
    }
    let is = fs::read_to_string(page).unwrap_or_default();
    let line = is.lines().zip(should.lines()).find(|(is, should)| is != should);
    assert!(is == should, "{}: {line:?}; scripts/book --update writes it anew", page.display());
}

#[test]
fn the_summary_lists_every_page_once_and_no_other() {
    let named: Vec<_> = links(&read("SUMMARY.md")).into_iter().map(|link| book().join(link)).collect();
    let listed: BTreeSet<_> = named.iter().cloned().collect();
    assert_eq!(listed.len(), named.len(), "a page is listed twice: {named:?}");
    let there: BTreeSet<_> = pages().into_iter().filter(|page| !page.ends_with("SUMMARY.md")).collect();
    assert_eq!(listed, there);
}

#[test]
fn every_link_and_anchor_of_the_book_leads_somewhere() {
    let mut seen = 0;
    for page in pages() {
        for link in links(&expanded(&page)).into_iter().filter(|link| !link.starts_with("http")) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(target.exists(), "{}: {link}", page.display());
            let outside = !target.canonicalize().unwrap().starts_with(book().canonicalize().unwrap());
            assert!(!outside, "{}: {link} is not in the book, which is read without the project", page.display());
            assert!(anchor.is_empty() || anchors(&expanded(&target)).contains(anchor), "{}: {link}", page.display());
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen} links");
}

#[test]
fn the_commands_of_the_book_run_and_say_what_it_shows() {
    let with_commands: Vec<_> = pages().into_iter().filter(|page| console::has_commands(page)).collect();
    assert!(with_commands.len() >= 6, "{with_commands:?}");
    std::thread::scope(|scope| {
        for page in &with_commands {
            scope.spawn(move || console::check(page, writes()));
        }
    });
}

#[test]
fn the_reference_of_commands_is_what_help_says() {
    let bench = Bench::default();
    let mut page = String::from(
        "<!-- Made from `airball --help` by `scripts/book --update`. -->\n\n# Commands\n\n\
         What `airball COMMAND --help` says. `--config`, `--patch`, `--effects`, `--html` and `--json` \
         mean the same in every command that has them.\n",
    );
    help_of(&bench, &[], &mut page);
    is_or_write(&book().join("reference/commands.md"), &page);
}

#[test]
fn the_reference_of_keys_is_what_the_program_expects() {
    let (keys, bounds) = &*KEYS;
    is_or_write(&book().join("reference/keys.md"), &keys::page(keys, bounds));
}

#[test]
fn a_number_just_within_its_bounds_is_accepted_and_one_just_beyond_is_refused_by_its_key() {
    let bench = Bench::default();
    let mut seen = 0;
    for probe in KEYS.1.probes() {
        let (key, step) = probe.key();
        let (min, max) = probe.common();
        let [below, above] = match step {
            Some(step) => [min - step, max + step],
            None => [min.next_down(), max.next_up()],
        };
        for within in [min, max].into_iter().filter(|end| end.is_finite()) {
            assert!(!probe.refuses(&bench, within), "{key} = {within} is refused within {min} to {max}");
        }
        for beyond in [below, above].into_iter().filter(|end| end.is_finite()) {
            assert!(probe.refuses(&bench, beyond), "{key} = {beyond} is not refused beyond {min} to {max}");
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen} ends");
}

/// The help of a command, and of its subcommands.
fn help_of(bench: &Bench, command: &[&str], page: &mut String) {
    let help = bench.output(&[command, &["--help"]].concat());
    let name = ["airball"].iter().chain(command).copied().collect::<Vec<_>>().join(" ");
    let marks = "#".repeat(command.len().clamp(1, 2) + 1);
    let text: Vec<&str> = help.lines().map(str::trim_end).collect();
    page.push_str(&format!("\n{marks} {name}\n\n```text\n{}\n```\n", text.join("\n").trim_end()));
    let below = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // Names are indented by two spaces; the continuation of a description is indented further.
    let named = below.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    for word in named.filter(|word| *word != "help") {
        help_of(bench, &[command, &[word]].concat(), page);
    }
}

#[test]
fn the_gallery_is_what_the_catalogue_makes() {
    let bench = Bench::default();
    let ran = bench.gallery(&["--out", "gallery"]);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    let made = bench.path("gallery");
    let kept = book().join("gallery");
    let files = |folder: &Path| -> BTreeSet<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    for file in files(&made) {
        is_or_write(&kept.join(&file), &fs::read_to_string(made.join(&file)).unwrap());
    }
    for old in files(&kept).difference(&files(&made)).filter(|_| writes()) {
        fs::remove_file(kept.join(old)).unwrap();
    }
    assert_eq!(files(&made), files(&kept));
}

#[test]
fn the_reference_of_documents_names_every_key_that_the_program_writes_and_no_other() {
    let bench = Bench::default();
    let experiment = root().join("experiments/gallery.toml");
    let fly = |name: &str, patch: &str| {
        let [patch_file, log] = ["toml", "mcap"].map(|end| format!("{name}.{end}"));
        bench.write(&patch_file, patch);
        let flags = ["simulate", "--patch", &patch_file, "--log", &log, "--experiment", experiment.to_str().unwrap()];
        let _ = bench.output(&flags);
    };
    fly("stuck", "[plant.effects.dead_zone]\nlower_percent = -0.4\nupper_percent = 0.4\n");
    // A force that no effect of the catalogue explains, so that the document has a formula.
    fly(
        "bumpy",
        "[effect.bumpy]\nstage = \"air\"\nadds = \"size * sin(2 * pi * x / 60)\"\n\
         parameters.size = { neutral = 0.0, low = -500.0, high = 500.0 }\n[plant.effects.bumpy]\nsize = 90.0\n",
    );
    // A friction that varies periodically, so that the parameter of the effect that resembles it varies.
    fly(
        "uneven",
        "[effect.uneven]\nstage = \"ball\"\nadds = \"-size * tanh(v / 5) * (1 + sin(2 * pi * t / 12))\"\n\
         parameters.size = { neutral = 0.0, low = -500.0, high = 500.0 }\n[plant.effects.uneven]\nsize = 150.0\n",
    );
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let page = read("reference/documents.md");
    for (command, logs) in
        [("replay", &["stuck.mcap"][..]), ("diagnose", &["stuck.mcap", "still.csv", "bumpy.mcap", "uneven.mcap"])]
    {
        let mut keys = BTreeSet::new();
        let mut schema = String::new();
        for log in logs {
            let written: Value = { serde_json::from_str(&bench.run(&[command, log, "--json"]).output).unwrap() };
            keys_of(&written, "", &mut keys);
            schema = written["schema"].as_str().unwrap().to_owned();
        }
        let whole = keys.clone();
        // A value that is null or empty in one document is present in another.
        keys.retain(|key| {
            !whole.iter().any(|other| other.strip_prefix(key).is_some_and(|rest| rest.starts_with(['.', '['])))
        });
        let part = page.split(&format!("## {schema}\n")).nth(1).expect(&schema).split("\n## ").next().unwrap();
        let rows = part.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
        assert_eq!(rows.map(str::to_owned).collect::<BTreeSet<_>>(), keys, "{schema}");
    }
}

#[test]
fn the_table_of_schemas_is_what_the_program_writes() {
    let mut written = BTreeSet::new();
    let sources = ["app/src", "diagnose/src", "score/src", "python/python"];
    let mut folders: Vec<_> = sources.map(|folder| root().join("crates").join(folder)).into();
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            // A built extension module of Python is not text.
            let Ok(source) = fs::read_to_string(&path) else { continue };
            let strings = source.split('"').filter(|string| string.starts_with("airball."));
            let versioned =
                |string: &&str| string.split_once('/').is_some_and(|(_, version)| version.parse::<u32>().is_ok());
            written.extend(strings.filter(versioned).map(str::to_owned));
        }
    }
    let page = read("reference/documents.md");
    let rows =
        page.split("\n## ").next().unwrap().lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    assert_eq!(rows.map(str::to_owned).collect::<BTreeSet<_>>(), written);
}

#[test]
fn what_is_built_for_a_block_that_is_not_run_is_made_by_a_script() {
    let name = |letter: char| letter.is_ascii_alphanumeric() || "._-".contains(letter);
    let scripts = fs::read_dir(root().join("scripts")).unwrap();
    let scripts: String = scripts.map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap()).collect();
    let mut seen = 0;
    for page in pages() {
        let text = read(page.to_str().unwrap());
        let blocks = text.split("```sh\n").skip(1).map(|rest| rest.split("\n```").next().unwrap());
        for block in blocks {
            for rest in block.split("target/").skip(1) {
                let path = format!("target/{}", rest.split(|letter| !name(letter) && letter != '/').next().unwrap());
                let made = scripts.split(&path).skip(1).any(|after| !after.starts_with(name));
                assert!(made, "{}: no script makes {path}", page.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 1, "{seen} paths");
}

/// Paths of the values of a document: `a.b` in an object, `a[]` in a list; `*` for a number of a model or of an effect.
fn keys_of(value: &Value, path: &str, keys: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let key = if path.ends_with("parameters") { "*" } else { key };
                keys_of(value, &if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }, keys);
            }
        }
        Value::Array(values) if values.iter().any(Value::is_object) => {
            values.iter().for_each(|value| keys_of(value, &format!("{path}[]"), keys));
        }
        _ => drop(keys.insert(path.to_owned())),
    }
}
