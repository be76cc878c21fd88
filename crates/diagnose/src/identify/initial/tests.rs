use super::{Initial, NoPlant, NoUse, initial};
use crate::Gap;
use crate::random_for_tests::uniform;
use crate::tests_support::{model, record, shaken};
use crate::{Recording, Sample};
use plant::Effect;
use plant::effects::HeightDependentFlow;

fn changed(recording: &Recording, change: impl Fn(usize, &Sample) -> Sample) -> Recording {
    Recording::new(recording.samples().iter().enumerate().map(|(k, row)| change(k, row)).collect()).unwrap()
}

fn of(recording: Recording) -> Result<Initial, NoPlant> {
    initial(&[recording], 0.0, 583.0, None, None)
}

#[test]
fn a_rig_is_found_with_its_lag_and_its_noise() {
    let found = of(shaken(&model(), 2, 60)).unwrap();
    let close = |value: f64, truth: f64, share: f64| (value / truth - 1.0).abs() < share;
    let model = &found.model;
    assert!(close(model.gain_mm_per_s2_per_percent, 254.6, 0.2) && close(model.noise.sensor_mm, 2.5, 0.1), "{model:?}");
    assert!(close(model.hover_duty_percent, 21.4, 0.02), "{model:?}");
    assert!(model.effects.fan_lag_s().is_some_and(|lag_s| close(lag_s, 0.2, 0.3)), "{model:?}");
    assert!(!found.is_turned && found.sign_is_seen && !found.gain_is_lost && found.no_use.is_none());
}

#[test]
fn a_model_that_forecasts_worse_than_a_ball_that_stays_put_is_of_no_use() {
    let mut wrong = model();
    wrong.gain_mm_per_s2_per_percent *= 30.0;
    let found = NoUse::of(&Gap::measure(&wrong, &record(&model(), 2, 60))).unwrap();
    assert!(found.horizon_s == 0.1 && found.error_mm > found.stay_put_mm && found.stay_put_mm > 0.0, "{found:?}");
}

/// An axis in degrees, ÿ = 12·u − 1.1·ẏ − force(t, y), pushed by steps of a random duty.
fn axis(mean_percent: f64, range_percent: f64, force: impl Fn(f64, f64) -> f64) -> Recording {
    let (mut angle, mut speed, mut duty, mut random) = (15.0_f64, 0.0, 20.0, uniform(11));
    let row = |k: i32| {
        if k % 150 == 0 {
            duty = mean_percent + range_percent * random();
        }
        for _ in 0..20 {
            speed += 5e-4 * (12.0 * duty - 1.1 * speed - force(0.01 * f64::from(k), angle));
            angle += 5e-4 * speed;
        }
        let position_mm = Some(angle + 0.2 * random());
        Sample { time_s: 0.01 * f64::from(k), duty_percent: duty, position_mm, ..Sample::default() }
    };
    Recording::new((0..6000).map(row).collect()).unwrap()
}

/// Gravity on a pendulum of 13/s².
fn gravity(_: f64, angle: f64) -> f64 {
    13.0 * angle.to_radians().sin().to_degrees()
}

fn gravity_of(recording: &Recording, turn_mm: Option<f64>) -> Option<Vec<f64>> {
    let found = initial(std::slice::from_ref(recording), -1e5, 2e5, turn_mm, None).unwrap();
    found.model.effects.values(HeightDependentFlow::ENTRY.name)
}

#[test]
fn gravity_is_believed_as_a_sine_where_the_position_is_an_angle() {
    // At 10 to 50 degrees.
    let pendulum = axis(29.0, 38.0, gravity);
    let found = gravity_of(&pendulum, Some(360.0)).unwrap();
    let [gradient, centre, turn] = found[..] else { panic!("no sine") };
    assert!((12.3..13.7).contains(&gradient) && centre.abs() < 3.0 && turn == 360.0, "{gradient}, {centre}");
    assert_eq!(gravity_of(&pendulum, None).map(|values| values.len()), Some(1));
}

#[test]
fn gravity_is_believed_where_a_pendulum_turns_over() {
    let turning = axis(0.0, 200.0, gravity);
    assert_eq!(gravity_of(&turning, None), None, "over full turns it has no linear part");
    let found = gravity_of(&turning, Some(360.0)).unwrap();
    let (gradient, upright) = (found[0], (found[1] / 360.0).fract().abs());
    assert!((12.3..13.7).contains(&gradient) && upright.min(1.0 - upright) < 0.01, "{found:?}");
}

#[test]
fn a_force_over_time_is_no_gravity() {
    let shaken = axis(0.0, 20.0, |time_s, _| 80.0 * (std::f64::consts::TAU * 0.71 * time_s).sin());
    assert_eq!(gravity_of(&shaken, Some(360.0)), None);
}

#[test]
fn the_sign_is_seen_in_a_record_that_begins_and_ends_at_rest_on_the_ground() {
    let flight = shaken(&model(), 2, 60);
    let end_s = flight.duration_s() + 4.0;
    for sign in [1.0, -1.0] {
        let resting = |time_s: f64| Sample { time_s, duty_percent: 0.0, position_mm: Some(0.0), ..Sample::default() };
        let before = (0..100).map(|k| resting(f64::from(k) * 0.02));
        let between = flight.samples().iter().map(|row| Sample {
            time_s: row.time_s + 3.0,
            duty_percent: sign * row.duty_percent,
            ..*row
        });
        let after = (0..100).map(|k| resting(end_s + f64::from(k) * 0.02));
        let found = of(Recording::new(before.chain(between).chain(after).collect()).unwrap()).unwrap();
        assert!(found.sign_is_seen && found.is_turned == (sign < 0.0), "{sign}: {found:?}");
    }
}

#[test]
fn the_readings_have_the_noise_of_their_rounding_at_least() {
    let mut smooth = model();
    smooth.noise.sensor_mm = 0.0;
    let rounded = |mm: f64| (mm / 0.5).round() * 0.5;
    let row = |_, row: &Sample| Sample { position_mm: row.position_mm.map(rounded), ..*row };
    let found = of(changed(&shaken(&smooth, 2, 60), row)).unwrap();
    assert!(found.model.noise.sensor_mm >= 0.5 / 12f64.sqrt(), "{:?}", found.model.noise);
}

#[test]
fn a_turned_input_is_turned_back() {
    let turned = |_, row: &Sample| Sample { duty_percent: -row.duty_percent, ..*row };
    let [plain, other] = [of(record(&model(), 2, 60)), of(changed(&record(&model(), 2, 60), turned))];
    let (plain, other) = (plain.unwrap(), other.unwrap());
    assert!(other.is_turned && !plain.is_turned);
    assert_eq!(plain.model, other.model);
}

/// A ball below a magnet: ẍ = 20·u + 900·x mm/s², held by a PD controller with a random setpoint, 0.02 mm of noise.
fn magnet(sign: f64) -> Recording {
    let (mut x, mut v, mut setpoint) = (0.0, 0.0, 0.0);
    let mut random = uniform(1);
    let rows = (0..6000).map(|k| {
        if k % 60 == 0 {
            setpoint = 8.0 * random();
        }
        let reading: f64 = x + 0.05 * (random() + random());
        let duty_percent: f64 = -150.0 * (reading - setpoint) - 3.0 * v - 45.0 * setpoint;
        for _ in 0..10 {
            v += 5e-4 * (20.0 * duty_percent + 900.0 * x + 100.0 * random());
            x += 5e-4 * v;
        }
        let duty_percent = sign * duty_percent;
        // In the middle of the pipe.
        let position_mm = Some(291.5 + reading);
        Sample { time_s: 0.005 * f64::from(k), duty_percent, position_mm, ..Sample::default() }
    });
    Recording::new(rows.collect()).unwrap()
}

#[test]
fn a_plant_that_its_controller_holds_is_believed_with_the_force_that_drives_it_away() {
    for sign in [1.0, -1.0] {
        let found = of(magnet(sign)).unwrap();
        let gradient = found.model.effects.values(HeightDependentFlow::ENTRY.name).unwrap()[0];
        assert!((gradient / -900.0 - 1.0).abs() < 0.2, "{gradient}");
        assert!((found.model.gain_mm_per_s2_per_percent / 20.0 - 1.0).abs() < 0.2, "{:?}", found.model);
        assert_eq!((found.is_turned, found.sign_is_seen), (sign < 0.0, true));
    }
    // A rig that nothing drives away is not believed to be one.
    for seed in 0..4 {
        assert_eq!(of(record(&model(), seed, 60)).unwrap().model.effects.values(HeightDependentFlow::ENTRY.name), None);
    }
}

#[test]
fn a_speed_read_as_a_position_is_refused_as_of_first_order_and_a_stranger_as_no_input() {
    // ẏ = 0.4·u − y/0.5, without noise but for the rounding of the file.
    let mut speed = 0.0;
    let rows = (0..3000).map(|k| {
        let duty_percent = if (k / 100) % 2 == 0 { 10.0 } else { -10.0 } + f64::from(k % 37) / 37.0;
        let row = Sample {
            time_s: 0.02 * f64::from(k),
            duty_percent,
            position_mm: Some((1e3 * speed + 200.0 * f64::from(k * 7919 % 13) / 13.0_f64).round() / 1e3),
            ..Sample::default()
        };
        speed += 0.02 * (0.4 * duty_percent - speed / 0.5);
        row
    });
    let refused = of(Recording::new(rows.collect()).unwrap()).unwrap_err();
    assert!(
        matches!(refused, NoPlant::FirstOrder { time_constant_s } if (time_constant_s / 0.5 - 1.0).abs() < 0.3),
        "{refused:?}"
    );
    // A random input, which the motion does not know.
    let stranger = |k: usize, row: &Sample| {
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let duty_percent = ((k / 20).wrapping_mul(2_654_435_761) % 1000) as f64 / 50.0;
        Sample { duty_percent, ..*row }
    };
    let refused = of(changed(&record(&model(), 2, 60), stranger)).unwrap_err();
    assert!(matches!(refused, NoPlant::NoAnswer { .. }), "{refused:?}");
}
