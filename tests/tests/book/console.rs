//! Commands on a page with their output: a fenced block `console`, in which commands begin with `$ `.
//!
//! The commands of a page run one after another in one shell, in a folder with the layout of the project's. `…` stands
//! for text that differs in each run: at the end of a line for the rest of it, on a line of its own for any lines. Each
//! command must succeed. A picture that a command draws and the page shows is compared as well. A page that uses
//! mosquitto gets a broker.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use system_tests::{Bench, Broker, root};

const FENCE: &str = "```console";
/// How the lines begin that tell of the progress of a search.
const PROGRESS: &str = "note: still searching";
/// Separator between the outputs of two commands.
const BETWEEN: char = '\u{1}';
const ANYTHING: &str = "…";

/// A command, and the lines of its output.
struct Step<'a> {
    command: &'a str,
    says: Vec<&'a str>,
}

/// Whether a page has commands to run.
pub(crate) fn has_commands(page: &Path) -> bool {
    fs::read_to_string(page).unwrap().contains(FENCE)
}

/// Runs the commands of a page and compares their output with the shown one, or writes it where it differs.
pub(crate) fn check(page: &Path, writes: bool) {
    let text = fs::read_to_string(page).unwrap();
    let blocks: Vec<&str> = text.split(FENCE).skip(1).map(|rest| rest.split("\n```").next().unwrap()).collect();
    let steps: Vec<Vec<Step<'_>>> = blocks.iter().map(|block| steps(block)).collect();
    let bench = Bench::default();
    let said = run(&bench, page, &text, steps.iter().flatten().map(|step| step.command));
    let mut said = said.iter();
    let mut anew = text.clone();
    for (block, steps) in blocks.iter().zip(&steps) {
        let mut right = String::new();
        for step in steps {
            let said: Vec<&str> = said.next().unwrap().lines().map(str::trim_end).collect();
            let alike = alike(&step.says, &said);
            assert!(alike || writes, "{}: {} says\n{}", page.display(), step.command, said.join("\n"));
            let lines = if alike { &step.says } else { &said };
            right.push_str(&format!("\n$ {}", step.command));
            lines.iter().for_each(|line| right.push_str(&format!("\n{line}")));
        }
        anew = anew.replacen(&format!("{FENCE}{block}\n```"), &format!("{FENCE}{right}\n```"), 1);
    }
    if writes {
        fs::write(page, anew).unwrap();
    }
    pictures(&bench, page, &text);
}

/// Compares the pictures that a page shows with those that its commands drew.
fn pictures(bench: &Bench, page: &Path, text: &str) {
    for picture in super::links(text).iter().filter(|link| link.ends_with(".svg") && bench.path(link).exists()) {
        super::is_or_write(&page.with_file_name(picture), &bench.read(picture));
    }
}

/// The commands of a block.
fn steps(block: &str) -> Vec<Step<'_>> {
    let mut steps: Vec<Step<'_>> = Vec::new();
    for line in block.lines().skip(1) {
        match (line.strip_prefix("$ "), steps.last_mut()) {
            (Some(command), _) => steps.push(Step { command, says: Vec::new() }),
            (None, Some(step)) => step.says.push(line),
            (None, None) => panic!("a block says {line:?} before a command"),
        }
    }
    steps
}

/// The output of each command on standard output and standard error.
fn run<'a>(bench: &Bench, page: &Path, text: &str, commands: impl Iterator<Item = &'a str>) -> Vec<String> {
    for name in ["docs", "experiments", "data", "effects.toml"] {
        std::os::unix::fs::symlink(root().join(name).canonicalize().unwrap(), bench.path(name)).unwrap();
    }
    let broker = text.contains("mosquitto").then(Broker::default);
    let port = broker.as_ref().map_or(1, |broker| broker.port);
    let config = bench.read("config.toml").replace("port = 1883", &format!("port = {port}"));
    // A longer timeout for a busy machine.
    bench.write("config.toml", config.replace("stall_s = 0.5 ", "stall_s = 10.0 "));
    let mut script = format!(
        "exec 2>&1\ntrap 'kill $(jobs -p) 2>/dev/null' EXIT\n\
         mosquitto_pub() {{ command mosquitto_pub -p {port} \"$@\"; }}\nmosquitto_sub() {{ command mosquitto_sub -p {port} \"$@\"; }}\n"
    );
    for command in commands {
        let checked = if command.ends_with('&') { "" } else { " || { echo \"exit status $?\"; exit 1; }" };
        script.push_str(&format!("printf '{BETWEEN}'\n{command}{checked}\n"));
    }
    let airball = bench.airball(&[]);
    let built = Path::new(airball.get_program()).parent().unwrap();
    let path = format!("{}:/usr/sbin:{}", built.display(), std::env::var("PATH").unwrap_or_default());
    // A shell loop without end must be stopped.
    let mut shell = Command::new("timeout");
    shell
        .args(["600", "bash", "-c", &script])
        .current_dir(bench.path(""))
        .env("PATH", path)
        .env_remove("COLUMNS")
        .stdin(Stdio::null());
    let output = shell.output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}: {said}", page.display());
    said.split(BETWEEN).skip(1).map(without_progress).collect()
}

/// An output without the lines of a long search, whose number depends on the computer.
fn without_progress(said: &str) -> String {
    let lines = said.trim_end().lines().filter(|line| !line.starts_with(PROGRESS));
    lines.collect::<Vec<_>>().join("\n")
}

/// Whether the shown output is the real one.
fn alike(shown: &[&str], said: &[&str]) -> bool {
    match (shown.split_first(), said.split_first()) {
        (None, None) => true,
        (Some((&ANYTHING, shown)), _) => (0..=said.len()).any(|from| alike(shown, &said[from..])),
        (Some((show, shown)), Some((say, said))) => {
            let same = show.strip_suffix(ANYTHING).map_or(show == say, |start| say.starts_with(start));
            same && alike(shown, said)
        }
        _ => false,
    }
}

#[test]
fn an_ellipsis_stands_for_the_rest_of_a_line_or_for_lines_and_for_nothing_else() {
    let said = ["flight 40 s", "late 3", "log x.mcap"];
    assert!(alike(&["flight 40 s", "late …", "log x.mcap"], &said));
    assert!(alike(&["flight…", "…"], &said) && alike(&["…", "log x.mcap"], &said));
    assert!(!alike(&["flight 40 s", "late 3"], &said) && !alike(&["…", "log y.mcap"], &said));
    assert!(!alike(&["flight 41 s", "…"], &said));
}
