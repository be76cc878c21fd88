//! The link for its owner: start it, give the mailbox to the loop, stop it.

use super::about::About;
use super::claim::Claim;
use super::count::{Counters, Counts};
use super::credentials::MqttError;
use super::hearing::Hearing;
use super::line::Line;
use super::local::LocalServer;
use super::mailbox::{Mailbox, ROOM};
use super::network::{self, Network};
use super::outage::Outage;
use super::owner::Owner;
use super::publisher::Publisher;
use super::stream::Stream;
use crate::flight::last_fault::LastFault;
use config::mqtt::MqttConfig;
use config::topics::Topics;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Longest wait until the broker has the last messages.
const LONGEST_GOODBYE: Duration = Duration::from_secs(1);
/// Longest wait for others of our name.
const LONGEST_WAIT: Duration = Duration::from_secs(1);

/// The other end of a link.
pub enum Endpoint<'a> {
    /// A broker, and through it anybody.
    Broker(&'a MqttConfig),
    /// The program's own server, and through it browsers of this computer.
    Page(&'a LocalServer),
}

impl Endpoint<'_> {
    /// The broker's host and port.
    fn broker(&self) -> Option<String> {
        match self {
            Self::Broker(config) => Some(format!("{}:{}", config.host, config.port())),
            Self::Page(_) => None,
        }
    }
}

/// Two threads between the loop and the broker. Dropping it sends `offline` and disconnects, as [`Link::stop`] does.
pub struct Link {
    line: Arc<Line>,
    counters: Arc<Counters>,
    /// The publisher first: its last message ends the network's session.
    threads: Vec<JoinHandle<()>>,
}

impl Link {
    /// Starts the link and returns at once, with or without a broker; the description of the rig and its last fault are
    /// published with every connection. Start it before the loop raises its priority, which new threads would inherit.
    /// `lands` is set where another program flies a rig of this name.
    ///
    /// # Errors
    /// [`MqttError`]: a rig's name that is not allowed in topics, a password or certificate that cannot be read, no
    /// thread. A missing broker is not an error.
    pub fn start(
        endpoint: &Endpoint<'_>,
        about: &About,
        last_fault: Option<&LastFault>,
        lands: &Arc<AtomicBool>,
        owner: Box<dyn Owner>,
    ) -> Result<(Self, Mailbox), MqttError> {
        let topics = Arc::new(Topics::new(&about.rig)?);
        let claim = Claim::new(Arc::clone(lands));
        let options = network::options(endpoint, &about.rig, claim.id(), &topics)?;
        let (counters, line) = (Arc::<Counters>::default(), Arc::new(Line::new(about, claim)));
        line.know(last_fault);
        let numbers = about.values();
        line.know_numbers(&numbers, owner.critical_kp_per_mm(&numbers));
        let (mailbox, far) = Mailbox::new(Arc::clone(&counters));
        let (aside, asides) = mpsc::sync_channel(ROOM);
        let network = Network {
            options,
            topics: Arc::clone(&topics),
            commands: far.commands,
            asides: aside,
            line: Arc::clone(&line),
            counters: Arc::clone(&counters),
            outage: Outage::new(endpoint.broker()),
            hearing: Hearing::new(),
        };
        let publisher = Publisher {
            topics,
            answers: far.answers,
            states: far.states,
            asides,
            line: Arc::clone(&line),
            counters: Arc::clone(&counters),
            in_force: None,
            due: Instant::now(),
            stream: Stream::default(),
            owner,
            waits_after: None,
        };
        let mut link = Self { line, counters, threads: Vec::new() };
        link.spawn("mqtt-publisher", move || publisher.run())?;
        link.spawn("mqtt-network", move || network.run())?;
        Ok((link, mailbox))
    }

    /// Waits until others of this name would have been heard of, a second at most. A missing broker is not waited for.
    pub fn wait_for_others(&self) {
        let deadline = Instant::now() + LONGEST_WAIT;
        while !self.line.claim.is_settled() && Instant::now() < deadline {
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// The program that flies a rig of this name instead of us, if there is one, by its process and start.
    #[must_use]
    pub fn other(&self) -> Option<String> {
        self.line.claim.other()
    }

    fn spawn(&mut self, name: &str, run: impl FnOnce() + Send + 'static) -> Result<(), MqttError> {
        let thread = thread::Builder::new().name(name.to_owned()).spawn(run).map_err(MqttError::Thread)?;
        self.threads.push(thread);
        Ok(())
    }

    /// Sends the loop's last messages and the fault that ended it, sends `offline` and disconnects. Waits for that a
    /// second at most; what takes longer ends with the process. Returns the counts of the link.
    pub fn stop(mut self, fault: Option<&LastFault>) -> Counts {
        self.line.know(fault);
        self.leave();
        self.counts()
    }

    /// The counts so far.
    pub(super) fn counts(&self) -> Counts {
        self.counters.read()
    }

    fn leave(&mut self) {
        self.line.stop();
        let deadline = Instant::now() + LONGEST_GOODBYE;
        for thread in self.threads.drain(..) {
            thread.thread().unpark();
            while !thread.is_finished() && Instant::now() < deadline {
                thread::sleep(Duration::from_millis(2));
            }
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.leave();
    }
}
