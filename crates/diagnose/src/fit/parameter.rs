//! The parameters of a fit, each in its own scale, and their prior, which is the owner's belief.
//!
//! ```text
//! −ln p(d) = (ν + 1)/2 · ln( 1 + d²/(ν·s²) )        d: distance from the belief, Student's t with scale s
//! ```
//!
//! An owner knows gain and drag to some percent, unless they are altogether wrong: a scale of 5 % with the tails of a
//! Cauchy distribution (ν = 1), so that a parameter far from its belief costs only a few nats, and the prior does not
//! stop it on the way. The noise of a sensor is measured on a ball at rest and better known (2 %), the noise of the air
//! less so (10 %), both with ν = 10: the growth of these noises that would explain a record costs as much as an effect.
//! The parameters of an effect that is not believed have no prior.

use crate::fit::bounds::Bounds;
use plant::{Changes, Entry, Model, Param, Scale};

/// A parameter of the model that a fit may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// `gain_mm_per_s2_per_percent`, as a ratio.
    Gain,
    /// `drag_per_s`, as a ratio of drag + 1/s: a ratio of the drag alone has no slope at 0, and a fit that came there
    /// would stay.
    Drag,
    /// `hover_duty_percent`, in tenths of a percent.
    Hover,
    /// `noise.sensor_mm`, as a ratio.
    SensorNoise,
    /// `noise.acceleration_psd_mm2_per_s3`, as a ratio.
    AirNoise,
    /// Both noises, as one ratio of standard deviations: the filter keeps its bandwidth.
    NoiseLevel,
    /// A parameter of an effect that is on.
    Effect {
        /// The effect.
        entry: &'static Entry,
        /// The index of the parameter.
        index: usize,
        /// A typical size on a rig.
        size: f64,
    },
}

/// The prior of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prior {
    /// The owner's belief, see [`Parameter`].
    Belief,
    /// None: maximum likelihood.
    Nothing,
}

/// The parameters that every model has, noise last.
pub(crate) const BASE: [Parameter; 5] =
    [Parameter::Gain, Parameter::Drag, Parameter::Hover, Parameter::SensorNoise, Parameter::AirNoise];

/// Scale of the prior of gain and drag, as a share.
const KNOWN: f64 = 0.05;
/// Scale of the prior of an effect's parameter, as a share of its value.
const EFFECT_KNOWN: f64 = 0.07;
/// Below this drag its scale is linear, 1/s: the ball then keeps its speed for a second, which a forecast of 1 s hardly
/// tells from no drag. Chosen, not fitted.
const LINEAR_DRAG: f64 = 1.0;
/// Least drag of which the owner knows some percent, 1/s, so that a belief of 0 can move. Chosen, not fitted.
const LEAST_DRAG: f64 = 0.1;
/// Lower limits of noises, so that a belief of 0 can move: mm and mm²/s³. Both are far below those of an encoder's
/// step.
const LEAST_SENSOR_MM: f64 = 1e-5;
const LEAST_AIR: f64 = 1e-6;

/// Longest move of a parameter with a ratio scale: from a noise believed 0 to that of the worst sensor.
const FARTHEST: f64 = 25.0;

/// The parameters of an effect that a fit moves, each in steps of the size of `values`; not those that are given with
/// the effect, and none for an effect whose value is read off the readings.
pub(crate) fn parameters_of_effect(entry: &'static Entry, values: &[f64]) -> Vec<Parameter> {
    if entry.start.is_read_off() {
        return Vec::new();
    }
    let is_fitted =
        |(index, _): &(usize, &f64)| entry.params.get(*index).is_some_and(|param| param.scale != Scale::Given);
    let fitted = values.iter().enumerate().filter(is_fitted);
    fitted.map(|(index, value)| Parameter::Effect { entry, index, size: entry.step_size(index, *value) }).collect()
}

impl Parameter {
    /// Scale and degrees of freedom of the prior; `None` where there is no belief.
    fn belief(self, belief: &Model) -> Option<(f64, f64)> {
        match self {
            Self::Gain => Some((KNOWN, 1.0)),
            Self::Drag => {
                let drag = belief.drag_per_s.max(LEAST_DRAG);
                Some((KNOWN * drag / (drag + LINEAR_DRAG), 1.0))
            }
            Self::Hover => Some((1.0, 1.0)),
            Self::SensorNoise => Some((0.02, 10.0)),
            Self::AirNoise => Some((0.1, 10.0)),
            Self::NoiseLevel => None,
            Self::Effect { size, .. } => {
                let believed = self.value(belief)?;
                Some((EFFECT_KNOWN * believed.abs().max(0.1 * size) / size, 1.0))
            }
        }
    }

    /// The distance of `model` from `belief`, in the parameter's own scale.
    #[must_use]
    pub fn distance(self, model: &Model, belief: &Model) -> f64 {
        let ratio = |a: f64, b: f64, least: f64| (a.max(least) / b.max(least)).ln();
        match self {
            Self::Gain => (model.gain_mm_per_s2_per_percent / belief.gain_mm_per_s2_per_percent).ln(),
            Self::Drag => ((model.drag_per_s + LINEAR_DRAG) / (belief.drag_per_s + LINEAR_DRAG)).ln(),
            Self::Hover => (model.hover_duty_percent - belief.hover_duty_percent) / 0.1,
            Self::SensorNoise | Self::NoiseLevel => {
                ratio(model.noise.sensor_mm, belief.noise.sensor_mm, LEAST_SENSOR_MM)
            }
            Self::AirNoise => {
                let psd = |model: &Model| model.noise.acceleration_psd_mm2_per_s3;
                ratio(psd(model), psd(belief), LEAST_AIR)
            }
            Self::Effect { size, .. } => {
                self.value(model).zip(self.value(belief)).map_or(0.0, |(there, believed)| (there - believed) / size)
            }
        }
    }

    /// The value as the config has it; `None` where the effect is off.
    #[must_use]
    pub fn value(self, model: &Model) -> Option<f64> {
        match self {
            Self::Gain => Some(model.gain_mm_per_s2_per_percent),
            Self::Drag => Some(model.drag_per_s),
            Self::Hover => Some(model.hover_duty_percent),
            Self::SensorNoise | Self::NoiseLevel => Some(model.noise.sensor_mm),
            Self::AirNoise => Some(model.noise.acceleration_psd_mm2_per_s3),
            Self::Effect { entry, index, .. } => model.effects.values(entry.name)?.get(index).copied(),
        }
    }

    /// Its key in its table of the config.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Gain => "gain_mm_per_s2_per_percent",
            Self::Drag => "drag_per_s",
            Self::Hover => "hover_duty_percent",
            Self::SensorNoise | Self::NoiseLevel => "sensor_mm",
            Self::AirNoise => "acceleration_psd_mm2_per_s3",
            Self::Effect { .. } => self.param().map_or("", |param| param.name),
        }
    }

    /// Its name and its bounds; `None` for noises.
    pub(crate) fn param(self) -> Option<&'static Param> {
        match self {
            Self::Gain => Some(&Model::GAIN),
            Self::Drag => Some(&Model::DRAG),
            Self::Hover => Some(&Model::HOVER),
            Self::SensorNoise | Self::AirNoise | Self::NoiseLevel => None,
            Self::Effect { entry, index, .. } => entry.params.get(index),
        }
    }

    /// The value at which it has no effect; `None` for base parameters.
    pub(crate) fn neutral(self, model: &Model) -> Option<f64> {
        let Self::Effect { index, .. } = self else { return None };
        self.entry()?.neutral(model).get(index).copied()
    }

    /// The model with this value of the parameter.
    pub(crate) fn with_value(self, model: &Model, value: f64) -> Model {
        let mut model = model.clone();
        match self {
            Self::Gain => model.gain_mm_per_s2_per_percent = value,
            Self::Drag => model.drag_per_s = value,
            Self::Hover => model.hover_duty_percent = value,
            Self::SensorNoise | Self::NoiseLevel => model.noise.sensor_mm = value,
            Self::AirNoise => model.noise.acceleration_psd_mm2_per_s3 = value,
            Self::Effect { entry: Entry { name, .. }, index, .. } => {
                let mut values = model.effects.values(name).unwrap_or_default();
                if let Some(old) = values.get_mut(index) {
                    *old = value;
                }
                model.effects.set(name, &values);
            }
        }
        model
    }

    /// The distance to its bound in `model` on the side of `towards`, in its own scale.
    pub(crate) fn room(self, model: &Model, towards: f64, bounds: &Bounds) -> f64 {
        let Self::Effect { size, .. } = self else { return f64::INFINITY };
        let [low, high] = bounds.range(self);
        let Some(value) = self.value(model) else { return f64::INFINITY };
        (if towards < 0.0 { value - low } else { high - value }) / size
    }

    /// Whether it is a parameter of this effect.
    pub(crate) fn is_of(self, effect: &str) -> bool {
        matches!(self, Self::Effect { entry, .. } if entry.name == effect)
    }

    /// Its index among the parameters of this effect; `None` for others.
    pub(crate) fn index_in(self, effect: &str) -> Option<usize> {
        match self {
            Self::Effect { entry, index, .. } if entry.name == effect => Some(index),
            _ => None,
        }
    }

    /// The effect that it belongs to; `None` for base parameters.
    pub(crate) fn entry(self) -> Option<&'static Entry> {
        let Self::Effect { entry, .. } = self else { return None };
        Some(entry)
    }

    /// Whether it is a level of noise, which moves no forecast.
    pub(crate) fn is_noise(self) -> bool {
        matches!(self, Self::SensorNoise | Self::AirNoise | Self::NoiseLevel)
    }

    /// Whether it changes the density of a reading, rather than its expectation or variance.
    pub(crate) fn is_of_the_density(self) -> bool {
        self.entry().is_some_and(|entry| entry.acts.changes == Changes::Density)
    }

    /// The distance of a parameter from its neutral value, in its own scale, clamped to ±1; `None` unless its effect is
    /// absent from the belief.
    pub(crate) fn distance_from_neutral(self, model: &Model, belief: &Model) -> Option<f64> {
        let Self::Effect { entry, index, size } = self else { return None };
        if belief.effects.values(entry.name).is_some() {
            return None;
        }
        let neutral = *entry.neutral(model).get(index)?;
        Some(((self.value(model)? - neutral) / size).clamp(-1.0, 1.0))
    }

    /// ln of the prior density at `model`, up to a constant; its slope; and an upper bound of its curvature.
    pub(crate) fn prior(self, model: &Model, belief: &Model) -> (f64, f64, f64) {
        let Some((scale, tail)) = self.belief(belief) else { return (0.0, 0.0, 0.0) };
        let d = self.distance(model, belief);
        let width = tail * scale * scale;
        let curvature = (tail + 1.0) / (width + d * d);
        (-(tail + 1.0) / 2.0 * (d * d / width).ln_1p(), -d * curvature, curvature)
    }

    /// Step of numerical derivatives in the parameter's own scale: 1 % of it, far above rounding.
    pub(crate) const DIFFERENCE: f64 = 0.01;

    /// The model with this parameter moved by `by` in its own scale, within its bounds.
    #[must_use]
    pub fn stepped(self, model: &Model, by: f64) -> Model {
        let mut model = model.clone();
        let ratio = by.clamp(-FARTHEST, FARTHEST).exp();
        let scaled = |number: f64, least: f64| (number.max(least) * ratio).max(least);
        match self {
            Self::Gain => model.gain_mm_per_s2_per_percent *= ratio,
            Self::Drag => {
                let drag = (model.drag_per_s + LINEAR_DRAG) * ratio - LINEAR_DRAG;
                model.drag_per_s = drag.clamp(0.0, 1e3);
            }
            Self::Hover => model.hover_duty_percent += 0.1 * by,
            Self::SensorNoise => model.noise.sensor_mm = scaled(model.noise.sensor_mm, LEAST_SENSOR_MM),
            Self::NoiseLevel => {
                model.noise.sensor_mm = scaled(model.noise.sensor_mm, LEAST_SENSOR_MM);
                model.noise.acceleration_psd_mm2_per_s3 *= ratio * ratio;
            }
            Self::AirNoise => {
                let psd = &mut model.noise.acceleration_psd_mm2_per_s3;
                *psd = scaled(*psd, LEAST_AIR);
            }
            Self::Effect { entry: Entry { name, .. }, index, size } => {
                let mut values = model.effects.values(name).unwrap_or_default();
                if let (Some(value), Some(param)) = (values.get_mut(index), self.param()) {
                    *value = (*value + size * by).clamp(param.min, param.max);
                }
                model.effects.set(name, &values);
            }
        }
        model
    }
}

/// ln of the prior density of `model` over these parameters, up to a constant.
#[must_use]
pub(crate) fn prior(parameters: &[Parameter], model: &Model, belief: &Model) -> f64 {
    parameters.iter().map(|parameter| parameter.prior(model, belief).0).sum()
}
