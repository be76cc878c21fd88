//! Prepares recorded flights for a diagnosis.
//!
//! Each flight is checked by itself. Codes of the sensor are removed and a fast clock is decimated. A flight that
//! cannot be diagnosed, or is of another rig, is left out where there are others. The flights are then sorted by
//! content, so that the answer does not depend on the order in which they were given.

use crate::record::airborne::airborne;
use crate::record::check::{Finding, check, is_hopeless};
use crate::record::decimate::{Purpose, decimated};
use crate::record::implausible::plausible;
use crate::record::quantisation::coarse_step;
use crate::record::reading_variance::reading_variance;
use crate::record::recording::{Recording, Sample};
use crate::record::stretches::stretches;
use plant::{Changes, Model};
use std::borrow::Cow;
use std::mem::discriminant;

/// A finding, and the flight that it is about, counted from 0 in the order in which they were given.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct FlightFinding {
    /// The flight.
    pub flight: usize,
    /// The finding about it.
    pub finding: Finding,
}

/// The rows of a diagnosis, and the findings about them.
pub(crate) struct Prepared<'a> {
    pub(crate) findings: Vec<FlightFinding>,
    pub(crate) recording: Cow<'a, Recording>,
    /// Whether any flight can be diagnosed.
    pub(crate) can_answer: bool,
}

impl<'a> Prepared<'a> {
    /// Checks and prepares `recordings`, one flight each, for `purpose` with `belief`.
    pub(crate) fn of(recordings: &'a [Recording], belief: &Model, purpose: Purpose) -> Self {
        let (mut findings, mut flights, mut hopeless) = (Vec::new(), Vec::new(), Vec::new());
        for (number, flight) in recordings.iter().enumerate() {
            let (found, parts, answers) = one(flight, recordings, belief, purpose);
            findings.extend(found.into_iter().map(|finding| FlightFinding { flight: number, finding }));
            if answers { flights.extend(parts) } else { hopeless.push((number, parts)) }
        }
        let can_answer = !flights.is_empty();
        if can_answer {
            findings.extend(
                hopeless.iter().map(|(flight, _)| FlightFinding { flight: *flight, finding: Finding::LeftOut }),
            );
        } else {
            flights.extend(hopeless.into_iter().flat_map(|(_, parts)| parts));
        }
        Self { findings, recording: together(flights), can_answer }
    }
}

/// Whether the mean of several readings is a valid reading of smaller variance: no outliers, no repeats, no
/// quantisation, and noise larger than the resolution.
fn is_smooth(findings: &[Finding], flight: &Recording, belief: &Model) -> bool {
    let odd = |finding: &Finding| matches!(finding, Finding::Outliers { .. } | Finding::Repeats { .. });
    let believed = belief.effects.present().iter().any(|entry| entry.acts.changes == Changes::Density);
    let noisy = reading_variance(belief).sqrt() > flight.resolution_mm();
    noisy && !believed && !findings.iter().any(odd) && coarse_step(flight, belief).is_none()
}

/// The rows of `recordings`, one flight each, as a fit or an evaluation uses them, and the findings about each.
#[must_use]
pub fn prepared(recordings: &[Recording], belief: &Model) -> (Vec<FlightFinding>, Recording) {
    let Prepared { findings, recording, .. } = Prepared::of(recordings, belief, Purpose::Fit);
    (findings, recording.into_owned())
}

/// The findings about a flight, its rows as they are used, in one part or several, and whether it can be diagnosed.
fn one<'a>(
    flight: &'a Recording,
    all: &[Recording],
    belief: &Model,
    purpose: Purpose,
) -> (Vec<Finding>, Vec<Cow<'a, Recording>>, bool) {
    let mut findings = check(flight, belief);
    let answers = !is_hopeless(&findings, flight, belief);
    let all_rows = all.iter().map(|one| one.samples().len()).sum();
    let Some(parts) = stretches(flight, all_rows) else {
        let (findings, flight) = part(Cow::Borrowed(flight), findings, all, belief, purpose);
        return (findings, vec![flight], answers);
    };
    let used = parts.iter().map(|part| part.samples().len()).sum();
    findings.push(Finding::Stretches { rows: flight.samples().len(), used, count: parts.len() });
    let mut used = Vec::new();
    for rows in parts {
        let (found, rows) = part(Cow::Owned(rows), findings.clone(), all, belief, purpose);
        let is_new = |new: &Finding| findings.iter().all(|old| discriminant(old) != discriminant(new));
        let new: Vec<Finding> = found.into_iter().filter(is_new).collect();
        findings.extend(new);
        used.push(rows);
    }
    (findings, used, answers)
}

/// A flight or a part of one as it is used, and `findings` with those about it.
fn part<'a>(
    flight: Cow<'a, Recording>,
    mut findings: Vec<Finding>,
    all: &[Recording],
    belief: &Model,
    purpose: Purpose,
) -> (Vec<Finding>, Cow<'a, Recording>) {
    let flight = plausible(flight, belief);
    let flight = match airborne(&flight, belief) {
        Some((finding, airborne)) => {
            findings.push(finding);
            Cow::Owned(airborne)
        }
        None => flight,
    };
    let smooth = is_smooth(&findings, &flight, belief);
    let Some((how, decimated)) = decimated(&flight, all, belief, purpose, smooth) else { return (findings, flight) };
    findings.push(if how.means {
        Finding::Averaged { merged: how.merged }
    } else {
        Finding::Decimated { merged: how.merged }
    });
    (findings, Cow::Owned(decimated))
}

/// One recording of all flights, in an order that depends only on their content.
fn together(mut flights: Vec<Cow<'_, Recording>>) -> Cow<'_, Recording> {
    let row = |row: &Sample| (row.duty_percent.to_bits(), row.position_mm.map(f64::to_bits));
    flights.sort_by(|a, b| {
        let (a, b) = (a.samples(), b.samples());
        a.len().cmp(&b.len()).then_with(|| a.iter().map(row).cmp(b.iter().map(row)))
    });
    match flights.len() {
        1 => flights.swap_remove(0),
        _ => Cow::Owned(Recording::together(flights.into_iter().map(Cow::into_owned))),
    }
}

#[cfg(test)]
mod tests {
    use super::FlightFinding;
    use crate::tests_support::{model, record};
    use crate::{Diagnosis, Finding, Options, Parameter, Recording, Sample, Verdict, diagnose};
    use plant::{Effects, Model};

    fn without_lag() -> Model {
        Model { effects: Effects::default(), ..model() }
    }

    /// Width of the interval of the lag's time constant: ln of the ratio of its ends, because the relative uncertainty
    /// is the same for short and long lags.
    fn width_of_lag(found: &Diagnosis) -> f64 {
        let is_lag = |parameter: &Parameter| parameter.is_of("fan_lag") || parameter.is_of("sensor_lag");
        let intervals = found.intervals();
        let (_, low, high) = intervals.iter().find(|(parameter, ..)| is_lag(parameter)).unwrap();
        (high / low).ln()
    }

    #[test]
    fn two_halves_of_a_flight_say_more_than_one_and_as_much_as_the_whole() {
        let whole = record(&model(), 4, 80);
        let (first, second) = whole.samples().split_at(2000);
        let halves = [first, second].map(|rows| Recording::new(rows.to_vec()).unwrap());
        let width = |flights: &[Recording]| width_of_lag(&diagnose(&without_lag(), flights, &Options::default()));
        let (one, other, both) = (width(&halves[..1]), width(&halves[1..]), width(&halves));
        assert!(both < 0.85 * one && both < 0.85 * other, "{both} of {one} and {other}");
        assert!((both / width(whole.as_ref()) - 1.0).abs() < 0.1, "{both} of {}", width(whole.as_ref()));
    }

    #[test]
    fn two_short_flights_tell_together_what_neither_tells_alone() {
        let mut rig = model();
        rig.effects.set("thrust_curve", &[0.2]);
        let flights = [1, 2].map(|seed| record(&rig, seed, 25));
        let named = |flights: &[Recording]| {
            let found = diagnose(&model(), flights, &Options::default());
            let names = found.effects.iter().map(|n| (n.candidate.entry.name, n.indistinguishable_from.clone()));
            names.collect::<Vec<_>>()
        };
        for flight in &flights {
            assert_eq!(named(flight.as_ref()), [("thrust_curve", vec!["force_asymmetry"])]);
        }
        assert_eq!(named(&flights), [("thrust_curve", vec![])]);
    }

    #[test]
    fn the_order_of_the_flights_changes_nothing() {
        let flights = [record(&model(), 4, 40), record(&model(), 5, 30)];
        let found = diagnose(&without_lag(), &flights, &Options::default());
        let [first, second] = flights;
        let turned = diagnose(&without_lag(), &[second, first], &Options::default());
        assert_eq!(found.verdict, Verdict::Effect);
        assert_eq!((&found.mended.model, found.closed), (&turned.mended.model, turned.closed));
        assert_eq!((found.rounds, found.places), (turned.rounds, turned.places));
    }

    #[test]
    fn a_flight_that_says_nothing_is_left_out_by_its_number_and_the_other_is_used() {
        let whole = record(&model(), 4, 60);
        let good = Recording::new(whole.samples()[100..].to_vec()).unwrap();
        let still = good.samples().iter().map(|row| Sample { duty_percent: 21.4, ..*row }).collect();
        let still = Recording::new(still).unwrap();
        let found = diagnose(&without_lag(), &[good, still.clone()], &Options::default());
        assert_eq!(found.verdict, Verdict::Effect);
        let of_second = |finding| FlightFinding { flight: 1, finding };
        assert_eq!(found.findings, [of_second(Finding::StillDuty { range_percent: 0.0 }), of_second(Finding::LeftOut)]);
        let found = diagnose(&without_lag(), &[still.clone(), still], &Options::default());
        assert_eq!(found.verdict, Verdict::InsufficientData);
        assert!(found.findings.iter().all(|noted| noted.finding != Finding::LeftOut));
    }
}
