//! The mended model as a config patch.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::verdict::Verdict;
use plant::Noise;
use std::fmt::Write;

impl Diagnosis {
    /// The mended model as a patch (TOML) for `simulate` and `replay`; empty if nothing changes.
    #[must_use]
    pub fn patch_toml(&self) -> String {
        if matches!(self.verdict, Verdict::NoGap | Verdict::InsufficientData) {
            return String::new();
        }
        let model = &self.mended.model;
        let mut patch = String::from("[plant]\n");
        for (key, value) in [
            ("gain_mm_per_s2_per_percent", model.gain_mm_per_s2_per_percent),
            ("drag_per_s", model.drag_per_s),
            ("hover_duty_percent", model.hover_duty_percent),
        ] {
            // Writing to a string cannot fail.
            let _ = writeln!(patch, "{key} = {value:?}");
        }
        if self.mends_noise {
            let Noise { sensor_mm, acceleration_psd_mm2_per_s3 } = model.noise;
            let _ = writeln!(patch, "\n[plant.noise]\nsensor_mm = {sensor_mm:?}");
            let _ = writeln!(patch, "acceleration_psd_mm2_per_s3 = {acceleration_psd_mm2_per_s3:?}");
        }
        // A patch stands alone: it brings the definitions of what a user wrote.
        for definition in model.effects.written.present() {
            let _ = write!(patch, "\n{definition}");
        }
        for entry in model.effects.present() {
            let _ = writeln!(patch, "\n[plant.effects.{}]", entry.name);
            for (param, value) in entry.params.iter().zip(model.effects.values(entry.name).unwrap_or_default()) {
                let _ = writeln!(patch, "{} = {value:?}", param.name);
            }
        }
        patch
    }
}
