//! A first belief about a rig of which nothing is known but a record: a linear plant with its noise.
//!
//! ```text
//! forms of a linear plant → does the input drive an acceleration? of which sign? → grey-box fits of 2 and 3 poles
//! ```
//!
//! The forms are those of [`linear`](crate::linear). A plant of first order, whose reading follows the input as a speed
//! does, is no rig of ours and refused.

use crate::identify::forms::{Forms, SEEN};
use crate::identify::gravity::gravity;
use crate::identify::grey_box::{GreyBox, Poles, TooLittle, better};
use crate::identify::input_outlier::input_outlier;
use crate::identify::rest::moving_part;
use crate::linear::{LinearFit, beginning};
use crate::record::prepare::prepared;
use crate::record::recording::{Recording, Sample};
use plant::effects::HeightDependentFlow;
use plant::{Effect, Effects, Model, Noise};
use rayon::prelude::*;
use std::iter;

/// A grey-box gain below this share of the form's has lost it, to noise that follows the record instead.
const LOST: f64 = 0.2;
/// A lag shorter than this share of the time between readings is none.
const NO_LAG: f64 = 0.25;
/// A return stiffer than this, 1/s², is read as that of a servo: gravity returns a pendulum of 0.2 m by as much.
const STIFFEST_PER_S2: f64 = 50.0;

/// A first belief.
#[derive(Clone, Debug)]
pub struct Initial {
    /// The plant, by the grey-box fit that is kept.
    pub found: GreyBox,
    /// The model to believe.
    pub model: Model,
    /// Whether the position falls where the input rises; the model is that of the input with its sign turned.
    pub is_turned: bool,
    /// Whether the grey-box fit has lost the gain, so that gain, drag and hover are those of the form.
    pub gain_is_lost: bool,
    /// Whether the sign is seen at all.
    pub sign_is_seen: bool,
    /// The form that the fit began with.
    pub form: LinearFit,
}

/// Why there is no first belief.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoPlant {
    /// Input or position never moves.
    #[error(
        "the input or the position never moves, or there are too few readings; record what moves, for 30 s or more"
    )]
    Still,
    /// A single input is far from all others.
    #[error(
        "the input of row {row} is {times:.3e} times as far from all others as these are from each other: remove this \
         row, or mend the recorder"
    )]
    InputOutlier {
        /// The row, counted from 1.
        row: usize,
        /// Its distance from the others, in their range.
        times: f64,
    },
    /// The input does nothing that can be seen.
    #[error(
        "the position does not answer the input (its gain is {deviations:.1} of its standard deviations); choose other \
         columns, or record an experiment in which the input moves the rig"
    )]
    NoAnswer {
        /// The gain in its standard deviations.
        deviations: f64,
    },
    /// The plant is of first order.
    #[error(
        "the reading follows the input as a plant of first order, with a time constant of {time_constant_s:.3} s, as a \
         temperature or a speed does: ẏ = K·u − a·y. A plant here is of second order, ÿ = K·(u − hover) − a·ẏ: the \
         input is a force. If the column holds a speed, name it with --speed, and it is integrated"
    )]
    FirstOrder {
        /// 1/a, seconds.
        time_constant_s: f64,
    },
    /// The position returns too stiffly.
    #[error(
        "the position follows the input as a servo does (it returns by {per_s2:.0} per s², and at most \
         {STIFFEST_PER_S2} is read as gravity or a spring); if the input is a commanded position, name it as the \
         setpoint: the input is then setpoint minus position; if a controller only holds one position, its answer \
         looks the same: record a setpoint that moves"
    )]
    Servo {
        /// k, 1/s².
        per_s2: f64,
    },
    /// Too little to identify.
    #[error(transparent)]
    TooLittle(#[from] TooLittle),
    /// The fit left the bounds of a model.
    #[error("the fit ends outside the bounds of a model: {0}; choose other scales of the columns")]
    OutOfBounds(String),
}

/// A first belief about the rig of `recordings`, in a pipe with this lower end and this length, mm; `turn_mm`: length of
/// one turn where the position is an angle. A force that returns an angle to one place is then tried as gravity too.
///
/// # Errors
/// [`NoPlant`]: the record is of no plant of ours, or too short.
pub fn initial(
    recordings: &[Recording],
    bottom_mm: f64,
    length_mm: f64,
    turn_mm: Option<f64>,
) -> Result<Initial, NoPlant> {
    let flight = recordings.iter().max_by_key(|one| one.readings()).ok_or(NoPlant::Still)?;
    if let Some((row, times)) = recordings.iter().find_map(input_outlier) {
        return Err(NoPlant::InputOutlier { row, times });
    }
    let forms = forms_of(flight).ok_or(NoPlant::Still)?;
    if let Some(time_constant_s) = forms.first_order_s() {
        return Err(NoPlant::FirstOrder { time_constant_s });
    }
    TooLittle::check_row_period(flight)?;
    if forms.best_deviations() < SEEN {
        return Err(NoPlant::NoAnswer { deviations: forms.best_deviations() });
    }
    let is_turned = forms.are_turned();
    let (sign, form) = (forms.sign(), forms.start());
    if form.spring_per_s2 > STIFFEST_PER_S2 {
        return Err(NoPlant::Servo { per_s2: form.spring_per_s2 });
    }
    let start = model(&form, sign, bottom_mm, length_mm);
    let turned: Vec<Recording> = recordings.iter().map(|one| with_sign(one, sign)).collect();
    let (_, recording) = prepared(&turned, &start);
    let identify = |poles: &Poles| GreyBox::identify(&start, &recording, *poles);
    let found = [Poles::Two, Poles::Three].par_iter().map(identify).collect::<Result<Vec<_>, _>>()?;
    let linear = better(&found).cloned().ok_or(NoPlant::Still)?;
    let gravity = gravity(&linear.fit.model, turn_mm, &recording);
    let gravity = gravity.map(|model| GreyBox::identify(&model, &recording, linear.poles)).transpose()?;
    let found: Vec<GreyBox> = iter::once(linear).chain(gravity).collect();
    let found = better(&found).cloned().ok_or(NoPlant::Still)?;
    let fitted = &found.fit.model;
    let gain_is_lost = fitted.gain_mm_per_s2_per_percent < LOST * start.gain_mm_per_s2_per_percent;
    let kept = if gain_is_lost { Model { noise: fitted.noise, ..start.clone() } } else { fitted.clone() };
    let shortest_s = NO_LAG * recording.flights().first().map_or(0.0, |flight| recording.reading_period_s(flight));
    let mut model = within_bounds(&without_short_lag(kept, shortest_s));
    // A fit may put all noise into the force; the readings have that of their rounding at least.
    model.noise.sensor_mm = model.noise.sensor_mm.max(recording.rounding_mm());
    model.check().map_err(|(_, unsound)| NoPlant::OutOfBounds(unsound.to_string()))?;
    Ok(Initial { model, is_turned, gain_is_lost, sign_is_seen: forms.show_sign(), form, found })
}

/// The forms of a flight; where they do not show the sign of the input, those of the flight without its rests.
fn forms_of(flight: &Recording) -> Option<Forms> {
    let forms = Forms::of(&beginning(flight))?;
    if forms.show_sign() {
        return Some(forms);
    }
    let moving = moving_part(flight).and_then(|moving| Forms::of(&beginning(&moving)));
    moving.filter(Forms::show_sign).or(Some(forms))
}

/// The model without a lag that is shorter than this.
fn without_short_lag(model: Model, shortest_s: f64) -> Model {
    match model.effects.fan_lag_s() {
        Some(lag_s) if lag_s < shortest_s => Model { effects: model.effects.with_fan_lag(None), ..model },
        _ => model,
    }
}

/// The flight with an input of this sign.
fn with_sign(flight: &Recording, sign: f64) -> Recording {
    let row = |row: &Sample| Sample { duty_percent: sign * row.duty_percent, ..*row };
    Recording::new(flight.samples().iter().map(row).collect()).unwrap_or_else(|_| flight.clone())
}

/// The model that a fit begins with.
fn model(form: &LinearFit, sign: f64, bottom_mm: f64, length_mm: f64) -> Model {
    let mut effects = Effects::default();
    if form.spring_per_s2 != 0.0 {
        effects.set(HeightDependentFlow::ENTRY.name, &[form.spring_per_s2]);
    }
    within_bounds(&Model {
        gain_mm_per_s2_per_percent: form.gain.abs(),
        drag_per_s: form.drag_per_s,
        hover_duty_percent: sign * form.hover,
        pipe_bottom_mm: bottom_mm,
        pipe_length_mm: length_mm,
        turn_mm: None,
        noise: Noise { sensor_mm: form.sensor, acceleration_psd_mm2_per_s3: form.psd },
        effects,
    })
}

/// The model with each number within what a config takes.
fn within_bounds(model: &Model) -> Model {
    Model {
        gain_mm_per_s2_per_percent: model.gain_mm_per_s2_per_percent.clamp(Model::GAIN.min, Model::GAIN.max),
        drag_per_s: model.drag_per_s.clamp(Model::DRAG.min, Model::DRAG.max),
        hover_duty_percent: model.hover_duty_percent.clamp(Model::HOVER.min, Model::HOVER.max),
        noise: Noise {
            sensor_mm: model.noise.sensor_mm.clamp(0.0, 1e3),
            acceleration_psd_mm2_per_s3: model.noise.acceleration_psd_mm2_per_s3.clamp(0.0, 1e9),
        },
        ..model.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::{Initial, NoPlant, initial};
    use crate::random_for_tests::uniform;
    use crate::tests_support::{model, record, shaken};
    use crate::{Recording, Sample};

    fn changed(recording: &Recording, change: impl Fn(usize, &Sample) -> Sample) -> Recording {
        Recording::new(recording.samples().iter().enumerate().map(|(k, row)| change(k, row)).collect()).unwrap()
    }

    fn of(recording: Recording) -> Result<Initial, NoPlant> {
        initial(&[recording], 0.0, 583.0, None)
    }

    #[test]
    fn a_rig_is_found_with_its_lag_and_its_noise() {
        let found = of(shaken(&model(), 2, 60)).unwrap();
        let close = |value: f64, truth: f64, share: f64| (value / truth - 1.0).abs() < share;
        let model = &found.model;
        assert!(
            close(model.gain_mm_per_s2_per_percent, 254.6, 0.2) && close(model.noise.sensor_mm, 2.5, 0.1),
            "{model:?}"
        );
        assert!(close(model.hover_duty_percent, 21.4, 0.02), "{model:?}");
        assert!(model.effects.fan_lag_s().is_some_and(|lag_s| close(lag_s, 0.2, 0.3)), "{model:?}");
        assert!(!found.is_turned && found.sign_is_seen && !found.gain_is_lost);
    }

    /// A pendulum of 13/s², in degrees, pushed by steps of a propeller whose thrust holds it at 10 to 50 degrees.
    fn pendulum() -> Recording {
        let (mut angle, mut speed, mut duty, mut random) = (15.0_f64, 0.0, 20.0, uniform(11));
        let row = |k: i32| {
            if k % 150 == 0 {
                duty = 29.0 + 38.0 * random();
            }
            for _ in 0..20 {
                speed += 5e-4 * (12.0 * duty - 1.1 * speed - 13.0 * angle.to_radians().sin().to_degrees());
                angle += 5e-4 * speed;
            }
            let position_mm = Some(angle + 0.2 * random());
            Sample { time_s: 0.01 * f64::from(k), duty_percent: duty, position_mm, ..Sample::default() }
        };
        Recording::new((0..6000).map(row).collect()).unwrap()
    }

    #[test]
    fn gravity_is_believed_as_a_sine_where_the_position_is_an_angle() {
        let values = |turn_mm: Option<f64>| {
            let found = initial(&[pendulum()], -200.0, 400.0, turn_mm).unwrap();
            found.model.effects.values("height_dependent_flow").unwrap()
        };
        let [gradient, centre, turn] = values(Some(360.0))[..] else { panic!("no sine") };
        assert!((12.3..13.7).contains(&gradient) && centre.abs() < 3.0 && turn == 360.0, "{gradient}, {centre}");
        assert_eq!(values(None).len(), 1);
    }

    #[test]
    fn the_sign_is_seen_in_a_record_that_begins_and_ends_at_rest_on_the_ground() {
        let flight = shaken(&model(), 2, 60);
        let end_s = flight.duration_s() + 4.0;
        for sign in [1.0, -1.0] {
            let resting =
                |time_s: f64| Sample { time_s, duty_percent: 0.0, position_mm: Some(0.0), ..Sample::default() };
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
            let gradient = found.model.effects.values("height_dependent_flow").unwrap()[0];
            assert!((gradient / -900.0 - 1.0).abs() < 0.2, "{gradient}");
            assert!((found.model.gain_mm_per_s2_per_percent / 20.0 - 1.0).abs() < 0.2, "{:?}", found.model);
            assert_eq!((found.is_turned, found.sign_is_seen), (sign < 0.0, true));
        }
        // A rig that nothing drives away is not believed to be one.
        for seed in 0..4 {
            assert_eq!(of(record(&model(), seed, 60)).unwrap().model.effects.values("height_dependent_flow"), None);
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
}
