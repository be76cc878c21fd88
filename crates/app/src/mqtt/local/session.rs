//! One connection, by its bytes: MQTT 3.1.1 of one client, decoded and encoded by the codec of the MQTT library.
//!
//! Messages are delivered at most once, which is what a subscription is granted: nothing is lost within one computer
//! but with its connection. A command is acknowledged when it is in the rig's queue, and not at all where no rig
//! listens, so that who sent it tries again.

use super::exchange::{Exchange, LARGEST};
use bytes::{Bytes, BytesMut};
use rumqttc::mqttbytes::{Error, valid_filter, valid_topic};
use rumqttc::{
    ConnAck, Connect, ConnectReturnCode, LastWill, Packet, PubAck, Publish, QoS, SubAck, Subscribe,
    SubscribeReasonCode, UnsubAck,
};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;

/// Patience before a client has said how often it will be heard of.
const FIRST_PATIENCE: Duration = Duration::from_secs(10);
/// The longest, where it need not be heard of.
const LONGEST_PATIENCE: Duration = Duration::from_secs(600);

/// Who may publish what.
#[derive(Clone, Debug)]
pub(super) enum Role {
    /// The rig: anything.
    Rig,
    /// A page: messages below this prefix, which nobody keeps.
    Visitor(Arc<str>),
}

/// The end of a connection: its client broke the protocol, left, or asked for what is not given.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Closed;

/// A connection.
pub(super) struct Session {
    exchange: Arc<Exchange>,
    id: u64,
    role: Role,
    buffer: BytesMut,
    /// Whether the client has introduced itself.
    connected: bool,
    patience: Duration,
    will: Option<LastWill>,
}

impl Session {
    /// A connection of which nothing has been read, and the messages that it will be sent. `None`: too many are there.
    pub(super) fn open(exchange: &Arc<Exchange>, role: Role) -> Option<(Self, mpsc::Receiver<Bytes>)> {
        let (id, messages) = exchange.join()?;
        let session = Self {
            exchange: Arc::clone(exchange),
            id,
            role,
            buffer: BytesMut::new(),
            connected: false,
            patience: FIRST_PATIENCE,
            will: None,
        };
        Some((session, messages))
    }

    /// How long the client may be silent.
    pub(super) const fn patience(&self) -> Duration {
        self.patience
    }

    /// Takes bytes of the client, and returns the answers.
    pub(super) fn take(&mut self, bytes: &[u8]) -> Result<Bytes, Closed> {
        self.buffer.extend_from_slice(bytes);
        let mut answers = BytesMut::new();
        loop {
            match Packet::read(&mut self.buffer, LARGEST) {
                Ok(packet) => self.answer(packet, &mut answers)?,
                Err(Error::InsufficientBytes(_)) => return Ok(answers.freeze()),
                Err(_) => return Err(Closed),
            }
        }
    }

    fn answer(&mut self, packet: Packet, answers: &mut BytesMut) -> Result<(), Closed> {
        match packet {
            Packet::Connect(connect) if !self.connected => self.connect(connect, answers),
            _ if !self.connected => Err(Closed),
            Packet::Publish(message) => self.publish(&message, answers),
            Packet::Subscribe(asked) => self.subscribe(&asked, answers),
            Packet::Unsubscribe(asked) => {
                asked.topics.iter().for_each(|filter| self.exchange.unsubscribe(self.id, filter));
                write(Packet::UnsubAck(UnsubAck::new(asked.pkid)), answers)
            }
            Packet::PingReq => write(Packet::PingResp, answers),
            Packet::Disconnect => {
                self.will = None;
                Err(Closed)
            }
            // Nothing is sent that a client would have to acknowledge.
            _ => Err(Closed),
        }
    }

    fn connect(&mut self, connect: Connect, answers: &mut BytesMut) -> Result<(), Closed> {
        self.connected = true;
        self.patience = match connect.keep_alive {
            0 => LONGEST_PATIENCE,
            seconds => Duration::from_millis(1500 * u64::from(seconds)),
        };
        self.will = connect.last_will.filter(|_| matches!(self.role, Role::Rig));
        write(Packet::ConnAck(ConnAck::new(ConnectReturnCode::Success, false)), answers)
    }

    fn publish(&self, message: &Publish, answers: &mut BytesMut) -> Result<(), Closed> {
        let topic = std::str::from_utf8(&message.topic).map_err(|_| Closed)?;
        let (allowed, retain) = match &self.role {
            Role::Rig => (true, message.retain),
            Role::Visitor(below) => (topic.starts_with(&**below), false),
        };
        if !allowed || !valid_topic(topic) || message.qos == QoS::ExactlyOnce {
            return Err(Closed);
        }
        let got = self.exchange.publish(topic, &message.payload, retain);
        match (message.qos, &self.role) {
            (QoS::AtLeastOnce, Role::Visitor(_)) if got == 0 => Err(Closed),
            (QoS::AtLeastOnce, _) => write(Packet::PubAck(PubAck::new(message.pkid)), answers),
            _ => Ok(()),
        }
    }

    fn subscribe(&self, asked: &Subscribe, answers: &mut BytesMut) -> Result<(), Closed> {
        let (mut codes, mut kept) = (Vec::new(), Vec::new());
        for filter in &asked.filters {
            let found = Some(&filter.path).filter(|path| valid_filter(path));
            let found = found.and_then(|path| self.exchange.subscribe(self.id, path));
            codes.push(match found {
                Some(_) => SubscribeReasonCode::Success(QoS::AtMostOnce),
                None => SubscribeReasonCode::Failure,
            });
            kept.extend(found.unwrap_or_default());
        }
        write(Packet::SubAck(SubAck::new(asked.pkid, codes)), answers)?;
        kept.iter().for_each(|message| answers.extend_from_slice(message));
        Ok(())
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.exchange.leave(self.id);
        if let Some(LastWill { topic, message, retain, .. }) = self.will.take() {
            self.exchange.publish(&topic, &message, retain);
        }
    }
}

fn write(packet: Packet, answers: &mut BytesMut) -> Result<(), Closed> {
    packet.write(answers, LARGEST).map(drop).map_err(|_| Closed)
}
