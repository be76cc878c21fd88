//! Units behind a predistortion: the control value is an acceleration, and gains of a config without it are too small
//! by the force per percent of duty, hundreds of times.
//!
//! ```text
//! S = force per percent at hover      [observer.believed] gain: 1 converted, S not      K_p: ω² converted, ω²/S not
//! ```

use super::tables::Tables;
use control::predistortion::Predistortion;

/// Half the duties about hover between which the force per percent is taken, percent.
const ABOUT_HOVER_PERCENT: f64 = 1.0;
/// ω² of a position loop of a usual speed, 1/s²: 2 rad/s.
const USUAL_PER_S2: f64 = 4.0;
/// With a smaller force per percent the two units cannot be told apart, and do not differ much.
const TELLING: f64 = 16.0;

/// Whether the gains are those of a control value in percent, behind a predistortion: the key, and what to do.
pub(super) fn check(tables: &Tables) -> Result<(), (&'static str, String)> {
    let curve = tables.compensation.as_ref().and_then(|table| table.predistortion.as_ref());
    let Some(slope) = curve.map(per_percent).filter(|slope| *slope > TELLING) else { return Ok(()) };
    let refused = |key: &'static str, value: f64, wanted: f64| {
        let message = format!(
            "{value} is of a control value in percent, and behind [compensation] predistortion it is in mm/s²: \
             {wanted:.3} is the same there. `airball measure force-curve --patch-out FILE` converts every gain; \
             without new gains, leave predistortion out"
        );
        Err((key, message))
    };
    if let Some(gain) = tables.observer.map(|observer| observer.believed.gain_mm_per_s2_per_control)
        && gain > slope.sqrt()
    {
        return refused("observer.believed.gain_mm_per_s2_per_control", gain, gain / slope);
    }
    match position_gains(tables).into_iter().find(|(_, gain)| *gain > 0.0 && *gain < USUAL_PER_S2 / slope.sqrt()) {
        Some((key, gain)) => refused(key, gain, gain * slope),
        None => Ok(()),
    }
}

/// Force per percent of duty at hover, mm/s².
fn per_percent(curve: &Predistortion) -> f64 {
    let curve = curve.curve();
    (curve.mm_per_s2(ABOUT_HOVER_PERCENT) - curve.mm_per_s2(-ABOUT_HOVER_PERCENT)) / (2.0 * ABOUT_HOVER_PERCENT)
}

/// The gains from position to control value.
fn position_gains(tables: &Tables) -> Vec<(&'static str, f64)> {
    let Some(all) = &tables.controller else { return Vec::new() };
    let gains = [
        ("controller.pid.kp_per_mm", all.pid.as_ref().map(|law| law.kp_per_mm)),
        ("controller.cascade.velocity_s_per_mm", all.cascade.as_ref().map(|c| c.velocity_s_per_mm * c.position_per_s)),
        ("controller.state_feedback.position_per_mm", all.state_feedback.as_ref().map(|law| law.position_per_mm)),
        ("controller.lqg.position_per_mm", all.lqg.as_ref().map(|law| law.position_per_mm)),
    ];
    gains.into_iter().filter_map(|(key, gain)| Some((key, gain?))).collect()
}
