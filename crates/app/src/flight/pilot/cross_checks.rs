//! Use of the optional signals by the pilot: choice of the sensor, inputs of the observer, and reasons to stop.
//!
//! ```text
//! one sensor silent for 2.5 periods             use the other, and report it
//! |first − second| > disagree_mm, disagree_s    stop: the wrong one is not known
//! driven, and no edge for stalled_after_s       stop
//! ```

use super::Pilot;
use super::exchange::{Seen, Senses};
use crate::flight::vocabulary::{Fault, Mode, Which};
use config::{SecondSensor, Tachometer};
use control::Duty;

/// Below this duty a fan need not turn, percent.
const DRIVEN_PERCENT: f64 = 5.0;

/// The pilot's memory of the signals.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Watch {
    /// Time of each sensor's last reading of the ball.
    first_s: Option<f64>,
    second_s: Option<f64>,
    /// Start of the disagreement, and the last pair of readings that showed it.
    apart_s: Option<(f64, f64)>,
    /// Time since which a driven fan has not turned.
    stands_since_s: Option<f64>,
    /// The silent sensor, if any, and the length of the silence, seconds.
    silent: Option<(Which, f64)>,
}

impl Watch {
    /// The reading in use, and whether it is the second sensor's: only after the first has seen the ball and become
    /// silent.
    fn look(&mut self, time_s: f64, senses: &Senses, missing_s: f64) -> (Seen, bool) {
        let Some(second) = senses.second else { return (senses.ball, false) };
        let see = |last_s: &mut Option<f64>, seen: Seen| {
            if matches!(seen, Seen::Ball(_)) {
                *last_s = Some(time_s);
            }
            last_s.map(|last_s| time_s - last_s).filter(|silent_s| *silent_s > missing_s)
        };
        let first_silent_s = see(&mut self.first_s, senses.ball);
        // The silence of a sensor that has never seen the ball counts from the first reading of the other.
        self.second_s = self.second_s.or(self.first_s);
        let second_silent_s = see(&mut self.second_s, second);
        self.silent = match (first_silent_s, second_silent_s) {
            (Some(silent_s), None) => Some((Which::First, silent_s)),
            (None, Some(silent_s)) => Some((Which::Second, silent_s)),
            _ => None,
        };
        match (first_silent_s, second) {
            (Some(_), Seen::Ball(_)) => (second, true),
            _ => (senses.ball, false),
        }
    }

    /// Detects that two sensors see the ball at different positions for too long. Pairs of readings that are further
    /// apart than `missing_s` show nothing about the time between them.
    fn disagree(&mut self, time_s: f64, senses: &Senses, limits: &SecondSensor, missing_s: f64) -> Option<Fault> {
        let (first_mm, second_mm) = senses.ball.position_mm().zip(senses.second?.position_mm())?;
        if (first_mm - second_mm).abs() <= limits.disagree_mm {
            self.apart_s = None;
            return None;
        }
        let since_s =
            self.apart_s.filter(|(_, last_s)| time_s - last_s <= missing_s).map_or(time_s, |(since, _)| since);
        self.apart_s = Some((since_s, time_s));
        let for_s = time_s - since_s;
        (for_s >= limits.disagree_s).then_some(Fault::SensorsDisagree { first_mm, second_mm, for_s })
    }

    /// Detects a fan that does not turn although it got `driven_percent` until now.
    fn stalled(&mut self, time_s: f64, rpm: f64, driven_percent: f64, limits: &Tachometer) -> Option<Fault> {
        if rpm > 0.0 || driven_percent < DRIVEN_PERCENT {
            self.stands_since_s = None;
            return None;
        }
        let for_s = time_s - *self.stands_since_s.get_or_insert(time_s);
        (for_s >= limits.stalled_after_s).then_some(Fault::FanStalled { duty_percent: driven_percent, for_s })
    }
}

impl Pilot {
    /// A fault that does not end the flight: one of two sensors is silent.
    #[must_use]
    pub fn advisory(&self) -> Option<Fault> {
        self.watch.silent.map(|(which, silent_s)| Fault::OneSensorSilent { which, silent_s })
    }

    /// The reading in use, and whether it is the second sensor's.
    pub(super) fn look(&mut self, time_s: f64, senses: &Senses) -> (Seen, bool) {
        let missing_s = self.missing_s();
        self.watch.look(time_s, senses, missing_s)
    }

    /// Passes the other signals to the observer.
    pub(super) fn hear(&mut self, senses: &Senses) {
        if let (Seen::Ball(_), Some(Seen::Ball(second_mm))) = (senses.ball, senses.second) {
            self.orders.regulator.read_second(second_mm);
        }
        if let (Some(rpm), Some(tachometer)) = (senses.fan_rpm, &self.orders.signals.tachometer) {
            // The speed of a fan is about proportional to its duty.
            let percent = self.orders.compensation.hover_duty_percent * rpm / tachometer.hover_rpm;
            self.orders.regulator.read_fan(self.compensator.control(Duty::clamped(percent)));
        }
    }

    /// Stops if the signals contradict each other or the fan does not turn. `duty` has been in force until now.
    pub(super) fn cross_check(&mut self, time_s: f64, senses: &Senses, duty: Duty) {
        let signals = self.orders.signals;
        let missing_s = self.missing_s();
        let apart = signals.second_sensor.and_then(|limits| self.watch.disagree(time_s, senses, &limits, missing_s));
        let stalled = signals.tachometer.zip(senses.fan_rpm);
        let stalled = stalled.and_then(|(limits, rpm)| self.watch.stalled(time_s, rpm, duty.percent(), &limits));
        if let Some(fault) = apart.or(stalled).filter(|_| self.mode != Mode::Stopped && self.mode != Mode::Waiting) {
            self.mode = self.stop(fault);
        }
    }
}
