//! One rig of a name: programs that fly rigs of the same name on one broker notice each other, and the younger gives
//! way.
//!
//! ```text
//! at every connection    claim {id, age_s}             seen by all who fly this name, and by its sender
//! the older answers      held  {id, age_s, to}         the younger lands, or does not take off
//! ```
//!
//! Ages are since the start of each program, so that clocks that differ between computers do not matter; about as old,
//! the lower id stays. Nothing is retained: a program that is gone holds no name.

use crate::locked::locked;
use serde::{Deserialize, Serialize};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant, SystemTime};

/// Ages that differ by less are the same, seconds.
const SAME_S: f64 = 0.5;
/// How long an answer may take after the broker has returned our own claim, and how long the broker may take for that.
const ANSWERS_WITHIN: Duration = Duration::from_millis(250);
const RETURNS_WITHIN: Duration = Duration::from_secs(1);

/// A message on the topic `claim`.
#[derive(Debug, Serialize, Deserialize)]
struct Message {
    /// Who flies.
    id: String,
    /// Since its start, seconds.
    age_s: f64,
    /// Whose claim this answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    to: Option<String>,
}

/// What is known of others.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Known {
    /// Nothing was heard yet.
    Nothing,
    /// There is no broker.
    NoBroker,
    /// A claim was sent then.
    Sent(Instant),
    /// The broker returned our claim then.
    Claimed(Instant),
    /// This other one stays.
    Other(String),
}

/// Our claim of a name.
#[derive(Debug)]
pub(super) struct Claim {
    id: String,
    since: Instant,
    known: Mutex<Known>,
    /// Set when another one stays.
    lands: Arc<AtomicBool>,
}

/// An identifier of this process alone. Its number is the same on computers and in containers that start alike, so the
/// time is part of it.
pub(super) fn unique() -> String {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    format!("{}-{}", process::id(), now.as_nanos())
}

impl Claim {
    /// A claim from now on; `lands` is set when the flight must end.
    pub(super) fn new(lands: Arc<AtomicBool>) -> Self {
        Self { id: unique(), since: Instant::now(), known: Mutex::new(Known::Nothing), lands }
    }

    /// Tells programs of one name apart.
    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// The message of a new connection, which is sent now.
    pub(super) fn message(&self) -> String {
        self.know(Known::Sent(Instant::now()));
        self.said(None)
    }

    /// Notes what is known, unless another one is known to stay.
    fn know(&self, news: Known) {
        let mut known = self.known();
        if !matches!(*known, Known::Other(_)) {
            *known = news;
        }
    }

    fn said(&self, to: Option<String>) -> String {
        let message = Message { id: self.id.clone(), age_s: self.since.elapsed().as_secs_f64(), to };
        serde_json::to_string(&message).unwrap_or_default()
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        locked(&self.known)
    }

    /// Notes that a connection failed.
    pub(super) fn no_broker(&self) {
        let mut known = self.known();
        if *known == Known::Nothing {
            *known = Known::NoBroker;
        }
    }

    /// Evaluates a message; returns the answer to it, if there is one.
    pub(super) fn hear(&self, payload: &[u8]) -> Option<String> {
        let Message { id, age_s, to } = serde_json::from_slice(payload).ok()?;
        if id == self.id {
            self.know(Known::Claimed(Instant::now()));
            return None;
        }
        let older_s = self.since.elapsed().as_secs_f64() - age_s;
        let stays = match &to {
            Some(to) if *to != self.id => return None,
            Some(_) => false,
            None if older_s.abs() < SAME_S => self.id < id,
            None => older_s > 0.0,
        };
        if stays {
            return Some(self.said(Some(id)));
        }
        *self.known() = Known::Other(id);
        self.lands.store(true, Relaxed);
        None
    }

    /// Who stays instead of us, by its id.
    pub(super) fn other(&self) -> Option<String> {
        match &*self.known() {
            Known::Other(id) => Some(id.clone()),
            _ => None,
        }
    }

    /// Whether nothing more is to be waited for before a take-off.
    pub(super) fn is_settled(&self) -> bool {
        match &*self.known() {
            Known::Nothing => false,
            Known::Sent(at) => at.elapsed() >= RETURNS_WITHIN,
            Known::Claimed(at) => at.elapsed() >= ANSWERS_WITHIN,
            Known::NoBroker | Known::Other(_) => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Arc, AtomicBool, Claim, Duration, Instant, Relaxed};

    fn claim(id: &str, age_s: f64) -> Claim {
        let since = Instant::now().checked_sub(Duration::from_secs_f64(age_s)).unwrap();
        Claim { id: id.into(), since, ..Claim::new(Arc::new(AtomicBool::new(false))) }
    }

    #[test]
    fn the_older_stays_and_answers_and_the_younger_lands_whichever_hears_the_other_first() {
        let (old, young) = (claim("z", 60.0), claim("a", 0.0));
        assert_eq!(old.hear(young.message().as_bytes()).and_then(|held| young.hear(held.as_bytes())), None);
        assert_eq!((young.other().as_deref(), young.lands.load(Relaxed)), (Some("z"), true));
        assert_eq!((old.other(), old.lands.load(Relaxed)), (None, false));
        let young = claim("b", 0.0);
        assert_eq!(young.hear(old.message().as_bytes()), None);
        assert_eq!(young.other().as_deref(), Some("z"));
    }

    #[test]
    fn of_two_as_old_as_each_other_the_lower_id_stays() {
        let (a, b) = (claim("a", 0.1), claim("b", 0.2));
        assert!(a.hear(b.message().as_bytes()).is_some() && b.hear(a.message().as_bytes()).is_none());
        assert_eq!((a.other(), b.other().as_deref()), (None, Some("a")));
    }

    #[test]
    fn our_own_claim_settles_nothing_at_once_and_what_is_meant_for_others_or_is_rubbish_is_passed_over() {
        let own = claim("a", 0.0);
        assert!(!own.is_settled());
        assert_eq!(own.hear(own.message().as_bytes()), None);
        assert!(!own.is_settled(), "another may still answer");
        for passed in [&b"\xff{"[..], b"", br#"{"id":"z","age_s":9.0,"to":"q"}"#, br#"{"id":3}"#] {
            assert_eq!(own.hear(passed), None);
        }
        assert_eq!(own.other(), None);
        own.hear(br#"{"id":"z","age_s":0.0,"to":"a"}"#);
        assert!(own.is_settled() && own.other().is_some());
    }

    #[test]
    fn without_a_broker_nobody_is_waited_for() {
        let own = claim("a", 0.0);
        own.no_broker();
        assert!(own.is_settled() && own.other().is_none());
    }
}
