//! Any bytes as somebody's table: refused, or a recording of finite numbers whose time never goes backwards.
#![no_main]

use airball::fuzzing::parse_record;
use libfuzzer_sys::fuzz_target;
use rows::Import;
use std::path::Path;
use std::sync::LazyLock;

/// Another rig's columns, one of them a speed.
static IMPORT: LazyLock<Import> = LazyLock::new(|| {
    toml::from_str(
        "time_s = { column = 't', scale = 0.001 }\nduty_percent = { column = 'u', scale = 100.0 }\n\
         position_mm = { column = 'v', integrate = true }\nfan_rpm = { column = 'rpm' }",
    )
    .expect("an import")
});

fuzz_target!(|bytes: &[u8]| {
    for import in [None, Some(&*IMPORT)] {
        let Ok(log) = parse_record(Path::new("f.csv"), bytes, import) else { continue };
        let samples = log.recording.samples();
        assert!(samples.is_sorted_by_key(|sample| sample.time_s));
        let finite = |value: Option<f64>| value.is_none_or(f64::is_finite);
        for sample in samples {
            assert!(sample.time_s.is_finite() && sample.duty_percent.is_finite(), "{sample:?}");
            assert!([sample.position_mm, sample.setpoint_mm, sample.fan_rpm].into_iter().all(finite), "{sample:?}");
        }
    }
});
