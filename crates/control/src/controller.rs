//! The controllers of a rig: each is a table that is there or not, and one of them flies at a time.

use crate::cascade::Cascade;
use crate::check::{OutOfRange, within};
use crate::feed_forward::FeedForward;
use crate::inputs::Source;
use crate::mpc::Mpc;
use crate::pid::Pid;
use crate::schedule::Schedule;
use crate::state_feedback::{Lqg, StateFeedback};

/// The name of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Kind {
    /// PID on the position.
    Pid,
    /// A velocity loop within a position loop.
    Cascade,
    /// State feedback, with or without an integral.
    StateFeedback,
    /// State feedback of the observer's estimate.
    Lqg,
    /// Model-predictive control.
    Mpc,
    /// A constant control value.
    OpenLoop,
}

impl Kind {
    /// All of them, in the order of the config.
    pub const ALL: [Self; 6] = [Self::Pid, Self::Cascade, Self::StateFeedback, Self::Lqg, Self::Mpc, Self::OpenLoop];

    /// The word for it in config, commands and logs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pid => "pid",
            Self::Cascade => "cascade",
            Self::StateFeedback => "state_feedback",
            Self::Lqg => "lqg",
            Self::Mpc => "mpc",
            Self::OpenLoop => "open_loop",
        }
    }

    /// The kind that a word means.
    #[must_use]
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == word)
    }

    /// Whether it uses only the observer's estimate, which exists without a new reading too.
    #[must_use]
    pub const fn trusts_the_observer(self) -> bool {
        matches!(self, Self::Lqg | Self::Mpc)
    }
}

/// No feedback: a constant control value, besides the feed-forward.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct OpenLoop {
    /// The control value.
    pub control: f64,
}

/// `[controller]`: the controllers, and what supports them.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct Controllers {
    /// Which one flies first. Absent: the first that there is, in the order of [`Kind::ALL`].
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub active: Option<Kind>,
    /// PID on the position.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub pid: Option<Pid>,
    /// A velocity loop within a position loop.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub cascade: Option<Cascade>,
    /// State feedback, with or without an integral.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub state_feedback: Option<StateFeedback>,
    /// State feedback of the observer's estimate.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub lqg: Option<Lqg>,
    /// Model-predictive control.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub mpc: Option<Mpc>,
    /// No feedback.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub open_loop: Option<OpenLoop>,
    /// A factor on the gains over height. Model-predictive control has no gains, and open loop none.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub gain_schedule: Option<Schedule>,
    /// Feed-forward of setpoint changes, for whichever controller flies.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub feed_forward: Option<FeedForward>,
}

impl Controllers {
    /// A rig with a PID and nothing else.
    #[must_use]
    pub fn only_pid(pid: Pid) -> Self {
        Self { pid: Some(pid), ..Self::default() }
    }

    /// Whether there is a controller of this kind.
    #[must_use]
    pub const fn has(&self, kind: Kind) -> bool {
        match kind {
            Kind::Pid => self.pid.is_some(),
            Kind::Cascade => self.cascade.is_some(),
            Kind::StateFeedback => self.state_feedback.is_some(),
            Kind::Lqg => self.lqg.is_some(),
            Kind::Mpc => self.mpc.is_some(),
            Kind::OpenLoop => self.open_loop.is_some(),
        }
    }

    /// The one that flies first. `None`: there is none, or not the named one.
    #[must_use]
    pub fn first(&self) -> Option<Kind> {
        self.active.or_else(|| Kind::ALL.into_iter().find(|kind| self.has(*kind))).filter(|kind| self.has(*kind))
    }

    /// What needs an observer: the first table or key that does. `None`: nothing does.
    #[must_use]
    pub fn needs_observer(&self) -> Option<&'static str> {
        let by = |velocity: Option<Source>| velocity == Some(Source::Observer);
        [
            (self.lqg.is_some(), "lqg"),
            (self.mpc.is_some(), "mpc"),
            (self.feed_forward.is_some(), "feed_forward"),
            (by(self.cascade.map(|law| law.velocity)), "cascade.velocity"),
            (by(self.state_feedback.map(|law| law.velocity)), "state_feedback.velocity"),
        ]
        .into_iter()
        .find_map(|(needs, name)| needs.then_some(name))
    }

    /// Checks every number of every table that is there.
    ///
    /// # Errors
    /// The table below `[controller]` and the first number outside its bounds there.
    pub fn check(&self) -> Result<(), (&'static str, OutOfRange)> {
        let at = |table: &'static str| move |error| (table, error);
        self.pid.map_or(Ok(()), |law| law.check()).map_err(at("pid"))?;
        self.cascade.map_or(Ok(()), |law| law.check()).map_err(at("cascade"))?;
        self.state_feedback.map_or(Ok(()), |law| law.check()).map_err(at("state_feedback"))?;
        self.lqg.map_or(Ok(()), |law| law.check()).map_err(at("lqg"))?;
        self.mpc.map_or(Ok(()), |law| law.check()).map_err(at("mpc"))?;
        self.open_loop.map_or(Ok(()), |law| within("control", law.control, -1e6, 1e6)).map_err(at("open_loop"))?;
        self.gain_schedule.as_ref().map_or(Ok(()), Schedule::check).map_err(at("gain_schedule"))?;
        self.feed_forward.map_or(Ok(()), |law| law.check()).map_err(at("feed_forward"))
    }

    /// The same with the loop gain of every controller that has one multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            pid: self.pid.map(|law| law.scaled(factor)),
            cascade: self.cascade.map(|law| law.scaled(factor)),
            state_feedback: self.state_feedback.map(|law| law.scaled(factor)),
            lqg: self.lqg.map(|law| law.scaled(factor)),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Controllers, Kind, OpenLoop};
    use crate::pid::{DerivativeOn, Pid};

    #[test]
    fn the_first_is_the_one_asked_for_or_else_the_first_that_there_is() {
        let open_loop = Some(OpenLoop { control: 0.0 });
        let both = Controllers {
            open_loop,
            ..Controllers::only_pid(Pid::new(0.01, 3.0, 0.3, 10.0, DerivativeOn::Measurement))
        };
        assert_eq!(both.first(), Some(Kind::Pid));
        assert_eq!(Controllers { active: Some(Kind::OpenLoop), ..both.clone() }.first(), Some(Kind::OpenLoop));
        assert_eq!(Controllers { active: Some(Kind::Mpc), ..both }.first(), None);
        assert_eq!(Controllers::default().first(), None);
    }

    #[test]
    fn every_kind_is_found_by_its_own_name() {
        for kind in Kind::ALL {
            assert_eq!(Kind::named(kind.name()), Some(kind));
        }
        assert_eq!(Kind::named("PID"), None);
    }
}
