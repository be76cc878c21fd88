//! The reference of the config's keys, found by running the program: for an unknown key it lists the expected ones.

use super::bounds::Bounds;
use super::pages::read;
use std::fmt::Write;
use system_tests::Bench;

/// A name that no table, choice or value has.
const NOBODY: &str = "nosuch";
/// The bounds of their numbers are on the gallery's pages.
const EFFECTS: &str = "plant.effects.";

/// A key of the config, or a word of a choice.
#[derive(Clone)]
pub(crate) struct Key {
    /// Dotted path.
    pub(crate) path: String,
    /// The expected content.
    pub(crate) holds: Holds,
    /// Whether it is a word.
    is_word: bool,
}

/// The expected content of a key.
#[derive(Clone)]
pub(crate) enum Holds {
    /// A table with these keys.
    Table(Vec<String>),
    /// One of these words; some are tables.
    OneOf(Vec<String>),
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// A list of numbers.
    Numbers,
    /// Text, or the name of a file.
    Words(&'static str),
    /// A value of this kind.
    Other(&'static str),
    /// Nothing: the key is a word of the choice above it.
    Nothing,
}

/// The page, from the program's answers.
pub(crate) fn page(keys: &[Key], bounds: &Bounds) -> String {
    let mut page = String::from(
        "<!-- Made from what `airball config check` expects and refuses by `scripts/book --update`. -->\n\n# Every table and key\n\n\
         What a config may hold; what it means stands in the comments of [config.toml](config.md). `a.b` is the key `b` of the table `[a]`. Which keys a \
         table needs depends on the command; one that lacks a key says so. A number may be as small and as large as its bounds; a bound that is a key is \
         the number that this key holds. If two values contradict each other, the error message \
         states the condition.\n\n| key | holds |\n|---|---|\n",
    );
    let mut effects = String::from(
        "\n## Effects\n\nA key of an effect is needed, unless it may be absent.\n\n| key | accepted | no effect at \
         |\n|---|---|---|\n",
    );
    for Key { path, holds, is_word } in keys {
        match (path.strip_prefix(EFFECTS), holds) {
            (Some(effect), Holds::Table(keys)) => {
                for key in keys {
                    let _ = writeln!(effects, "| `{path}.{key}` | {} |", of_effect(effect, key));
                }
            }
            // A choice without keys of its own is in the line of its key.
            (_, holds) if !is_word || matches!(holds, Holds::Table(_)) => {
                let _ = writeln!(page, "| `{path}` | {} |", words(holds, bounds.words(path)));
            }
            _ => {}
        }
    }
    page + &effects
}

/// What a key holds, in words.
fn words(holds: &Holds, bounds: Option<String>) -> String {
    let bounded = |number: &str, joint: &str| match &bounds {
        Some(bounds) => format!("{number}{joint} {bounds}"),
        None => number.to_owned(),
    };
    match holds {
        Holds::Table(_) => "a table".into(),
        Holds::OneOf(words) => format!("one of `{}`", words.join("`, `")),
        Holds::Number => bounded("a number", ","),
        Holds::Whole => bounded("a whole number", ","),
        Holds::Numbers => bounded("a list of numbers", ", each"),
        Holds::Words(kind) | Holds::Other(kind) => (*kind).into(),
        Holds::Nothing => String::new(),
    }
}

/// All keys except those of effects, each table before its content.
pub(crate) fn keys(bench: &Bench) -> Vec<Key> {
    let mut keys = Vec::new();
    keys_below(bench, "", &holds(bench, ""), &mut keys);
    keys
}

fn keys_below(bench: &Bench, table: &str, held: &Holds, keys: &mut Vec<Key>) {
    let (Holds::Table(names) | Holds::OneOf(names)) = held else { return };
    for name in names.iter().filter(|_| !table.starts_with(EFFECTS)) {
        let path = if table.is_empty() { name.clone() } else { format!("{table}.{name}") };
        let holds = holds(bench, &path);
        keys.push(Key { path: path.clone(), holds: holds.clone(), is_word: matches!(held, Holds::OneOf(_)) });
        keys_below(bench, &path, &holds, keys);
    }
}

/// Finds the expected content of a key.
fn holds(bench: &Bench, key: &str) -> Holds {
    let table = if key.is_empty() { String::new() } else { format!("[{key}]\n") };
    let said = answer(bench, format!("{table}{NOBODY} = 1\n"));
    let expected = said.split("expected ").nth(1).unwrap_or_else(|| panic!("[{key}]: {said}"));
    // Advice may follow.
    let expected = expected.split("; ").next().unwrap_or(expected).trim();
    let names = || expected.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    match expected {
        _ if said.contains("unknown key") => Holds::Table(names()),
        _ if said.contains("unknown word") => Holds::OneOf(names()),
        "empty table" => Holds::Nothing,
        "a number" => Holds::Number,
        "a whole number of 0 or more" => Holds::Whole,
        "a text in quotes" => Holds::Words("text"),
        "a text of 1 to 24 letters, in quotes" => Holds::Words("text of 1 to 24 letters"),
        "a path in quotes" => Holds::Words("a path"),
        "a list" if answer(bench, format!("{key} = [\"{NOBODY}\"]\n")).contains("expected a number") => Holds::Numbers,
        "a list" => Holds::Other("a list"),
        "a table" => Holds::Other("tables, one for each effect of your own"),
        "true or false" => Holds::Other("`true` or `false`"),
        other => panic!("[{key}]: {other} is new here; give it words"),
    }
}

/// The program's output for a config.
pub(crate) fn answer(bench: &Bench, config: String) -> String {
    bench.write("asked.toml", config);
    bench.run(&["config", "check", "--config", "asked.toml"]).errors
}

/// The accepted values of an effect's number, and the value without effect, as the gallery's page has them from the
/// catalogue.
fn of_effect(effect: &str, key: &str) -> String {
    let page = read(&format!("gallery/{effect}.md"));
    let row = page.lines().find_map(|line| line.strip_prefix(&format!("| `{key}` | ")));
    // Its first cell is the shown size. A number that is not identifiable from any log is not in the catalogue.
    row.map_or("a number; may be absent | –", |row| row.split_once(" | ").unwrap().1.trim_end_matches(" |")).to_owned()
}
