//! What the system tests share: the built binary, a broker of their own, a directory of their own.

mod emulated;
pub mod spoilt;

pub use emulated::Emulated;

use socket2::{Domain, Socket, Type};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The binary, built once for all tests of a test program.
static AIRBALL: LazyLock<PathBuf> = LazyLock::new(|| built("airball"));

/// The binary that makes the book's gallery, which is not shipped.
static GALLERY: LazyLock<PathBuf> = LazyLock::new(|| built("gallery"));

/// The program that scores blind diagnoses, built once as well.
static BLIND: LazyLock<PathBuf> = LazyLock::new(|| built("blind"));

/// A binary of the project.
fn built(name: &str) -> PathBuf {
    // In the same way as `cargo test --workspace`. A small test is named too, because only then are the features the
    // same: without it, those that the crates' tests need of the dependencies would be missing, and most of it would be
    // built again.
    let build = escargot::CargoBuild::new().args(["--workspace", "--test", "catalogue"]).bin(name);
    build.manifest_path(root().join("Cargo.toml")).run().expect("the binary builds").path().to_owned()
}

/// The project's root.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Runs a script of `tests/` with Python.
#[must_use]
pub fn python(arguments: &[&str]) -> Ran {
    let output = Command::new("python3").current_dir(root().join("tests")).args(arguments).output();
    Ran::from(output.expect("this test needs python3"))
}

/// A directory of its own with copies of the project's config, and commands that run in it.
pub struct Bench(TempDir);

impl Default for Bench {
    fn default() -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        std::fs::copy(root().join("config.toml"), directory.path().join("config.toml")).expect("the project's config");
        Self(directory)
    }
}

impl Bench {
    /// The path of a file in it.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).expect("a file is written");
    }

    /// Reads a file as text.
    #[must_use]
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// `airball` with these arguments, to be run in the directory.
    #[must_use]
    pub fn airball(&self, arguments: &[&str]) -> Command {
        self.command(&AIRBALL, arguments)
    }

    fn command(&self, binary: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(binary);
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Runs `gallery` to its end.
    #[must_use]
    pub fn gallery(&self, arguments: &[&str]) -> Ran {
        Ran::from(self.command(&GALLERY, arguments).output().expect("the binary runs"))
    }

    /// Runs `airball` to its end.
    #[must_use]
    pub fn run(&self, arguments: &[&str]) -> Ran {
        Ran::from(self.airball(arguments).output().expect("the binary runs"))
    }

    /// `blind` with these arguments, to be run in the directory; it finds the built `airball` next to itself.
    #[must_use]
    pub fn blind(&self, arguments: &[&str]) -> Command {
        LazyLock::force(&AIRBALL);
        let mut command = Command::new(&*BLIND);
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Runs `blind` to its end.
    #[must_use]
    pub fn judge(&self, arguments: &[&str]) -> Ran {
        Ran::from(self.blind(arguments).output().expect("the binary runs"))
    }

    /// Runs `airball`, which must succeed, and returns its standard output.
    #[must_use]
    pub fn output(&self, arguments: &[&str]) -> String {
        let ran = self.run(arguments);
        assert_eq!(ran.code, Some(0), "airball {arguments:?}: {}", ran.errors);
        ran.output
    }
}

/// The result of a command.
#[derive(Debug)]
pub struct Ran {
    /// Exit status. `None`: a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub output: String,
    /// Standard error.
    pub errors: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        Self { code: output.status.code(), output: text(&output.stdout), errors: text(&output.stderr) }
    }
}

/// A mosquitto of its own on a free port, ended with the test.
pub struct Broker {
    process: Child,
    /// Its port.
    pub port: u16,
    /// Keeps its ports from the brokers and clients of other tests.
    reserved: Vec<Socket>,
}

impl Default for Broker {
    fn default() -> Self {
        let (reserved, port) = reserved_port();
        let process = mosquitto(&["-p", &port.to_string()]);
        listens(port);
        Self { process, port, reserved: vec![reserved] }
    }
}

fn mosquitto(arguments: &[&str]) -> Child {
    let search = format!("{}:/usr/sbin", std::env::var("PATH").unwrap_or_default());
    let mut command = Command::new("mosquitto");
    command.args(arguments).env("PATH", search).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("mosquitto starts; scripts/test installs it")
}

/// Writes the file of a broker's users, of whom there is one.
pub fn password_file(path: &Path, user: &str, password: &str) {
    let made = Command::new("mosquitto_passwd").args(["-b", "-c"]).arg(path).args([user, password]).status();
    assert!(made.expect("mosquitto_passwd runs; scripts/test installs it").success());
}

fn listens(port: u16) {
    eventually("the broker listens", || TcpStream::connect(("127.0.0.1", port)).is_ok().then_some(()));
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Broker {
    /// Kills it and starts another one on the same port.
    pub fn replace(&mut self) {
        self.process.kill().expect("a broker to kill");
        self.process.wait().expect("its end");
        self.process = mosquitto(&["-p", &self.port.to_string()]);
        listens(self.port);
    }

    /// A broker with the config that `config` makes of a free port, written to `path`.
    #[must_use]
    pub fn with_config(path: &Path, config: impl Fn(u16) -> String) -> Self {
        let (reserved, port) = reserved_port();
        // Started by root it would change to another user, who cannot read a test's directory.
        std::fs::write(path, format!("user root\n{}", config(port))).expect("the broker's config is written");
        let process = mosquitto(&["-c", &path.display().to_string()]);
        let broker = Self { process, port, reserved: vec![reserved] };
        listens(port);
        broker
    }

    /// The same with two free ports: for MQTT, and for WebSockets, which is returned.
    #[must_use]
    pub fn configured(path: &Path, config: impl Fn(u16, u16) -> String) -> (Self, u16) {
        let (reserved, sockets) = reserved_port();
        let mut broker = Self::with_config(path, |port| config(port, sockets));
        broker.reserved.push(reserved);
        listens(sockets);
        (broker, sockets)
    }

    /// A broker that accepts `user` alone; its files are in the folder of `bench`.
    #[must_use]
    pub fn with_user(bench: &Bench, user: &str, password: &str) -> Self {
        let passwords = bench.path("passwords");
        password_file(&passwords, user, password);
        let access = format!("allow_anonymous false\npassword_file {}\n", passwords.display());
        Self::with_config(&bench.path("mosquitto.conf"), |port| format!("listener {port} 127.0.0.1\n{access}"))
    }

    /// Publishes as `mosquitto_pub` does for a user.
    pub fn publish(&self, topic: &str, message: &str) {
        let port = self.port.to_string();
        let status = Command::new("mosquitto_pub")
            .args(["-h", "127.0.0.1", "-p", &port, "-q", "1", "-t", topic, "-m", message])
            .status();
        assert!(status.expect("mosquitto_pub runs").success(), "mosquitto_pub {topic}");
    }

    /// Subscribes as `mosquitto_sub` does and ends after `count` messages or 20 s; collect its output with
    /// `wait_with_output`.
    #[must_use]
    pub fn subscribe(&self, topic: &str, count: u32) -> Child {
        let (port, count) = (self.port.to_string(), count.to_string());
        let child = Command::new("mosquitto_sub")
            .args(["-h", "127.0.0.1", "-p", &port, "-q", "1", "-t", topic, "-C", &count, "-W", "20"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("mosquitto_sub runs");
        // The broker does not report a subscription to other clients.
        sleep(Duration::from_millis(300));
        child
    }

    /// Waits for one message and returns it.
    #[must_use]
    pub fn next(&self, topic: &str) -> String {
        collect(self.subscribe(topic, 1))
    }
}

/// What a child wrote to standard output until its end.
#[must_use]
pub fn collect(child: Child) -> String {
    Ran::from(child.wait_with_output().expect("the child ends")).output
}

/// Waits for a result of other programs, 20 s at most.
pub fn eventually<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + Duration::from_secs(20);
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(Instant::now() < deadline, "still not true after 20 s: {what}");
        sleep(Duration::from_millis(50));
    }
}

/// A free port, which no other program is given as long as the socket lives: it is bound and does not listen, so that a
/// program that asks for this port with `SO_REUSEADDR`, as mosquitto does, gets it (Linux, `socket(7)`).
fn reserved_port() -> (Socket, u16) {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None).expect("a socket");
    socket.set_reuse_address(true).expect("a socket's option");
    socket.bind(&SocketAddr::from((Ipv4Addr::LOCALHOST, 0)).into()).expect("a free port");
    let address = socket.local_addr().expect("its address");
    let port = address.as_socket().expect("an internet address").port();
    (socket, port)
}
