//! A client for a rig's topics: receives its messages and sends it commands. `airball monitor` uses it.
//!
//! As on the rig, a session has a client of its own, so that no old command is sent later.

use super::about::About;
use super::claim::unique;
use super::credentials::MqttError;
use super::network;
use super::seen::{Said, Seen};
use crate::flight::last_fault::LastFault;
use crate::locked::locked;
use config::mqtt::MqttConfig;
use config::topics::{Quantity, Topics};
use rumqttc::{Client, ConnectionError, Event, MqttOptions, Packet, Publish, PublishOptions, QoS, SubscribeFilter};
use serde::de::DeserializeOwned;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

/// Messages that can wait for the reader; older ones are useless anyway.
const ROOM: usize = 64;
/// Time between two attempts to connect.
const PAUSE: Duration = Duration::from_secs(1);

/// A message from the broker, or a change of the connection.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// The broker answers.
    Connected,
    /// It does not answer, for this reason.
    Lost(String),
    /// Whether the rig's program runs.
    Online(bool),
    /// The description of the rig.
    About(Box<About>),
    /// The state.
    State(Box<Seen>),
    /// The last fault that ended a flight.
    Fault(LastFault),
    /// The reply to a command of any client.
    Reply(Said),
}

/// A connection to the broker that is restored for as long as it exists.
pub struct Remote {
    topics: Arc<Topics>,
    client: Arc<Mutex<Option<Client>>>,
    heard: Receiver<Heard>,
}

impl Remote {
    /// Starts connecting and returns at once.
    ///
    /// # Errors
    /// [`MqttError`]: a rig's name that is not allowed in topics, a password or certificate that cannot be read, no
    /// thread. A missing broker is not an error.
    pub fn start(config: &MqttConfig, rig: &str) -> Result<Self, MqttError> {
        let topics = Arc::new(Topics::new(rig)?);
        let id = format!("airball-monitor-{}", unique());
        let options = network::to_broker(config, id)?;
        let client = Arc::<Mutex<Option<Client>>>::default();
        let (tell, heard) = sync_channel(ROOM);
        let session = Session { options, topics: Arc::clone(&topics), client: Arc::clone(&client), tell };
        let thread = thread::Builder::new().name("mqtt-remote".to_owned());
        thread.spawn(move || session.run()).map_err(MqttError::Thread)?;
        Ok(Self { topics, client, heard })
    }

    /// Waits for the next message. `None`: there was none.
    #[must_use]
    pub fn next(&self, patience: Duration) -> Option<Heard> {
        match self.heard.recv_timeout(patience) {
            Ok(heard) => Some(heard),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                thread::sleep(patience);
                None
            }
        }
    }

    /// Sends a command. False: there is no connection.
    #[must_use]
    pub fn send(&self, quantity: Quantity, payload: &str) -> bool {
        let client = locked(&self.client);
        let topic = self.topics.set(quantity);
        client
            .as_ref()
            .is_some_and(|client| client.try_publish(topic, payload, PublishOptions::at_least_once()).is_ok())
    }
}

/// The state of the thread.
struct Session {
    options: MqttOptions,
    topics: Arc<Topics>,
    client: Arc<Mutex<Option<Client>>>,
    tell: SyncSender<Heard>,
}

impl Session {
    /// Reconnects until the receiver is gone.
    fn run(self) {
        loop {
            let cause = self.listen();
            self.hold(None);
            if cause.is_none_or(|cause| self.tell.send(Heard::Lost(cause.to_string())).is_err()) {
                return;
            }
            thread::sleep(PAUSE);
        }
    }

    fn hold(&self, client: Option<Client>) {
        *locked(&self.client) = client;
    }

    /// One connection, until it fails. `None`: the receiver is gone.
    fn listen(&self) -> Option<ConnectionError> {
        let (client, mut connection) = Client::builder(self.options.clone()).capacity(ROOM).build();
        loop {
            let heard = match connection.recv() {
                Ok(Ok(Event::Incoming(Packet::ConnAck(_)))) => {
                    let Topics { about, status, fault, state, reply, .. } = &*self.topics;
                    let filters = [about, status, fault, state, reply]
                        .map(|topic| SubscribeFilter::new(topic.clone(), QoS::AtMostOnce));
                    if client.try_subscribe_many(filters).is_err() {
                        return Some(ConnectionError::RequestsDone);
                    }
                    self.hold(Some(client.clone()));
                    Some(Heard::Connected)
                }
                Ok(Ok(Event::Incoming(Packet::Publish(message)))) => self.read(&message),
                Ok(Ok(_)) => None,
                Ok(Err(cause)) => return Some(cause),
                Err(_) => return Some(ConnectionError::RequestsDone),
            };
            if let Some(heard) = heard {
                self.tell.send(heard).ok()?;
            }
        }
    }

    /// The content of a message. `None`: it is not one of a rig.
    fn read(&self, Publish { topic, payload, .. }: &Publish) -> Option<Heard> {
        let (topics, payload) = (&*self.topics, &payload[..]);
        match topic {
            topic if *topic == topics.status => Some(Heard::Online(payload == b"online")),
            topic if *topic == topics.about => of(payload).map(Box::new).map(Heard::About),
            topic if *topic == topics.state => of(payload).map(Box::new).map(Heard::State),
            topic if *topic == topics.fault => of(payload).map(Heard::Fault),
            topic if *topic == topics.reply => of(payload).map(Heard::Reply),
            _ => None,
        }
    }
}

fn of<T: DeserializeOwned>(payload: &[u8]) -> Option<T> {
    serde_json::from_slice(payload).ok()
}
