//! The ball in its air stream.
//!
//! ```text
//! dy/dt = v
//! dv/dt = A − a·v               A: acceleration by the fan's air about hover    a: linear drag
//! dA/dt = fan lag, or A = A_cmd without it
//! at an end of the pipe the ball rests: y stays at 0 or L until the force points inward
//! ```
//!
//! Linear about hover: v_f − v_eq and v are small beside v_eq.
//! Source: the thesis, equations 3.1.1.8 and 3.1.1.10 with K_g = gain; RK4 between events.

use crate::effects::FanLag;
use crate::model::Model;
use crate::rk4;

/// State of the plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// y, mm above the bottom of the pipe.
    pub position_mm: f64,
    /// v, mm/s, upward.
    pub velocity_mm_per_s: f64,
    /// A, mm/s²: what the fan's air does to the ball at rest, about hover.
    pub fan_mm_per_s2: f64,
}

impl Motion {
    /// The ball at rest at `position_mm` with the fan settled at `commanded` mm/s².
    #[must_use]
    pub const fn at_rest(position_mm: f64, commanded: f64) -> Self {
        Self { position_mm, velocity_mm_per_s: 0.0, fan_mm_per_s2: commanded }
    }

    /// One RK4 step of `dt_s` under a constant `commanded` acceleration, mm/s², and the ends of the pipe.
    #[must_use]
    pub fn step(&self, model: &Model, commanded: f64, dt_s: f64) -> Self {
        self.step_in_endless_pipe(model, commanded, dt_s).within_pipe(model.pipe_length_mm)
    }

    /// The same step where the pipe has no ends.
    #[must_use]
    pub fn step_in_endless_pipe(&self, model: &Model, commanded: f64, dt_s: f64) -> Self {
        let [y, v, fan] = match model.effects.fan_lag.filter(FanLag::acts) {
            Some(lag) => {
                let rate = |x: &[f64; 3]| [x[1], x[2] - model.drag_per_s * x[1], lag.rate(commanded, x[2])];
                rk4::step(rate, &[self.position_mm, self.velocity_mm_per_s, self.fan_mm_per_s2], dt_s)
            }
            None => {
                let rate = |x: &[f64; 2]| [x[1], commanded - model.drag_per_s * x[1]];
                let [y, v] = rk4::step(rate, &[self.position_mm, self.velocity_mm_per_s], dt_s);
                [y, v, commanded]
            }
        };
        Self { position_mm: y, velocity_mm_per_s: v, fan_mm_per_s2: fan }
    }

    /// The ends of the pipe: the ball stops there without a bounce.
    #[must_use]
    fn within_pipe(self, length_mm: f64) -> Self {
        if self.position_mm < 0.0 {
            Self { position_mm: 0.0, velocity_mm_per_s: self.velocity_mm_per_s.max(0.0), ..self }
        } else if self.position_mm > length_mm {
            Self { position_mm: length_mm, velocity_mm_per_s: self.velocity_mm_per_s.min(0.0), ..self }
        } else {
            self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Motion;
    use crate::effects::{DeadZone, Effects, FanLag};
    use crate::model::{Model, tests::thesis};
    use libm::exp;

    fn fly(model: &Model, duty: f64, seconds: f64, steps: u32, start: Motion) -> Motion {
        let commanded = model.commanded(duty);
        let dt = seconds / f64::from(steps);
        (0..steps).fold(start, |motion, _| motion.step(model, commanded, dt))
    }

    #[test]
    fn a_duty_step_without_lag_is_the_closed_form() {
        let model = Model { pipe_length_mm: 1e6, effects: Effects::default(), ..thesis() };
        let (t, a) = (0.8, model.drag_per_s);
        let force = model.gain_mm_per_s2_per_percent * 0.5;
        let end = fly(&model, model.hover_duty_percent + 0.5, t, 800, Motion::at_rest(0.0, 0.0));
        let exact = force / a * (t - (1.0 - exp(-a * t)) / a);
        assert!((end.position_mm - exact).abs() < 1e-9, "{} mm, exact {exact} mm", end.position_mm);
    }

    #[test]
    fn a_duty_step_through_the_double_pole_of_g_c_is_the_closed_form() {
        // τ = 1/a: velocity F/a·(1 − (1 + a·t)·e^(−a·t)), position its integral.
        let a = 3.896;
        let lag = FanLag { time_constant_s: 1.0 / a };
        let effects = Effects { fan_lag: Some(lag), ..Effects::default() };
        let model = Model { pipe_length_mm: 1e6, effects, ..thesis() };
        let force = model.gain_mm_per_s2_per_percent;
        let t = 1.0;
        let end = fly(&model, model.hover_duty_percent + 1.0, t, 1000, Motion::at_rest(0.0, 0.0));
        let decay = exp(-a * t);
        let velocity = force / a * (1.0 - (1.0 + a * t) * decay);
        let position = force / a * (t - 2.0 / a * (1.0 - decay) + t * decay);
        assert!((end.velocity_mm_per_s - velocity).abs() < 1e-8, "{} mm/s, exact {velocity}", end.velocity_mm_per_s);
        assert!((end.position_mm - position).abs() < 1e-8, "{} mm, exact {position}", end.position_mm);
    }

    #[test]
    fn the_ball_rests_at_both_ends_and_leaves_them_when_pushed() {
        let model = Model { effects: Effects::default(), ..thesis() };
        let bottom = fly(&model, model.hover_duty_percent - 3.0, 2.0, 2000, Motion::at_rest(100.0, 0.0));
        assert_eq!((bottom.position_mm, bottom.velocity_mm_per_s), (0.0, 0.0));
        let top = fly(&model, model.hover_duty_percent + 3.0, 3.0, 3000, bottom);
        assert_eq!((top.position_mm, top.velocity_mm_per_s), (model.pipe_length_mm, 0.0));
        let falling = fly(&model, model.hover_duty_percent - 1.0, 0.1, 100, top);
        assert!(falling.position_mm < model.pipe_length_mm && falling.velocity_mm_per_s < 0.0);
    }

    #[test]
    fn neutral_effects_change_nothing_bit_for_bit() {
        let bare = Model { effects: Effects::default(), ..thesis() };
        let zone = DeadZone { lower_percent: 0.0, upper_percent: 0.0 };
        let lag = FanLag { time_constant_s: 0.0 };
        let neutral = Model { effects: Effects { dead_zone: Some(zone), fan_lag: Some(lag) }, ..bare.clone() };
        let start = Motion::at_rest(50.0, 0.0);
        assert_eq!(fly(&neutral, 21.9, 0.4, 400, start), fly(&bare, 21.9, 0.4, 400, start));
    }
}
