//! The prediction of the filter: from one instant to another, through every duty that is written between them.

use super::covariance::{Propagation, PropagationCache, motion_of, vector};
use super::fast_duty::DutyBlock;
use super::step::{MAX_STEP_S, Step, longest_step_s, parts_by_drag, steps_over};
use super::{Ekf, State};
use plant::{Actuator, Friction, Motion};

impl Ekf<'_> {
    /// Propagates to `time_s` through every written duty and every jump of the command.
    pub(super) fn advance_to(&mut self, time_s: f64, steps: &mut PropagationCache) {
        let start_s = self.writes.first().map_or(0.0, |first| first.time_s);
        let mut chatter = DutyBlock::from(self.time_s);
        while self.time_s < time_s || self.next_write == 0 {
            let written = self.writes.get(self.next_write);
            let write_s = written.map_or(f64::INFINITY, |write| write.time_s - start_s);
            if let Some(write) = written.filter(|_| write_s <= chatter.until_s) {
                self.actuator.set_setpoint(write.setpoint_mm);
                self.actuator.write(self.model, write_s.max(0.0), write.duty_percent);
                self.next_write += 1;
                continue;
            }
            if self.time_s >= time_s {
                break;
            }
            let jump_s = self.actuator.next_jump_s(chatter.until_s).unwrap_or(f64::INFINITY);
            let next_s = time_s.min(write_s).min(jump_s);
            if self.flown.averages() {
                self.average_duty(&mut chatter, next_s, next_s >= time_s, steps);
            } else {
                self.propagate_to(next_s, steps);
                chatter.until_s = next_s;
            }
        }
    }

    /// Where duties are written faster than a ball responds, adds each to `chatter` until all are propagated at once.
    fn average_duty(&mut self, chatter: &mut DutyBlock, next_s: f64, last: bool, known: &mut PropagationCache) {
        let middle_s = 0.5 * (chatter.until_s + next_s);
        chatter.add(self.actuator.commanded(self.model, middle_s.max(0.0)), next_s);
        let dt = next_s - self.time_s;
        if dt > 0.0 && (last || dt >= MAX_STEP_S) {
            let (commands, step_s) = chatter.as_few(self.flown);
            commands.for_each(|commanded| self.step(commanded, step_s, known));
            self.time_s = next_s;
            *chatter = DutyBlock::from(next_s);
        }
    }

    /// Propagates to `time_s`; the command does not jump before.
    fn propagate_to(&mut self, time_s: f64, known: &mut PropagationCache) {
        let (start, ahead) = (self.time_s, time_s - self.time_s);
        // Where one step does in any case, the rates need not be computed.
        let steps = if ahead <= MAX_STEP_S { 1.0 } else { steps_over(ahead, self.longest_step_s()) };
        let dt = ahead / steps;
        let drifts = Actuator::drifts(self.model);
        let mut commanded = self.actuator.commanded(self.model, start.max(0.0));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
        for step in 0..steps as u64 {
            if drifts {
                commanded = self.actuator.commanded(self.model, (start + (step as f64 + 0.5) * dt).max(0.0));
            }
            self.step(commanded, dt, known);
        }
        self.time_s = time_s;
    }

    /// The longest integration step from here, seconds.
    fn longest_step_s(&self) -> f64 {
        longest_step_s(motion_of(&self.state).fastest_rate_per_s(self.model, self.input()))
    }

    /// A step of `dt` seconds, in parts where the time constant of drag and smooth friction is shorter.
    fn step(&mut self, commanded: f64, dt: f64, known: &mut PropagationCache) {
        let friction = self.model.effects.smooth_friction();
        let friction_per_s = friction.map_or(0.0, |friction| friction.steepness_per_s());
        let parts = parts_by_drag(self.model.drag_per_s + friction_per_s, dt);
        for _ in 0..parts {
            self.part(commanded, dt / f64::from(parts), known);
        }
    }

    /// One integration step of `dt` seconds.
    fn part(&mut self, commanded: f64, dt: f64, known: &mut PropagationCache) {
        self.commanded_mm_per_s2 = commanded;
        let motion = motion_of(&self.state);
        let step = Step::new(self.model, self.input(), dt, self.covariance[(1, 1)].max(0.0).sqrt());
        if !self.keeps_covariance && !self.linear {
            self.state = vector(&step.after(&motion));
            self.time_s += dt;
            return;
        }
        let (next, propagation) = if self.linear {
            let (shared, scratch) = known.shared(dt, |new| new.set_linear(&self.active, &step));
            match self.slid(&step, &motion, shared) {
                Some((after, friction)) if friction.slope_per_s == 0.0 => (Some(after), shared),
                Some((after, friction)) => {
                    scratch.set_with_friction(shared, &self.active, &step, friction.slope_per_s);
                    (Some(after), &*scratch)
                }
                None => (Some(scratch.set(&self.active, &step, &motion)), &*scratch),
            }
        } else {
            let mut next = None;
            let propagation = known.propagation(dt, |new| next = Some(new.set(&self.active, &step, &motion)));
            (next, propagation)
        };
        let next = self.in_the_air(next).unwrap_or_else(|| vector(&step.after(&motion)));
        if let Some(back) = &mut self.back {
            back.go(&propagation.transition);
        }
        self.state = next;
        if self.keeps_covariance {
            self.active.predict(&propagation.transition, &propagation.noise, &mut self.covariance);
        }
        self.time_s += dt;
    }

    /// The state after a linear step and the friction during it. `None`: friction stops the ball.
    fn slid(&self, step: &Step<'_>, motion: &Motion, shared: &Propagation) -> Option<(State, Friction)> {
        let friction = step.friction(motion)?;
        let after = shared.moved(&self.active, &self.state, self.commanded_mm_per_s2, friction.mm_per_s2)?;
        step.slides(motion, &motion_of(&after)).then_some((after, friction))
    }

    /// The state after a step, where the step touches no end of the pipe.
    fn in_the_air(&self, next: Option<State>) -> Option<State> {
        let (bottom, top) = self.model.ends_mm();
        let between = |state: &State| bottom < state[0] && state[0] < top;
        next.filter(|next| between(&self.state) && between(next))
    }
}
