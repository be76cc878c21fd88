//! The pilot: decides the duty of each cycle. Of observe, decide and act, this is *decide*.
//!
//! ```text
//! waiting ─ first position ─▶ flying / open loop ─ no new position ─▶ coasting ─ too long ─▶ stopped
//!                                   ▲                                     │                     │
//!                                   └──────────── position again ─────────┘        `fly` ───────┘
//! ```
//!
//! It gets samples and times and returns a duty. It reads no clock, bus or file, so that it can be tested without a
//! rig.

mod commands;
mod cross_checks;
mod exchange;
mod modes;
mod programme;
mod stuck_ball;
mod tune;

pub use exchange::{Decision, NoOrders, Orders, Seen, Senses, Signals, reading_period_s};

use super::experiment::Demand;
use super::experiment::offers::Offer;
use super::vocabulary::{Fault, Mode};
use control::Duty;
use control::compensation::Compensator;
use control::controller::Kind;
use control::numbers::Numbers;
use control::observer::Estimate;
use control::pid::Pid;
use cross_checks::Watch;
use programme::{Programme, Started};
use stuck_ball::Still;
use tune::Tuning;

/// How long readings may be missing before the last one is no longer used, in periods of the readings.
const MISSING_PERIODS: f64 = 2.5;
/// A fan that has been off for this time has stopped, seconds.
const OFF_S: f64 = 10.0;

/// The pilot with its memory.
#[derive(Clone, Debug)]
pub struct Pilot {
    orders: Orders,
    /// Experiments that can be started in flight.
    offers: Vec<Offer>,
    /// The one that was started.
    started: Option<Started>,
    mode: Mode,
    compensator: Compensator,
    /// Time of the last decision.
    decided_s: Option<f64>,
    /// Time and value of the last position.
    last: Option<(f64, f64)>,
    /// When the sensor reported something else than the ball, and what.
    reported: Option<(f64, Fault)>,
    /// Numbers that commands change.
    tuning: Tuning,
    /// Progress of the programme.
    programme: Programme,
    /// Start of the wait for the first position.
    waiting_since_s: Option<f64>,
    /// A commanded setpoint, in force instead of the programme's.
    held_mm: Option<f64>,
    control: f64,
    /// The control value that acts on the ball, from any source.
    acting: f64,
    been_in_band: bool,
    still: Still,
    watch: Watch,
    /// The last decided duty.
    duty: Duty,
    fault: Option<Fault>,
}

impl Pilot {
    /// A pilot before take-off.
    #[must_use]
    pub fn new(mut orders: Orders) -> Self {
        let compensator = orders.compensation.start();
        let acting = compensator.control(Duty::OFF);
        orders.regulator.pass(acting, OFF_S);
        let programme = Programme::default();
        let tuning = Tuning::of(Numbers {
            controllers: orders.regulator.controllers().clone(),
            observer: orders.regulator.observer().copied(),
            compensation: orders.compensation.clone(),
        });
        Self {
            compensator,
            tuning,
            orders,
            offers: Vec::new(),
            started: None,
            mode: Mode::Waiting,
            decided_s: None,
            last: None,
            reported: None,
            programme,
            waiting_since_s: None,
            held_mm: None,
            control: 0.0,
            acting,
            been_in_band: false,
            still: Still::default(),
            watch: Watch::default(),
            duty: Duty::OFF,
            fault: None,
        }
    }

    /// What the loop is doing.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// The gains of the PID, where there is one: of the programme's segment, or else those commanded.
    #[must_use]
    pub const fn gains(&self) -> Option<Pid> {
        if self.programme.sets_gains() {
            self.orders.regulator.controllers().pid
        } else {
            self.numbers().controllers.pid
        }
    }

    /// The active controller.
    #[must_use]
    pub const fn controller(&self) -> Kind {
        self.orders.regulator.kind()
    }

    /// The setpoint in force at `time_s`, mm. `None` while the fan is driven without control.
    #[must_use]
    pub fn setpoint_mm(&self, time_s: f64) -> Option<f64> {
        match self.demand(time_s) {
            Some(Demand::Control { setpoint_mm, .. }) => Some(setpoint_mm),
            _ => self.held_mm,
        }
    }

    /// The fault that stopped the flight, if one did.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Largest delay of the cycles behind their deadlines, seconds.
    #[must_use]
    pub const fn stall_s(&self) -> f64 {
        self.orders.safety.stall_s
    }

    /// Whether the programme is over at `time_s`.
    #[must_use]
    pub fn is_over(&self, time_s: f64) -> bool {
        self.started.is_none()
            && self.programme.at_s(time_s).is_some_and(|at_s| self.orders.experiment.demand(at_s).is_none())
    }

    /// Decides the duty from `time_s` on.
    pub fn decide(&mut self, time_s: f64, senses: impl Into<Senses>) -> Decision {
        let senses = senses.into();
        let decision = self.decided(time_s, &senses);
        self.duty = decision.duty;
        decision
    }

    fn decided(&mut self, time_s: f64, senses: &Senses) -> Decision {
        let cycle_s = self.decided_s.replace(time_s).map_or(self.orders.reading_period_s, |last_s| time_s - last_s);
        self.orders.regulator.pass(self.acting, cycle_s);
        self.move_numbers(cycle_s);
        let (seen, stands_in) = self.look(time_s, senses);
        let reading_s = self.observe(time_s, seen, stands_in);
        self.hear(senses);
        self.follow_programme(time_s, seen);
        self.change_mode(time_s, seen);
        self.cross_check(time_s, senses, self.duty);
        let mut decision = Decision {
            mode: self.mode,
            setpoint_mm: None,
            control_percent: None,
            control_mm_per_s2: None,
            duty: Duty::OFF,
            velocity_mm_per_s: self.orders.regulator.velocity_mm_per_s(),
            position_mm: self.last.map(|(_, mm)| mm),
            estimate: self.estimate(),
            innovation: self.orders.regulator.innovation(),
        };
        if self.mode != Mode::Flying {
            // The record of an earlier push does not apply after this.
            self.still = Still::default();
        }
        match (self.mode, self.demand(time_s)) {
            (Mode::Flying, Some(Demand::Control { setpoint_mm, excitation_percent })) => {
                let blind = self.controller().trusts_the_observer();
                if let Some(dt_s) = if blind { Some(cycle_s) } else { reading_s } {
                    self.control = self.control(setpoint_mm, excitation_percent, dt_s);
                }
                decision.setpoint_mm = Some(setpoint_mm);
                self.fly(&mut decision, excitation_percent);
                self.stop_if_stuck(time_s, &mut decision);
            }
            (Mode::OpenLoop, Some(Demand::Drive { duty_percent })) => decision.duty = self.drive(duty_percent),
            (Mode::Coasting, _) => decision.duty = self.drive(self.orders.compensation.hover_duty_percent),
            _ => {
                self.orders.regulator.rest();
                self.acting = self.compensator.control(Duty::OFF);
            }
        }
        decision
    }

    /// Updates the estimate with the reading, of the first sensor or of its substitute. Returns the time since the
    /// reading before, if both exist.
    fn observe(&mut self, time_s: f64, seen: Seen, stands_in: bool) -> Option<f64> {
        let Seen::Ball(position_mm) = seen else { return None };
        let gap_s = self.last.map(|(last_s, _)| time_s - last_s);
        self.last = Some((time_s, position_mm));
        if gap_s.is_none_or(|gap_s| gap_s > self.missing_s()) {
            // After a gap the derivatives would include its whole jump at once.
            self.orders.regulator.lose_sight();
        }
        let dt_s = gap_s.unwrap_or(self.orders.reading_period_s).min(self.missing_s());
        if stands_in {
            self.orders.regulator.stand_in(position_mm, dt_s);
        } else {
            self.orders.regulator.read(position_mm, dt_s);
        }
        Some(dt_s)
    }

    /// The observer's estimate, with control values converted to percent of duty.
    fn estimate(&self) -> Option<Estimate> {
        let percent = |control| self.compensator.about_hover(control);
        let estimate = self.orders.regulator.observed()?;
        Some(Estimate { fan: percent(estimate.fan), disturbance: percent(estimate.disturbance), ..estimate })
    }

    fn demand(&self, time_s: f64) -> Option<Demand> {
        let demand = self.flown().demand(self.programme.at_s(time_s)?)?;
        Some(match (demand, self.held_mm) {
            (Demand::DriveAboutHover { percent }, _) => {
                Demand::Drive { duty_percent: self.orders.compensation.hover_duty_percent + percent }
            }
            (Demand::Control { .. }, Some(setpoint_mm)) => Demand::Control { setpoint_mm, excitation_percent: 0.0 },
            (demand, _) => demand,
        })
    }

    fn control(&mut self, setpoint_mm: f64, excitation_percent: f64, dt_s: f64) -> f64 {
        let safety = &self.orders.safety;
        let (lowest, highest) = (Duty::clamped(safety.duty_min_percent), Duty::clamped(safety.duty_max_percent));
        let limits = self.compensator.control_limits(lowest, highest, excitation_percent);
        self.orders.regulator.step(setpoint_mm, dt_s, limits)
    }

    /// Sets the duty of the controller, and the excitation.
    fn fly(&mut self, decision: &mut Decision, excitation_percent: f64) {
        self.acting = self.compensator.acting(self.control, excitation_percent);
        decision.control_percent = Some(self.compensator.about_hover(self.control) + excitation_percent);
        decision.control_mm_per_s2 = self.orders.compensation.predistortion.is_some().then_some(self.control);
        let duty = self.compensator.duty(self.control, excitation_percent);
        decision.duty = self.safe_duty(duty.percent());
    }

    /// Turns the fan off when the ball is pushed and does not move.
    fn stop_if_stuck(&mut self, time_s: f64, decision: &mut Decision) {
        let (Some(limits), Some(position_mm)) = (&self.orders.safety.stuck, decision.position_mm) else { return };
        let control_percent = decision.control_percent.unwrap_or(0.0);
        let Some(still_s) = self.still.pushed(time_s, position_mm, control_percent, limits, self.orders.top_mm) else {
            return;
        };
        self.mode = self.stop(Fault::BallStuck { position_mm, control_percent, still_s });
        decision.mode = self.mode;
        decision.duty = Duty::OFF;
        self.acting = self.compensator.control(Duty::OFF);
    }

    /// Sets a duty without a controller.
    fn drive(&mut self, percent: f64) -> Duty {
        let duty = self.safe_duty(percent);
        self.acting = self.compensator.control(duty);
        duty
    }

    fn missing_s(&self) -> f64 {
        MISSING_PERIODS * self.orders.reading_period_s
    }

    fn safe_duty(&self, percent: f64) -> Duty {
        let safety = &self.orders.safety;
        Duty::clamped(percent.clamp(safety.duty_min_percent, safety.duty_max_percent))
    }
}

#[cfg(test)]
pub(crate) mod tests;
