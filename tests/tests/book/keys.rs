//! The reference of the config's keys, made by asking the program: under a key that cannot be there it says what it expects.

use super::pages::read;
use std::fmt::Write;
use system_tests::Bench;

/// No table, no choice and no value is called so.
const NOBODY: &str = "nosuch";
/// Their numbers have bounds, which the gallery's pages say.
const EFFECTS: &str = "plant.effects";

/// What the program expects at a key.
enum Holds {
    /// A table with these keys.
    Table(Vec<String>),
    /// One of these words; some are tables.
    OneOf(Vec<String>),
    /// A value of this kind.
    Value(&'static str),
    /// Nothing: the key is a word of the choice above it.
    Word,
}

/// The page, from the program's answers.
pub(crate) fn page(bench: &Bench) -> String {
    let mut page = String::from(
        "<!-- Made from what `airball config check` expects by `scripts/book --update`. -->\n\n# Every table and key\n\n\
         What a config may hold; what it means stands in the comments of [config.toml](config.md). `a.b` is the key `b` of the table `[a]`. Which keys a \
         table needs depends on the command; one that lacks a key says so.\n\n| key | holds |\n|---|---|\n",
    );
    let mut effects = String::new();
    keys_of(bench, "", holds(bench, ""), &mut page, &mut effects);
    page + "\n## Effects\n\nA key of an effect is needed, unless it may be absent.\n\n| key | accepted | does nothing at |\n|---|---|---|\n"
        + &effects
}

/// Writes the keys of a table that holds these, and of those within it.
fn keys_of(bench: &Bench, table: &str, held: Holds, page: &mut String, effects: &mut String) {
    let (keys, of_table) = match held {
        Holds::Table(keys) => (keys, true),
        Holds::OneOf(words) => (words, false),
        Holds::Value(_) | Holds::Word => return,
    };
    for key in keys {
        let path = if table.is_empty() { key.clone() } else { format!("{table}.{key}") };
        if let Some(effect) = table.strip_prefix(EFFECTS).and_then(|name| name.strip_prefix('.')) {
            let _ = writeln!(effects, "| `{path}` | {} |", bounds(effect, &key));
            continue;
        }
        let held = holds(bench, &path);
        let what = match &held {
            Holds::Table(_) if table == EFFECTS => None,
            Holds::Table(_) => Some("a table".to_owned()),
            Holds::OneOf(words) => Some(format!("one of `{}`", words.join("`, `"))),
            Holds::Value(kind) => Some((*kind).to_owned()),
            Holds::Word => None,
        };
        // A choice without keys of its own stands in the line of the key that it is for.
        if let Some(what) = what.filter(|what| of_table || what == "a table") {
            let _ = writeln!(page, "| `{path}` | {what} |");
        }
        keys_of(bench, &path, held, page, effects);
    }
}

/// Asks the program what it expects at a key.
fn holds(bench: &Bench, key: &str) -> Holds {
    let table = if key.is_empty() { String::new() } else { format!("[{key}]\n") };
    bench.write("keys.toml", format!("{table}{NOBODY} = 1\n"));
    let said = bench.run(&["config", "check", "--config", "keys.toml"]).errors;
    let expected = said.split("expected ").nth(1).unwrap_or_else(|| panic!("[{key}]: {said}")).trim();
    let names = || expected.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    match expected {
        _ if said.contains("unknown field") => Holds::Table(names()),
        _ if said.contains("unknown variant") => Holds::OneOf(names()),
        "empty table" => Holds::Word,
        "f64" => Holds::Value("a number"),
        "u8" | "u16" | "u32" | "u64" => Holds::Value("a whole number"),
        "a string" => Holds::Value("text"),
        "path string" => Holds::Value("a path"),
        "a sequence" => Holds::Value("a list"),
        "a boolean" => Holds::Value("`true` or `false`"),
        other => panic!("[{key}]: {other} is new here; give it words"),
    }
}

/// What is accepted of a number of an effect and where it does nothing, as the gallery's page has it from the catalogue.
fn bounds(effect: &str, key: &str) -> String {
    let page = read(&format!("gallery/{effect}.md"));
    let row = page.lines().find_map(|line| line.strip_prefix(&format!("| `{key}` | ")));
    // Its first cell is the size that is shown. A number that no log can tell is not in the catalogue.
    row.map_or("a number; may be absent | –", |row| row.split_once(" | ").unwrap().1.trim_end_matches(" |")).to_owned()
}
