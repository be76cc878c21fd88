//! Only the catalogue names its effects: no other source does, and a new effect is a module and a line.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use system_tests::root;

/// The sources of a folder, without those of tests.
fn sources(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() && name != "tests" && name != "target" {
            sources(&path, all);
        } else if name.ends_with(".rs")
            && name != "tests.rs"
            && !name.ends_with("_tests.rs")
            && name != "tests_support.rs"
        {
            all.push(path);
        }
    }
}

/// The names of the effects, by their modules.
fn effects() -> Vec<String> {
    let modules = fs::read_dir(root().join("crates/plant/src/effects")).unwrap();
    let names = modules.map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned());
    names.filter(|name| name != "tests").collect()
}

/// Parts of `text`, tests left out, where an effect is named by a string or accessed by its field.
fn named(text: &str, effects: &[String]) -> Vec<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let names = |line: &&str| {
        effects.iter().any(|name| {
            line.contains(&format!("\"{name}\"")) && !line.contains(&format!("[\"compensation\", \"{name}\""))
                || line.contains(&format!("effects.{name}."))
        })
    };
    lines.filter(names).map(|line| line.trim().to_owned()).collect()
}

#[test]
fn no_source_outside_the_catalogue_names_an_effect() {
    let (effects, mut all) = (effects(), Vec::new());
    assert!(effects.len() > 22, "{} effects", effects.len());
    for folder in ["app", "config", "control", "diagnose", "fmu", "fmu-c", "hal", "plant", "python", "rig", "rows"] {
        sources(&root().join("crates").join(folder).join("src"), &mut all);
    }
    sources(&root().join("book/src"), &mut all);
    all.retain(|path| !path.parent().unwrap().ends_with("effects"));
    assert!(all.len() > 200, "{} sources", all.len());
    let found: Vec<String> = all
        .iter()
        .flat_map(|path| {
            named(&fs::read_to_string(path).unwrap(), &effects)
                .into_iter()
                .map(move |line| format!("{}: {line}", path.display()))
        })
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_name_and_a_field_are_seen_and_a_comment_and_a_test_are_not() {
    let effects = ["fan_lag".to_owned()];
    let text = "// \"fan_lag\"\nlet a = \"fan_lag\";\nlet b = model.effects.fan_lag.is_some();\n#[cfg(test)]\nmod tests { \"fan_lag\" }";
    assert_eq!(named(text, &effects).len(), 2);
}

/// An effect for this test: above a height the air pulls the ball down. It defines only what is required.
const LEAKY_PIPE: &str = r#"//! Leaky pipe: above one height the air pulls the ball down.
//!
//! ```text
//! a = −pull·max(x − from, 0)      a in mm/s², pull in 1/s², x and from in mm
//! ```
//!
//! Source: made for a test.

use crate::acts::{Acts, Conditions};
use crate::effect::{Effect, Entry, Similar, Neutral, Param, Scale, Stage, values_in_order};
use serde::{Deserialize, Serialize};

/// A pull that sets in at a height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeakyPipe {
    /// Pull per height, 1/s².
    pub pull_per_s2: f64,
    /// Where it sets in, mm.
    pub from_mm: f64,
}

impl Effect for LeakyPipe {
    const ENTRY: Entry = Entry {
        name: "leaky_pipe",
        stage: Stage::Air,
        params: &[
            Param { name: "pull_per_s2", min: 0.0, max: 100.0, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "from_mm", min: 0.0, max: 1e3, neutral: Neutral::Any(300.0), scale: Scale::Value },
        ],
        sizes: &[&[5.0, 300.0], &[10.0, 250.0]],
        in_a_log: "the ball needs more duty above one height and not below it",
        mend: "seal the pipe above that height, or look for what leans on it",
        similar: &[Similar { name: "height_dependent_flow", distinguished_by: "below one height nothing changes: hold several heights on either side" }],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { force: Some(Self::pull), ..Acts::NONE };

    values_in_order!(pull_per_s2, from_mm);
}

impl LeakyPipe {
    fn pull(&self, now: &Conditions) -> f64 {
        -self.pull_per_s2 * (now.position_mm - self.from_mm).max(0.0)
    }
}
"#;

/// Flies a rig with the effect, and diagnoses it.
const PROOF: &str = r#"
use diagnose::{Options, Recording, Sample, Verdict, diagnose};
use plant::{Effects, Model, Noise, Simulator};

fn main() {
    let belief = Model {
        gain_mm_per_s2_per_percent: 827.2,
        drag_per_s: 3.896,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
        effects: Effects::default(),
    };
    let mut rig = belief.clone();
    assert!(rig.effects.set("leaky_pipe", &[12.0, 280.0]));
    let found = diagnose(&belief, &flight(&rig), &Options::default());
    let named = &found.effects[0];
    let scored = found.rounds[0].iter().find(|one| one.name == "leaky_pipe");
    assert!(scored.is_some_and(|one| one.in_full && one.held_out_gain > 5.0), "{scored:?}");
    assert_eq!((found.verdict, named.candidate.entry.name), (Verdict::Effect, "leaky_pipe"));
    let values = found.mended.model.effects.values("leaky_pipe").unwrap();
    assert!((values[0] / 12.0 - 1.0).abs() < 0.25 && (values[1] - 280.0).abs() < 30.0, "{values:?}");
    assert!(found.patch_toml().contains("[plant.effects.leaky_pipe]"), "{}", found.patch_toml());
    assert!(found.verdict_in_words().contains("leaky pipe"), "{}", found.verdict_in_words());
    println!("{}: {:?}", found.verdict_in_words(), values);
}

/// 60 s of a rig that a PD controller leads through the pipe.
fn flight(rig: &Model) -> Recording {
    let mut simulator = Simulator::new(rig.clone(), 3);
    let (mut last, mut rows) = (0.0, Vec::new());
    for k in 0..3000 {
        let time_s = 0.02 * f64::from(k);
        simulator.advance_to(time_s);
        let position = simulator.reading_mm();
        let setpoint = [150.0, 420.0, 250.0, 480.0, 330.0][(k / 200 % 5) as usize];
        let duty = 21.4 + 0.012 * (setpoint - position) - 0.006 * (position - last) / 0.02;
        last = position;
        let duty_percent = duty.clamp(15.0, 30.0);
        simulator.drive(duty_percent);
        rows.push(Sample { time_s, duty_percent, position_mm: Some(position), ..Sample::default() });
    }
    Recording::new(rows).unwrap()
}
"#;

/// Copies the sources of a crate.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let there = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &there);
        } else {
            fs::copy(&path, &there).unwrap();
        }
    }
}

/// A workspace with copies of the crates that an effect needs, and the effect in them.
fn workspace(folder: &Path) {
    for name in ["control", "formula", "plant", "diagnose"] {
        copy(&root().join("crates").join(name), &folder.join("crates").join(name));
    }
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let members = manifest.lines().find(|line| line.starts_with("members")).unwrap();
    let mine = r#"members = ["crates/control", "crates/formula", "crates/plant", "crates/diagnose", "proof"]"#;
    fs::write(folder.join("Cargo.toml"), manifest.replace(members, mine)).unwrap();
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    fs::create_dir_all(folder.join("proof/src")).unwrap();
    let proof = "[package]\nname = \"proof\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\ndiagnose.workspace = true\nplant.workspace = true\n";
    fs::write(folder.join("proof/Cargo.toml"), proof).unwrap();
    fs::write(folder.join("proof/src/main.rs"), PROOF).unwrap();
    // The module, and its line in the catalogue.
    let effects = folder.join("crates/plant/src/effects.rs");
    fs::write(folder.join("crates/plant/src/effects/leaky_pipe.rs"), LEAKY_PIPE).unwrap();
    let catalogue = fs::read_to_string(&effects).unwrap();
    let catalogue = catalogue.replace("mod quadratic_drag;", "mod leaky_pipe;\nmod quadratic_drag;");
    fs::write(
        effects,
        catalogue.replace("    turbulence: Turbulence,", "    leaky_pipe: LeakyPipe,\n    turbulence: Turbulence,"),
    )
    .unwrap();
}

fn cargo(folder: &Path, arguments: &[&str]) -> String {
    let target = root().join("target/new-effect");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(arguments).current_dir(folder).env("CARGO_TARGET_DIR", target).env_remove("RUSTFLAGS");
    let output = command.output().unwrap();
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "cargo {}: {said}", arguments.join(" "));
    said
}

/// A single quick test needs no optimised build of all tests of the diagnosis, which takes minutes.
const UNOPTIMISED: &str = "profile.dev.package.diagnose.opt-level=0";

/// Slow: it builds the diagnosis once more.
#[test]
fn an_effect_made_for_the_test_in_one_module_and_one_line_is_simulated_filtered_fitted_found_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    workspace(folder.path());
    let said = cargo(folder.path(), &["run", "--quiet", "--offline", "--package", "proof"]);
    assert!(said.contains("that the simulator lacks"), "{said}");
    // The filter's derivatives of every effect of that catalogue agree with its motion.
    let said = cargo(
        folder.path(),
        &[
            "test",
            "--offline",
            "--config",
            UNOPTIMISED,
            "--package",
            "diagnose",
            "--lib",
            "the_transition_of_every_effect",
        ],
    );
    assert!(said.contains("1 passed"), "{said}");
}
