//! `airball monitor`: a rig in a terminal. Its data and the commands of its keys are here, without a terminal and
//! without a broker; [`view`] draws it.

pub mod keys;
pub mod view;

use super::About;
use super::remote::Heard;
use super::seen::Seen;
use config::topics::Quantity;
use keys::Deed;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// A rig that is online without a message for this time is reported as silent.
const SILENT: Duration = Duration::from_secs(2);
/// Number of states kept: one minute.
const KEPT: usize = 600;

/// The known data of a rig.
#[derive(Clone, Debug, Default)]
pub struct Monitor {
    /// Its name.
    rig: String,
    /// Whether the broker answers, or the reason why it does not.
    link: Option<Result<(), String>>,
    online: bool,
    about: Option<About>,
    seen: Option<Seen>,
    /// Time of the last state.
    spoke: Option<Instant>,
    /// Time, position, setpoint and duty of the last states; NaN where there is none.
    past: VecDeque<[f64; 4]>,
    /// A commanded setpoint that is not yet in force, mm.
    wanted_mm: Option<f64>,
    /// The result of the last command, or the last fault that ended a flight.
    word: String,
}

impl Monitor {
    /// A monitor that knows only the rig's name.
    #[must_use]
    pub fn of(rig: &str) -> Self {
        Self { rig: rig.to_owned(), ..Self::default() }
    }

    /// Takes a message of the broker.
    pub fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Connected => self.link = Some(Ok(())),
            Heard::Lost(why) => {
                self.link = Some(Err(why));
                self.online = false;
            }
            Heard::Online(online) => self.online = online,
            Heard::About(about) => self.about = Some(*about),
            Heard::State(seen) => self.see(*seen),
            Heard::Fault(fault) if fault.acknowledged.is_some() => {}
            Heard::Fault(fault) => self.word = format!("last fault, {}: {}", fault.at, fault.fault),
            Heard::Reply(said) => {
                self.wanted_mm = self.wanted_mm.filter(|_| said.accepted);
                let topic = said.topic.trim_start_matches("set/");
                self.word = said.reason.map_or_else(|| format!("{topic}: in force"), |why| format!("{topic}: {why}"));
            }
        }
    }

    fn see(&mut self, seen: Seen) {
        let cycle = &seen.cycle;
        if self.past.back().is_some_and(|last| cycle.time_s < last[0]) {
            self.past.clear();
        }
        if self.past.len() == KEPT {
            self.past.pop_front();
        }
        let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
        self.past.push_back([cycle.time_s, known(cycle.position_mm), known(cycle.setpoint_mm), cycle.duty_percent]);
        self.wanted_mm = self.wanted_mm.filter(|wanted_mm| cycle.setpoint_mm != Some(*wanted_mm));
        (self.seen, self.spoke) = (Some(seen), Some(Instant::now()));
    }

    fn is_silent(&self, now: Instant) -> bool {
        self.spoke.is_none_or(|spoke| now.saturating_duration_since(spoke) > SILENT)
    }

    /// The command of a key's action. `None`: none, or not yet known.
    pub fn command(&mut self, deed: Deed) -> Option<(Quantity, String)> {
        match deed {
            Deed::Quit => None,
            Deed::Help => {
                self.word = keys::ALL.into();
                None
            }
            Deed::Unknown(letter) => {
                self.word = format!("the key {letter} does nothing; ? shows the keys");
                None
            }
            Deed::Mode(word) => Some((Quantity::Mode, word.to_owned())),
            Deed::Nudge(by_mm) => {
                let flown_mm = self.seen.as_ref().and_then(|seen| seen.cycle.setpoint_mm);
                let Some((about, from_mm)) = self.about.as_ref().zip(self.wanted_mm.or(flown_mm)) else {
                    self.word = "there is no setpoint to move yet, or the fan is driven without one".into();
                    return None;
                };
                let limits = about.setpoint_mm;
                let to_mm = (from_mm + by_mm).round().clamp(limits.min, limits.max);
                self.wanted_mm = Some(to_mm);
                Some((Quantity::Setpoint, to_mm.to_string()))
            }
        }
    }

    /// Reports that a command could not be sent.
    pub fn unsent(&mut self, deed: Deed) {
        self.wanted_mm = None;
        let supply = if deed == Deed::STOP { " Switch off the fan's supply." } else { "" };
        self.word = format!("not sent: there is no connection to the broker.{supply}");
    }

    /// The state in one line, for scripts and logs. `None` before the first.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        let Seen { cycle, controller, late_cycles, lateness, fault, .. } = self.seen.as_ref()?;
        let mm = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.0}"));
        Some(format!(
            "{:8.2} s  {:9}  position {:>3} mm  setpoint {:>3} mm  duty {:5.2} %  {}  {late_cycles} late, 99 % within {:.0} µs  {}",
            cycle.time_s,
            crate::flight::vocabulary::word(cycle.mode),
            mm(cycle.position_mm),
            mm(cycle.setpoint_mm),
            cycle.duty_percent,
            controller.name(),
            lateness.p99_us,
            fault.as_deref().unwrap_or("no fault"),
        ))
    }
}

#[cfg(test)]
mod tests;
