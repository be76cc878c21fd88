//! The regulator: from readings to control values, by the active controller, with bumpless transfer between
//! controllers.
//!
//! ```text
//! reading → derivative filter ┐
//!         → observer          ┴→ feed-forward → controller → + handover → control value
//!
//! at a change    the new integral is set to keep the control value; a law without one is shifted by the difference,
//!                and the shift fades by e^(−t/1 s)
//! ```
//!
//! For every input, the output is a number within the limits: readings and setpoints that are impossible in any pipe
//! are ignored. Source: Åström & Hägglund, *Advanced PID Control*, "Mode switches".

mod adopt;
mod error;
mod readings;

pub use error::Unready;

use crate::Limits;
use crate::believed::Believed;
use crate::controller::{Controllers, Kind};
use crate::feed_forward::Way;
use crate::filter::DerivativeFilter;
use crate::inputs::{Inputs, Reference};
use crate::mpc::{Mpc, Planner};
use crate::observer::{Estimate, Estimator, Innovation, Observer};
use crate::pid::{Pid, PidState};
use libm::{exp, fabs};

/// The velocity's derivative filter smooths over so many seconds.
pub const VELOCITY_FILTER_S: f64 = VELOCITY_TD_S / VELOCITY_N;
/// Its T_d, seconds, and N.
const VELOCITY_TD_S: f64 = 0.3;
const VELOCITY_N: f64 = 10.0;
/// How fast the shift of a handover fades, seconds, and below which it is over, control value.
const HANDOVER_S: f64 = 1.0;
const HANDED_OVER: f64 = 1e-9;
/// Largest length of a pipe, mm; largest control value; longest step, seconds.
const FARTHEST_MM: f64 = 1e5;
const STRONGEST: f64 = 1e6;
const LONGEST_S: f64 = 10.0;

/// Estimate and control of one flight.
#[derive(Clone, Debug)]
pub struct Regulator {
    set: Controllers,
    kind: Kind,
    estimator: Option<Estimator>,
    planner: Option<Planner>,
    /// What the planner plans with.
    planned: Option<(Mpc, Believed)>,
    velocity: DerivativeFilter,
    /// The last reading, and its velocity by the filter.
    filtered: Option<Estimate>,
    innovation: Option<Innovation>,
    setpoint_mm: Option<f64>,
    /// The states of the controllers.
    pid: PidState,
    integral: f64,
    way: Way,
    handover: Handover,
    /// The control value in force.
    control: f64,
}

/// The state of a change of controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Handover {
    /// The next step is the first of the new one.
    Ahead,
    /// The shift of the control value.
    Shifted(f64),
}

impl Regulator {
    /// A regulator before take-off, for readings every `period_s`.
    ///
    /// # Errors
    /// [`Unready`]: there is no controller to fly first, one of them needs an observer that is missing, or numbers are
    /// too far apart.
    pub fn new(set: Controllers, observer: Option<&Observer>, period_s: f64) -> Result<Self, Unready> {
        let kind = set.first().ok_or(Unready::NoController)?;
        if let (None, Some(needed_by)) = (observer, set.needs_observer()) {
            return Err(Unready::NoObserver { needed_by });
        }
        let planned = set.mpc.zip(observer.map(|observer| observer.believed));
        let plan = |(mpc, believed): (Mpc, Believed)| Planner::new(&mpc, &believed).ok_or(Unready::Plan);
        let planner = planned.map(plan).transpose()?;
        let estimator = observer.map(|observer| Estimator::new(*observer, period_s)).transpose();
        Ok(Self {
            set,
            kind,
            estimator: estimator.map_err(Unready::Observer)?,
            planner,
            planned,
            velocity: DerivativeFilter::default(),
            filtered: None,
            innovation: None,
            setpoint_mm: None,
            pid: PidState::default(),
            integral: 0.0,
            way: Way::default(),
            handover: Handover::Shifted(0.0),
            control: 0.0,
        })
    }

    /// The active controller.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// All controllers, as they are now.
    #[must_use]
    pub const fn controllers(&self) -> &Controllers {
        &self.set
    }

    /// The estimated velocity, mm/s: the observer's, or else the filter's. `None` before the first reading.
    #[must_use]
    pub fn velocity_mm_per_s(&self) -> Option<f64> {
        self.observed().or(self.filtered).map(|estimate| estimate.velocity_mm_per_s)
    }

    /// The observer's estimate. `None` without an observer, and before its first reading.
    #[must_use]
    pub fn observed(&self) -> Option<Estimate> {
        self.estimator.as_ref().and_then(Estimator::estimate)
    }

    /// The innovation of the last reading. `None` where there was no reading or is no observer.
    #[must_use]
    pub const fn innovation(&self) -> Option<Innovation> {
        self.innovation
    }

    /// Changes to another controller from the next step on. `false`: there is none of this kind.
    pub fn switch(&mut self, kind: Kind) -> bool {
        if self.set.has(kind) && self.kind != kind {
            self.kind = kind;
            self.handover = Handover::Ahead;
        }
        self.set.has(kind)
    }

    /// Changes the gains of the PID without a bump.
    pub fn retune(&mut self, pid: Pid) {
        if let Some(old) = self.set.pid.replace(pid) {
            pid.take_over(&old, &mut self.pid);
        }
    }

    /// Resets the controllers to before the first reading. The observer keeps its estimate of hover.
    pub fn take_off(&mut self) {
        self.pid = PidState::default();
        (self.integral, self.control) = (0.0, 0.0);
        (self.way, self.handover, self.setpoint_mm) = (Way::default(), Handover::Shifted(0.0), None);
    }

    /// For a gap in the readings, or a fan driven by something else: integrals are kept, derivatives start anew.
    pub fn lose_sight(&mut self) {
        self.velocity = DerivativeFilter::default();
        self.pid = self.pid.after_a_hole();
        self.way = Way::default();
        if let Some(estimator) = &mut self.estimator {
            estimator.lose_sight();
        }
    }

    /// The derivatives start anew, after a time in open loop with readings.
    pub fn forget_derivatives(&mut self) {
        self.pid = self.pid.after_a_hole();
        self.way = Way::default();
    }

    /// For a ball at rest on a support, where the model does not apply: the observer starts from the next reading.
    pub const fn rest(&mut self) {
        if let Some(estimator) = &mut self.estimator {
            estimator.lose_sight();
        }
    }

    /// Lets `dt_s` pass, in which `acting` was the control value.
    pub fn pass(&mut self, acting: f64, dt_s: f64) {
        self.innovation = None;
        if let Some(estimator) = &mut self.estimator {
            estimator.predict(if fabs(acting) <= STRONGEST { acting } else { 0.0 }, sensible(dt_s));
        }
    }

    /// One control step, `dt_s` after the last one. 0, held within `limits`, before the first reading.
    pub fn step(&mut self, setpoint_mm: f64, dt_s: f64, limits: Limits) -> f64 {
        let Some(filtered) = self.filtered else { return limits.hold(0.0) };
        if is_a_place(setpoint_mm) {
            self.setpoint_mm = Some(setpoint_mm);
        }
        let setpoint_mm = self.setpoint_mm.unwrap_or(filtered.position_mm);
        let dt_s = sensible(dt_s);
        let reference = self.reference(setpoint_mm, filtered.position_mm, dt_s);
        let filtered = Estimate { fan: self.control, ..filtered };
        let observed = self.observed().unwrap_or(filtered);
        let forward = reference.control;
        let inputs = Inputs { reference, filtered, observed, dt_s, limits: limits.shifted(-forward) };
        let shift = self.hand_over(&inputs, self.control - forward);
        let inputs = Inputs { limits: limits.shifted(-forward - shift), ..inputs };
        self.control = limits.hold(self.law(&inputs) + forward + shift);
        self.control
    }

    fn reference(&mut self, setpoint_mm: f64, here_mm: f64, dt_s: f64) -> Reference {
        match (self.set.feed_forward, &self.estimator) {
            (Some(law), Some(estimator)) => law.step(&mut self.way, estimator.believed(), setpoint_mm, here_mm, dt_s),
            _ => Reference::at(setpoint_mm),
        }
    }

    /// The shift of the control value. At a change, the new controller is set up so that it gives `kept`, and the shift
    /// is the remaining difference.
    fn hand_over(&mut self, inputs: &Inputs, kept: f64) -> f64 {
        let shift = match self.handover {
            Handover::Ahead => {
                self.align(inputs, kept);
                let (pid, integral) = (self.pid, self.integral);
                let shift = kept - self.law(inputs);
                (self.pid, self.integral) = (pid, integral);
                shift
            }
            Handover::Shifted(shift) if fabs(shift) < HANDED_OVER => 0.0,
            Handover::Shifted(shift) => shift * exp(-inputs.dt_s / HANDOVER_S),
        };
        self.handover = Handover::Shifted(shift);
        shift
    }

    /// Sets the state of the active controller so that it would give `control`, as far as possible.
    fn align(&mut self, inputs: &Inputs, control: f64) {
        let factor = self.factor(inputs);
        let (wanted_mm, here_mm) = (inputs.reference.position_mm, inputs.filtered.position_mm);
        match (self.kind, self.set.pid, self.set.cascade, self.set.state_feedback) {
            (Kind::Pid, Some(law), _, _) => law.scaled(factor).align(&mut self.pid, wanted_mm, here_mm, control),
            (Kind::Cascade, _, Some(law), _) => self.integral = law.scaled(factor).align(inputs, control),
            (Kind::StateFeedback, _, _, Some(law)) => self.integral = law.scaled(factor).align(inputs, control),
            _ => {}
        }
    }

    /// The control value of the active controller.
    fn law(&mut self, inputs: &Inputs) -> f64 {
        let factor = self.factor(inputs);
        let (wanted_mm, here_mm) = (inputs.reference.position_mm, inputs.filtered.position_mm);
        let control = match self.kind {
            Kind::Pid => self
                .set
                .pid
                .map(|law| law.scaled(factor).step(&mut self.pid, wanted_mm, here_mm, inputs.dt_s, inputs.limits)),
            Kind::Cascade => self.set.cascade.map(|law| law.scaled(factor).step(&mut self.integral, inputs)),
            Kind::StateFeedback => {
                self.set.state_feedback.map(|law| law.scaled(factor).step(&mut self.integral, inputs))
            }
            Kind::Lqg => self.set.lqg.map(|law| law.scaled(factor).step(inputs)),
            Kind::Mpc => self.planner.as_ref().map(|planner| planner.step(inputs)),
            Kind::OpenLoop => self.set.open_loop.map(|law| law.control),
        };
        // The table of the active kind exists: `new` and `switch` check it.
        inputs.limits.hold(control.unwrap_or(0.0))
    }

    fn factor(&self, inputs: &Inputs) -> f64 {
        self.set.gain_schedule.as_ref().map_or(1.0, |schedule| schedule.factor(inputs.filtered.position_mm))
    }
}

/// Whether a position is possible.
fn is_a_place(position_mm: f64) -> bool {
    fabs(position_mm) <= FARTHEST_MM
}

/// A time that has passed.
const fn sensible(dt_s: f64) -> f64 {
    if dt_s.is_nan() { 0.0 } else { dt_s.max(0.0).min(LONGEST_S) }
}

#[cfg(test)]
mod tests;
