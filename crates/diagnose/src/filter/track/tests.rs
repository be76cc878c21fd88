use super::{Track, Variances, innovations};
use crate::filter::ekf::VELOCITY_PRIOR_MM_PER_S;
use crate::filter::written_support::with_written;
use crate::record::recording::{Recording, Sample};
use crate::tests_support::{model, record, shaken};
use plant::effects::{EndStop, WallFriction};
use plant::{Effects, Model, Noise, Simulator, Stage};

#[test]
fn forecasts_of_a_noiseless_flight_by_its_own_model_are_exact() {
    let noise = Noise { sensor_mm: 0.0, acceleration_psd_mm2_per_s3: 0.0 };
    let own = Model { noise, ..model() };
    let recording = record(&own, 1, 20);
    // A filter with little sensor noise soon corrects the error of a take-off in the middle of a step.
    let noise = Noise { sensor_mm: 1e-4, acceleration_psd_mm2_per_s3: 360.0 };
    let trusting = Model { noise, ..own };
    let track = Track::new(&trusting, &recording);
    for forecast in track.forecasts(400) {
        let real = recording.samples()[forecast.row].position_mm.unwrap();
        assert!((forecast.position_mm - real).abs() < 0.02, "{} for {real}", forecast.position_mm);
    }
}

#[test]
fn a_rig_that_the_drag_stops_within_a_fraction_of_a_row_is_followed_to_its_noise() {
    let noise = Noise { sensor_mm: 0.5, acceleration_psd_mm2_per_s3: 0.0 };
    for drag_per_s in [100.0, 200.0, 900.0] {
        let gain_mm_per_s2_per_percent = 120.0 * drag_per_s;
        let effects = Effects::default();
        let own = Model { drag_per_s, gain_mm_per_s2_per_percent, noise, effects, ..model() };
        let innovations = innovations(&own, &shaken(&own, 1, 20));
        let squares = innovations.iter().skip(5).map(|s| (s.standardised * s.variance_mm2.sqrt()).powi(2));
        let rms_mm = (squares.sum::<f64>() / (innovations.len() - 5) as f64).sqrt();
        // 995 readings: four standard errors are 9 %.
        assert!((rms_mm / 0.5 - 1.0).abs() < 0.09, "{drag_per_s} /s: {rms_mm} mm");
    }
}

#[test]
fn the_ends_stop_a_ball_with_dry_friction_as_they_do_one_without() {
    let mut own = model();
    own.effects.end_stop = Some(EndStop { bottom_mm: 270.0, top_mm: 330.0, restitution: 0.3 });
    let recording = shaken(&own, 1, 20);
    let mut with = own.clone();
    with.effects.wall_friction = Some(WallFriction { acceleration_mm_per_s2: 0.01, transition_mm_per_s: None });
    let [without, with] = [own, with].map(|model| {
        let squares = innovations(&model, &recording).into_iter().map(|s| s.standardised.powi(2));
        squares.sum::<f64>()
    });
    assert!((with / without - 1.0).abs() < 0.05, "{with} and {without}");
}

#[test]
fn the_spread_of_forecasts_is_what_the_filter_says_it_is() {
    // Squared errors of one-second forecasts, divided by their variances, average to 1 over many flights.
    let own = model();
    let (mut sum, mut count) = (0.0, 0.0);
    for seed in 0..40 {
        let recording = record(&own, seed, 30);
        let track = Track::new(&own, &recording);
        for from in (100..1400).step_by(50) {
            let forecast = track.forecasts(from).nth(49).unwrap();
            let real = recording.samples()[forecast.row].position_mm.unwrap();
            sum += (forecast.position_mm - real).powi(2) / forecast.variance_mm2.unwrap();
            count += 1.0;
        }
    }
    // 1040 almost independent errors: five standard errors are 0.22.
    assert!((sum / count - 1.0_f64).abs() < 0.22, "{}", sum / count);
}

#[test]
fn one_wild_reading_is_passed_over_and_a_ball_that_moved_is_followed() {
    let own = model();
    let good = record(&own, 5, 20);
    let spoilt = |rows: std::ops::Range<usize>| {
        let rows = good.samples().iter().enumerate().map(|(k, s)| {
            let jump = if rows.contains(&k) { 150.0 } else { 0.0 };
            crate::Sample { position_mm: s.position_mm.map(|mm| mm + jump), ..*s }
        });
        crate::Recording::new(rows.collect()).unwrap()
    };
    let expected_after = |recording: &crate::Recording, row: usize| {
        Track::new(&own, recording).forecasts(row).next().unwrap().position_mm
    };
    let clean = expected_after(&good, 500);
    assert!((expected_after(&spoilt(500..501), 500) - clean).abs() < 1.0);
    assert!((expected_after(&spoilt(500..1000), 510) - clean).abs() > 100.0);
}

#[test]
fn every_flight_is_followed_and_forecast_as_if_it_were_alone() {
    // A drift and a delay, so that a clock or a duty carried over from the first flight would show.
    let mut own = model();
    own.effects.set("gain_drift", &[0.005]);
    own.effects.set("transport_delay", &[0.05]);
    let flights = [record(&own, 5, 20), record(&own, 6, 15)];
    let both = crate::Recording::together(flights.clone());
    let together = super::innovations(&own, &both);
    let apart: Vec<_> = flights.iter().flat_map(|flight| super::innovations(&own, flight)).collect();
    // The first reading of the second flight has no prediction either.
    let compared = together.iter().filter(|s| s.row != both.flights()[1].start);
    for (a, b) in compared.zip(&apart) {
        assert!((a.expected_mm - b.expected_mm).abs() < 1e-6 && (a.variance_mm2 / b.variance_mm2 - 1.0).abs() < 1e-9);
    }
    assert_eq!(together.len(), apart.len() + 1);
    let track = Track::new(&own, &both);
    let last = track.forecasts(900).last().unwrap();
    assert_eq!(last.row, 999, "no forecast crosses into another flight");
    let alone = Track::new(&own, &flights[1]).forecasts(100).last().unwrap().position_mm;
    assert!((track.forecasts(1100).last().unwrap().position_mm - alone).abs() < 1e-6);
}

#[test]
fn rows_without_a_reading_are_flown_through() {
    let own = model();
    let full = record(&own, 5, 20);
    let decimated = full.samples().iter().enumerate();
    let decimated = decimated.map(|(k, s)| crate::Sample { position_mm: s.position_mm.filter(|_| k % 3 == 0), ..*s });
    let recording = crate::Recording::new(decimated.collect()).unwrap();
    let track = Track::new(&own, &recording);
    assert_eq!(track.readings(), full.samples().len().div_ceil(3));
    assert!(track.forecasts(10).all(|forecast| forecast.row % 3 == 0));
}

#[test]
fn the_first_reading_leaves_the_velocity_open() {
    let own = model();
    let recording = record(&own, 5, 5);
    let track = Track::new(&own, &recording);
    let first = track.forecasts(0).next().unwrap();
    // One period later the velocity's prior dominates the variance.
    let variance_mm2 = first.variance_mm2.unwrap();
    assert!(variance_mm2 > (0.9 * VELOCITY_PRIOR_MM_PER_S * 0.02).powi(2), "{variance_mm2}");
}

#[test]
fn the_filter_takes_the_setpoint_of_each_row_and_holds_it_where_a_row_has_none() {
    let plain = model();
    for (stage, k) in [(Stage::Air, 2.0), (Stage::Actuator, 0.01)] {
        let model = with_written(plain.clone(), stage, "k * (setpoint - 300)", None, k);
        let mut simulator = Simulator::new(model.clone(), 4);
        let mut row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            let setpoint_mm = if k % 200 < 100 { 350.0 } else { 250.0 };
            simulator.advance_to(time_s);
            let reading = simulator.reading_mm();
            let duty_percent = 21.4 + 0.01 * (300.0 - reading);
            simulator.set_setpoint(Some(setpoint_mm));
            simulator.drive(duty_percent);
            let setpoint_mm = Some(setpoint_mm).filter(|_| k.is_multiple_of(100));
            Sample { time_s, duty_percent, setpoint_mm, position_mm: Some(reading), ..Sample::default() }
        };
        let recording = Recording::new((0..2000).map(&mut row).collect()).unwrap();
        let variance = |model: &Model| {
            let all = innovations(model, &recording);
            all.iter().skip(200).map(|one| one.standardised.powi(2)).sum::<f64>() / (all.len() - 200) as f64
        };
        let (own, without) = (variance(&model), variance(&plain));
        assert!((own - 1.0).abs() < 0.1 && without > 1.2, "{stage:?}: {own}, without {without}");
    }
}

#[test]
fn forecasts_without_variances_are_those_with_them_in_every_kind_of_motion() {
    for entry in plant::Effects::CATALOGUE {
        let mut own = model();
        assert!(own.effects.set(entry.name, entry.sizes[0]));
        let recording = record(&own, 3, 8);
        let (with, without) = (Track::new(&own, &recording), Track::with(Variances::Omitted, &own, &recording));
        let far = |track: &Track<'_>| track.forecasts(50).nth(100).unwrap();
        let (with, without) = (far(&with), far(&without));
        let off = (with.position_mm - without.position_mm).abs();
        assert!(off < 1e-9 && without.variance_mm2.is_none(), "{}: {with:?}, {without:?}", entry.name);
    }
}
