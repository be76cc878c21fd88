//! What both threads and the link share: the client of the session, and what the broker keeps of us.

use super::about::{About, in_force};
use super::claim::Claim;
use super::network::Aside;
use crate::flight::last_fault::LastFault;
use crate::locked::locked;
use config::topics::Topics;
use control::numbers::Values;
use rumqttc::{Client, PublishOptions};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Mutex, MutexGuard};

/// Of a message that the broker keeps for readers to come.
pub(super) const RETAINED: PublishOptions = PublishOptions::at_least_once().retained();

/// Shared by both threads and the link: the client of the session, while there is one.
pub(super) struct Line {
    client: Mutex<Option<Client>>,
    stopping: AtomicBool,
    /// The last fault, as published; `None`: none is known.
    fault: Mutex<Option<String>>,
    /// The description of the rig, as published.
    about: String,
    /// All numbers, as published.
    numbers: Mutex<String>,
    /// The critical K_p, as published.
    critical: Mutex<String>,
    /// Our claim of the rig's name.
    pub(super) claim: Claim,
    /// The client of a session that has claimed the name and said nothing else yet.
    claiming: Mutex<Option<Client>>,
    /// A refusal to be sent in the next session.
    owed: Mutex<Option<Aside>>,
}

impl Line {
    pub(super) fn new(about: &About, claim: Claim) -> Self {
        Self {
            client: Mutex::default(),
            stopping: AtomicBool::default(),
            fault: Mutex::default(),
            about: about.json(),
            numbers: Mutex::default(),
            critical: Mutex::default(),
            claim,
            claiming: Mutex::default(),
            owed: Mutex::default(),
        }
    }

    pub(super) fn client(&self) -> MutexGuard<'_, Option<Client>> {
        locked(&self.client)
    }

    /// Sets the last fault, if there is one.
    pub(super) fn know(&self, fault: Option<&LastFault>) {
        if let Some(fault) = fault {
            *locked(&self.fault) = Some(fault.json());
        }
    }

    /// Publishes the last fault, if one is known.
    pub(super) fn publish_fault(&self, client: &Client, topics: &Topics) -> bool {
        let fault = locked(&self.fault).clone();
        fault.is_none_or(|fault| client.try_publish(&topics.fault, fault, RETAINED).is_ok())
    }

    pub(super) fn claiming(&self) -> MutexGuard<'_, Option<Client>> {
        locked(&self.claiming)
    }

    /// Sends what the broker keeps of us, once in a session, when no other program holds the rig's name; from then on
    /// the session is used. Returns the refusal that is owed.
    pub(super) fn introduce(&self, topics: &Topics) -> Option<Aside> {
        if !self.claim.is_settled() || self.claim.other().is_some() {
            return None;
        }
        // Held to the end: a session that ends meanwhile must find its client here, and not leave it behind.
        let mut claiming = self.claiming();
        let client = claiming.take()?;
        // The queue of a new session has space for these.
        let _ = client.try_publish(&topics.status, "online", RETAINED).is_ok()
            && client.try_publish(&topics.about, self.about.clone(), RETAINED).is_ok()
            && self.publish_numbers(&client, topics)
            && self.publish_fault(&client, topics);
        *self.client() = Some(client);
        locked(&self.owed).take()
    }

    /// Forgets the client of a session that has ended.
    pub(super) fn ended(&self) {
        let mut claiming = self.claiming();
        *claiming = None;
        *self.client() = None;
    }

    /// Whether a session waits for the answers of others of our name. What is to be said waits with it.
    pub(super) fn is_claiming(&self) -> bool {
        self.claiming().is_some()
    }

    /// Keeps a refusal for the next session.
    pub(super) fn owe(&self, refusal: Aside) {
        *locked(&self.owed) = Some(refusal);
    }

    /// Leaves a session that has said nothing, so that the broker does not publish the last will.
    pub(super) fn leave_unsaid(&self) {
        if let Some(client) = self.claiming().take() {
            let _ = client.try_disconnect();
        }
    }

    /// Sets all numbers, and the critical K_p of the loop with them.
    pub(super) fn know_numbers(&self, values: &Values, critical_kp_per_mm: Option<f64>) {
        *locked(&self.critical) = json(critical_kp_per_mm);
        *locked(&self.numbers) = in_force(values);
    }

    /// Publishes all numbers, and the critical K_p.
    pub(super) fn publish_numbers(&self, client: &Client, topics: &Topics) -> bool {
        let (numbers, critical) = (locked(&self.numbers).clone(), locked(&self.critical).clone());
        client.try_publish(&topics.numbers, numbers, RETAINED).is_ok()
            && client.try_publish(&topics.critical_kp_per_mm, critical, RETAINED).is_ok()
    }

    pub(super) fn stop(&self) {
        self.stopping.store(true, SeqCst);
    }

    pub(super) fn stopping(&self) -> bool {
        self.stopping.load(SeqCst)
    }
}

/// A number as JSON.
fn json(number: Option<f64>) -> String {
    number.map_or_else(|| "null".to_owned(), |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::{Line, Topics, locked};
    use crate::mqtt::claim::Claim;
    use crate::mqtt::link_support::about;
    use crate::mqtt::test_broker::until;
    use rumqttc::{Client, MqttOptions};
    use std::sync::Arc;
    use std::thread;
    use std::time::Duration;

    #[test]
    fn a_session_that_ends_while_it_introduces_itself_leaves_no_client() {
        let (client, _connection) = Client::builder(MqttOptions::new("rig1", ("127.0.0.1", 1))).capacity(9).build();
        let line = Arc::new(Line::new(&about(), Claim::new(Arc::default())));
        line.claim.no_broker();
        *line.claiming() = Some(client);
        let halfway = locked(&line.numbers);
        let introduces = Arc::clone(&line);
        let publisher = thread::spawn(move || introduces.introduce(&Topics::new("rig1").unwrap()));
        until("the introduction", || {
            line.claiming.try_lock().map_or(Some(()), |client| client.is_none().then_some(()))
        });
        let ends = Arc::clone(&line);
        let network = thread::spawn(move || ends.ended());
        // Time for the end of the session, were it not to wait for the introduction.
        thread::sleep(Duration::from_millis(20));
        drop(halfway);
        publisher.join().unwrap();
        network.join().unwrap();
        assert!(line.client().is_none());
    }
}
