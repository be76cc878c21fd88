//! How to correct an effect on the rig, in words: the text of the catalogue, or, where the rig's compensation is known,
//! its new values.
//!
//! ```text
//! compensation's hover + edge = mended hover + edge of the dead zone      percent of duty
//! ```
//!
//! The duty of a log is the one that the fan received, compensation included: a dead zone found in it is the whole dead
//! zone, not the rest that a correction left.

use control::compensation::{Compensation, DeadZoneCorrection};
use plant::effects::DeadZone;
use plant::{Effect, Entry, Model};

/// An edge of the correction within this distance of the mended one is right, percent of duty: three steps of a 12-bit
/// chip.
const RIGHT_PERCENT: f64 = 0.07;

/// The correction of the effect of `entry`, which `mended` has. `compensation`: the one of the recorded flight.
#[must_use]
pub fn words(entry: &Entry, mended: &Model, compensation: Option<&Compensation>) -> String {
    let zone = mended.effects.get::<DeadZone>().filter(|_| entry.name == DeadZone::ENTRY.name);
    let Some((compensation, zone)) = compensation.zip(zone) else { return entry.mend.to_owned() };
    let shift = mended.hover_duty_percent - compensation.hover_duty_percent;
    let should = DeadZoneCorrection {
        lower_percent: (zone.lower_percent + shift).clamp(-20.0, 0.0),
        upper_percent: (zone.upper_percent + shift).clamp(0.0, 20.0),
    };
    compensation.dead_zone.map_or_else(|| first_correction(should), |is| correction(is, should))
}

fn first_correction(should: DeadZoneCorrection) -> String {
    format!(
        "correct it in [compensation.dead_zone] with lower_percent = {:.2}, upper_percent = {:.2}, which count from the hover of \
         [compensation], or take fan and driver with finer steps",
        should.lower_percent, should.upper_percent
    )
}

fn correction(is: DeadZoneCorrection, should: DeadZoneCorrection) -> String {
    let off = |is: f64, should: f64| (is - should).abs() > RIGHT_PERCENT;
    let (lower, upper) = (is.lower_percent, is.upper_percent);
    if !off(lower, should.lower_percent) && !off(upper, should.upper_percent) {
        return format!(
            "[compensation.dead_zone] was on and corrects it already ({lower:.2} to {upper:.2} %): only the simulator lacks it"
        );
    }
    format!(
        "[compensation.dead_zone] was on with {lower:.2} to {upper:.2} %: set lower_percent = {:.2}, upper_percent = {:.2}",
        should.lower_percent, should.upper_percent
    )
}

#[cfg(test)]
mod tests {
    use super::words;
    use crate::analysis::closed_loop::tests::project;
    use control::compensation::{Compensation, DeadZoneCorrection};
    use plant::Effects;

    fn said(correction: Option<(f64, f64)>) -> String {
        let mut mended = project().plant.unwrap();
        mended.hover_duty_percent = 21.5;
        mended.effects.set("dead_zone", &[-0.3, 0.3]);
        let zone = |(lower_percent, upper_percent)| DeadZoneCorrection { lower_percent, upper_percent };
        let compensation = Compensation { dead_zone: correction.map(zone), ..Compensation::bare(21.4) };
        words(Effects::built_in("dead_zone").unwrap(), &mended, Some(&compensation))
    }

    #[test]
    fn a_correction_is_given_numbers_about_its_own_hover() {
        assert!(said(None).contains("lower_percent = -0.20, upper_percent = 0.40"), "{}", said(None));
        let change = said(Some((-0.1, 0.1)));
        assert!(change.ends_with("set lower_percent = -0.20, upper_percent = 0.40"), "{change}");
        let right = said(Some((-0.2, 0.4)));
        assert!(right.contains("corrects it already"), "{right}");
    }

    #[test]
    fn other_effects_are_mended_as_the_catalogue_says() {
        let mended = project().plant.unwrap();
        let lag = Effects::built_in("fan_lag").unwrap();
        assert_eq!(words(lag, &mended, project().compensation.as_ref()), lag.mend);
    }
}
