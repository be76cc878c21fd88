//! A flight controlled from outside: by the live page in a real browser, served by a broker with the project's config
//! for it, and by the monitor.

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use system_tests::{Bench, Broker, Ran, collect, eventually, password_file, root};

const LOGIN: (&str, &str) = ("pilot", "up and away");
/// Who may speak as a rig.
const RIG: &str = "rig";

/// A flight of the simulated rig that ends with the test.
struct Flight(Child);

impl Flight {
    fn start(bench: &Bench, broker: &Broker) -> Self {
        let config = bench.read("config.toml");
        bench.write("config.toml", config.replace("port = 1883", &format!("port = {}", broker.port)));
        let mut run = bench.airball(&["run", "--sim", "--log", "f.mcap"]);
        let flight = Self(run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap());
        let flying = |state: &str| serde_json::from_str::<Value>(state).is_ok_and(|state| state["mode"] == "flying");
        eventually("the ball flies", || flying(&broker.next("airball/rig1/state")).then_some(()));
        flight
    }
}

impl Drop for Flight {
    fn drop(&mut self) {
        let _ = self.0.id().try_into().map(|id| kill(Pid::from_raw(id), Signal::SIGINT));
        let _ = self.0.wait();
    }
}

/// The broker of `packaging/mosquitto.conf`, with ports and paths of its own.
fn shipped(bench: &Bench) -> (Broker, u16) {
    let users = bench.path("airball.users");
    password_file(&users, LOGIN.0, LOGIN.1);
    let status = Command::new("mosquitto_passwd").arg("-b").arg(&users).args([RIG, LOGIN.1]).status();
    assert!(status.unwrap().success());
    let config = std::fs::read_to_string(root().join("packaging/mosquitto.conf")).unwrap();
    Broker::configured(&bench.path("mosquitto.conf"), |port, sockets| {
        let changes = [
            ("listener 1883 localhost", format!("listener {port} localhost")),
            ("listener 9001", format!("listener {sockets}")),
            ("/var/lib/airball/live", bench.path("live").display().to_string()),
            ("/etc/mosquitto/airball.users", users.display().to_string()),
            ("/etc/mosquitto/airball.acl", root().join("packaging/mosquitto.acl").display().to_string()),
        ];
        changes.iter().fold(config.clone(), |config, (ours, here)| {
            assert!(config.contains(ours), "{ours}");
            config.replace(ours, here)
        })
    })
}

#[test]
fn the_live_page_flies_the_rig_and_stops_it_whatever_else_fails() {
    let bench = Bench::default();
    std::fs::create_dir(bench.path("live")).unwrap();
    let said = bench.output(&["live", "--out", "live/index.html", "--wall", "live/wall.html"]);
    assert!(said.contains("live/index.html") && said.contains("rig1") && said.contains("live/wall.html"), "{said}");
    let (broker, sockets) = shipped(&bench);
    let _flight = Flight::start(&bench, &broker);

    let mut browser = Command::new("node");
    browser.arg("--test").arg(root().join("tests/browser/live.test.mjs"));
    browser.env("URL", format!("http://127.0.0.1:{sockets}/")).env("BROKER", format!("ws://127.0.0.1:{sockets}"));
    browser
        .env("FILE", bench.path("live/index.html"))
        .env("USER_NAME", LOGIN.0)
        .env("PASSWORD", LOGIN.1)
        .env("RIG_NAME", RIG);
    let ran = Ran::from(browser.output().unwrap_or_else(|error| panic!("node: {error}; run scripts/test")));
    assert_eq!(ran.code, Some(0), "{}\n{}", ran.output, ran.errors);
}

/// A flight of the simulated rig that serves the page itself, and where.
fn served(bench: &Bench) -> (Flight, String) {
    let mut run = bench.airball(&["run", "--sim", "--live", "--live-port", "0", "--log", "f.mcap"]);
    let mut child = run.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let url = said.find_map(|line| line.strip_prefix("note: live page ").map(str::to_owned)).expect("no page");
    // Read on, so that the flight is not stopped by a full pipe.
    std::thread::spawn(move || said.for_each(drop));
    (Flight(child), url)
}

#[test]
fn a_flight_serves_its_page_without_a_broker_and_stops_whatever_else_fails() {
    let (bench, stuck) = (Bench::default(), Bench::default());
    // A ball that no force of the fan moves.
    let friction = "\n[plant.effects.wall_friction]\nacceleration_mm_per_s2 = 10000.0\n";
    stuck.write("config.toml", format!("{}{friction}", stuck.read("config.toml")));
    let (flight, url) = served(&bench);
    let (_stuck_flight, stuck_url) = served(&stuck);
    let mut browser = Command::new("node");
    browser.arg("--test").arg(root().join("tests/browser/served.test.mjs"));
    browser.env("URL", url).env("STUCK_URL", stuck_url).env("PID", flight.0.id().to_string());
    let ran = Ran::from(browser.output().unwrap_or_else(|error| panic!("node: {error}; run scripts/test")));
    assert_eq!(ran.code, Some(0), "{}\n{}", ran.output, ran.errors);
}

#[test]
fn the_monitor_says_a_line_of_a_rig_and_what_to_do_where_there_is_none() {
    let bench = Bench::default();
    let broker = Broker::default();
    let _flight = Flight::start(&bench, &broker);
    let line = bench.output(&["monitor", "--once"]);
    assert_eq!(line.lines().count(), 1, "{line}");
    assert!(line.contains("flying") && line.contains("duty") && line.contains("no fault"), "{line}");

    bench.write("config.toml", bench.read("config.toml").replace("name = \"rig1\"", "name = \"nobody\""));
    let ran = bench.run(&["monitor", "--once"]);
    assert_eq!(ran.code, Some(1), "{}", ran.output);
    assert!(ran.errors.contains("nothing heard of nobody") && ran.errors.contains("airball run"), "{}", ran.errors);
}

#[test]
fn keys_of_the_monitor_move_the_setpoint_and_stop_the_fan() {
    let bench = Bench::default();
    let broker = Broker::default();
    let _flight = Flight::start(&bench, &broker);
    broker.publish("airball/rig1/set/setpoint_mm", "300");
    // `script` gives it a terminal.
    let monitor = format!("stty rows 30 cols 100; exec {} monitor", bench.airball(&[]).get_program().display());
    let mut script = Command::new("script");
    script.args(["-qec", &monitor, "/dev/null"]).current_dir(bench.path("")).env("TERM", "xterm");
    let mut terminal = script.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("script of bsdutils runs");
    let mut keys = terminal.stdin.take().unwrap();
    let mut press = |key: &[u8]| std::io::Write::write_all(&mut keys, key).unwrap();
    let setpoint = || {
        let state: Value = serde_json::from_str(&broker.next("airball/rig1/state")).unwrap();
        state["setpoint_mm"].as_f64()
    };
    // A key has an effect only after the monitor has received the rig's messages.
    eventually("a nudge upwards arrives", || {
        press(b"\x1b[A");
        setpoint().filter(|mm| *mm > 300.0)
    });
    press(b" ");
    eventually("the fan is off", || broker.next("airball/rig1/state").contains("\"mode\":\"stopped\"").then_some(()));
    press(b"q");
    let screen = collect(terminal);
    assert!(screen.contains("rig1") && screen.contains("setpoint"), "{screen:?}");
}
