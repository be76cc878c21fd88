//! Tests of the page's server: who gets which message, and who is refused.

use super::LocalServer;
use super::exchange::{Exchange, LARGEST, ROOM};
use super::session::{Closed, Role, Session};
use crate::flight::command::Command;
use crate::flight::outside::Commander;
use crate::mqtt::link::{Endpoint, Link};
use crate::mqtt::link_support::{MODE, REPLY, SETPOINT, STATE, STATUS, about, obey, state};
use crate::mqtt::mailbox::Mailbox;
use crate::mqtt::owner::Nobody;
use crate::mqtt::test_broker::until;
use bytes::{Bytes, BytesMut};
use rumqttc::{Connect, ConnectReturnCode, LastWill, Packet, Publish, QoS, Subscribe};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use tokio::sync::mpsc;

/// A client by its bytes.
struct Visitor {
    session: Session,
    messages: mpsc::Receiver<Bytes>,
}

fn bytes(packet: Packet) -> BytesMut {
    let mut bytes = BytesMut::new();
    packet.write(&mut bytes, LARGEST).unwrap();
    bytes
}

fn packets(bytes: &[u8]) -> Vec<Packet> {
    let mut bytes = BytesMut::from(bytes);
    std::iter::from_fn(|| Packet::read(&mut bytes, LARGEST).ok()).collect()
}

impl Visitor {
    fn on(exchange: &Arc<Exchange>, role: Role) -> Self {
        let (session, messages) = Session::open(exchange, role).unwrap();
        let mut visitor = Self { session, messages };
        let met = visitor.say(Packet::Connect(Connect::new("v"))).unwrap();
        assert!(matches!(&met[..], [Packet::ConnAck(ack)] if ack.code == ConnectReturnCode::Success), "{met:?}");
        visitor
    }

    fn page(exchange: &Arc<Exchange>) -> Self {
        Self::on(exchange, Role::Visitor("airball/rig1/set/".into()))
    }

    fn say(&mut self, packet: Packet) -> Result<Vec<Packet>, Closed> {
        self.session.take(&bytes(packet)).map(|answers| packets(&answers))
    }

    fn publish(&mut self, topic: &str, payload: &str, qos: QoS) -> Result<Vec<Packet>, Closed> {
        self.say(Packet::Publish(Publish { pkid: 7, ..Publish::new(topic, qos, payload) }))
    }

    /// Subscribes, and returns the topics of what was kept for it.
    fn subscribe(&mut self, filter: &str) -> Vec<String> {
        let asked = Subscribe { pkid: 1, ..Subscribe::new(filter, QoS::AtLeastOnce) };
        let answers = self.say(Packet::Subscribe(asked)).unwrap();
        assert!(matches!(answers[0], Packet::SubAck(_)), "{answers:?}");
        answers.iter().filter_map(topic).collect()
    }

    /// The topic and the text of the next message on `topic`.
    fn hear(&mut self, wanted: &str) -> String {
        until(wanted, || {
            let message = self.messages.try_recv().ok()?;
            let packet = packets(&message).pop()?;
            let Packet::Publish(published) = &packet else { return None };
            (topic(&packet)? == wanted).then(|| String::from_utf8_lossy(&published.payload).into_owned())
        })
    }
}

fn topic(packet: &Packet) -> Option<String> {
    let Packet::Publish(message) = packet else { return None };
    Some(String::from_utf8_lossy(&message.topic).into_owned())
}

fn flying() -> (LocalServer, Link, Mailbox, Visitor) {
    let server = LocalServer::start("rig1", 0, |address| format!("the page of {address}")).unwrap();
    let (link, mailbox) =
        Link::start(&Endpoint::Page(&server), &about(), None, &Arc::default(), Box::new(Nobody)).unwrap();
    let mut visitor = Visitor::page(&server.exchange);
    until("the rig is there", || visitor.subscribe("airball/rig1/#").contains(&STATUS.to_owned()).then_some(()));
    (server, link, mailbox, visitor)
}

#[test]
fn a_command_of_a_page_reaches_the_loop_and_reply_and_state_the_page() {
    let (_server, _link, mut mailbox, mut page) = flying();
    let acknowledged = page.publish(SETPOINT, "300", QoS::AtLeastOnce).unwrap();
    assert!(matches!(&acknowledged[..], [Packet::PubAck(ack)] if ack.pkid == 7), "{acknowledged:?}");
    assert_eq!(obey(&mut mailbox, None), Command::Setpoint(300.0));
    assert!(page.hear(REPLY).contains("\"accepted\":true"));
    mailbox.publish_state(state(1.0));
    assert!(page.hear(STATE).contains("\"time_s\":1.0"));
}

#[test]
fn a_rig_that_leaves_is_offline_for_who_is_there_and_for_who_comes() {
    let (server, link, _mailbox, mut page) = flying();
    link.stop(None);
    until("offline", || (page.hear(STATUS) == "offline").then_some(()));
    assert!(Visitor::page(&server.exchange).subscribe("airball/+/status").contains(&STATUS.to_owned()));
}

#[test]
fn a_command_that_no_rig_hears_is_not_acknowledged() {
    let exchange = Arc::<Exchange>::default();
    assert_eq!(Visitor::page(&exchange).publish(MODE, "stop", QoS::AtLeastOnce), Err(Closed));
    let mut rig = Visitor::on(&exchange, Role::Rig);
    rig.subscribe("airball/rig1/set/#");
    assert!(Visitor::page(&exchange).publish(MODE, "stop", QoS::AtLeastOnce).is_ok());
    assert_eq!(rig.hear(MODE), "stop");
}

#[test]
fn a_page_speaks_for_no_rig_and_keeps_nothing() {
    let exchange = Arc::<Exchange>::default();
    let mut rig = Visitor::on(&exchange, Role::Rig);
    rig.subscribe("#");
    for forged in [STATE, STATUS, "airball/rig1/claim", "airball/rig2/set/mode"] {
        assert_eq!(Visitor::page(&exchange).publish(forged, "online", QoS::AtLeastOnce), Err(Closed), "{forged}");
    }
    let mut page = Visitor::page(&exchange);
    let kept = Publish { retain: true, pkid: 7, ..Publish::new(MODE, QoS::AtLeastOnce, "fly") };
    page.say(Packet::Publish(kept)).unwrap();
    assert_eq!(rig.hear(MODE), "fly");
    assert_eq!(Visitor::on(&exchange, Role::Rig).subscribe("#"), [""; 0]);
    let will = Some(LastWill::new(STATUS, "offline", QoS::AtMostOnce, true));
    let (mut session, _messages) = Session::open(&exchange, Role::Visitor("airball/rig1/set/".into())).unwrap();
    session.take(&bytes(Packet::Connect(Connect { last_will: will, ..Connect::new("w") }))).unwrap();
    drop(session);
    assert_eq!(Visitor::on(&exchange, Role::Rig).subscribe("#"), [""; 0]);
}

#[test]
fn who_does_not_keep_up_is_disconnected_and_nobody_else_loses_a_message() {
    let exchange = Arc::<Exchange>::default();
    let mut slow = Visitor::page(&exchange);
    slow.subscribe(STATE);
    let mut quick = Visitor::page(&exchange);
    quick.subscribe(STATE);
    let mut rig = Visitor::on(&exchange, Role::Rig);
    for k in 0..2 * ROOM {
        rig.publish(STATE, &k.to_string(), QoS::AtMostOnce).unwrap();
        assert_eq!(quick.hear(STATE), k.to_string());
    }
    let got = std::iter::from_fn(|| slow.messages.try_recv().ok()).count();
    assert!(got == ROOM && slow.messages.is_closed(), "{got}");
}

#[test]
fn what_is_no_mqtt_ends_its_connection_and_no_other() {
    let exchange = Arc::<Exchange>::default();
    let fresh = || Session::open(&exchange, Role::Visitor("airball/rig1/set/".into())).unwrap().0;
    assert_eq!(fresh().take(format!("GET / HTTP/1.1\r\nHost: {:80}\r\n\r\n", "a").as_bytes()), Err(Closed));
    assert_eq!(fresh().take(&[0xff; 64]), Err(Closed));
    assert_eq!(fresh().take(&bytes(Packet::PingReq)), Err(Closed), "nobody has introduced himself");
    // A length that never comes is waited for, and takes no memory.
    assert_eq!(fresh().take(&[0x30, 0xff, 0xff, 0xff, 0x7f]), Err(Closed));
    let mut page = Visitor::page(&exchange);
    assert_eq!(page.say(Packet::PingReq), Ok(vec![Packet::PingResp]));
    let whole = bytes(Packet::PingReq);
    assert!(page.session.take(&whole[..1]).unwrap().is_empty());
    assert_eq!(packets(&page.session.take(&whole[1..]).unwrap()), [Packet::PingResp]);
}

/// The first line and the rest of the answer to a request with these headers.
fn request(server: &LocalServer, headers: &str) -> (String, String) {
    let mut stream = TcpStream::connect(server.address).unwrap();
    let host = format!("127.0.0.1:{}", server.address.port());
    let headers = headers.replace("{host}", &host);
    write!(stream, "GET / HTTP/1.1\r\nConnection: close\r\n{headers}\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (first, rest) = answer.split_once("\r\n").unwrap();
    (first.to_owned(), rest.to_owned())
}

#[test]
fn the_page_is_for_its_own_address_and_no_other_site() {
    let server = LocalServer::start("rig1", 0, |address| format!("the page of {address}")).unwrap();
    let (status, page) = request(&server, "Host: {host}\r\n");
    assert!(status.contains("200") && page.contains(&format!("the page of {}", server.address)), "{status} {page}");
    assert!(page.to_lowercase().contains("x-frame-options: deny"), "{page}");
    assert!(request(&server, "Host: {host}\r\nOrigin: http://{host}\r\n").0.contains("200"));
    let port = server.address.port();
    for foreign in [
        "Host: evil.example\r\n".to_owned(),
        format!("Host: evil.example:{port}\r\n"),
        "Host: {host}\r\nOrigin: http://evil.example\r\n".into(),
        format!("Host: {{host}}\r\nOrigin: https://localhost:{port}\r\n"),
        "Host: {host}\r\nOrigin: null\r\n".into(),
    ] {
        assert!(request(&server, &foreign).0.contains("403"), "{foreign}");
    }
}

#[test]
fn a_port_that_is_taken_is_said_with_its_number_and_what_to_do() {
    let server = LocalServer::start("rig1", 0, |_| String::new()).unwrap();
    let port = server.address.port();
    let error = LocalServer::start("rig1", port, |_| String::new()).err().unwrap().to_string();
    assert!(error.contains(&port.to_string()) && error.contains("--live-port"), "{error}");
    drop(server);
    until("the port is free again", || LocalServer::start("rig1", port, |_| String::new()).ok());
}
