//! A folder of cases: `case-NNN.csv` or `case-NNN.csv.zst`, each with `case-NNN.toml`.

use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The cases of a folder.
pub(crate) struct Folder {
    /// Names with their records, in order.
    pub(crate) records: BTreeMap<String, PathBuf>,
    path: PathBuf,
}

impl Folder {
    /// Finds the cases.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let look = || format!("cannot look into {}; name a folder of cases", path.display());
        let mut records = BTreeMap::new();
        for entry in std::fs::read_dir(path).with_context(look)? {
            let file = entry.with_context(look)?.path();
            if let Some(name) = case_of(&file) {
                records.insert(name, file);
            }
        }
        ensure!(
            !records.is_empty(),
            "{} holds no case-NNN.csv and no case-NNN.csv.zst; name the folder that does",
            path.display()
        );
        Ok(Self { records, path: path.to_owned() })
    }

    /// The belief of the owner of a case's rig.
    pub(crate) fn belief(&self, case: &str) -> PathBuf {
        self.path.join(format!("{case}.toml"))
    }
}

/// The name of the case whose record a file is.
fn case_of(file: &Path) -> Option<String> {
    let name = file.file_name()?.to_str()?;
    let case = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".csv.zst"))?;
    case.starts_with("case-").then(|| case.to_owned())
}

#[cfg(test)]
mod tests {
    use super::Folder;

    #[test]
    fn records_packed_or_not_are_cases_and_nothing_else_is() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["case-b.csv.zst", "case-a.csv", "case-a.toml", "notes.csv", "case-c.json"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = Folder::open(folder.path()).unwrap();
        assert!(found.records.keys().eq(["case-a", "case-b"]), "{:?}", found.records);
    }

    #[test]
    fn a_folder_without_cases_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let error = Folder::open(folder.path()).err().unwrap().to_string();
        assert!(error.contains("no case-NNN.csv"), "{error}");
    }
}
