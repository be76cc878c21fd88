//! Step metrics of a flight: how the ball followed each jump of the setpoint.
//!
//! ```text
//! overshoot   largest excursion beyond the new setpoint, as a share of the jump
//! peak        time from the jump to the first peak beyond the new setpoint, found as in the transient method, if it is
//!             over 2.5 % of the jump: smaller ones are noise
//! settling    time from the jump until the position stays within ±5 % of the jump for a second
//! ```
//!
//! All on the centred mean of five readings, so that one noisy reading decides nothing. A second is enough: air that
//! is never still pushes a settled ball out of any band if one waits for long.
//! Source of the definitions: Åström & Murray, *Feedback Systems*, "Performance Specifications".

use crate::flight::vocabulary::Cycle;
use control::design::step::BAND;
use diagnose::identify::first_peak;

/// A change of the setpoint that counts as a jump, mm: four times a sensor's noise.
const JUMP_MM: f64 = 10.0;
/// A step begins at rest where the ball is at most so far from the old setpoint, percent of the jump: twice the band,
/// because air that is never still moves a settled ball.
pub const AT_REST_PERCENT: f64 = 200.0 * BAND;
/// A jump must be followed for so long to count, seconds: ramps and chirps are no jumps.
const FOLLOWED_S: f64 = 1.0;
/// How long the position must stay within the band, seconds.
const HELD_S: f64 = 1.0;
/// Readings on each side of the centred mean.
const HALF_MEAN: usize = 2;

/// The signals of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// When, seconds.
    pub time_s: f64,
    /// Commanded position, mm. `None`: the controller is off.
    pub setpoint_mm: Option<f64>,
    /// Position, mm, if one was read.
    pub position_mm: Option<f64>,
}

impl From<&Cycle> for Moment {
    fn from(cycle: &Cycle) -> Self {
        Self { time_s: cycle.time_s, setpoint_mm: cycle.setpoint_mm, position_mm: cycle.position_mm }
    }
}

/// The response to one jump of the setpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// When the setpoint jumped, seconds.
    pub time_s: f64,
    /// From where, mm.
    pub from_mm: f64,
    /// To where, mm.
    pub to_mm: f64,
    /// How far the ball was from the old setpoint when the setpoint jumped, percent of the jump.
    pub off_at_start_percent: f64,
    /// Largest excursion beyond the new setpoint, percent of the jump.
    pub overshoot_percent: f64,
    /// Time of the first peak, seconds. `None`: no visible overshoot.
    pub peak_s: Option<f64>,
    /// Time until the position remains within the band, seconds. `None`: it did not before the next jump.
    pub settling_s: Option<f64>,
}

/// A row with a setpoint and a position.
#[derive(Clone, Copy)]
struct Row {
    time_s: f64,
    setpoint_mm: f64,
    position_mm: f64,
}

/// The steps of a flight, in the order of time.
#[must_use]
pub fn steps(cycles: &[Cycle]) -> Vec<Step> {
    steps_of(&cycles.iter().map(Moment::from).collect::<Vec<_>>())
}

/// The steps of any rows in the order of time.
#[must_use]
pub fn steps_of(moments: &[Moment]) -> Vec<Step> {
    // A time without control ends a step; the next step begins at the ball's position then.
    moments.split(|moment| moment.setpoint_mm.is_none()).flat_map(steps_under_control).collect()
}

fn steps_under_control(moments: &[Moment]) -> Vec<Step> {
    let rows: Vec<Row> = moments
        .iter()
        .filter_map(|c| Some(Row { time_s: c.time_s, setpoint_mm: c.setpoint_mm?, position_mm: c.position_mm? }))
        .collect();
    let mut starts: Vec<usize> =
        (1..rows.len()).filter(|&k| (rows[k].setpoint_mm - rows[k - 1].setpoint_mm).abs() >= JUMP_MM).collect();
    // The take-off is a step from the ball's rest position.
    if rows.first().is_some_and(|first| (first.setpoint_mm - first.position_mm).abs() >= JUMP_MM) {
        starts.insert(0, 0);
    }
    let ends = starts.iter().skip(1).copied().chain([rows.len()]);
    starts.iter().zip(ends).filter_map(|(&start, end)| step(&rows, start, end)).collect()
}

fn step(rows: &[Row], start: usize, end: usize) -> Option<Step> {
    let (first, last) = (rows.get(start)?, rows.get(end.checked_sub(1)?)?);
    let constant = rows[start..end].iter().all(|row| (row.setpoint_mm - first.setpoint_mm).abs() < JUMP_MM);
    if !constant || last.time_s - first.time_s < FOLLOWED_S {
        return None;
    }
    let from_mm = if start == 0 { first.position_mm } else { rows[start - 1].setpoint_mm };
    let jump = first.setpoint_mm - from_mm;
    let errors: Vec<(f64, f64)> =
        (start..end).map(|k| (rows[k].time_s, mean_error(&rows[start..end], k - start))).collect();
    let beyond = errors.iter().map(|(_, error)| error * jump.signum()).fold(0.0, f64::max);
    let settled_s = settling(&errors, BAND * jump.abs());
    Some(Step {
        time_s: first.time_s,
        from_mm,
        to_mm: first.setpoint_mm,
        off_at_start_percent: 100.0 * (off_at_start_mm(rows, start) / jump).abs(),
        overshoot_percent: 100.0 * beyond / jump.abs(),
        peak_s: peak_s(&errors, jump),
        settling_s: settled_s.map(|time_s| time_s - first.time_s),
    })
}

/// Position minus the old setpoint before the jump at row `start`: the mean of as many readings as a centred mean has.
fn off_at_start_mm(rows: &[Row], start: usize) -> f64 {
    mean_error_of(&rows[start.saturating_sub(2 * HALF_MEAN + 1)..start])
}

/// Time from the jump to the first peak beyond the new setpoint, if it exceeds half of the band.
fn peak_s(errors: &[(f64, f64)], jump: f64) -> Option<f64> {
    let start_s = errors.first()?.0;
    let shares: Vec<_> = errors.iter().map(|(time_s, error)| (time_s - start_s, 1.0 + error / jump)).collect();
    first_peak(&shares).filter(|(_, height)| *height > 1.0 + BAND / 2.0).map(|(time_s, _)| time_s)
}

/// The first time after which the error remains within `band_mm` for [`HELD_S`].
fn settling(errors: &[(f64, f64)], band_mm: f64) -> Option<f64> {
    let mut since = None;
    for (time_s, error) in errors {
        if error.abs() > band_mm {
            since = None;
        } else if time_s - *since.get_or_insert(*time_s) >= HELD_S {
            return since;
        }
    }
    None
}

/// Position minus setpoint around row `k`, mean of the rows next to it.
fn mean_error(rows: &[Row], k: usize) -> f64 {
    mean_error_of(&rows[k.saturating_sub(HALF_MEAN)..(k + HALF_MEAN + 1).min(rows.len())])
}

/// Position minus setpoint, mean of all rows; 0 without rows.
fn mean_error_of(rows: &[Row]) -> f64 {
    rows.iter().map(|row| row.position_mm - row.setpoint_mm).sum::<f64>() / rows.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::steps;
    use crate::flight::vocabulary::{Cycle, Mode};

    fn cycle(time_s: f64, setpoint_mm: f64, position_mm: f64) -> Cycle {
        Cycle {
            time_s,
            period_s: 0.01,
            lateness_s: 0.0,
            mode: Mode::Flying,
            setpoint_mm: Some(setpoint_mm),
            control_percent: Some(0.0),
            commanded_duty_percent: 21.4,
            duty_percent: 21.4,
            position_mm: Some(position_mm),
            fresh: true,
            position2_mm: None,
            fan_rpm: None,
            velocity_mm_per_s: Some(0.0),
            control_mm_per_s2: None,
            estimated_position_mm: None,
            estimated_fan_percent: None,
            estimated_disturbance_percent: None,
            innovation_mm: None,
            innovation_test_ratio: None,
        }
    }

    #[test]
    fn a_second_order_step_has_the_overshoot_and_settling_of_the_closed_form() {
        // δ = 0.4, ω_n = 5 rad/s: overshoot e^(−πδ/√(1−δ²)); the position leaves ±5 % for the last time near 1.5 s.
        let (delta, omega) = (0.4_f64, 5.0);
        let damped = omega * (1.0 - delta * delta).sqrt();
        let response = |t: f64| {
            let decay = (-delta * omega * t).exp();
            1.0 - decay * ((damped * t).cos() + delta * omega / damped * (damped * t).sin())
        };
        let before = (0..100).map(|k| cycle(f64::from(k) * 0.01, 200.0, 200.0));
        let after =
            (0..500).map(|k| cycle(1.0 + f64::from(k) * 0.01, 400.0, 200.0 + 200.0 * response(f64::from(k) * 0.01)));
        let found = steps(&before.chain(after).collect::<Vec<_>>());
        assert_eq!(found.len(), 1);
        let overshoot = 100.0 * (-std::f64::consts::PI * delta / (1.0 - delta * delta).sqrt()).exp();
        assert!((found[0].overshoot_percent - overshoot).abs() < 0.3, "{found:?}, exact {overshoot} %");
        let peak_s = std::f64::consts::PI / damped;
        assert!((found[0].peak_s.unwrap() - peak_s).abs() < 0.03, "{found:?}, exact {peak_s} s");
        let last_outside = (0..500).map(|k| f64::from(k) * 0.01).rfind(|t| (response(*t) - 1.0).abs() > 0.05).unwrap();
        assert!((found[0].settling_s.unwrap() - last_outside).abs() < 0.03, "{found:?}, exact {last_outside} s");
    }

    #[test]
    fn a_ball_that_stays_away_has_not_settled() {
        let before = (0..100).map(|k| cycle(f64::from(k) * 0.01, 200.0, 200.0));
        let after = (100..400).map(|k| cycle(f64::from(k) * 0.01, 400.0, 300.0));
        let found = steps(&before.chain(after).collect::<Vec<_>>());
        assert_eq!((found.len(), found[0].settling_s, found[0].overshoot_percent), (1, None, 0.0));
        assert_eq!(found[0].peak_s, None);
    }

    #[test]
    fn a_step_knows_how_far_from_rest_the_ball_was_when_it_began() {
        let at = |k: u32| f64::from(k) * 0.01;
        let before = (0..100).map(|k| cycle(at(k), 200.0, if k < 50 { 200.0 } else { 215.0 }));
        let after = (100..300).map(|k| cycle(at(k), 250.0, 250.0));
        let back = (300..500).map(|k| cycle(at(k), 200.0, 200.0));
        let found = steps(&before.chain(after).chain(back).collect::<Vec<_>>());
        // 15 mm of 50 mm, then none.
        let off: Vec<f64> = found.iter().map(|step| step.off_at_start_percent).collect();
        assert_eq!(off, [30.0, 0.0]);
    }

    #[test]
    fn a_stretch_without_control_belongs_to_no_step() {
        let before = (0..300).map(|k| cycle(f64::from(k) * 0.01, 200.0, 200.0));
        let open = (300..400).map(|k| Cycle { setpoint_mm: None, ..cycle(f64::from(k) * 0.01, 0.0, 500.0) });
        let after = (400..700).map(|k| cycle(f64::from(k) * 0.01, 200.0, if k < 450 { 400.0 } else { 200.0 }));
        let found = steps(&before.chain(open).chain(after).collect::<Vec<_>>());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].time_s - 4.0).abs() < 1e-9 && found[0].from_mm == 400.0, "{found:?}");
    }

    #[test]
    fn a_ramp_of_the_setpoint_is_no_step() {
        let ramp: Vec<Cycle> =
            (0..1000).map(|k| cycle(f64::from(k) * 0.01, 200.0 + 0.2 * f64::from(k), 200.0)).collect();
        assert!(steps(&ramp).is_empty());
    }
}
