//! A flight: cycle after cycle on the deadlines, until it ends, and then the fan off.
//!
//! ```text
//! sleep → commands → observe → decide → act → record
//! ```
//!
//! The same loop flies the bench, the simulated rig in real time and the simulated rig in virtual time; it waits for
//! nothing but its deadline. Logging and MQTT are behind [`Recorder`] and [`Commander`].

pub mod command;
pub mod deadline;
pub mod experiment;
pub mod last_fault;
pub mod lateness;
pub mod name;
pub mod outside;
pub mod pilot;
pub mod real_time;
pub mod state;
pub mod vocabulary;
pub mod wall_clock;
pub mod watchdog;

use config::Loop;
use control::{Duty, Millimetres};
use deadline::{Deadlines, Punctuality};
use embedded_hal::i2c::ErrorKind;
use outside::{Commander, Recorder};
use pilot::{Pilot, Seen, Senses};
use rig::{Rig, Sighting};
use state::{Answer, InForce, State};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use vocabulary::{Cycle, End, Event, Fault, Mode, What};

/// Largest number of commands in one cycle: many commands must not lengthen it.
const COMMANDS_PER_CYCLE: usize = 4;
/// Writes of the fan in a row that may fail before the flight ends.
pub const FAN_FAILURES: u32 = 5;
/// How long the loop tries to turn the fan off at the end, seconds: the kernel's timeout for a stuck bus. After that
/// the guard continues.
const LANDING_S: f64 = 1.0;
/// Between two attempts.
const RETRY_S: f64 = 0.01;

/// The parts of a flight.
pub struct Flight<'a, R: Rig> {
    rig: &'a mut R,
    pilot: Pilot,
    recorder: &'a mut dyn Recorder,
    commander: Option<&'a mut dyn Commander>,
    table: Loop,
    deadlines: Deadlines,
    start_s: f64,
    last_cycle_s: f64,
    /// The duty in the chip.
    held: Duty,
    fan_failures: u32,
    /// The last recorded fault, so that a lasting one is recorded once.
    noted: Option<Fault>,
    pulse: Option<&'a AtomicU32>,
    /// Whether a fault may wait for `fly`.
    may_wait: bool,
    /// Whether one does.
    waits: bool,
}

/// The result of a flight besides its log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Why it ended.
    pub end: End,
    /// The fault that ended it.
    pub fault: Option<Fault>,
    /// Lateness of its cycles.
    pub punctuality: Punctuality,
    /// The fan could not be turned off.
    pub fan_still_on: Option<ErrorKind>,
}

impl<'a, R: Rig> Flight<'a, R> {
    /// A flight of `rig` by `pilot` that starts with the next [`Flight::fly`].
    pub fn new(
        rig: &'a mut R,
        pilot: Pilot,
        table: &Loop,
        recorder: &'a mut dyn Recorder,
        commander: Option<&'a mut dyn Commander>,
    ) -> Self {
        Self {
            rig,
            pilot,
            recorder,
            commander,
            table: *table,
            deadlines: Deadlines::new(0.0, table.period_s, table.late_after_s),
            start_s: 0.0,
            last_cycle_s: 0.0,
            held: Duty::OFF,
            fan_failures: 0,
            noted: None,
            pulse: None,
            may_wait: false,
            waits: false,
        }
    }

    /// A fault that can be flown from does not end this flight if somebody can send `fly`: with the fan off it waits
    /// for that.
    #[must_use]
    pub const fn waiting_after_faults(mut self) -> Self {
        self.may_wait = true;
        self
    }

    /// Counts the cycles in `pulse`, for a thread that watches the loop.
    #[must_use]
    pub fn with_pulse(mut self, pulse: &'a AtomicU32) -> Self {
        self.pulse = Some(pulse);
        self
    }

    /// Flies until the programme is over, `duration_s` has passed, `stop` is set or a fault ends it. A fault that still
    /// waits then has ended it too.
    pub fn fly(mut self, duration_s: f64, stop: &AtomicBool) -> Outcome {
        self.start();
        let (end, fault) = loop {
            self.rig.sleep_until_s(self.deadlines.next_s());
            if stop.load(Ordering::Relaxed) {
                break (End::Signal, self.pilot.fault());
            }
            let now_s = self.rig.now_s() - self.start_s;
            if now_s >= duration_s || self.pilot.is_over(now_s) {
                break (End::Finished, self.pilot.fault());
            }
            if let Some(fault) = self.cycle() {
                break (End::Fault, Some(fault));
            }
        };
        let end = if fault.is_some() { End::Fault } else { end };
        let fan_still_on = self.land();
        let punctuality = self.deadlines.punctuality();
        if punctuality.lateness.says_something() {
            self.event(What::Lateness(punctuality.lateness));
        }
        self.event(What::End(end));
        Outcome { end, fault, punctuality, fan_still_on }
    }

    /// Sets the deadlines just after the sensor's readings. A silent sensor is detected in the first cycles.
    fn start(&mut self) {
        let _ = self.rig.align();
        self.start_s = self.rig.now_s() + self.table.period_s;
        self.last_cycle_s = self.start_s - self.table.period_s;
        self.deadlines = Deadlines::new(self.start_s, self.table.period_s, self.table.late_after_s);
    }

    /// One control period. Returns the fault that ends the flight, if there is one.
    fn cycle(&mut self) -> Option<Fault> {
        let woke_s = self.rig.now_s();
        let lateness_s = self.deadlines.woke(woke_s);
        if let Some(pulse) = self.pulse {
            pulse.fetch_add(1, Ordering::Relaxed);
        }
        if let Some(fault) = self.behind(0.0) {
            return Some(fault);
        }
        let before = self.pilot.mode();
        self.take_commands();

        let senses = self.observe();
        let observed_s = self.rig.now_s();
        if let Some(fault) = self.behind(observed_s - woke_s) {
            return Some(fault);
        }
        let time_s = observed_s - self.start_s;
        let decision = self.pilot.decide(time_s, senses);
        self.rig.set_setpoint(decision.setpoint_mm);
        let fan_fault = self.act(decision.duty);

        let cycle = Cycle {
            time_s,
            period_s: woke_s - self.last_cycle_s,
            lateness_s,
            mode: decision.mode,
            setpoint_mm: decision.setpoint_mm,
            control_percent: decision.control_percent,
            control_mm_per_s2: decision.control_mm_per_s2,
            commanded_duty_percent: decision.duty.percent(),
            duty_percent: self.held.percent(),
            position_mm: decision.position_mm,
            fresh: matches!(senses.ball, Seen::Ball(_)),
            position2_mm: senses.second.and_then(Seen::position_mm),
            fan_rpm: senses.fan_rpm,
            velocity_mm_per_s: decision.velocity_mm_per_s,
            estimated_position_mm: decision.estimate.map(|estimate| estimate.position_mm),
            estimated_fan_percent: decision.estimate.map(|estimate| estimate.fan),
            estimated_disturbance_percent: decision.estimate.map(|estimate| estimate.disturbance),
            innovation_mm: decision.innovation.map(|innovation| innovation.innovation_mm),
            innovation_test_ratio: decision.innovation.map(|innovation| innovation.test_ratio),
        };
        self.last_cycle_s = woke_s;
        self.record(&cycle, before, senses.ball);
        fan_fault.or_else(|| self.ending_fault())
    }

    /// The fault of the pilot that ends the flight. It waits instead where the fan is known to be off and somebody
    /// could send `fly`, also if the connection is lost later.
    fn ending_fault(&mut self) -> Option<Fault> {
        let fault = self.pilot.fault();
        let heard = || self.commander.as_ref().is_some_and(|commander| commander.is_heard());
        let begins = || self.may_wait && self.held == Duty::OFF && heard();
        self.waits = fault.is_some_and(|fault| fault.can_be_flown_from() && (self.waits || begins()));
        fault.filter(|_| !self.waits)
    }

    /// A loop that cannot keep up no longer controls the ball. `running_s` is how long the cycle has run: after a delay
    /// within a cycle, the loop must not act on its old reading, nor take the gap for a ball that did not move.
    fn behind(&mut self, running_s: f64) -> Option<Fault> {
        let behind_s = self.deadlines.behind_s() + running_s;
        let fault = (behind_s >= self.pilot.stall_s()).then_some(Fault::Late { behind_s })?;
        self.note(fault);
        Some(fault)
    }

    fn take_commands(&mut self) {
        for _ in 0..COMMANDS_PER_CYCLE {
            let Some(command) = self.commander.as_mut().and_then(|commander| commander.try_command()) else { return };
            let refused = self.pilot.command(command).err();
            self.event(What::Command { command, refused });
            let in_force = InForce {
                setpoint_mm: self.pilot.setpoint_mm(self.rig.now_s() - self.start_s),
                controller: self.pilot.controller(),
                gains: self.pilot.gains().map(Into::into),
                mode: self.pilot.mode(),
                experiment: self.pilot.experiment(),
            };
            if let Some(commander) = self.commander.as_mut() {
                let changed = refused.is_none() && command.is_of_numbers();
                let numbers = changed.then(|| self.pilot.numbers().values());
                commander.answer(Answer { command, refused, in_force, numbers });
            }
        }
    }

    fn observe(&mut self) -> Senses {
        let ball = seen(self.rig.position());
        Senses { ball, second: self.rig.second_position().map(seen), fan_rpm: self.rig.fan_rpm() }
    }

    /// Writes the duty. Returns a fault after too many consecutive failures.
    fn act(&mut self, duty: Duty) -> Option<Fault> {
        match self.rig.drive(duty) {
            Ok(held) => {
                self.held = held;
                self.fan_failures = 0;
                None
            }
            Err(kind) => {
                self.fan_failures += 1;
                let fault = Fault::FanBus { kind };
                self.note(fault);
                (self.fan_failures >= FAN_FAILURES).then_some(fault)
            }
        }
    }

    fn record(&mut self, cycle: &Cycle, before: Mode, seen: Seen) {
        if cycle.mode != before {
            self.event(What::Mode { from: before, to: cycle.mode });
        }
        match (seen, self.pilot.fault().or(self.pilot.advisory())) {
            (_, Some(fault)) | (Seen::Nothing(Some(fault)), None) => self.note(fault),
            (Seen::Ball(_), None) if self.fan_failures == 0 => self.noted = None,
            _ => {}
        }
        self.recorder.cycle(cycle);
        let punctuality = self.deadlines.punctuality();
        let state = State {
            cycle: *cycle,
            controller: self.pilot.controller(),
            gains: self.pilot.gains().map(Into::into),
            experiment: self.pilot.experiment(),
            late_cycles: punctuality.late,
            lateness: punctuality.lateness,
            dropped_log_messages: self.recorder.dropped(),
            fault: self.noted,
            stopped_by: self.pilot.fault(),
        };
        if let Some(commander) = self.commander.as_mut() {
            commander.publish_state(state);
        }
    }

    /// Records the beginning of a fault.
    fn note(&mut self, fault: Fault) {
        let same = |noted: Fault| std::mem::discriminant(&noted) == std::mem::discriminant(&fault);
        if !self.noted.is_some_and(same) {
            self.noted = Some(fault);
            self.event(What::Fault(fault));
        }
    }

    fn event(&mut self, what: What) {
        let time_s = self.rig.now_s() - self.start_s;
        self.recorder.event(&Event { time_s, what });
    }

    /// Turns the fan off, with repeated attempts, because a failed bus may recover.
    fn land(&mut self) -> Option<ErrorKind> {
        let until_s = self.rig.now_s() + LANDING_S;
        loop {
            match self.rig.drive(Duty::OFF) {
                Ok(_) => return None,
                Err(failure) if self.rig.now_s() >= until_s => return Some(failure),
                Err(_) => self.rig.sleep_until_s(self.rig.now_s() + RETRY_S),
            }
        }
    }
}

/// A sensor's answer as the pilot needs it.
fn seen(answer: Result<Sighting, ErrorKind>) -> Seen {
    match answer {
        Ok(Sighting::Ball(Millimetres(position_mm))) => Seen::Ball(position_mm),
        Ok(Sighting::NotReady) => Seen::Nothing(None),
        Ok(Sighting::NoBall { reported_mm }) => Seen::Nothing(Some(Fault::NoBall { reported_mm })),
        Ok(Sighting::Doubtful { status, reported_mm }) => {
            Seen::Nothing(Some(Fault::DoubtfulRange { status, reported_mm }))
        }
        Err(kind) => Seen::Nothing(Some(Fault::SensorBus { kind })),
    }
}

#[cfg(test)]
pub(crate) use campaign::rich;

#[cfg(test)]
mod campaign;
#[cfg(test)]
mod tests;
