//! The names of the topics.
//!
//! Everything of one rig is below `airball/<rig>/`. Some names of the original rig are kept as aliases, so that its
//! dashboards work with this program; they contain no rig's name, so that two rigs on one broker would share them.

/// The original rig's setpoint, millimetres.
pub const ORIGINAL_SETPOINT: &str = "ball/parameters/reference";
/// The original rig's gains of the PID: K_p, T_i and T_d.
pub const ORIGINAL_GAINS: &str = "ball/parameters/PID";
/// The original rig's measured position, millimetres.
pub const ORIGINAL_POSITION: &str = "ball/measures/position";

/// Longest name of a rig, in characters.
const LONGEST_NAME: usize = 64;

/// The rig's name cannot be part of a topic.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "[rig] name {0:?} cannot be part of an MQTT topic; use 1 to 64 letters, digits, `-`, `_` or `.`, like \"rig1\""
)]
pub struct RigNameError(String);

/// What a command can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The commanded position.
    Setpoint,
    /// The controller's gains, together.
    Gains,
    /// Any numbers of controllers, observer and compensation, together, or the last change of them undone.
    Numbers,
    /// Which controller flies.
    Controller,
    /// What the loop does.
    Mode,
    /// An experiment to fly.
    Experiment,
    /// Whether every cycle is published, or ten in a second.
    Stream,
}

impl Quantity {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 7] =
        [Self::Setpoint, Self::Gains, Self::Numbers, Self::Controller, Self::Mode, Self::Experiment, Self::Stream];

    /// The topic below the rig's.
    #[must_use]
    pub const fn topic(self) -> &'static str {
        match self {
            Self::Setpoint => "set/setpoint_mm",
            Self::Gains => "set/gains",
            Self::Numbers => "set/numbers",
            Self::Controller => "set/controller",
            Self::Mode => "set/mode",
            Self::Experiment => "set/experiment",
            Self::Stream => "set/stream",
        }
    }
}

/// The topics of one rig.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topics {
    /// `airball/<rig>/`.
    root: String,
    /// Answers to commands.
    pub reply: String,
    /// The state, at 10 Hz.
    pub state: String,
    /// Every cycle, in batches, while requested.
    pub cycles: String,
    /// What the rig is and accepts, retained.
    pub about: String,
    /// All numbers that can be changed, as they are, retained.
    pub numbers: String,
    /// The K_p at which the loop of the model loses stability, retained.
    pub critical_kp_per_mm: String,
    /// `online` or `offline`, retained.
    pub status: String,
    /// The last fault, retained.
    pub fault: String,
    /// Who flies a rig of this name, to others who would.
    pub claim: String,
    /// The mode, alone.
    pub mode: String,
    /// Filter of all commands, known and unknown, so that a misspelt one gets a reply too.
    pub commands: String,
}

impl Topics {
    /// The topics of the rig with this name.
    ///
    /// # Errors
    /// [`RigNameError`] where the name would change the meaning of a topic.
    pub fn new(rig: &str) -> Result<Self, RigNameError> {
        let fit = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
        if rig.is_empty() || rig.chars().count() > LONGEST_NAME || !rig.chars().all(fit) {
            return Err(RigNameError(rig.to_owned()));
        }
        let root = format!("airball/{rig}/");
        let below = |name: &str| format!("{root}{name}");
        Ok(Self {
            reply: below("reply"),
            state: below("state"),
            cycles: below("cycles"),
            about: below("about"),
            numbers: below("numbers"),
            critical_kp_per_mm: below("critical_kp_per_mm"),
            status: below("status"),
            fault: below("fault"),
            claim: below("claim"),
            mode: below(Quantity::Mode.topic()),
            commands: below("set/#"),
            root,
        })
    }

    /// What a message on `topic` sets, if it is a command.
    #[must_use]
    pub fn quantity(&self, topic: &str) -> Option<Quantity> {
        match topic {
            ORIGINAL_SETPOINT => return Some(Quantity::Setpoint),
            ORIGINAL_GAINS => return Some(Quantity::Gains),
            _ => {}
        }
        let name = topic.strip_prefix(&self.root)?;
        Quantity::ALL.into_iter().find(|quantity| quantity.topic() == name)
    }

    /// The topic of a command.
    #[must_use]
    pub fn set(&self, quantity: Quantity) -> String {
        format!("{}{}", self.root, quantity.topic())
    }

    /// A topic as replies name it: without the prefix, where it is the rig's.
    #[must_use]
    pub fn short<'a>(&self, topic: &'a str) -> &'a str {
        topic.strip_prefix(&self.root).unwrap_or(topic)
    }
}

#[cfg(test)]
mod tests {
    use super::{ORIGINAL_GAINS, ORIGINAL_POSITION, ORIGINAL_SETPOINT, Quantity, Topics};

    #[test]
    fn every_quantity_is_found_by_its_own_topic_and_by_no_other_rigs() {
        let topics = Topics::new("rig1").unwrap();
        for quantity in Quantity::ALL {
            assert_eq!(topics.quantity(&format!("airball/rig1/{}", quantity.topic())), Some(quantity));
            assert_eq!(topics.quantity(&format!("airball/rig2/{}", quantity.topic())), None);
        }
        assert_eq!(topics.quantity(ORIGINAL_SETPOINT), Some(Quantity::Setpoint));
        assert_eq!(topics.quantity(ORIGINAL_GAINS), Some(Quantity::Gains));
        assert_eq!(topics.quantity("airball/rig1/set/setpoint"), None);
    }

    #[test]
    fn the_book_lists_every_topic_and_no_other() {
        let page = include_str!("../../../docs/book/src/reference/mqtt.md");
        let mut listed: Vec<&str> = page.lines().filter_map(|row| row.strip_prefix("| `")?.split('`').next()).collect();
        let topics = Topics::new("rig1").unwrap();
        let own = [
            &topics.reply,
            &topics.state,
            &topics.cycles,
            &topics.about,
            &topics.numbers,
            &topics.critical_kp_per_mm,
            &topics.status,
            &topics.fault,
            &topics.claim,
        ];
        let own = own.map(|topic| topics.short(topic));
        let mut there: Vec<&str> = own.into_iter().chain(Quantity::ALL.map(Quantity::topic)).collect();
        there.extend([ORIGINAL_SETPOINT, ORIGINAL_GAINS, ORIGINAL_POSITION]);
        listed.sort_unstable();
        there.sort_unstable();
        assert_eq!(listed, there);
    }

    #[test]
    fn a_name_that_would_change_a_topic_is_refused() {
        for name in ["", "a/b", "+", "#", "a b", "a\0", &"x".repeat(65)] {
            assert!(Topics::new(name).is_err(), "{name:?} was accepted");
        }
        assert!(Topics::new("míček-2.b_c").is_ok());
    }
}
