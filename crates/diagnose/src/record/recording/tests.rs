use super::{Recording, RecordingError, Sample};

fn rows(count: usize) -> Vec<Sample> {
    let row = Sample { duty_percent: 20.0, position_mm: Some(100.0), ..Sample::default() };
    (0..count).map(|k| Sample { time_s: 0.02 * k as f64, ..row }).collect()
}

#[test]
fn good_rows_are_kept_as_they_are() {
    let recording = Recording::new(rows(50)).unwrap();
    assert_eq!(recording.samples(), rows(50));
    assert!((recording.duration_s() - 0.98).abs() < 1e-12);
}

#[test]
fn flights_follow_each_other_by_whole_seconds() {
    let later = |by_s: f64| rows(50).into_iter().map(move |row| Sample { time_s: row.time_s + by_s, ..row });
    let flights = [rows(50), later(7.25).collect(), rows(30)].map(|rows| Recording::new(rows).unwrap());
    let both = Recording::together(flights.clone());
    assert_eq!(both.flights(), [0..50, 50..100, 100..130]);
    assert!((both.duration_s() - 2.0 * 0.98 - 0.58).abs() < 1e-9, "{}", both.duration_s());
    assert_eq!((both.flight_of(49), both.flight_of(50), both.flight_of(129)), (0..50, 50..100, 100..130));
    let starts = [0, 50, 100].map(|row: usize| both.samples()[row].time_s);
    assert_eq!(starts, [0.0, 1.25, 3.0]);
}

#[test]
fn each_flight_knows_its_rows_with_a_reading_and_every_row_its_duty() {
    let sparse = |rows: Vec<Sample>, every: usize| {
        let read =
            |(k, row): (usize, Sample)| Sample { position_mm: row.position_mm.filter(|_| k % every == 0), ..row };
        Recording::new(rows.into_iter().enumerate().map(read).collect()).unwrap()
    };
    let mut turning = rows(60);
    turning.iter_mut().for_each(|row| (row.duty_percent, row.fan_rpm) = (30.0, Some(5000.0)));
    let both = Recording::together([sparse(rows(50), 2), sparse(turning, 3)]);
    assert_eq!(both.readings(), 25 + 20);
    assert_eq!(both.readings_of(&(0..50)).last(), Some(&48));
    assert_eq!(both.readings_of(&(50..110)), (0..20).map(|k| 50 + 3 * k).collect::<Vec<_>>());
    assert!((both.reading_period_s(&(50..110)) - 3.0 * 0.02).abs() < 1e-9);
    assert!(both.has_fan_speed());
    let written: Vec<_> = both.writes().iter().map(|write| (write.time_s, write.duty_percent)).collect();
    assert_eq!(written, both.samples().iter().map(|row| (row.time_s, row.duty_percent)).collect::<Vec<_>>());
}

#[test]
fn the_first_wrong_row_is_named() {
    let mut backwards = rows(50);
    backwards[30].time_s = 0.1;
    let error = Recording::new(backwards).unwrap_err();
    assert_eq!(error, RecordingError::TimeBackwards { row: 31, from_s: 0.02 * 29.0, to_s: 0.1 });

    let mut not_a_number = rows(50);
    not_a_number[7].duty_percent = f64::NAN;
    let error = Recording::new(not_a_number).unwrap_err();
    assert!(matches!(error, RecordingError::NotFinite { row: 8, quantity: "duty_percent", .. }), "{error}");
}

#[test]
fn time_that_stands_still_or_jumps_far_is_refused_with_the_unit_to_check() {
    let mut still = rows(50);
    still.iter_mut().for_each(|s| s.time_s = 3.0);
    assert_eq!(Recording::new(still).unwrap_err(), RecordingError::NoTime { time_s: 3.0 });
    let mut nanoseconds = rows(50);
    nanoseconds.iter_mut().for_each(|s| s.time_s *= 1e9);
    let error = Recording::new(nanoseconds).unwrap_err();
    assert!(matches!(error, RecordingError::Hole { row: 2, .. }) && error.to_string().contains("scale"), "{error}");
}

#[test]
fn an_empty_and_a_silent_recording_are_told_apart() {
    assert_eq!(Recording::new(vec![]).unwrap_err(), RecordingError::Empty);
    let mut silent = rows(50);
    silent.iter_mut().skip(5).for_each(|s| s.position_mm = None);
    assert_eq!(Recording::new(silent).unwrap_err(), RecordingError::TooShort { readings: 5, needed: 20 });
}
