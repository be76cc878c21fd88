//! A step with dry friction and its derivatives by the states at its start, stop by stop.
//!
//! ```text
//! D = D₂·S·D₁                     D₁, D₂: of the motion before and after a stop
//! S = diag(1, v̇⁺/v̇⁻, 1, …)        v̇⁻, v̇⁺: accelerations right before and after the stop; 0 where friction holds the ball
//! ```
//!
//! S is the saltation matrix of an event at v = 0. Only the acceleration jumps there: dy/dt = v is 0 on both sides.
//! Source: Leine and Nijmeijer, *Dynamics and Bifurcations of Non-Smooth Mechanical Systems*, section 7.

use crate::flow::Flow;
use crate::model::Model;
use crate::motion::{Input, MAX_EVENTS, Motion};
use crate::tangent::{Derivatives, Friction, Phase};

impl Motion {
    /// [`Motion::step_in_endless_pipe`], and its derivatives by the states at its start.
    #[must_use]
    pub fn step_with_derivatives(&self, model: &Model, input: Input, dt_s: f64) -> (Self, Derivatives) {
        let (mut now, mut left) = (*self, dt_s);
        let (mut before, mut events): (Option<(f64, Derivatives)>, _) = (None, 0);
        loop {
            events += 1;
            let flow = Flow { model, input: input.later(dt_s - left) };
            let friction = model.effects.friction();
            // A ball that still moves after so many stops is at rest.
            let direction = now.slides(&flow).filter(|_| events <= MAX_EVENTS);
            let friction =
                direction.zip(friction).map_or(0.0, |(direction, friction)| friction.acceleration(direction));
            let phase =
                direction.map_or(Phase::Held, |_| Phase::Sliding(Friction { mm_per_s2: friction, slope_per_s: 0.0 }));
            let (mut after, mut own) = flow.with_derivatives(&now, phase, left);
            let mut used = left;
            // The stop is searched for only where there is one: most steps have none.
            if let Some(way) = direction.filter(|way| !after.still_slides(*way, friction)) {
                let (stopped, at) = now.until_stop(&flow, way, friction, left);
                (after, own) = flow.with_derivatives(&now, phase, at);
                (after.velocity_mm_per_s, used) = (stopped.velocity_mm_per_s, at);
            }
            if let Some((acceleration, before)) = before {
                let starts = if direction.is_some() { flow.net(&now) + friction } else { 0.0 };
                own = own.following(&before, starts / acceleration);
            }
            left -= used;
            if left <= 0.0 {
                return (after, own);
            }
            let at_stop = Flow { input: input.later(dt_s - left), ..flow };
            before = Some((at_stop.net(&after) + friction, own));
            now = after;
        }
    }
}

impl Derivatives {
    /// These derivatives of a motion that begins at a stop, by the states before it: those there are `before`, and the
    /// acceleration jumps by the factor `jump`.
    fn following(&self, before: &Self, jump: f64) -> Self {
        let of = |start: &Motion| self.of(&Motion { velocity_mm_per_s: jump * start.velocity_mm_per_s, ..*start });
        Self {
            by_position: of(&before.by_position),
            by_velocity: of(&before.by_velocity),
            by_fan: of(&before.by_fan),
            by_turbulence: of(&before.by_turbulence),
            by_sensed: of(&before.by_sensed),
            by_own: before.by_own.each_ref().map(of),
        }
    }

    /// The change after the step with a change at its start.
    fn of(&self, start: &Motion) -> Motion {
        let parts = [
            (&self.by_position, start.position_mm),
            (&self.by_velocity, start.velocity_mm_per_s),
            (&self.by_fan, start.fan_mm_per_s2),
            (&self.by_turbulence, start.turbulence_mm_per_s2),
            (&self.by_sensed, start.sensed_mm),
            (&self.by_own[0], start.own[0]),
            (&self.by_own[1], start.own[1]),
        ];
        let sum = |of: &dyn Fn(&Motion) -> f64| parts.iter().map(|(by, change)| of(by) * change).sum();
        Motion {
            position_mm: sum(&|by| by.position_mm),
            velocity_mm_per_s: sum(&|by| by.velocity_mm_per_s),
            fan_mm_per_s2: sum(&|by| by.fan_mm_per_s2),
            turbulence_mm_per_s2: sum(&|by| by.turbulence_mm_per_s2),
            sensed_mm: sum(&|by| by.sensed_mm),
            own: std::array::from_fn(|state| sum(&|by| by.own[state])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Derivatives;
    use crate::effects::Effects;
    use crate::model::{Model, Noise};
    use crate::motion::{Input, Motion};

    const DT: f64 = 0.02;
    const INPUT: Input = Input::of(60.0);

    fn model(friction: f64) -> Model {
        let mut model = Model {
            gain_mm_per_s2_per_percent: 800.0,
            drag_per_s: 3.0,
            hover_duty_percent: 20.0,
            pipe_bottom_mm: 0.0,
            pipe_length_mm: 600.0,
            turn_mm: None,
            noise: Noise { sensor_mm: 1.0, acceleration_psd_mm2_per_s3: 100.0 },
            effects: Effects::default(),
        };
        for (name, values) in [("fan_lag", [0.2]), ("sensor_lag", [0.1]), ("wall_friction", [friction])] {
            assert!(model.effects.set(name, &values));
        }
        model
    }

    fn rows(motion: &Motion) -> [f64; 4] {
        [motion.position_mm, motion.velocity_mm_per_s, motion.fan_mm_per_s2, motion.sensed_mm]
    }

    /// Derivatives after a step, by position, velocity, fan and sensed position, and the same by central differences.
    fn both(model: &Model, start: &Motion) -> ([[f64; 4]; 4], [[f64; 4]; 4]) {
        let (after, by) = start.step_with_derivatives(model, INPUT, DT);
        let plain = start.step_in_endless_pipe(model, INPUT, DT);
        for (one, other) in rows(&after).into_iter().zip(rows(&plain)) {
            assert!((one - other).abs() < 1e-9, "{after:?} for {plain:?}");
        }
        let Derivatives { by_position, by_velocity, by_fan, by_sensed, .. } = by;
        let nudges: [fn(&mut Motion, f64); 4] = [
            |motion, by| motion.position_mm += by,
            |motion, by| motion.velocity_mm_per_s += by,
            |motion, by| motion.fan_mm_per_s2 += by,
            |motion, by| motion.sensed_mm += by,
        ];
        let differences = nudges.map(|nudge| {
            let at = |by: f64| {
                let mut there = *start;
                nudge(&mut there, by);
                rows(&there.step_in_endless_pipe(model, INPUT, DT))
            };
            let (up, down) = (at(1e-3), at(-1e-3));
            std::array::from_fn(|row| (up[row] - down[row]) / 2e-3)
        });
        ([by_position, by_velocity, by_fan, by_sensed].map(|column| rows(&column)), differences)
    }

    #[test]
    fn a_step_has_the_derivatives_of_differences_when_the_ball_slides_stops_turns_and_is_held() {
        let start = |velocity_mm_per_s: f64, fan_mm_per_s2: f64| Motion {
            velocity_mm_per_s,
            fan_mm_per_s2,
            sensed_mm: 290.0,
            ..Motion::at_rest(300.0, 0.0)
        };
        // The friction is 100 mm/s²: with 40 by the fan the ball stays where it stops, with 400 it turns back.
        for (case, start, ends_at_rest) in [
            ("slides", start(80.0, 40.0), false),
            ("stops", start(0.6, 40.0), true),
            ("turns", start(-2.0, 400.0), false),
            ("is held", start(0.0, 40.0), true),
        ] {
            let (found, expected) = both(&model(100.0), &start);
            let after = start.step_in_endless_pipe(&model(100.0), INPUT, DT);
            assert_eq!(after.velocity_mm_per_s == 0.0, ends_at_rest, "{case}: {after:?}");
            for (column, (found, expected)) in found.iter().zip(&expected).enumerate() {
                for (row, (found, expected)) in found.iter().zip(expected).enumerate() {
                    assert!((found - expected).abs() < 2e-5, "{case}, {row} by {column}: {found} for {expected}");
                }
            }
        }
    }
}
