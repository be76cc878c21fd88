//! What packages say of the parts of the binary: licence texts and the bill of materials of `scripts/notices`.

use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn every_crate_of_the_binary_and_what_is_no_crate_has_its_licence_text_and_its_line_in_the_bill() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = tempfile::tempdir().unwrap();
    let status = Command::new(root.join("scripts/notices")).arg(folder.path()).status();
    assert!(status.expect("this test needs python3").success());
    let notices = fs::read_to_string(folder.path().join("THIRD-PARTY-NOTICES")).unwrap();
    let bill = fs::read_to_string(folder.path().join("airball.cdx.json")).unwrap();
    let bill: serde_json::Value = serde_json::from_str(&bill).unwrap();
    assert_eq!((&bill["bomFormat"], &bill["specVersion"]), (&"CycloneDX".into(), &"1.5".into()));
    let named: Vec<_> =
        bill["components"].as_array().unwrap().iter().map(|part| part["name"].as_str().unwrap()).collect();
    for part in ["musl", "MQTT.js", "uPlot", "Rust standard library", "ring", "nalgebra", "zstd-sys", "rumqttc-v4-next"]
    {
        assert!(named.contains(&part), "{part} is not in the bill");
    }
    for part in &named {
        assert!(notices.lines().any(|line| line.starts_with(&format!("{part} "))), "{part} has no licence text");
    }
    // Of the parts whose licence asks for it in binaries.
    for words in ["Rich Felker", "Leon Sorokin", "MQTT.js contributors", "Meta Platforms", "Brian Smith"] {
        assert!(notices.contains(words), "{words}");
    }
}
