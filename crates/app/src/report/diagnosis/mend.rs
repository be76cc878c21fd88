//! How to correct an effect on the rig, in words: the text of the catalogue, or, where the rig's compensation is known,
//! its new values.
//!
//! ```text
//! compensation's hover + edge = mended hover + edge of the dead zone      percent of duty
//! ```
//!
//! The duty of a log is the one that the fan received, compensation included: a dead zone found in it is the whole dead
//! zone, not the rest that a correction left.

use config::words::Words;
use control::compensation::{Compensation, DeadZoneCorrection};
use plant::effects::DeadZone;
use plant::{Effect, Entry, Model};

/// An edge of the correction within this distance of the mended one is right, percent of duty: three steps of a 12-bit
/// chip.
const RIGHT_PERCENT: f64 = 0.07;

/// The correction of the effect of `entry`, which `mended` has. `compensation`: the one of the recorded flight.
#[must_use]
pub fn words(entry: &Entry, mended: &Model, compensation: Option<&Compensation>, rig: &Words) -> String {
    let Some((compensation, should)) = needed(entry, mended, compensation) else {
        let elsewhere = Some(entry.mend_elsewhere).filter(|mend| !mend.is_empty() && !rig.is_ball_pipe());
        return elsewhere.unwrap_or(entry.mend).to_owned();
    };
    compensation.dead_zone.map_or_else(|| first_correction(should), |is| correction(is, should))
}

/// The same as a config patch, where the rig's compensation is known and not right already.
#[must_use]
pub fn patch(entry: &Entry, mended: &Model, compensation: Option<&Compensation>) -> Option<String> {
    let (compensation, should) = needed(entry, mended, compensation)?;
    let DeadZoneCorrection { lower_percent, upper_percent } = should;
    let is_needed = compensation.dead_zone.is_none_or(|is| is_off(is, should));
    is_needed.then(|| {
        format!("[compensation.dead_zone]\nlower_percent = {lower_percent:.2}\nupper_percent = {upper_percent:.2}\n")
    })
}

/// The compensation in flight, and the correction of the dead zone that it should have.
fn needed<'a>(
    entry: &Entry,
    mended: &Model,
    compensation: Option<&'a Compensation>,
) -> Option<(&'a Compensation, DeadZoneCorrection)> {
    let zone = mended.effects.get::<DeadZone>().filter(|_| entry.name == DeadZone::ENTRY.name)?;
    let compensation = compensation?;
    let shift = mended.hover_duty_percent - compensation.hover_duty_percent;
    let should = DeadZoneCorrection {
        lower_percent: (zone.lower_percent + shift).clamp(-20.0, 0.0),
        upper_percent: (zone.upper_percent + shift).clamp(0.0, 20.0),
    };
    Some((compensation, should))
}

/// Whether an edge is not where it should be.
fn is_off(is: DeadZoneCorrection, should: DeadZoneCorrection) -> bool {
    let off = |is: f64, should: f64| (is - should).abs() > RIGHT_PERCENT;
    off(is.lower_percent, should.lower_percent) || off(is.upper_percent, should.upper_percent)
}

fn first_correction(should: DeadZoneCorrection) -> String {
    format!(
        "correct it in [compensation.dead_zone] with lower_percent = {:.2}, upper_percent = {:.2}, which count from the hover of \
         [compensation], or take fan and driver with finer steps",
        should.lower_percent, should.upper_percent
    )
}

fn correction(is: DeadZoneCorrection, should: DeadZoneCorrection) -> String {
    let (lower, upper) = (is.lower_percent, is.upper_percent);
    if !is_off(is, should) {
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
    use super::{patch, words};
    use crate::analysis::closed_loop::tests::project;
    use config::words::Words;
    use control::compensation::{Compensation, DeadZoneCorrection};
    use plant::Effects;

    fn said(correction: Option<(f64, f64)>) -> String {
        let mut mended = project().plant.unwrap();
        mended.hover_duty_percent = 21.5;
        mended.effects.set("dead_zone", &[-0.3, 0.3]);
        let zone = |(lower_percent, upper_percent)| DeadZoneCorrection { lower_percent, upper_percent };
        let compensation = Compensation { dead_zone: correction.map(zone), ..Compensation::bare(21.4) };
        words(Effects::built_in("dead_zone").unwrap(), &mended, Some(&compensation), &Words::default())
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
    fn a_correction_can_be_copied_unless_it_is_right_already() {
        let mut mended = project().plant.unwrap();
        mended.hover_duty_percent = 21.5;
        mended.effects.set("dead_zone", &[-0.3, 0.3]);
        let zone = Effects::built_in("dead_zone").unwrap();
        let bare = Compensation::bare(21.4);
        let block = patch(zone, &mended, Some(&bare)).unwrap();
        assert_eq!(block, "[compensation.dead_zone]\nlower_percent = -0.20\nupper_percent = 0.40\n");
        let right = DeadZoneCorrection { lower_percent: -0.2, upper_percent: 0.4 };
        assert_eq!(patch(zone, &mended, Some(&Compensation { dead_zone: Some(right), ..bare })), None);
        assert_eq!(patch(Effects::built_in("fan_lag").unwrap(), &mended, Some(&Compensation::bare(21.4))), None);
    }

    #[test]
    fn other_effects_are_mended_as_the_catalogue_says() {
        let mended = project().plant.unwrap();
        let lag = Effects::built_in("fan_lag").unwrap();
        assert_eq!(words(lag, &mended, project().compensation.as_ref(), &Words::default()), lag.mend);
        // A rig with words of its own has no fan.
        let cart = Words { position: Some("angle".into()), ..Words::default() };
        assert!(!words(lag, &mended, None, &cart).contains("fan"));
    }
}
