//! A duty in a single row to which the ball did not respond: the recorder's mistake, or a disturbance of the wire.
//!
//! ```text
//! spike of row k: the smaller distance to the duties before and after it, where both lie on one side
//! spurious: the record is likelier, by the belief, with the duty before it in its place
//! ```
//!
//! A fan that gets one wild duty for one row pushes the ball for seconds. Where it did not, some effect that takes most
//! of a large duty away would be named from this row alone. Only the largest spike of a log is asked about, and none
//! that a controller makes: at a step of the setpoint, or one from which the duty does not return at once.

use crate::fit::log_likelihood::log_likelihood;
use crate::record::check::Finding;
use crate::record::implausible::plausible;
use crate::record::prepare::FlightFinding;
use crate::record::recording::{Recording, Sample};
use plant::Model;
use std::borrow::Cow;

/// A spike stands out that is so many times the next largest, and this share of the range of the other duties. The
/// largest of the 240 records of `tests/blind` is 1.5 times the next: a controller makes many of its noise, and an
/// effect may take a part of each.
const NEXT: f64 = 2.0;
const STANDS_OUT: f64 = 0.25;
/// The duties before and after a mistake of the recorder differ by less than this share of the spike. No rate was
/// measured; it was 0.5 for the spike of a controller at a step of the setpoint, in a record that was refused for it.
const RETURNS: f64 = 0.1;
/// Nats by which the record must be likelier without it: odds of 3000 to 1.
const SPURIOUS: f64 = 8.0;

/// The spurious duty of each log.
pub(crate) fn spurious_duties(belief: &Model, recordings: &[Recording]) -> Vec<FlightFinding> {
    let of_one = |(flight, one)| spurious_duty(belief, one).map(|finding| FlightFinding { flight, finding });
    recordings.iter().enumerate().filter_map(of_one).collect()
}

fn spurious_duty(belief: &Model, recording: &Recording) -> Option<Finding> {
    let row = spike(recording.samples())?;
    let seen = plausible(Cow::Borrowed(recording), belief);
    let mut rows = seen.samples().to_vec();
    let duty_percent = rows[row].duty_percent;
    rows[row].duty_percent = rows[row - 1].duty_percent;
    let likelihood = |one: &Recording| log_likelihood(belief, one, belief, None);
    let without = Recording::new(rows).ok()?;
    // Not a number is no reason either.
    (likelihood(&without) - likelihood(&seen) > SPURIOUS)
        .then_some(Finding::SpuriousDuty { row: row + 1, duty_percent })
}

/// The row of the largest spike, if it stands out.
fn spike(samples: &[Sample]) -> Option<usize> {
    let size = |three: &[Sample]| {
        let [before, after] = [0, 2].map(|other| three[1].duty_percent - three[other].duty_percent);
        if before * after > 0.0 { before.abs().min(after.abs()) } else { 0.0 }
    };
    let (mut at, mut largest, mut next) = (0, 0.0, 0.0_f64);
    for (row, size) in samples.windows(3).map(size).enumerate() {
        if size > largest {
            (at, next, largest) = (row + 1, largest, size);
        } else {
            next = next.max(size);
        }
    }
    let others = samples.iter().enumerate().filter(|(row, _)| *row != at).map(|(_, sample)| sample.duty_percent);
    let (low, high) = others.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), u| (low.min(u), high.max(u)));
    let stands_out = largest > NEXT * next && largest >= STANDS_OUT * (high - low);
    let around = samples.get(at.checked_sub(1)?..at + 2).filter(|_| stands_out)?;
    let returns = (around[2].duty_percent - around[0].duty_percent).abs() < RETURNS * largest;
    (returns && around[0].setpoint_mm == around[1].setpoint_mm).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::{spike, spurious_duties, spurious_duty};
    use crate::tests_support::{model, record};
    use crate::{Finding, Options, Recording, Sample, Verdict, diagnose};
    use plant::Simulator;

    fn spoilt(row: usize, duty_percent: f64) -> Recording {
        let mut rows = record(&model(), 3, 20).samples().to_vec();
        rows[row].duty_percent = duty_percent;
        Recording::new(rows).unwrap()
    }

    #[test]
    fn a_wild_duty_of_one_row_without_a_response_ends_the_diagnosis_with_its_row() {
        assert_eq!(spurious_duty(&model(), &record(&model(), 3, 20)), None);
        for (row, duty_percent) in [(500, 0.0), (200, 1e-300), (700, 100.0), (900, 140.0), (300, -60.0)] {
            let found = spurious_duties(&model(), &[record(&model(), 4, 20), spoilt(row, duty_percent)]);
            let expected = Finding::SpuriousDuty { row: row + 1, duty_percent };
            assert!(found.len() == 1 && found[0].flight == 1 && found[0].finding == expected, "{found:?}");
        }
        let found = diagnose(&model(), &spoilt(500, 0.0), &Options::default());
        assert_eq!((found.verdict, found.effects.len()), (Verdict::InsufficientData, 0));
        let said = found.findings.iter().map(|noted| noted.finding.to_string()).collect::<String>();
        assert!(said.contains("row 501"), "{said}");
    }

    #[test]
    fn a_duty_that_a_controller_gives_at_a_step_is_no_mistake() {
        let mut rows = spoilt(500, 0.0).samples().to_vec();
        assert_eq!(spike(&rows), Some(500));
        // The duty returns over several rows.
        rows[501].duty_percent = 16.0;
        assert_eq!(spike(&rows), None);
        // The setpoint changes.
        let mut rows = spoilt(500, 0.0).samples().to_vec();
        let setpoint_mm = |row: usize| Some(if row < 500 { 380.0 } else { 235.0 });
        rows.iter_mut().enumerate().for_each(|(row, sample)| sample.setpoint_mm = setpoint_mm(row));
        assert_eq!(spike(&rows), None);
    }

    #[test]
    fn a_wild_duty_with_a_response_is_no_mistake() {
        let rig = model();
        let mut simulator = Simulator::new(rig.clone(), 8);
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            let reading = simulator.reading_mm();
            let duty_percent = if k == 500 { 60.0 } else { 21.4 + 0.01 * (300.0 - reading) };
            simulator.drive(duty_percent);
            Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
        };
        let record = Recording::new((0..1000).map(row).collect()).unwrap();
        assert_eq!(spike(record.samples()), Some(500));
        assert_eq!(spurious_duty(&rig, &record), None);
    }
}
