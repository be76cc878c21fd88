//! Experiments that can be started in flight, by name.
//!
//! The program has safe ones of its own; `[mqtt] experiments` adds files of the rig. All are read and checked before
//! the flight, so that in flight only a name is sent.

use super::Experiment;
use crate::flight::name::{LONGEST, Name};
use config::{ConfigError, Safety};
use std::path::{Path, PathBuf};

/// The program's own: name of the file in the project, and its text.
const OWN: [(&str, &str); 4] = [
    ("experiments/steps.toml", include_str!("../../../../../experiments/steps.toml")),
    ("experiments/square.toml", include_str!("../../../../../experiments/square.toml")),
    ("experiments/slow-ramp.toml", include_str!("../../../../../experiments/slow-ramp.toml")),
    ("experiments/identify.toml", include_str!("../../../../../experiments/identify.toml")),
];

/// An experiment that may be started by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// The file's name without its ending.
    pub name: Name,
    /// The experiment.
    pub experiment: Experiment,
}

/// All offers of a rig with these limits: the program's own as far as they are safe there, then `files`; a file
/// replaces an experiment of the same name.
///
/// # Errors
/// [`ConfigError`] names the file and what is wrong in it.
pub fn offers(files: &[PathBuf], safety: &Safety) -> Result<Vec<Offer>, ConfigError> {
    let own = OWN.iter().filter_map(|(file, text)| {
        let experiment = Experiment::own(file, text, safety).ok()?;
        Some(Offer { name: name_of(Path::new(file))?, experiment })
    });
    let mut all: Vec<Offer> = own.collect();
    for file in files {
        let experiment = Experiment::of_file(file, safety, "`[mqtt] experiments`")?;
        let name = name_of(file).ok_or_else(|| ConfigError::Contradiction {
            place: file.display().to_string(),
            message: format!(
                "an experiment is started by its file's name, and this is none; use 1 to {LONGEST} letters, digits, \
                 `-`, `_` or `.`"
            ),
        })?;
        all.retain(|offer| offer.name != name);
        all.push(Offer { name, experiment });
    }
    Ok(all)
}

fn name_of(file: &Path) -> Option<Name> {
    Name::new(file.file_stem()?.to_str()?)
}

#[cfg(test)]
mod tests {
    use super::{LONGEST, Name, OWN, offers};
    use config::Config;
    use std::path::{Path, PathBuf};

    fn safety() -> config::Safety {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        Config::read(&root.join("config.toml"), &[]).unwrap().tables.safety.unwrap()
    }

    fn names(files: &[PathBuf]) -> Vec<String> {
        offers(files, &safety()).unwrap().iter().map(|offer| offer.name.to_string()).collect()
    }

    #[test]
    fn a_name_is_a_short_word_and_nothing_else() {
        for word in ["", "a b", "a/b", "ž", "a\0", &"x".repeat(LONGEST + 1)] {
            assert_eq!(Name::new(word), None, "{word:?}");
        }
        let longest = "x".repeat(LONGEST);
        assert_eq!(Name::new(&longest).unwrap().as_str(), longest);
        assert_eq!(serde_json::to_string(&Name::new("slow-ramp")).unwrap(), "\"slow-ramp\"");
    }

    #[test]
    fn the_rig_of_the_project_offers_all_of_the_programs_own() {
        assert_eq!(names(&[]), ["steps", "square", "slow-ramp", "identify"]);
    }

    #[test]
    fn what_is_unsafe_on_a_rig_is_not_on_offer_there() {
        let low = config::Safety { setpoint_max_mm: 300.0, ..safety() };
        assert!(offers(&[], &low).unwrap().len() < OWN.len());
    }

    #[test]
    fn a_file_of_the_rig_takes_the_place_of_one_of_the_same_name_and_a_bad_one_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("square.toml");
        let text = "title = 'mine'\n[[segment]]\nduration_s = 4.0\nsetpoint_mm.constant = { value = 250.0 }\n";
        std::fs::write(&file, text).unwrap();
        assert_eq!(names(std::slice::from_ref(&file)), ["steps", "slow-ramp", "identify", "square"]);
        let offered = offers(std::slice::from_ref(&file), &safety()).unwrap();
        assert_eq!(offered[3].experiment.title, "mine");
        std::fs::write(&file, text.replace("250.0", "5000.0")).unwrap();
        let error = offers(&[file], &safety()).unwrap_err().to_string();
        assert!(error.contains("square.toml:4") && error.contains("5000"), "{error}");
        let gone = offers(&[folder.path().join("gone.toml")], &safety()).unwrap_err().to_string();
        assert!(gone.contains("gone.toml") && gone.contains("`[mqtt] experiments`"), "{gone}");
    }
}
