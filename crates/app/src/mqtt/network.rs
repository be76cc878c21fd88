//! The thread of the connection: connects, subscribes, and turns messages into commands.
//!
//! A session is one connection, from connecting to its first error, with a client of its own: requests queued in one
//! are not sent in the next, so that the broker never gets an old state. Subscriptions end with a session too. Between
//! sessions the thread sleeps, because a refused connection fails within microseconds.

use super::count::{Counters, count};
use super::credentials::{Credentials, MqttError, credentials, exposures};
use super::hearing::{Hearing, too_large};
use super::line::Line;
use super::link::Endpoint;
use super::local::LocalServer;
use super::mailbox::Inbox;
use super::outage::Outage;
use super::parse::{Asked, ParseError, parse};
use crate::standard_error::plain;
use config::mqtt::MqttConfig;
use config::topics::Topics;
use rumqttc::{
    Client, ConnectionError, Event, LastWill, MqttOptions, Packet, Publish, PublishOptions, QoS, TlsConfiguration,
    Transport,
};
use std::borrow::Cow;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::{Duration, Instant};

/// Requests that can wait for the connection: a few rounds of the publisher.
const QUEUE: usize = 256;
/// Largest packet accepted from the broker, so that its sender gets a reply. A larger one ends the connection.
pub(super) const LARGEST_IN: usize = 2 << 20;
/// Largest packet sent; a full batch of cycles is below 40 KB.
const LARGEST_OUT: usize = 64 * 1024;
/// After one and a half of these without a packet the broker publishes the last will.
const KEEP_ALIVE_S: u16 = 5;
/// Of a message between programs that are there now.
const UNRETAINED: PublishOptions = PublishOptions::at_least_once();
/// First and longest pause between two attempts to connect.
const PAUSES: (Duration, Duration) = (Duration::from_millis(200), Duration::from_secs(5));

/// A message that is answered without the loop.
pub(super) struct Aside {
    /// In the form of [`Topics::short`].
    pub(super) topic: String,
    pub(super) what: What,
}

/// Its result.
pub(super) enum What {
    /// It was refused for this reason.
    Refused(String),
    /// It starts or ends the stream of every cycle.
    Stream(bool),
}

/// The state of the thread.
pub(super) struct Network {
    pub(super) options: MqttOptions,
    pub(super) topics: Arc<Topics>,
    pub(super) commands: Inbox,
    pub(super) asides: SyncSender<Aside>,
    pub(super) line: Arc<Line>,
    pub(super) counters: Arc<Counters>,
    pub(super) outage: Outage,
    pub(super) hearing: Hearing,
}

/// The client's identity and last will.
pub(super) fn options(endpoint: &Endpoint<'_>, rig: &str, id: &str, topics: &Topics) -> Result<MqttOptions, MqttError> {
    let id = format!("airball-{rig}-{id}");
    let mut options = match endpoint {
        Endpoint::Broker(config) => to_broker(config, id)?,
        Endpoint::Page(server) => to_page(server, id),
    };
    options.set_last_will(LastWill::new(&topics.status, "offline", QoS::AtLeastOnce, true));
    Ok(options)
}

/// To the program's own server, by memory; the address is only a name.
fn to_page(server: &LocalServer, id: String) -> MqttOptions {
    let mut options = MqttOptions::new(id, ("localhost", 0));
    options.set_keep_alive(KEEP_ALIVE_S).set_max_packet_size(LARGEST_IN, LARGEST_OUT);
    let dial = server.dialler();
    options.set_socket_connector(move |_, _| {
        let pipe = dial();
        async move { pipe }
    });
    options
}

/// The broker's address, and the client's identity.
pub(super) fn to_broker(config: &MqttConfig, id: String) -> Result<MqttOptions, MqttError> {
    let mut options = MqttOptions::new(id, (config.host.clone(), config.port()));
    options.set_keep_alive(KEEP_ALIVE_S).set_max_packet_size(LARGEST_IN, LARGEST_OUT);
    exposures(config).into_iter().for_each(|exposure| say(Some(format!("warning: mqtt: {exposure}"))));
    if let Some(Credentials { user, password }) = credentials(config)? {
        options.set_credentials(user, password);
    }
    if let Some(tls) = &config.tls {
        options.set_transport(Transport::tls_with_config(TlsConfiguration::Rustls(super::tls::client(tls)?)));
    }
    Ok(options)
}

impl Network {
    /// Runs until the line is stopped.
    pub(super) fn run(mut self) {
        let mut pause = PAUSES.0;
        while !self.line.stopping() {
            let began = Instant::now();
            let cause = self.session();
            self.line.ended();
            if self.line.stopping() {
                return;
            }
            self.line.claim.no_broker();
            self.hearing.ended(&cause, Instant::now());
            if let Some(bytes) = too_large(&cause) {
                self.line.owe(self.refuse_packet(bytes));
            }
            say(self.outage.began(&cause));
            if began.elapsed() > PAUSES.1 {
                pause = PAUSES.0;
            }
            thread::park_timeout(pause);
            pause = (pause * 2).min(PAUSES.1);
        }
    }

    /// One connection, until it fails.
    fn session(&mut self) -> ConnectionError {
        let (client, mut connection) = Client::builder(self.options.clone()).capacity(QUEUE).build();
        loop {
            match connection.recv() {
                Ok(Ok(Event::Incoming(Packet::ConnAck(_)))) => {
                    if !self.greet(&client) {
                        return ConnectionError::RequestsDone;
                    }
                }
                Ok(Ok(Event::Incoming(Packet::Publish(message)))) if topic(&message) == self.topics.claim => {
                    self.hear_claim(&client, &message);
                }
                Ok(Ok(Event::Incoming(Packet::Publish(message)))) => self.take(&message),
                // A packet arrives every few seconds, at least a ping.
                Ok(Ok(_)) if self.hearing.recovers(Instant::now()) => {
                    self.hearing.subscribe(&client, &self.topics);
                }
                Ok(Ok(_)) => {}
                Ok(Err(cause)) => return cause,
                Err(_) => return ConnectionError::RequestsDone,
            }
        }
    }

    /// Subscribes and claims the rig's name. False where that is no longer wanted: a disconnection without a message
    /// makes the broker publish the last will, which is then right. The queue of a new session has space for these
    /// requests.
    fn greet(&mut self, client: &Client) -> bool {
        let mut held = self.line.claiming();
        let greeted = !self.line.stopping()
            && self.hearing.subscribe(client, &self.topics)
            && client.try_publish(&self.topics.claim, self.line.claim.message(), UNRETAINED).is_ok();
        if greeted {
            *held = Some(client.clone());
            say(self.outage.over());
        }
        greeted
    }

    /// Answers who would fly a rig of our name, or notes who does. What a broker kept is of a program that may be gone.
    fn hear_claim(&self, client: &Client, message: &Publish) {
        if message.retain {
            return;
        }
        let held = self.line.claim.hear(&message.payload);
        if held.is_some_and(|held| client.try_publish(&self.topics.claim, held, UNRETAINED).is_err()) {
            count(&self.counters.dropped);
        }
    }

    /// Passes a command to the loop, or the result of a message without the loop to the publisher.
    fn take(&mut self, message: &Publish) {
        count(&self.counters.received);
        let what = match self.asked(message) {
            Err(why) => {
                count(&self.counters.refused);
                What::Refused(why.to_string())
            }
            Ok(_) if self.commands.is_abandoned() => What::Refused("the flight is over".to_owned()),
            Ok(Asked::Stream(on)) => What::Stream(on),
            Ok(Asked::Loop(command)) => {
                if self.commands.push(command) {
                    return;
                }
                count(&self.counters.busy);
                What::Refused("busy: too many commands wait already; send fewer, and wait for the replies".to_owned())
            }
        };
        self.tell(Aside { topic: self.topics.short(&topic(message)).to_owned(), what });
    }

    fn tell(&self, aside: Aside) {
        if self.asides.try_send(aside).is_err() {
            count(&self.counters.dropped);
        }
    }

    /// Counts a packet that ended its session. Its topic is not known.
    fn refuse_packet(&self, bytes: usize) -> Aside {
        count(&self.counters.received);
        count(&self.counters.refused);
        let reason = format!(
            "a packet of {bytes} bytes is beyond the {LARGEST_IN} that are taken, and ended the connection; if the broker keeps it, remove it: mosquitto_pub -r -n -t TOPIC"
        );
        let topic = self.topics.short(&self.topics.commands).to_owned();
        Aside { topic, what: What::Refused(reason) }
    }

    fn asked(&self, message: &Publish) -> Result<Asked, ParseError> {
        if message.retain {
            return Err(ParseError::Retained);
        }
        parse(&self.topics, &topic(message), &message.payload)
    }
}

/// The topic of a message; the client has refused one that is no UTF-8.
pub(super) fn topic(message: &Publish) -> Cow<'_, str> {
    String::from_utf8_lossy(&message.topic)
}

/// Writes a line to standard error, where there is one. A closed standard error must not stop MQTT.
fn say(line: Option<String>) {
    if let Some(line) = line {
        plain(line);
    }
}
