//! Numbers of a record that no rig can have: duties far from any percent, and readings far from the pipe.
//!
//! A duty has no neighbour that could stand in for it, so one that is implausible ends the diagnosis. A reading is only
//! a look at the ball: without it, the filter goes on.

use crate::record::check::{Finding, without_codes};
use crate::record::corrections::duty;
use crate::record::recording::{Recording, Sample};
use crate::record::units::{OTHER_HOVER, nearest_scale};
use crate::stats::median::median;
use plant::Model;
use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};

/// Duties beyond this are no percent, in either direction: 100, with room for a wrong offset of the import.
pub(crate) const NO_PERCENT: f64 = 150.0;
/// The same in believed hover duties, and for single rows in usual duties, for a rig whose duty is not in percent. No
/// flight of the 240 of the committed verdicts comes near.
const TIMES: f64 = 7.0;
/// Where more than this share of the readings is implausible, their unit is wrong, and none is removed.
const UNIT: f64 = 0.1;
/// A scale that gives the believed hover within this factor is that of the counts.
const NEAR: f64 = 2.0;
/// A reading further outside the pipe than this share of its length is no position of the ball. None of the same
/// flights has one.
const FAR: f64 = 0.5;
/// A reading that jumps by this share of the pipe's length and back is none either. The largest jump of the same
/// flights is 0.61: a sensor's outlier, which the diagnosis models.
const JUMP: f64 = 0.75;
/// No ball moves there and back in this time, seconds.
const THERE_AND_BACK_S: f64 = 0.2;
/// Beyond this no fan turns, revolutions per minute.
const FASTEST_RPM: f64 = 1e6;

/// What to do about duties beyond any percent.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(transparent)]
pub struct DutyScale(pub(crate) Option<f64>);

impl Display for DutyScale {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(scale) => {
                write!(f, "the column holds another unit; if it is counts, write under [import]: {}", duty(scale))
            }
            None => write!(f, "remove these rows or mend the recorder"),
        }
    }
}

/// The finding about duties that are no percent. The median of a flight in the air is near hover: where it is far
/// beyond, the unit is wrong. A single row is compared with the others too, since a rig whose hover is near 0 may have
/// an input of any unit.
pub(crate) fn duty_beyond_percent(samples: &[Sample], model: &Model) -> Option<Finding> {
    let unit_percent = NO_PERCENT.max(TIMES * model.hover_duty_percent.abs());
    let middle = median(samples.iter().map(|sample| sample.duty_percent).collect())?.abs();
    let usual = median(samples.iter().map(|sample| sample.duty_percent.abs()).collect())?;
    let is_other_unit = middle > unit_percent;
    let limit_percent = if is_other_unit { unit_percent } else { unit_percent.max(TIMES * usual) };
    let is_beyond = |sample: &Sample| sample.duty_percent.abs() > limit_percent;
    let first = samples.iter().position(is_beyond)?;
    let count = samples.iter().filter(|sample| is_beyond(sample)).count();
    if is_other_unit && looks_exchanged(samples, model) {
        return Some(Finding::Exchanged);
    }
    let scale = DutyScale(is_other_unit.then(|| scale(usual, model.hover_duty_percent.abs())));
    Some(Finding::DutyBeyondPercent {
        count,
        row: first + 1,
        duty_percent: samples[first].duty_percent,
        limit_percent,
        scale,
    })
}

/// Whether the duties lie where positions of the ball are believed, and the positions near the believed hover.
fn looks_exchanged(samples: &[Sample], model: &Model) -> bool {
    let duty = median(samples.iter().map(|sample| sample.duty_percent).collect());
    let position = median(samples.iter().filter_map(|sample| sample.position_mm).collect());
    let (bottom, top) = model.pipe_mm();
    let is_position = duty.is_some_and(|duty| (bottom..=top).contains(&duty));
    let is_hover = position.map(|position| position / model.hover_duty_percent);
    is_position && is_hover.is_some_and(|ratio| ratio > 0.0 && ratio.ln().abs() < OTHER_HOVER.ln())
}

/// The finding about duties far below what holds a ball, the other side of the same limit. Duties of 0 are a fan at
/// rest. With a force over the position, as of a spring, what holds the ball differs from place to place, and a record
/// leaves the hover open: −21 to −2 % on a seesaw that mostly lay at 0.4 %.
pub(crate) fn duty_far_below_hover(samples: &[Sample], model: &Model) -> Option<Finding> {
    let usual_percent = median(samples.iter().map(|sample| sample.duty_percent.abs()).collect())?;
    let hover_percent = model.hover_duty_percent.abs();
    let (bottom, top) = model.pipe_mm();
    let holds_alike = model.force_at_rest(bottom) == model.force_at_rest(top);
    (holds_alike && usual_percent > 0.0 && usual_percent < hover_percent / TIMES).then(|| {
        let counts = || (scale(usual_percent, hover_percent), 0.0);
        let (scale, offset_percent) = symmetric(samples, model.hover_duty_percent).unwrap_or_else(counts);
        Finding::DutyFarBelowHover { usual_percent, hover_percent, scale, offset_percent }
    })
}

/// Scale and offset of duties from −1 to 1 that stand for 0 to 100 %, if the usual one is then near the believed hover.
fn symmetric(samples: &[Sample], hover_percent: f64) -> Option<(f64, f64)> {
    let usual = median(samples.iter().map(|sample| sample.duty_percent).collect())?;
    let hover = (50.0 * usual + 50.0) / hover_percent;
    let is_symmetric = samples.iter().all(|sample| sample.duty_percent.abs() <= 1.0);
    (is_symmetric && hover > 0.0 && hover.ln().abs() < NEAR.ln()).then_some((50.0, 50.0))
}

/// Percent per count: of the chip whose counts come nearest to the believed hover; of none, what gives that hover.
fn scale(usual: f64, hover_percent: f64) -> f64 {
    let wanted = if hover_percent > 0.0 { hover_percent / usual } else { 100.0 / usual };
    nearest_scale(wanted, NEAR)
}

/// The finding about readings that are no position of the ball; `is_code` tells codes of the sensor, which are
/// another finding.
pub(crate) fn implausible_readings(
    samples: &[Sample],
    model: &Model,
    is_code: impl Fn(f64) -> bool,
) -> Option<Finding> {
    let rows = implausible_rows(samples, model);
    let no_codes = rows.iter().filter_map(|row| Some((*row, samples[*row].position_mm.filter(|mm| !is_code(*mm))?)));
    let (first, reading_mm) = no_codes.clone().next()?;
    Some(Finding::ImplausibleReadings { count: no_codes.count(), row: first + 1, reading_mm })
}

/// The rows whose reading is no position of the ball; none where they are many: then the unit is wrong.
fn implausible_rows(samples: &[Sample], model: &Model) -> Vec<usize> {
    let readings: Vec<(usize, f64)> =
        samples.iter().enumerate().filter_map(|(row, sample)| Some((row, sample.position_mm?))).collect();
    let near: Vec<(usize, f64)> = readings.iter().copied().filter(|(_, mm)| !is_far(*mm, model)).collect();
    let jumps = near.windows(3).filter(|three| {
        let [(from, before), (_, mm), (to, after)] = [three[0], three[1], three[2]];
        let limit_mm = JUMP * model.pipe_length_mm;
        let quick = samples[to].time_s - samples[from].time_s < THERE_AND_BACK_S;
        quick && (mm - before).abs() > limit_mm && (mm - after).abs() > limit_mm && (mm - before) * (mm - after) > 0.0
    });
    let far = readings.iter().filter(|(_, mm)| is_far(*mm, model)).map(|(row, _)| *row);
    let mut rows: Vec<usize> = far.chain(jumps.map(|three| three[1].0)).collect();
    let many = rows.len() as f64 > UNIT * readings.len() as f64;
    rows.sort_unstable();
    rows.retain(|_| !many);
    rows
}

fn is_far(position_mm: f64, model: &Model) -> bool {
    let (bottom, top) = model.pipe_mm();
    (bottom - position_mm).max(position_mm - top) > FAR * model.pipe_length_mm
}

/// The recording without codes of a sensor that saw no target, and without readings and fan speeds that cannot be.
#[must_use]
pub fn plausible<'a>(recording: Cow<'a, Recording>, model: &Model) -> Cow<'a, Recording> {
    let seen = without_codes(&recording).map_or(recording, Cow::Owned);
    without_implausible_readings(&seen, model).map_or(seen, Cow::Owned)
}

/// The recording without the readings that are no position of the ball, and without implausible fan speeds; `None` if
/// it has none of them, or too few others.
fn without_implausible_readings(recording: &Recording, model: &Model) -> Option<Recording> {
    let is_near = |mm: &f64| !is_far(*mm, model);
    let turns = |rpm: &f64| rpm.abs() < FASTEST_RPM;
    let mut samples = recording.samples().to_vec();
    implausible_rows(&samples, model).into_iter().for_each(|row| samples[row].position_mm = None);
    for sample in &mut samples {
        sample.position2_mm = sample.position2_mm.filter(is_near);
        sample.fan_rpm = sample.fan_rpm.filter(turns);
    }
    (samples != recording.samples()).then(|| Recording::new(samples).ok())?
}

#[cfg(test)]
mod tests {
    use super::{duty_beyond_percent, duty_far_below_hover, scale, without_implausible_readings};
    use crate::gap::forecast_error::Gap;
    use crate::record::check::Finding;
    use crate::tests_support::{model, record};
    use crate::{Options, Recording, Sample, Verdict, diagnose};
    use plant::Model;

    fn rows_where(spoil: impl Fn(usize, &mut Sample)) -> Recording {
        let mut rows = record(&model(), 1, 40).samples().to_vec();
        rows.iter_mut().enumerate().for_each(|(row, sample)| spoil(row, sample));
        Recording::new(rows).unwrap()
    }

    #[test]
    fn duties_in_counts_are_found_with_the_scale_to_paste() {
        for (counts, line) in [(255.0, "0.3922"), (1023.0, "0.09775"), (4095.0, "0.02442"), (65535.0, "0.001526")] {
            let record = rows_where(|_, row| row.duty_percent *= counts / 100.0);
            let finding = duty_beyond_percent(record.samples(), &model());
            // 8 bits stay within what a percent can be.
            assert_eq!(finding.is_some(), counts > 1000.0, "{finding:?}");
            let said = finding.map(|finding| finding.to_string()).unwrap_or_default();
            assert!(counts < 1000.0 || said.contains(line), "{said}");
        }
        assert_eq!(scale(2e8, 20.0), 1e-7);
    }

    #[test]
    fn duties_from_minus_1_to_1_are_found_with_scale_and_offset() {
        let record = rows_where(|_, row| row.duty_percent = row.duty_percent / 50.0 - 1.0);
        let said = duty_far_below_hover(record.samples(), &model()).map(|finding| finding.to_string());
        assert!(said.as_ref().is_some_and(|said| said.contains("scale = 50, offset = 50 }")), "{said:?}");
        // A spring holds the ball elsewhere without the duty of the hover.
        let mut spring = model();
        spring.effects.set("height_dependent_flow", &[4.0]);
        assert_eq!(duty_far_below_hover(record.samples(), &spring), None);
    }

    #[test]
    fn exchanged_columns_are_no_counts() {
        let exchange = |_: usize, row: &mut Sample| {
            let position = row.position_mm.replace(row.duty_percent);
            row.duty_percent = position.unwrap_or_default();
        };
        let found = diagnose(&model(), &rows_where(exchange), &Options::default());
        let mistakes = found.findings.iter().filter(|noted| noted.finding.is_mistake());
        assert_eq!(mistakes.map(|noted| noted.finding).collect::<Vec<_>>(), [Finding::Exchanged]);
    }

    #[test]
    fn readings_outside_the_pipe_in_another_unit_are_found_with_their_scale() {
        let belief = Model { hover_duty_percent: 0.5, pipe_length_mm: 5e3, ..model() };
        let cm = |_: usize, row: &mut Sample| {
            row.duty_percent -= 20.9;
            row.position_mm = row.position_mm.map(|mm| 100.0 * mm);
        };
        let found = diagnose(&belief, &rows_where(cm), &Options::default());
        let said = found.findings.iter().map(|noted| noted.finding.to_string()).collect::<String>();
        assert!(said.contains("position_mm = { column = \"position_mm\", scale = 0.0"), "{said}");
        assert!(found.has_mistake(), "{said}");
    }

    #[test]
    fn a_rig_that_hovers_near_0_may_have_an_input_of_any_unit() {
        let belief = Model { hover_duty_percent: 2.0, ..model() };
        let signed = |k: usize, row: &mut Sample| row.duty_percent = if k.is_multiple_of(3) { 240.0 } else { -100.0 };
        let record = rows_where(signed);
        assert_eq!(duty_beyond_percent(record.samples(), &belief), None);
        let spoilt = rows_where(|k, row| {
            signed(k, row);
            row.duty_percent *= if k == 900 { 100.0 } else { 1.0 };
        });
        let found = duty_beyond_percent(spoilt.samples(), &belief);
        assert!(matches!(found, Some(Finding::DutyBeyondPercent { count: 1, row: 901, .. })), "{found:?}");
    }

    #[test]
    fn a_record_with_implausible_duties_has_no_verdict_and_says_the_row() {
        type Spoil = fn(usize, &mut Sample);
        let units: [(&str, Spoil); 5] = [
            ("counts", |_, row| row.duty_percent *= 655.35),
            ("millions", |_, row| row.duty_percent *= 1e6),
            ("one large", |k, row| row.duty_percent = if k == 900 { 1e5 } else { row.duty_percent }),
            ("one huge", |k, row| row.duty_percent = if k == 900 { 1e308 } else { row.duty_percent }),
            ("one below", |k, row| row.duty_percent = if k == 900 { -1e6 } else { row.duty_percent }),
        ];
        for (what, spoil) in units {
            let found = diagnose(&model(), &rows_where(spoil), &Options::default());
            assert_eq!(found.verdict, Verdict::InsufficientData, "{what}");
            let said = found.findings.iter().map(|noted| noted.finding.to_string()).collect::<String>();
            assert!(said.contains(if what.starts_with("one") { "row 901" } else { "[import]" }), "{what}: {said}");
        }
    }

    #[test]
    fn an_implausible_reading_counts_as_empty_and_moves_no_forecast_error() {
        let good = rows_where(|_, _| {});
        let empty = rows_where(|k, row| row.position_mm = row.position_mm.filter(|_| k != 900));
        let expected = Gap::measure(&model(), &empty);
        assert!(without_implausible_readings(&good, &model()).is_none());
        for far_mm in [1e3, -1e4, 1e6, 1e308, f64::MAX] {
            let spoilt = rows_where(|k, row| row.position_mm = if k == 900 { Some(far_mm) } else { row.position_mm });
            let seen = without_implausible_readings(&spoilt, &model()).unwrap();
            assert_eq!(Gap::measure(&model(), &seen), expected, "{far_mm}");
            let found = crate::check(&spoilt, &model());
            assert!(
                found.iter().any(|f| matches!(f, Finding::ImplausibleReadings { count: 1, row: 901, .. })),
                "{found:?}"
            );
        }
    }

    #[test]
    fn one_huge_reading_leaves_the_verdict_as_it_is_without_the_reading() {
        let with = |mm: Option<f64>| {
            let record = rows_where(|k, row| row.position_mm = if k == 900 { mm } else { row.position_mm });
            let found = diagnose(&model(), &record, &Options::default());
            (found.verdict, found.gaps)
        };
        assert_eq!(with(Some(1e308)), with(None));
    }

    #[test]
    fn a_forecast_error_that_is_no_number_is_none() {
        // Forecasts start 0.05 s apart, so that not every reading is forecast.
        let is_spoilt = |k: usize| (900..910).contains(&k);
        let spoilt = rows_where(|k, row| row.position_mm = if is_spoilt(k) { Some(1e308) } else { row.position_mm });
        assert_eq!(Gap::measure(&model(), &spoilt).error_mm, [None; 3]);
    }
}
