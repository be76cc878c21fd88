//! The model: what is believed of a rig. The config's `[plant]`.
//!
//! ```text
//! ÿ = gain·(duty − hover) − drag·ẏ        the linear part, K_g/(s(s + a)) of the thesis
//! ```
//!
//! Source: the thesis, equation 3.1.1.14. The effects come on top, in the order of the signal path.

use crate::acts::{Conditions, Direction};
use crate::actuator::Actuator;
use crate::effect::{Neutral, Param, Scale};
use crate::effects::Effects;
use crate::motion::{Input, Motion, OWN_STATES};
use crate::unsound::Unsound;
use control::check::{OutOfRange, within};
use serde::{Deserialize, Serialize};

/// The believed rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// K_g: acceleration per percent of duty about hover, mm/s² per percent.
    pub gain_mm_per_s2_per_percent: f64,
    /// a: linear drag of the ball in the air stream, 1/s.
    pub drag_per_s: f64,
    /// Duty at which the ball hovers, percent.
    pub hover_duty_percent: f64,
    /// Lower end of the pipe, mm: where another zero of the position is of use. The ball rests there, without bounce.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub pipe_bottom_mm: f64,
    /// Length of the pipe, mm; the ball rests, without bounce, at its upper end, too.
    pub pipe_length_mm: f64,
    /// Length of one turn, mm, where the position is an angle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_mm: Option<f64>,
    /// What is random.
    pub noise: Noise,
    /// What is switched on beyond the linear part.
    #[serde(default)]
    pub effects: Effects,
}

/// The random part of a model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Standard deviation of one reading of the sensor, mm.
    pub sensor_mm: f64,
    /// White acceleration: the variance of the velocity grows by this per second, mm²/s³.
    pub acceleration_psd_mm2_per_s3: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// A base parameter with its bounds.
const fn base(name: &'static str, min: f64, max: f64) -> Param {
    Param { name, min, max, neutral: Neutral::Any(0.0), scale: Scale::Value }
}

impl Model {
    /// The longest pipe that a model may have, mm.
    pub const LONGEST_PIPE_MM: f64 = 1e6;
    /// The gain, which is positive on every rig: duty upward is force upward.
    pub const GAIN: Param = base("gain_mm_per_s2_per_percent", 1e-6, 1e6);
    /// The linear drag.
    pub const DRAG: Param = base("drag_per_s", 0.0, 1e3);
    /// The duty at hover. Another rig's duty may be any number; a record narrows it to the duties that it holds.
    pub const HOVER: Param = base("hover_duty_percent", -1e3, 1e3);

    /// Checks every number against its bounds, and that the effects go together.
    ///
    /// # Errors
    /// The table below `[plant]` (empty for `[plant]` itself) and the first thing wrong there.
    pub fn check(&self) -> Result<(), (String, Unsound)> {
        let base = || -> Result<(), OutOfRange> {
            for (param, value) in [
                (Self::GAIN, self.gain_mm_per_s2_per_percent),
                (Self::DRAG, self.drag_per_s),
                (Self::HOVER, self.hover_duty_percent),
            ] {
                within(param.name, value, param.min, param.max)?;
            }
            within("pipe_bottom_mm", self.pipe_bottom_mm, -Self::LONGEST_PIPE_MM, Self::LONGEST_PIPE_MM)?;
            within("pipe_length_mm", self.pipe_length_mm, 1.0, Self::LONGEST_PIPE_MM)?;
            self.turn_mm.map_or(Ok(()), |turn_mm| within("turn_mm", turn_mm, 1e-3, 1e6))
        };
        let noise = || -> Result<(), OutOfRange> {
            within("sensor_mm", self.noise.sensor_mm, 0.0, 1e3)?;
            within("acceleration_psd_mm2_per_s3", self.noise.acceleration_psd_mm2_per_s3, 0.0, 1e9)
        };
        base().map_err(|error| (String::new(), error.into()))?;
        noise().map_err(|error| ("noise".into(), error.into()))?;
        self.effects.check().map_err(|(effect, error)| (format!("effects.{effect}"), error))
    }

    /// The acceleration that a duty commands which has acted for ever before time 0, mm/s² about hover.
    #[must_use]
    pub fn commanded(&self, duty_percent: f64) -> f64 {
        Actuator::new(self, duty_percent).commanded(self, 0.0)
    }

    /// The acceleration that the effects add to a ball at rest at a height, mm/s².
    #[must_use]
    pub fn force_at_rest(&self, position_mm: f64) -> f64 {
        self.effects.accelerated(0.0, &Conditions { position_mm, ..self.conditions() })
    }

    /// The conditions of a ball at rest at the bottom at time 0, with the fan at hover.
    #[inline(always)]
    #[must_use]
    pub const fn conditions(&self) -> Conditions {
        Conditions {
            time_s: 0.0,
            setpoint_mm: self.setpoint(None),
            position_mm: self.pipe_bottom_mm,
            velocity_mm_per_s: 0.0,
            commanded_mm_per_s2: 0.0,
            fan_mm_per_s2: 0.0,
            own: [0.0; OWN_STATES],
            gain_mm_per_s2_per_percent: self.gain_mm_per_s2_per_percent,
            drag_per_s: self.drag_per_s,
            hover_duty_percent: self.hover_duty_percent,
            middle_mm: self.middle_mm(),
        }
    }

    /// The conditions of a motion under an input.
    #[must_use]
    pub fn conditions_of(&self, motion: &Motion, input: Input) -> Conditions {
        Conditions {
            time_s: input.time_s,
            setpoint_mm: self.setpoint(input.setpoint_mm),
            position_mm: motion.position_mm,
            velocity_mm_per_s: motion.velocity_mm_per_s,
            commanded_mm_per_s2: input.commanded_mm_per_s2,
            fan_mm_per_s2: motion.fan_mm_per_s2,
            own: motion.own,
            ..self.conditions()
        }
    }

    /// The setpoint that effects depend on, mm: mid-pipe where none is known.
    #[inline(always)]
    pub(crate) const fn setpoint(&self, known_mm: Option<f64>) -> f64 {
        match known_mm {
            Some(setpoint_mm) => setpoint_mm,
            None => self.middle_mm(),
        }
    }

    /// The ball at rest at `position_mm` where a constant command has acted for ever.
    #[must_use]
    pub fn at_rest(&self, position_mm: f64, commanded_mm_per_s2: f64) -> Motion {
        self.at_rest_under(position_mm, Input::of(commanded_mm_per_s2))
    }

    /// The same of a constant input.
    #[must_use]
    pub fn at_rest_under(&self, position_mm: f64, input: Input) -> Motion {
        let motion = Motion::at_rest(position_mm, input.commanded_mm_per_s2);
        let conditions = self.conditions_of(&motion, input);
        Motion { own: self.effects.own_settled(&conditions), ..motion }
    }

    /// What the sensor shows of a motion, mm, but for its delay and what is random.
    #[must_use]
    #[inline]
    pub fn seen_mm(&self, motion: &Motion, input: Input) -> f64 {
        if !self.effects.acts_on_reading() {
            return motion.sensed_mm;
        }
        motion.sensed_mm + self.effects.written.reading_shift(&self.conditions_of_sensor(motion, input))
    }

    /// The directional derivative of [`Model::seen_mm`] by the state, along `along`.
    #[must_use]
    pub fn seen_along(&self, motion: &Motion, input: Input, along: &Motion) -> f64 {
        let direction = Direction {
            position: along.sensed_mm,
            velocity: along.velocity_mm_per_s,
            fan: along.fan_mm_per_s2,
            own: along.own,
        };
        let conditions = self.conditions_of_sensor(motion, input);
        along.sensed_mm + self.effects.written.reading_shift_along(&conditions, &direction)
    }

    /// The conditions of the sensor, which knows the height behind its inertia.
    fn conditions_of_sensor(&self, motion: &Motion, input: Input) -> Conditions {
        Conditions { position_mm: motion.sensed_mm, ..self.conditions_of(motion, input) }
    }

    /// Standard deviations of the own states before the first reading, each in its unit.
    #[must_use]
    pub fn own_spread(&self) -> [f64; OWN_STATES] {
        self.effects.own_spread(&self.conditions())
    }

    /// Both ends of the pipe, mm: bottom and top.
    #[must_use]
    pub const fn pipe_mm(&self) -> (f64, f64) {
        (self.pipe_bottom_mm, self.pipe_bottom_mm + self.pipe_length_mm)
    }

    /// The middle of the pipe, mm.
    #[inline(always)]
    #[must_use]
    pub const fn middle_mm(&self) -> f64 {
        self.pipe_bottom_mm + 0.5 * self.pipe_length_mm
    }

    /// Where the ball's way ends, mm: bottom and top.
    #[must_use]
    pub fn ends_mm(&self) -> (f64, f64) {
        self.effects.ends().map_or(self.pipe_mm(), |stop| (stop.bottom_mm, stop.top_mm))
    }

    /// The velocity after a hit at an end, mm/s. The ends of the pipe itself give no bounce.
    pub(crate) fn rebound(&self, velocity_mm_per_s: f64) -> f64 {
        self.effects.ends().map_or(0.0, |stop| stop.rebound(velocity_mm_per_s))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::{Model, Noise};
    use crate::effects::{Effects, FanLag};

    /// The three-pole model G_c of the thesis.
    pub(crate) fn thesis() -> Model {
        Model {
            gain_mm_per_s2_per_percent: 827.2,
            drag_per_s: 3.896,
            hover_duty_percent: 21.4,
            pipe_bottom_mm: 0.0,
            pipe_length_mm: 583.0,
            turn_mm: None,
            noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
            effects: Effects { fan_lag: Some(FanLag { time_constant_s: 0.257 }), ..Effects::default() },
        }
    }

    #[test]
    fn a_wrong_number_is_named_with_its_table() {
        let mut model = thesis();
        assert!(model.check().is_ok());
        model.noise.sensor_mm = f64::NAN;
        assert_eq!(model.check().unwrap_err().0, "noise");
        model = thesis();
        model.effects.fan_lag = Some(FanLag { time_constant_s: 9.0 });
        let (table, error) = model.check().unwrap_err();
        assert_eq!((table.as_str(), error.key()), ("effects.fan_lag", "time_constant_s"));
    }
}
