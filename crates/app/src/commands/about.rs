//! Where a model is linearised: `--about-duty` and `--about-height`.

use crate::cli::AboutArgs;
use crate::report::kit::about::About;
use anyhow::{Result, bail};
use plant::{Model, Slopes};

/// The height and duty that were asked for, with the slopes of the model there; `None`: neither flag was given.
///
/// # Errors
/// A duty or a height that the rig does not have, or one at which more duty does not push the ball more.
pub(super) fn asked(model: &Model, args: AboutArgs) -> Result<Option<About>> {
    if args.about_duty.is_none() && args.about_height.is_none() {
        return Ok(None);
    }
    let duty_percent = args.about_duty.unwrap_or(model.hover_duty_percent);
    let position_mm = args.about_height.unwrap_or(model.middle_mm());
    if !(0.0..=100.0).contains(&duty_percent) {
        bail!(
            "--about-duty {duty_percent}: give 0 to 100 %, for instance the model's hover, {}",
            model.hover_duty_percent
        );
    }
    let (bottom, top) = model.pipe_mm();
    if !(bottom..=top).contains(&position_mm) {
        bail!("--about-height {position_mm}: give a height within the pipe, {bottom} to {top} mm");
    }
    let Slopes { gain_mm_per_s2_per_percent, drag_per_s, gradient_per_s2 } = model.slopes_at(position_mm, duty_percent);
    let bounded = gain_mm_per_s2_per_percent.is_finite() && drag_per_s.is_finite() && gradient_per_s2.is_finite();
    if !bounded || gain_mm_per_s2_per_percent <= 0.0 || drag_per_s < 0.0 {
        bail!(
            "at {duty_percent} % and {position_mm} mm the model has a gain of {gain_mm_per_s2_per_percent} mm/s² per percent \
             and a drag of {drag_per_s} 1/s; a linear plant needs a gain above 0 and a drag of 0 or more: take another \
             --about-duty, or switch the effect off that bends the force there"
        );
    }
    Ok(Some(About { duty_percent, position_mm, gain_mm_per_s2_per_percent, drag_per_s, gradient_per_s2 }))
}
