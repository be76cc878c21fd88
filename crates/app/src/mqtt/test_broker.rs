//! The environment of the link's tests: a broker, a second client, and a connection that can be cut.

use super::line::RETAINED;
use config::mqtt::MqttConfig;
use rumqttc::{Client, Event, MqttOptions, Packet, Publish, PublishOptions, QoS, SubscribeFilter};
use socket2::{Domain, Socket, Type};
use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Timeout of a test.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);

/// A mosquitto on a free port of its own, killed on drop.
pub(super) struct Broker {
    child: Child,
    pub(super) port: u16,
    dir: TempDir,
    _port: Socket,
}

impl Broker {
    pub(super) fn start() -> Self {
        Self::with_access("allow_anonymous true")
    }

    /// A broker that accepts this user only.
    pub(super) fn with_user(user: &str, password: &str) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("users");
        let mut passwd = Command::new("mosquitto_passwd");
        let status = passwd.args(["-b", "-c"]).arg(&file).args([user, password]).status();
        assert!(status.expect("this test needs mosquitto_passwd: install mosquitto").success());
        Self::with_access(&format!("allow_anonymous false\npassword_file {}", file.display()))
    }

    /// A broker with more lines in its config: access, and listeners.
    pub(super) fn with_access(access: &str) -> Self {
        // Bound and not listening: no other program is given the port, and mosquitto gets it (`socket(7)`).
        let reserved = Socket::new(Domain::IPV4, Type::STREAM, None).unwrap();
        reserved.set_reuse_address(true).unwrap();
        reserved.bind(&SocketAddr::from((Ipv4Addr::LOCALHOST, 0)).into()).unwrap();
        let port = reserved.local_addr().unwrap().as_socket().unwrap().port();
        let dir = tempfile::tempdir().unwrap();
        let text = format!("user root\nlistener {port} 127.0.0.1\n{access}\n");
        std::fs::write(dir.path().join("mosquitto.conf"), text).unwrap();
        let broker = Self { child: launch(&dir), port, dir, _port: reserved };
        broker.wait();
        broker
    }

    fn wait(&self) {
        until("the broker listens", || TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).is_ok().then_some(()));
    }

    /// Starts another broker on the same port.
    pub(super) fn restart(&mut self) {
        self.child = launch(&self.dir);
        self.wait();
    }

    pub(super) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    pub(super) fn config(&self) -> MqttConfig {
        config(self.port)
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The config of a link to this port.
pub(super) fn config(port: u16) -> MqttConfig {
    let (host, port) = ("127.0.0.1".into(), Some(port));
    MqttConfig { host, port, user: None, password_file: None, tls: None, experiments: vec![] }
}

/// Debian does not have the broker in the path of ordinary users.
fn launch(dir: &TempDir) -> Child {
    for program in ["mosquitto", "/usr/sbin/mosquitto", "/usr/local/sbin/mosquitto"] {
        let mut command = Command::new(program);
        command.arg("-c").arg(dir.path().join("mosquitto.conf")).stdout(Stdio::null()).stderr(Stdio::null());
        match command.spawn() {
            Ok(child) => return child,
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => panic!("{program}: {error}"),
        }
    }
    panic!("this test needs a broker: install mosquitto (apt-get install mosquitto)");
}

/// Waits until `look` returns a value.
pub(super) fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(Instant::now() < deadline, "waited {PATIENCE:?} in vain: {what}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// A second client, which receives everything that is published.
pub(super) struct Outside {
    client: Client,
    heard: Receiver<Publish>,
}

impl Outside {
    pub(super) fn on(port: u16) -> Self {
        Self::with_login(port, None)
    }

    pub(super) fn with_login(port: u16, login: Option<(&str, &str)>) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let id = format!("outside-{}", COUNT.fetch_add(1, Relaxed));
        let mut options = MqttOptions::new(id, ("127.0.0.1", port));
        options.set_max_packet_size(16 << 20, 16 << 20);
        if let Some((user, password)) = login {
            options.set_credentials(user, password.to_owned());
        }
        let (client, mut connection) = Client::builder(options).capacity(1000).build();
        let filters = ["airball/#", "ball/#"].map(|all| SubscribeFilter::new(all.into(), QoS::AtLeastOnce));
        client.subscribe_many(filters).unwrap();
        let (hear, heard) = channel();
        let (ready, subscribed) = channel();
        thread::spawn(move || {
            while let Ok(Ok(event)) = connection.recv() {
                match event {
                    Event::Incoming(Packet::SubAck(_)) => ready.send(()).unwrap(),
                    Event::Incoming(Packet::Publish(message)) => drop(hear.send(message)),
                    _ => {}
                }
            }
        });
        subscribed.recv_timeout(PATIENCE).expect("no subscription");
        Self { client, heard }
    }

    pub(super) fn say(&self, topic: &str, payload: impl Into<Vec<u8>>) {
        self.client.publish(topic, payload.into(), PublishOptions::at_least_once()).unwrap();
    }

    pub(super) fn say_retained(&self, topic: &str, payload: impl Into<Vec<u8>>) {
        self.client.publish(topic, payload.into(), RETAINED).unwrap();
        self.hear(topic);
    }

    /// The next message on the topic; others are skipped.
    pub(super) fn message(&self, topic: &str) -> Publish {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let message = self.heard.recv_timeout(left).unwrap_or_else(|_| panic!("nothing on {topic}"));
            if message.topic == topic {
                return message;
            }
        }
    }

    /// The text of the next message on the topic.
    pub(super) fn hear(&self, topic: &str) -> String {
        String::from_utf8_lossy(&self.message(topic).payload).into_owned()
    }

    /// The next message on the topic, read as JSON.
    pub(super) fn json(&self, topic: &str) -> serde_json::Value {
        serde_json::from_str(&self.hear(topic)).unwrap()
    }
}

/// A connection to the broker that can be cut. It carries one connection; after that its port does not answer.
pub(super) struct Cable {
    pub(super) port: u16,
    ends: Receiver<TcpStream>,
}

impl Cable {
    pub(super) fn to(broker: u16) -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let (keep, ends) = channel();
        thread::spawn(move || {
            let (near, _) = listener.accept().unwrap();
            drop(listener);
            let far = TcpStream::connect((Ipv4Addr::LOCALHOST, broker)).unwrap();
            carry(near.try_clone().unwrap(), far.try_clone().unwrap());
            carry(far.try_clone().unwrap(), near.try_clone().unwrap());
            keep.send(near).unwrap();
            keep.send(far).unwrap();
        });
        Self { port, ends }
    }

    pub(super) fn cut(self) {
        for end in self.ends {
            end.shutdown(Shutdown::Both).unwrap();
        }
    }
}

fn carry(mut from: TcpStream, mut to: TcpStream) {
    thread::spawn(move || io::copy(&mut from, &mut to));
}
