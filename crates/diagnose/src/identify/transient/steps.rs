//! Pulses: the setpoint steps in a sweep of proportional gains.
//!
//! ```text
//! K_p: slope of the control value over the error     share = (y − from − offset)/jump     error = setpoint − y
//! ```
//!
//! K_p comes from the rows of the log. If the control value is not a straight line over the error, the controller was
//! not proportional, or it reached a limit.
//! Source: the thesis, section 3.1.2: five pulses of ±100 mm and five of ±200 mm for each gain, normalised, short ones
//! discarded.

use crate::record::recording::{Recording, Sample};

/// Smallest change of the setpoint that counts as a step, mm.
const JUMP_MM: f64 = 10.0;
/// Smallest number of readings of a pulse.
const FEWEST: usize = 20;
/// A pulse is short if it is shorter than this share of the median.
const SHORT: f64 = 0.75;
/// Where the settled part of a pulse begins, as a share of its length.
const SETTLED: f64 = 0.75;
/// The share of the variance of the control value that the error must explain.
const STRAIGHT: f64 = 0.98;

/// A setpoint step and the response of the ball.
#[derive(Clone, Debug, PartialEq)]
pub struct Pulse {
    /// K_p, percent per mm.
    pub kp_per_mm: f64,
    /// Setpoint before the step, mm.
    pub from_mm: f64,
    /// Size of the step, mm; negative downwards.
    pub jump_mm: f64,
    /// Time since the step in s, and position in mm.
    pub points: Vec<(f64, f64)>,
    /// Mean of position minus setpoint in the settled part, mm.
    pub settled_mm: f64,
}

/// Number of unused steps, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Rejected {
    /// Too short for the ball to settle, or from a position that had not settled: the take-off.
    pub short: usize,
    /// The control value is not proportional to the error.
    pub not_proportional: usize,
}

/// A stretch of constant setpoint.
struct Stretch<'a> {
    setpoint_mm: f64,
    rows: &'a [Sample],
}

impl Stretch<'_> {
    fn seconds(&self) -> f64 {
        crate::record::recording::duration_s(self.rows)
    }
}

/// The pulses of a recording in order of time, and the number of rejected steps.
#[must_use]
pub fn pulses(recording: &Recording) -> (Vec<Pulse>, Rejected) {
    let of_flight = |flight: &std::ops::Range<usize>| pairs(&recording.samples()[flight.clone()]);
    let pairs: Vec<(Stretch<'_>, Stretch<'_>)> = recording.flights().iter().flat_map(of_flight).collect();
    let mut lengths: Vec<f64> = pairs.iter().map(|(_, after)| after.seconds()).collect();
    lengths.sort_by(f64::total_cmp);
    let usual_s = lengths.get(lengths.len() / 2).copied().unwrap_or_default();
    let (mut kept, mut rejected) = (Vec::new(), Rejected::default());
    for (before, after) in &pairs {
        if before.seconds() < SHORT * usual_s || after.seconds() < SHORT * usual_s {
            rejected.short += 1;
            continue;
        }
        match pulse(before.setpoint_mm, after) {
            Some(pulse) => kept.push(pulse),
            None => rejected.not_proportional += 1,
        }
    }
    (kept, rejected)
}

/// Successive stretches of constant setpoint with a step between them.
fn pairs(rows: &[Sample]) -> Vec<(Stretch<'_>, Stretch<'_>)> {
    let same = |a: &Sample, b: &Sample| match (a.setpoint_mm, b.setpoint_mm) {
        (Some(a), Some(b)) => (a - b).abs() < JUMP_MM,
        (a, b) => a.is_none() && b.is_none(),
    };
    let stretch = |rows: &'_ [Sample]| rows.first().and_then(|row| row.setpoint_mm);
    let all: Vec<&[Sample]> = rows.chunk_by(same).collect();
    let both = all.windows(2).filter_map(|pair| {
        let of = |rows| Some(Stretch { setpoint_mm: stretch(rows)?, rows });
        Some((of(pair[0])?, of(pair[1])?))
    });
    both.collect()
}

/// `None` if the control is not proportional.
fn pulse(from_mm: f64, after: &Stretch<'_>) -> Option<Pulse> {
    let start_s = after.rows.first()?.time_s;
    let read = || after.rows.iter().filter_map(|row| Some((row, row.position_mm?)));
    let control = |row: &Sample| row.control_percent.unwrap_or(row.duty_percent);
    let law: Vec<(f64, f64)> = read().map(|(row, mm)| (after.setpoint_mm - mm, control(row))).collect();
    let kp_per_mm = slope(&law)?;
    let settled_from_s = start_s + SETTLED * after.seconds();
    let tail: Vec<f64> =
        read().filter(|(row, _)| row.time_s >= settled_from_s).map(|(_, mm)| mm - after.setpoint_mm).collect();
    Some(Pulse {
        kp_per_mm,
        from_mm,
        jump_mm: after.setpoint_mm - from_mm,
        points: read().map(|(row, mm)| (row.time_s - start_s, mm)).collect(),
        settled_mm: tail.iter().sum::<f64>() / tail.len().max(1) as f64,
    })
}

/// The slope of the second over the first; `None` if they do not lie on a rising line.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| of(p.0 - x, p.1 - y)).sum::<f64>();
    let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
    (points.len() >= FEWEST && xy > 0.0 && xy * xy > STRAIGHT * xx * yy).then(|| xy / xx)
}

#[cfg(test)]
mod tests {
    use super::{Rejected, pulses};
    use crate::{Recording, Sample};

    /// Rows of a ball that follows `setpoint` with a short lag, controlled with gain `kp`, where the control value is
    /// limited to `most`.
    fn flown(setpoint: impl Fn(f64) -> f64, kp: f64, most: f64, seconds: u32) -> Recording {
        let mut position: f64 = 0.0;
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            position += 0.05 * (setpoint(time_s) - position);
            let control = (kp * (setpoint(time_s) - position)).clamp(-most, most);
            let (setpoint_mm, position_mm) = (Some(setpoint(time_s)), Some(position));
            Sample { time_s, setpoint_mm, position_mm, control_percent: Some(control), ..Sample::default() }
        };
        Recording::new((0..50 * seconds).map(row).collect()).unwrap()
    }

    fn square(time_s: f64) -> f64 {
        if time_s % 10.0 < 5.0 { 200.0 } else { 400.0 }
    }

    #[test]
    fn the_gain_of_a_pulse_is_read_off_its_rows() {
        let (found, rejected) = pulses(&flown(square, 0.009, 9.0, 25));
        assert_eq!(
            found.iter().map(|p| (p.from_mm, p.jump_mm)).collect::<Vec<_>>(),
            [(200.0, 200.0), (400.0, -200.0), (200.0, 200.0), (400.0, -200.0)]
        );
        assert!(found.iter().all(|pulse| (pulse.kp_per_mm - 0.009).abs() < 1e-9 && pulse.settled_mm.abs() < 0.01));
        assert_eq!(rejected, Rejected::default());
    }

    #[test]
    fn short_pulses_and_those_at_a_limit_are_rejected() {
        let cut = |time_s: f64| if time_s > 22.0 { 300.0 } else { square(time_s) };
        let (found, rejected) = pulses(&flown(cut, 0.009, 9.0, 30));
        // The pulse at 20 s lasts 2 s, and the next one begins before the ball has settled.
        assert_eq!((found.len(), rejected), (3, Rejected { short: 2, not_proportional: 0 }));
        let (found, rejected) = pulses(&flown(square, 0.009, 0.3, 25));
        assert_eq!((found.len(), rejected), (0, Rejected { short: 0, not_proportional: 4 }));
    }
}
