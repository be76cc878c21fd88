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
        let all = with_other_control(tables, slope);
        let lines: Vec<String> = all.into_iter().map(|(key, value)| format!("{key} = {}", shown(value))).collect();
        let message = format!(
            "{value} is of a control value in percent, and behind [compensation] predistortion it is in mm/s²: \
             {wanted:.3} is the same there. Either leave predistortion out, or set all numbers of the control value to \
             what is the same by this curve: {}. By the curve of your own rig `airball measure force-curve --patch-out \
             FILE` sets them, flown without predistortion",
            lines.join(", ")
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

/// A number of a message: no longer than it helps.
fn shown(value: f64) -> String {
    let digits = format!("{value:.4e}").parse().unwrap_or(value);
    format!("{digits:?}")
}

/// Every number of a config whose unit has the control value in it, by its key, for a control value that is `factor`
/// times as large.
pub fn with_other_control(tables: &Tables, factor: f64) -> Vec<(&'static str, f64)> {
    let mut all = Vec::new();
    let mut times = |key, value: Option<f64>, by: f64| all.extend(value.map(|value| (key, value * by)));
    if let Some(set) = &tables.controller {
        let pid = set.pid.as_ref();
        times("controller.pid.kp_per_mm", pid.map(|law| law.kp_per_mm), factor);
        times("controller.pid.rate_limit_per_s", pid.and_then(|law| law.rate_limit_per_s), factor);
        let cascade = set.cascade.as_ref().map(|law| law.velocity_s_per_mm);
        times("controller.cascade.velocity_s_per_mm", cascade, factor);
        let state = set.state_feedback.as_ref();
        times("controller.state_feedback.position_per_mm", state.map(|law| law.position_per_mm), factor);
        times("controller.state_feedback.setpoint_per_mm", state.and_then(|law| law.setpoint_per_mm), factor);
        times("controller.state_feedback.velocity_s_per_mm", state.map(|law| law.velocity_s_per_mm), factor);
        // The gain on the fan's state has no unit: control value per control value.
        let lqg = set.lqg.as_ref();
        times("controller.lqg.position_per_mm", lqg.map(|law| law.position_per_mm), factor);
        times("controller.lqg.velocity_s_per_mm", lqg.map(|law| law.velocity_s_per_mm), factor);
        times("controller.mpc.control", set.mpc.as_ref().map(|law| law.control), factor);
        times("controller.open_loop.control", set.open_loop.as_ref().map(|law| law.control), factor);
    }
    if let Some(observer) = &tables.observer {
        let gain = observer.believed.gain_mm_per_s2_per_control;
        times("observer.believed.gain_mm_per_s2_per_control", Some(gain), factor.recip());
        times("observer.disturbance_psd_per_s", observer.disturbance_psd_per_s, factor * factor);
        let tachometer = observer.tachometer.as_ref();
        times("observer.tachometer.control", tachometer.map(|one| one.control), factor);
        times("observer.tachometer.psd_per_s", tachometer.map(|one| one.psd_per_s), factor * factor);
    }
    all
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
