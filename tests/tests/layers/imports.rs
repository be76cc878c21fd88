//! The imports between the modules of a folder, from their sources.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The imports between two modules of a folder, each with the first file that has it.
#[derive(Debug, Default)]
pub(crate) struct Imports(BTreeMap<(String, String), String>);

impl Imports {
    /// The imports of the crate whose sources are in this folder.
    pub(crate) fn read(src: &Path) -> Self {
        Self::within(src, &[])
    }

    /// The imports between the submodules of a module of that crate, given by its path.
    pub(crate) fn within(src: &Path, parent: &[&str]) -> Self {
        let src = &parent.iter().fold(src.to_owned(), |folder, name| folder.join(name));
        let files = files(src);
        let modules: BTreeSet<String> = files.iter().filter_map(|file| Some(module(file)?.remove(0))).collect();
        let texts: Vec<(PathBuf, String)> = files
            .into_iter()
            .map(|file| {
                let text = fs::read_to_string(src.join(&file)).unwrap();
                (file, text)
            })
            .collect();
        let of_tests: BTreeSet<Vec<String>> =
            texts.iter().flat_map(|(file, text)| modules_of_tests(file, text)).collect();
        let mut imports = Self::default();
        for (file, text) in &texts {
            // The root of a crate imports all of its modules.
            let Some(path) = module(file) else { continue };
            if (1..=path.len()).any(|length| of_tests.contains(&path[..length]))
                || path.iter().any(|name| is_test(name))
            {
                continue;
            }
            for to in imported(&words(&code(text)), &path, parent) {
                if modules.contains(&to) && to != path[0] {
                    imports.0.entry((path[0].clone(), to)).or_insert_with(|| file.display().to_string());
                }
            }
        }
        imports
    }

    /// Whether one imports the other.
    pub(crate) fn has(&self, from: &str, to: &str) -> bool {
        self.0.contains_key(&(from.to_owned(), to.to_owned()))
    }

    /// The sets of modules that import each other, each as the imports within it.
    pub(crate) fn circles(&self) -> Vec<String> {
        let modules: BTreeSet<&str> = self.0.keys().map(|(from, _)| from.as_str()).collect();
        let reach: BTreeMap<&str, BTreeSet<&str>> = modules.iter().map(|from| (*from, self.reached(from))).collect();
        let together = |a: &str, b: &str| {
            let reaches = |from: &str, to: &str| reach.get(from).is_some_and(|reached| reached.contains(to));
            reaches(a, b) && reaches(b, a)
        };
        let mut circles: Vec<String> = Vec::new();
        let mut placed = BTreeSet::new();
        for first in modules {
            if placed.contains(first) || !together(first, first) {
                continue;
            }
            let within = self.0.iter().filter(|((from, to), _)| together(first, from) && together(first, to));
            let arrows: Vec<String> = within.map(|((from, to), file)| format!("{from} → {to} ({file})")).collect();
            circles.push(arrows.join(", "));
            placed.extend(reach[first].iter().filter(|other| together(first, other)).copied());
        }
        circles
    }

    /// The direct and indirect imports of a module.
    fn reached(&self, from: &str) -> BTreeSet<&str> {
        let mut reached = BTreeSet::new();
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            for (_, to) in self.0.keys().filter(|(other, _)| other == at) {
                if reached.insert(to.as_str()) {
                    open.push(to);
                }
            }
        }
        reached
    }
}

/// All sources, relative to the folder.
fn files(src: &Path) -> BTreeSet<PathBuf> {
    let (mut files, mut folders) = (BTreeSet::new(), vec![src.to_owned()]);
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                files.insert(path.strip_prefix(src).unwrap().to_owned());
            }
        }
    }
    files
}

/// The path of a file's module from the folder; `None`: it is the folder's own.
fn module(file: &Path) -> Option<Vec<String>> {
    let mut path: Vec<String> = file.with_extension("").iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    path.pop_if(|last| last == "mod");
    (!path.is_empty() && path != ["lib"] && path != ["main"]).then_some(path)
}

fn is_test(module: &str) -> bool {
    module == "tests" || module == "tests_support" || module.ends_with("_tests")
}

/// The modules that a file declares for tests alone: `#[cfg(test)] mod name;`.
fn modules_of_tests(file: &Path, text: &str) -> Vec<Vec<String>> {
    let path = module(file).unwrap_or_default();
    let lines = text.split("#[cfg(test)]").skip(1).filter_map(|rest| rest.trim_start().lines().next());
    let names = lines.filter_map(|line| line.strip_suffix(';')?.split_once("mod ").map(|(_, name)| name.to_owned()));
    names.map(|name| [path.clone(), vec![name]].concat()).collect()
}

/// The text without the parts that only tests compile.
fn code(text: &str) -> String {
    let mut parts = text.split("#[cfg(test)]");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.map(after_item).collect::<String>()
}

/// The text after an item: after its semicolon, or after the brace that closes its body in the first column.
fn after_item(text: &str) -> &str {
    let item = text.trim_start();
    let line = item.lines().next().unwrap_or_default();
    if line.ends_with(';') {
        return &item[line.len()..];
    }
    let indent: String =
        text.rsplit_once(item).map_or("", |(before, _)| before).chars().filter(|c| *c == ' ').collect();
    let end = format!("\n{indent}}}");
    item.find(&end).map_or("", |at| &item[at + end.len()..])
}

/// Names and punctuation of a source, without comments and strings.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            '"' => string(rest),
            'r' if rest.starts_with("r\"") || rest.starts_with("r#\"") => raw_string(rest),
            '\'' if rest.starts_with("'\"'") => 3,
            letter if letter.is_alphanumeric() || letter == '_' => {
                let name = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                words.push(rest[..name].to_owned());
                name
            }
            ':' if rest.starts_with("::") => {
                words.push("::".into());
                2
            }
            sign => {
                if !sign.is_whitespace() {
                    words.push(sign.into());
                }
                sign.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    words
}

/// The length of a string in quotes.
fn string(text: &str) -> usize {
    let mut escaped = false;
    for (at, letter) in text.char_indices().skip(1) {
        match letter {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

fn raw_string(text: &str) -> usize {
    let (begin, end) = if text.starts_with("r#") { (3, "\"#") } else { (2, "\"") };
    text[begin..].find(end).map_or(text.len(), |at| begin + at + end.len())
}

/// The modules of the folder that a file names, `path` being its own and `parent` the folder's.
fn imported(words: &[String], path: &[String], parent: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for start in 0..words.len() {
        let begins = start == 0 || words[start - 1] != "::";
        let after = match words[start].as_str() {
            "crate" if begins => {
                let expected = parent.iter().flat_map(|name| ["::", name]);
                if !words[start + 1..].iter().take(2 * parent.len()).map(String::as_str).eq(expected) {
                    continue;
                }
                start + 1 + 2 * parent.len()
            }
            "super" if begins => {
                let supers = words[start..].chunks(2).take_while(|pair| pair[0] == "super").count();
                if supers != path.len() {
                    continue;
                }
                start + 2 * supers - 1
            }
            _ => continue,
        };
        if words.get(after).is_some_and(|word| word == "::") {
            found.extend(first_names(&words[after + 1..]));
        }
    }
    found
}

/// The next name of a path, or those of a group in braces.
fn first_names(words: &[String]) -> Vec<String> {
    if words.first().is_none_or(|word| word != "{") {
        return words.first().cloned().into_iter().collect();
    }
    let (mut names, mut depth, mut expected) = (Vec::new(), 0, false);
    for word in words {
        match word.as_str() {
            "{" => {
                depth += 1;
                expected = depth == 1;
            }
            "}" if depth == 1 => break,
            "}" => depth -= 1,
            "," => expected = depth == 1,
            name if expected => {
                names.push(name.to_owned());
                expected = false;
            }
            _ => {}
        }
    }
    names
}
