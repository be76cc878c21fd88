//! Properties of the gap.

use super::Gap;
use crate::filter::track::Track;
use crate::tests_support::{model, record};
use crate::{Recording, Sample};
use plant::Model;

#[test]
fn a_model_forecasts_its_own_flights_as_well_as_noise_allows() {
    let gaps: Vec<Gap> = (0..10).map(|seed| Gap::measure(&model(), &record(&model(), seed, 80))).collect();
    for h in 0..3 {
        let mean = |of: fn(&Gap) -> [Option<f64>; 3]| gaps.iter().map(|g| of(g)[h].unwrap().powi(2)).sum::<f64>();
        let ratio = (mean(|g| g.error_mm) / mean(|g| g.floor_mm)).sqrt();
        assert!((ratio - 1.0).abs() < 0.06, "E/F = {ratio} at horizon {h}");
    }
}

#[test]
fn a_missing_fan_lag_opens_the_gap_and_the_right_model_closes_it() {
    let rig = model();
    let recording = record(&rig, 3, 80);
    let belief = Model { effects: plant::Effects::default(), ..rig.clone() };
    let (without, with) = (Gap::measure(&belief, &recording), Gap::measure(&rig, &recording));
    let at_1s = |gap: &Gap| gap.error_mm[2].unwrap() / gap.floor_mm[2].unwrap();
    assert!(at_1s(&without) > 1.5 && at_1s(&with) < 1.1, "{} and {}", at_1s(&without), at_1s(&with));
    assert!(without.free_run_10s_mm.unwrap() > 1.5 * with.free_run_10s_mm.unwrap());
}

#[test]
fn staying_put_is_the_change_of_the_reading() {
    // A ramp of 10 mm/s without noise: the ball moves by h·10 mm within h.
    let row = |k: u32| Sample {
        time_s: 0.02 * f64::from(k),
        duty_percent: 21.4,
        position_mm: Some(100.0 + 0.2 * f64::from(k)),
        ..Sample::default()
    };
    let gap = Gap::measure(&model(), &Recording::new((0..1000).map(row).collect()).unwrap());
    for (stay_put, expected) in gap.stay_put_mm.into_iter().zip([1.0, 5.0, 10.0]) {
        assert!((stay_put.unwrap() - expected).abs() < 1e-9, "{stay_put:?}, not {expected}");
    }
}

#[test]
fn a_horizon_midway_between_two_readings_has_forecasts() {
    // 12.5 periods of 0.08 s are 1 s.
    let row = |k: u32| Sample {
        time_s: 0.08 * f64::from(k),
        duty_percent: 21.4,
        position_mm: Some(200.0 + f64::from(k % 7)),
        ..Sample::default()
    };
    let gap = Gap::measure(&model(), &Recording::new((0..444).map(row).collect()).unwrap());
    assert!(gap.error_mm.iter().all(Option::is_some), "{gap:?}");
}

#[test]
fn a_recording_too_short_for_a_horizon_says_so() {
    let gap = Gap::measure(&model(), &record(&model(), 1, 1));
    assert!(gap.error_mm[1].is_some() && gap.error_mm[2].is_none() && gap.free_run_10s_mm.is_none());
}

#[test]
fn the_forecasts_of_several_flights_are_those_of_each() {
    let flights = [record(&model(), 9, 40), record(&model(), 10, 35)];
    let both = Recording::together(flights.clone());
    let wrong = Model { gain_mm_per_s2_per_percent: 170.0, ..model() };
    let at_once = super::tallies(&Track::new(&wrong, &both), &|_| Some(0));
    let apart: Vec<_> =
        flights.iter().flat_map(|flight| super::tallies(&Track::new(&wrong, flight), &|_| Some(0))).collect();
    let apart = super::Tally::sum(apart.iter());
    assert!((at_once[0].square_at_1_s().unwrap() / apart.square_at_1_s().unwrap() - 1.0).abs() < 1e-6);
    assert_eq!(at_once[0].free_run.model.count, apart.free_run.model.count);
    let runs = super::free_runs(&wrong, &both);
    assert!(runs.iter().all(|run| both.flight_of(run.row).contains(&run.forecasts.last().unwrap().row)));
}

#[test]
fn readings_at_uneven_times_are_forecast_for_their_own_time() {
    // The true model at twice the jitter of a real log still reaches the noise floor.
    let recording = record(&model(), 9, 80);
    let kept = recording.samples().iter().enumerate().filter(|(k, _)| k % 7 != 3 && k % 11 != 5);
    let dropped: Vec<Sample> = recording
        .samples()
        .iter()
        .enumerate()
        .map(|(k, s)| Sample { position_mm: s.position_mm.filter(|_| k % 7 != 3 && k % 11 != 5), ..*s })
        .collect();
    assert!(kept.count() < recording.samples().len());
    let gap = Gap::measure(&model(), &Recording::new(dropped).unwrap());
    assert!((gap.error_mm[2].unwrap() / gap.floor_mm[2].unwrap() - 1.0).abs() < 0.2);
}
