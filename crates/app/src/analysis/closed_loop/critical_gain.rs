//! The critical gain: the smallest multiple of the proportional gain at which the simulated loop loses stability.
//!
//! ```text
//! ramp to mid-pipe, step by J = an eighth of the pipe, wait          without noise
//! lost: in the last third of the wait the ball still swings by J or more, or the flight ended in a fault
//! ```
//!
//! At the critical gain a step of J swings by 2·J for ever; below it the swing decays, above it it grows until the
//! fan's limits bound it. A limit cycle across a dead zone that is smaller than J is not a loss of stability.
//! Proportional, integral and derivative part are multiplied alike, as `K_p` of the control law does.

use crate::analysis::virtual_flight::Desk;
use crate::flight::experiment::{Experiment, Limits, Segment};
use control::waveform::Waveform;
use plant::{Model, Noise};

/// Factor by which the gain is raised or lowered in each step of the search.
const STRIDE: f64 = std::f64::consts::SQRT_2;
/// Steps at most: from a sixteenth to 64 times the gain.
const STRIDES_DOWN: u32 = 8;
const STRIDES_UP: u32 = 12;
/// Bisections of the last step: to 1.1 %.
const BISECTIONS: u32 = 5;
/// The parts of the flight, seconds.
const RAMP_S: f64 = 8.0;
const HOLD_S: f64 = 4.0;
const WAIT_S: f64 = 18.0;
/// J as a share of the pipe.
const STEP: f64 = 0.125;

/// The critical gain of `desk`'s controller on `model`, as a multiple of the gain in force. `None`: the loop is stable
/// up to 64 times its gain, or unstable down to a sixteenth, or the active controller has no gain.
pub(super) fn critical_gain(desk: &Desk, model: &Model) -> Option<f64> {
    let one = desk.with_gain(1.0)?;
    let model = without_chance(model);
    let (bottom_mm, top_mm) = model.ends_mm();
    let trial = Trial::about((bottom_mm + top_mm) / 2.0, STEP * (top_mm - bottom_mm), bottom_mm);
    let lost = |ratio: f64| one.with_gain(ratio).is_some_and(|desk| trial.loses(&desk, &model));
    let (mut below, mut above) = if lost(1.0) {
        let below = (1..=STRIDES_DOWN).map(|n| STRIDE.powi(-n.cast_signed())).find(|ratio| !lost(*ratio))?;
        (below, below * STRIDE)
    } else {
        let above = (1..=STRIDES_UP).map(|n| STRIDE.powi(n.cast_signed())).find(|ratio| lost(*ratio))?;
        (above / STRIDE, above)
    };
    for _ in 0..BISECTIONS {
        let middle = (below * above).sqrt();
        (below, above) = if lost(middle) { (below, middle) } else { (middle, above) };
    }
    Some(above)
}

/// The model without anything that is random.
fn without_chance(model: &Model) -> Model {
    let mut model = model.clone();
    model.noise = Noise { sensor_mm: 0.0, acceleration_psd_mm2_per_s3: 0.0 };
    for entry in model.effects.present().iter().filter(|entry| entry.acts.is_random()) {
        model.effects.remove(entry.name);
    }
    model
}

/// A ramp, a step and a wait.
struct Trial {
    experiment: Experiment,
    jump_mm: f64,
}

impl Trial {
    fn about(centre_mm: f64, jump_mm: f64, bottom_mm: f64) -> Self {
        let segment = |duration_s, wave| Segment { duration_s, setpoint_mm: Some(wave), ..Segment::default() };
        let low = centre_mm - jump_mm / 2.0;
        let segments = vec![
            segment(RAMP_S + HOLD_S, Waveform::Ramp { from: bottom_mm, to: low, over_s: RAMP_S }),
            segment(WAIT_S, Waveform::Constant { value: low + jump_mm }),
        ];
        let segments = segments.into();
        Self { experiment: Experiment { title: String::new(), limits: Limits::default(), segments }, jump_mm }
    }

    fn loses(&self, desk: &Desk, model: &Model) -> bool {
        let flown = desk.fly(model, &self.experiment, 1);
        let last_s = RAMP_S + HOLD_S + WAIT_S * 2.0 / 3.0;
        let late = flown.cycles.iter().filter(|cycle| cycle.time_s >= last_s).filter_map(|cycle| cycle.position_mm);
        let (low, high) = late.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mm| (low.min(mm), high.max(mm)));
        flown.fault.is_some() || high - low >= self.jump_mm
    }
}
