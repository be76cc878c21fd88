//! Gain, drag and hover of a diagnosis: as believed and mended, and whether the believed ones are right.
//!
//! The refit without effects moves these numbers until they imitate what is missing, and closes most of a gap by that.
//! So what it closes does not show that the believed numbers are wrong; their forecasts beside the effects do.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::sentences::decimals;
use crate::answer::verdict::{Verdict, matters};
use crate::select::forecast::error_at_1_s;
use crate::select::search::Search;
use plant::Model;

/// A change of a number by less than this share is none in words. Chosen for three digits.
const SAME: f64 = 0.005;

/// The numbers as believed.
#[derive(Clone, Debug)]
pub(crate) struct BelievedNumbers {
    belief: Model,
    /// Error of forecasts of 1 s with them, beside the effects of the mended model, mm.
    error_mm: Option<f64>,
}

impl BelievedNumbers {
    /// Beside the effects of `mended`.
    pub(crate) fn beside(search: &Search<'_>, mended: &Model) -> Self {
        let error_mm = error_at_1_s(search, &search.with_believed_base(mended));
        Self { belief: search.problem.belief.clone(), error_mm }
    }
}

impl Diagnosis {
    /// Whether the believed numbers forecast as well as the mended ones beside the effects of the mended model.
    pub(super) fn believed_numbers_are_right(&self) -> bool {
        let mended = &self.gaps[2];
        let all = self.believed_numbers.error_mm.zip(mended.error_mm[2]).zip(mended.floor_mm[2]);
        all.is_some_and(|((believed, mended), floor)| !matters(believed - mended, floor, &self.mended.model))
    }

    /// The numbers as believed and mended, in one line; `None` where no patch changes them.
    #[must_use]
    pub fn numbers_in_words(&self) -> Option<String> {
        if matches!(self.verdict, Verdict::NoGap | Verdict::InsufficientData) {
            return None;
        }
        let [belief, mended] = [&self.believed_numbers.belief, &self.mended.model];
        let all = [
            ("gain", belief.gain_mm_per_s2_per_percent, mended.gain_mm_per_s2_per_percent, "mm/s² per %"),
            ("drag", belief.drag_per_s, mended.drag_per_s, "/s"),
            ("hover", belief.hover_duty_percent, mended.hover_duty_percent, "%"),
        ];
        let is_same = |believed: f64, mended: f64| (mended - believed).abs() <= SAME * believed.abs().max(mended.abs());
        let digits = |value: f64| format!("{:.*}", decimals(value), value + 0.0);
        let changed = all.into_iter().filter(|(_, believed, mended, _)| !is_same(*believed, *mended));
        let changed: Vec<String> = changed
            .map(|(name, believed, mended, unit)| format!("{name} {} → {} {unit}", digits(believed), digits(mended)))
            .collect();
        let has_effects = mended.effects.present().len() > belief.effects.present().len();
        let as_well = if has_effects && self.believed_numbers_are_right() {
            "; beside the effects the believed numbers forecast as well"
        } else {
            ""
        };
        (!changed.is_empty()).then(|| format!("numbers, believed → mended: {}{as_well}", changed.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use crate::answer::verdict::Verdict;
    use crate::options::Options;
    use crate::tests_support::{model, shaken};
    use crate::{Diagnosis, diagnose};
    use plant::effects::TransportDelay;
    use plant::{Effect, Effects, Model};

    /// The diagnosis of a rig whose gain is this share of the believed one, with this dead time.
    fn found_of(share: f64, delay_s: f64) -> Diagnosis {
        let mut belief = model();
        belief.noise.sensor_mm = 0.3;
        belief.noise.acceleration_psd_mm2_per_s3 = 1.0;
        belief.effects = Effects::default();
        let gain_mm_per_s2_per_percent = share * belief.gain_mm_per_s2_per_percent;
        let mut rig = Model { gain_mm_per_s2_per_percent, ..belief.clone() };
        rig.effects.set(TransportDelay::ENTRY.name, &[delay_s]);
        let options = Options { without_formula: true, ..Options::default() };
        diagnose(&belief, &shaken(&rig, 4, 60), &options)
    }

    #[test]
    fn the_numbers_are_blamed_where_they_are_wrong_and_not_where_they_only_imitate_an_effect() {
        let wrong = found_of(0.7, 0.0);
        assert_eq!(wrong.verdict, Verdict::Parameters, "{}", wrong.verdict_in_words());
        assert!(!wrong.believed_numbers_are_right());
        assert!(wrong.numbers_in_words().unwrap().starts_with("numbers, believed → mended: gain "));
        let late = found_of(1.0, 0.08);
        assert!(late.believed_numbers_are_right(), "{:?}", late.numbers_in_words());
        assert!(!late.verdict_in_words().contains("numbers are off"), "{}", late.verdict_in_words());
    }
}
