//! Tests that the project's documents are correct.

use std::fs;
use system_tests::{Bench, root};

#[test]
fn the_architecture_page_names_every_crate_and_no_other() {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut crates: Vec<String> = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    crates.sort();
    let mut named: Vec<&str> =
        page.lines().filter_map(|line| line.strip_prefix("| `crates/")?.split('`').next()).collect();
    named.sort_unstable();
    assert_eq!(named, crates);
}

#[test]
fn the_architecture_page_fits_on_two_screens() {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    assert!(page.lines().count() <= 110, "{} lines", page.lines().count());
}

#[test]
fn the_readme_is_short() {
    let page = fs::read_to_string(root().join("README.md")).unwrap();
    assert!(page.lines().count() <= 150, "{} lines", page.lines().count());
}

#[test]
fn every_path_that_the_architecture_page_and_the_page_on_internals_name_exists() {
    for page in ["ARCHITECTURE.md", "docs/internals.md"] {
        every_path_exists(&fs::read_to_string(root().join(page)).unwrap());
    }
}

fn every_path_exists(page: &str) {
    let quoted = page.split('`').skip(1).step_by(2);
    let files: Vec<&str> = quoted
        .filter_map(|words| words.split(' ').next())
        .filter(|word| word.ends_with(".rs") || word.starts_with("scripts/"))
        .collect();
    assert!(files.len() > 10, "{files:?}");
    for file in files {
        let places = ["", "crates/app/src/", "crates/control/src/"].map(|place| root().join(place).join(file));
        assert!(places.iter().any(|place| place.exists()), "{file}");
    }
}

#[test]
fn the_config_of_the_project_is_sound_and_prints_back_as_itself() {
    let bench = Bench::default();
    assert!(bench.output(&["config", "check"]).contains("fan_lag"));
    let printed = bench.output(&["config", "print"]);
    bench.write("again.toml", &printed);
    assert_eq!(bench.output(&["config", "print", "--config", "again.toml"]), printed);
}

#[test]
fn every_command_explains_itself_and_its_flags() {
    let bench = Bench::default();
    let help = bench.output(&["--help"]);
    for command in ["run", "simulate", "measure", "replay", "diagnose", "identify", "config", "log"] {
        assert!(help.contains(&format!("  {command} ")), "{help}");
    }
    for command in ["run", "simulate"] {
        let help = bench.output(&[command, "--help"]);
        for flag in ["--config", "--patch", "--experiment", "--log", "--seed", "--duration", "--plot", "--json"] {
            assert!(help.contains(flag), "airball {command} --help: {flag}");
        }
    }
    for command in ["replay", "diagnose"] {
        let help = bench.output(&[command, "--help"]);
        for flag in ["--config", "--patch", "--plot", "--html", "--json"] {
            assert!(help.contains(flag), "airball {command} --help: {flag}");
        }
    }
    for command in [["design", "pid"], ["identify", "grey-box"], ["identify", "third-pole"]] {
        let help = bench.output(&[&command[..], &["--help"]].concat());
        for flag in ["--config", "--patch-out", "--plot", "--html", "--json"] {
            assert!(help.contains(flag), "airball {command:?} --help: {flag}");
        }
    }
    let help = bench.output(&["measure", "--help"]);
    for flag in
        ["--sim", "--virtual", "--from", "--patch-out", "--plot", "--html", "--json", "noise-floor", "force-curve"]
    {
        assert!(help.contains(flag), "airball measure --help: {flag}");
    }
}

#[test]
fn the_readme_shows_commands_and_files_that_exist() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    for script in ["scripts/fly", "scripts/test"] {
        assert!(readme.contains(script) && root().join(script).exists(), "{script}");
    }
    for link in readme.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        let file = link.split('#').next().unwrap();
        assert!(link.starts_with("http") || root().join(file).exists(), "{link}");
    }
}

#[test]
fn the_commands_of_the_readme_run_and_their_tables_are_what_they_print() {
    let bench = Bench::default();
    for directory in ["docs", "experiments", "data"] {
        std::os::unix::fs::symlink(root().join(directory).canonicalize().unwrap(), bench.path(directory)).unwrap();
    }
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let commands: Vec<&str> = readme.lines().filter_map(|line| line.strip_prefix("    airball ")).collect();
    assert!(commands.len() >= 3, "{commands:?}");
    for command in commands {
        let said = bench.output(&command.split_whitespace().collect::<Vec<_>>());
        for line in said.lines().filter(|line| !command.starts_with("simulate") && !line.starts_with("picture")) {
            assert!(readme.contains(line.trim_end()), "airball {command}: not in the README: {line}");
        }
    }
}
