//! A case as the scorer reads it, independent of the scored program: the record, and the belief of its rig's owner.

use anyhow::{Context, Result, ensure};
use diagnose::Recording;
use plant::Model;
use rows::Import;
use serde::Deserialize;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// First bytes of a zstd frame (RFC 8878).
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Largest size of a record: a small file could otherwise unpack to fill the memory.
const MOST_BYTES: u64 = 1 << 30;

/// A record and a belief about it.
pub(crate) struct Case {
    /// What the owner believes.
    pub(crate) belief: Model,
    /// The rows as they were read.
    pub(crate) recording: Recording,
}

/// The tables of a config that the scorer needs. The scored program checks the others.
#[derive(Deserialize)]
struct Belief {
    plant: Model,
    #[serde(default)]
    import: Import,
}

impl Case {
    /// Reads both files.
    pub(crate) fn read(record: &Path, belief: &Path) -> Result<Self> {
        let name = belief.display();
        let text = std::fs::read_to_string(belief).with_context(|| format!("cannot read {name}; check the name"))?;
        let read: Belief = toml::from_str(&text).with_context(|| {
            format!("{name} is no config with a table [plant]; check it with `airball config check`")
        })?;
        if let Err((table, error)) = read.plant.check() {
            anyhow::bail!("{name}: {table}.{}: check it with `airball config check`", error.key());
        }
        let name = record.display().to_string();
        let bytes = std::fs::read(record).with_context(|| format!("cannot read {name}; check the name"))?;
        let bytes = unpacked(&bytes).with_context(|| format!("cannot unpack {name} (zstd); copy the file again"))?;
        Ok(Self { belief: read.plant, recording: rows::recording(&name, &bytes, &read.import)? })
    }
}

/// The unpacked bytes, or the bytes themselves if they are not packed.
fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>> {
    if !bytes.starts_with(&MAGIC) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut unpacked = Vec::new();
    zstd::Decoder::new(bytes)?.take(MOST_BYTES + 1).read_to_end(&mut unpacked)?;
    ensure!(unpacked.len() as u64 <= MOST_BYTES, "it holds more than {MOST_BYTES} bytes");
    Ok(Cow::Owned(unpacked))
}

#[cfg(test)]
mod tests {
    use super::Case;

    const BELIEF: &str = "period_s = 0.02\n[plant]\ngain_mm_per_s2_per_percent = 250.0\ndrag_per_s = 1.9\n\
        hover_duty_percent = 21.4\npipe_length_mm = 600.0\n[plant.noise]\nsensor_mm = 2.0\n\
        acceleration_psd_mm2_per_s3 = 360.0\n[import]\nposition_mm = { column = \"y\", scale = 10.0 }\n";

    fn table() -> String {
        let rows: String = (0..60).map(|k| format!("{k},20,{k}\n")).collect();
        format!("time_s,duty_percent,y\n{rows}")
    }

    #[test]
    fn a_packed_record_is_the_same_case_and_its_columns_are_those_of_the_belief() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        let belief = file("a.toml", BELIEF.as_bytes());
        let plain = Case::read(&file("a.csv", table().as_bytes()), &belief).unwrap();
        let packed = zstd::encode_all(table().as_bytes(), 19).unwrap();
        let read = Case::read(&file("a.csv.zst", &packed), &belief).unwrap();
        assert_eq!((&read.recording, &read.belief), (&plain.recording, &plain.belief));
        assert_eq!(read.recording.samples()[3].position_mm, Some(30.0));
        let error = Case::read(&file("cut.csv.zst", &packed[..packed.len() - 3]), &belief).err().unwrap();
        assert!(error.to_string().starts_with("cannot unpack "), "{error}");
    }

    #[test]
    fn a_belief_that_is_not_there_or_not_sound_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        std::fs::write(place("a.csv"), table()).unwrap();
        std::fs::write(place("a.toml"), BELIEF.replace("600.0", "-600.0")).unwrap();
        for (belief, words) in [("none.toml", "none.toml"), ("a.toml", "pipe_length_mm"), ("a.csv", "[plant]")] {
            let error = Case::read(&place("a.csv"), &place(belief)).err().unwrap().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
