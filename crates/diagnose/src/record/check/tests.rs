use super::{Finding, check};
use crate::tests_support::{model, record};
use crate::{Recording, Sample};

/// The findings about a good flight after `spoil` has changed its rows.
fn findings(spoil: impl FnOnce(&mut Vec<Sample>)) -> Vec<Finding> {
    let mut samples = record(&model(), 1, 40).samples().to_vec();
    spoil(&mut samples);
    check(&Recording::new(samples).unwrap(), &model())
}

#[test]
fn a_good_flight_has_no_findings() {
    for seed in 0..10 {
        assert_eq!(check(&record(&model(), seed, 40), &model()), []);
    }
}

#[test]
fn single_wild_readings_are_counted() {
    let found = findings(|rows| [300, 900, 1500].iter().for_each(|&k| rows[k].position_mm = Some(500.0)));
    assert!(matches!(found[..], [Finding::Outliers { count: 3, .. }]), "{found:?}");
}

#[test]
fn a_ball_that_swings_within_a_few_readings_and_rests_otherwise_gives_no_outlier() {
    let found = findings(|rows| {
        for (k, row) in rows.iter_mut().enumerate() {
            let swing = if (500..560).contains(&k) { (k as f64 * std::f64::consts::TAU / 6.0).sin() } else { 0.0 };
            row.position_mm = row.position_mm.map(|mm| 0.1 * mm + 250.0 + 60.0 * swing);
        }
    });
    assert_eq!(found, []);
}

#[test]
fn the_steps_of_readings_that_a_slow_sensor_holds_are_no_outliers() {
    let found = findings(|rows| {
        for (k, row) in rows.iter_mut().enumerate() {
            row.position_mm = Some(300.0 + 200.0 * (0.4 * (k / 5) as f64).sin());
        }
    });
    assert!(!found.iter().any(|one| matches!(one, Finding::Outliers { .. })), "{found:?}");
}

#[test]
fn motion_at_irregular_times_gives_no_outlier_and_a_wild_reading_there_does() {
    let count = |wild_mm: Option<f64>| {
        let found = findings(|rows| {
            let mut number = 0;
            rows.retain(|_| {
                number += 1;
                number % 7 != 0 && number % 11 != 0
            });
            rows.iter_mut().for_each(|row| row.position_mm = Some(200.0 + 200.0 * (3.0 * row.time_s).sin()));
            let step = |k: usize| rows[k].time_s - rows[k - 1].time_s;
            let even = (900..).find(|&k| (step(k) - step(k + 1)).abs() < 1e-6).unwrap();
            rows[even].position_mm = wild_mm.or(rows[even].position_mm);
        });
        found.into_iter().find_map(|one| if let Finding::Outliers { count, .. } = one { Some(count) } else { None })
    };
    assert_eq!(count(Some(450.0)), Some(1));
    assert_eq!(count(None), None);
}

#[test]
fn codes_of_the_sensor_are_told_from_positions() {
    assert_eq!(findings(|rows| rows[700].position_mm = Some(8190.0)), [Finding::NoTarget { count: 1 }]);
}

#[test]
fn a_hole_in_time_is_a_gap() {
    let found = findings(|rows| drop(rows.drain(500..520)));
    assert!(
        matches!(found[..], [Finding::Gaps { count: 1, longest_s, .. }] if (longest_s - 0.42).abs() < 1e-9),
        "{found:?}"
    );
}

#[test]
fn rows_in_milliseconds_are_too_far_apart_to_be_seconds() {
    let found = findings(|rows| rows.iter_mut().for_each(|row| row.time_s *= 1000.0));
    assert!(matches!(found[..], [Finding::SlowRows { usual_s }] if (usual_s - 20.0).abs() < 1e-6), "{found:?}");
}

#[test]
fn two_rows_at_each_time_are_repeated_times_and_no_gaps() {
    let found = findings(|rows| (0..rows.len()).for_each(|k| rows[k].time_s = rows[k - k % 2].time_s));
    assert!(
        matches!(found[..], [Finding::RepeatedTimes { percent, row: 2 }] if (percent - 50.0).abs() < 0.1),
        "{found:?}"
    );
    let found = findings(|rows| rows[700].time_s = rows[699].time_s);
    assert_eq!(found, [], "one row is no clock");
}

#[test]
fn a_sensor_that_refreshes_late_shows_in_repeats() {
    let found = findings(|rows| {
        for k in 0..rows.len() {
            rows[k].position_mm = rows[k - k % 5].position_mm;
        }
    });
    assert!(found.iter().any(|f| matches!(f, Finding::Repeats { longest, .. } if *longest >= 5)), "{found:?}");
}

#[test]
fn a_duty_that_is_a_fraction_or_never_moves_and_a_position_that_never_moves_are_named() {
    let found = findings(|rows| rows.iter_mut().for_each(|row| row.duty_percent /= 100.0));
    assert!(found.contains(&Finding::FractionalDuty), "{found:?}");
    let found = findings(|rows| rows.iter_mut().for_each(|row| row.duty_percent /= 10.0));
    let [Finding::DutyFarBelowHover { scale, .. }] = found[..] else { panic!("{found:?}") };
    assert!((9.0..11.0).contains(&scale), "{scale}");
    let found = findings(|rows| rows.iter_mut().for_each(|row| row.duty_percent = 21.4));
    assert!(found.contains(&Finding::StillDuty { range_percent: 0.0 }), "{found:?}");
    let found = findings(|rows| rows.iter_mut().for_each(|row| row.position_mm = Some(7.0)));
    assert_eq!(found, [Finding::StillPosition { position_mm: 7.0 }]);
}
