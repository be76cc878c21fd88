//! A first belief about a rig of which nothing is known but a record: a linear plant with its noise.
//!
//! ```text
//! forms of a linear plant → does the input drive an acceleration? of which sign? → grey-box fits of 2 and 3 poles
//! ```
//!
//! The forms are those of [`linear`](crate::linear). A plant of first order, whose reading follows the input as a speed
//! does, is no rig of ours and refused.

use crate::gap::forecast_error::Gap;
use crate::identify::by_forecasts::by_forecasts;
use crate::identify::forms::{Forms, SEEN};
use crate::identify::gravity::{gravity, is_seen};
use crate::identify::grey_box::{GreyBox, Poles, TooLittle, better};
use crate::identify::input_outlier::input_outlier;
use crate::identify::rest::moving_part;
use crate::linear::{LinearFit, beginning};
use crate::record::prepare::prepared;
use crate::record::recording::{Recording, Sample};
use plant::effects::HeightDependentFlow;
use plant::{Effect, Effects, Model, Noise};
use rayon::prelude::*;

/// A grey-box gain below this share of the form's has lost it, to noise that follows the record instead.
const LOST: f64 = 0.2;
/// A lag shorter than this share of the time between readings is none.
const NO_LAG: f64 = 0.25;
/// A return stiffer than this, 1/s², may be that of a servo: gravity returns a pendulum of 0.2 m by as much.
const STIFFEST_PER_S2: f64 = 50.0;
/// It is one where the static gain is unity to within this factor. Chosen by hand: a loop without an
/// integral leaves an offset.
const NEAR_UNITY: f64 = 1.25;

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
    /// Whether gain, drag and hover are fitted by forecasts, which are then better than with those of `found`.
    pub by_forecasts: bool,
    /// Whether the sign is seen at all.
    pub sign_is_seen: bool,
    /// The form that the fit began with.
    pub form: LinearFit,
    /// Where the model forecasts worse than "the position stays put" at every horizon, the nearest one.
    pub no_use: Option<NoUse>,
}

/// A horizon at which a model is of no use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoUse {
    /// The horizon, seconds.
    pub horizon_s: f64,
    /// Error of the model, mm.
    pub error_mm: f64,
    /// Error of "the position stays put", mm.
    pub stay_put_mm: f64,
}

impl NoUse {
    /// `None`: the model is better at a horizon, or the record is too short.
    fn of(gap: &Gap) -> Option<Self> {
        let errors = gap.horizons_s.into_iter().zip(gap.error_mm).zip(gap.stay_put_mm);
        let known = errors.filter_map(|((horizon_s, error), stay_put)| {
            Some(Self { horizon_s, error_mm: error?, stay_put_mm: stay_put? })
        });
        let known: Vec<Self> = known.collect();
        let is_worse = known.iter().all(|at| at.error_mm > at.stay_put_mm);
        known.first().copied().filter(|_| is_worse)
    }
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
        "the position follows the input as a servo follows a commanded position: it returns by {per_s2:.0} per s², and \
         a change of the input by 1 moves it by {ratio:.2} in the end; name the command with --setpoint: the input is \
         then setpoint minus position; if a controller only holds one position, its answer looks the same: record a \
         setpoint that moves"
    )]
    Servo {
        /// k, 1/s².
        per_s2: f64,
        /// The static gain, both in the units of the log.
        ratio: f64,
    },
    /// Too little to identify.
    #[error(transparent)]
    TooLittle(#[from] TooLittle),
    /// The fit left the bounds of a model.
    #[error("the fit ends outside the bounds of a model: {0}; choose other scales of the columns")]
    OutOfBounds(String),
}

/// A first belief about the rig of `recordings`, in a pipe with this lower end and this length, mm; `turn_mm`: length
/// of one turn where the position is an angle. A force that returns an angle to one place is then tried as gravity too.
/// `unity_gain`: the static gain, mm per percent, of a position that follows the input in its own unit; `None`: the two
/// have different units.
///
/// # Errors
/// [`NoPlant`]: the record is of no plant of ours, or too short.
pub fn initial(
    recordings: &[Recording],
    bottom_mm: f64,
    length_mm: f64,
    turn_mm: Option<f64>,
    unity_gain: Option<f64>,
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
    if let Some(ratio) = unity_gain.and_then(|unity_gain| servo_ratio(&form, unity_gain)) {
        return Err(NoPlant::Servo { per_s2: form.spring_per_s2, ratio });
    }
    let start = model(&form, sign, bottom_mm, length_mm);
    let turned: Vec<Recording> = recordings.iter().map(|one| with_sign(one, sign)).collect();
    let (_, recording) = prepared(&turned, &start);
    let identify = |poles: &Poles| GreyBox::identify(&start, &recording, *poles);
    let found = [Poles::Two, Poles::Three].par_iter().map(identify).collect::<Result<Vec<_>, _>>()?;
    let linear = better(&found).cloned().ok_or(NoPlant::Still)?;
    let gravity = gravity(&linear.fit.model, turn_mm, &recording);
    let gravity = gravity.map(|model| GreyBox::identify(&model, &recording, linear.poles)).transpose()?;
    let is_kept = |gravity: &GreyBox| gravity.is_better_than(&linear) && is_seen(&linear.fit, &gravity.fit, &recording);
    let found = gravity.filter(is_kept).unwrap_or(linear);
    let forecasting = by_forecasts(&found.fit, &recording);
    let fitted = forecasting.as_ref().unwrap_or(&found.fit.model);
    let gain_is_lost = fitted.gain_mm_per_s2_per_percent < LOST * start.gain_mm_per_s2_per_percent;
    let kept = if gain_is_lost { Model { noise: fitted.noise, ..start.clone() } } else { fitted.clone() };
    let shortest_s = NO_LAG * recording.flights().first().map_or(0.0, |flight| recording.reading_period_s(flight));
    let mut model = within_bounds(&without_short_lag(kept, shortest_s));
    // A fit may put all noise into the force; the readings have that of their rounding at least.
    model.noise.sensor_mm = model.noise.sensor_mm.max(recording.rounding_mm());
    model.check().map_err(|(_, unsound)| NoPlant::OutOfBounds(unsound.to_string()))?;
    let no_use = NoUse::of(&Gap::measure(&model, &recording));
    let by_forecasts = forecasting.is_some() && !gain_is_lost;
    Ok(Initial { model, is_turned, gain_is_lost, by_forecasts, sign_is_seen: forms.show_sign(), form, no_use, found })
}

/// The static gain of a servo over the unity gain. `None`: the plant is no servo.
fn servo_ratio(form: &LinearFit, unity_gain: f64) -> Option<f64> {
    let ratio = (form.gain / form.spring_per_s2 / unity_gain).abs();
    (form.spring_per_s2 > STIFFEST_PER_S2 && ratio.max(ratio.recip()) < NEAR_UNITY).then_some(ratio)
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
mod tests;
