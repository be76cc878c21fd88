//! Who may do what on the broker of `packaging/mosquitto.conf`, encrypted with the certificates of
//! `scripts/broker-certificates`: watching is not commanding, and nobody but a rig says what it does.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use system_tests::{Bench, Broker, Ran, eventually, root};

const USERS: [&str; 3] = ["rig", "pilot", "watcher"];

/// The broker, with its encrypted listener switched on.
struct Encrypted {
    broker: Broker,
    ca: PathBuf,
}

impl Encrypted {
    fn start(bench: &Bench) -> Self {
        let certificates = bench.path("certificates");
        let made =
            Command::new(root().join("scripts/broker-certificates")).arg(&certificates).arg("127.0.0.1").output();
        let made = Ran::from(made.unwrap());
        assert_eq!(made.code, Some(0), "{}", made.errors);
        let users = bench.path("airball.users");
        std::fs::write(&users, "").unwrap();
        for user in USERS {
            // A user's password is its name.
            let status = Command::new("mosquitto_passwd").arg("-b").arg(&users).args([user, user]).status();
            assert!(status.unwrap().success());
        }
        let shipped = |name: &str| std::fs::read_to_string(root().join("packaging").join(name)).unwrap();
        bench.write("airball.acl", shipped("mosquitto.acl"));
        // The encrypted listener alone: it is the last of the file.
        let config = shipped("mosquitto.conf").replace("#tls ", "");
        let config = &config[config.find("listener 8883").unwrap()..];
        let here = bench.path("").display().to_string();
        let here = here.trim_end_matches('/');
        let broker = Broker::with_config(&bench.path("mosquitto.conf"), |port| {
            let config = config.replace("listener 8883", &format!("listener {port} 127.0.0.1"));
            let config = config.replace("/etc/mosquitto/airball/", &format!("{here}/certificates/"));
            format!("per_listener_settings true\n{}", config.replace("/etc/mosquitto/", &format!("{here}/")))
        });
        Self { broker, ca: certificates.join("ca.pem") }
    }

    fn client(&self, program: &str, user: &str) -> Command {
        let mut command = Command::new(program);
        let port = self.broker.port.to_string();
        command.args(["-h", "127.0.0.1", "-p", &port, "-q", "1", "-u", user, "-P", user, "--cafile"]).arg(&self.ca);
        command
    }

    /// Publishes, and lets the broker keep it; a broker of MQTT 3.1.1 does not say that it refused.
    fn say(&self, user: &str, topic: &str, message: &str, retained: bool) {
        let mut client = self.client("mosquitto_pub", user);
        client.args(["-t", &format!("airball/rig1/{topic}"), "-m", message]);
        assert!(client.args(retained.then_some("-r")).status().unwrap().success());
    }

    /// The next message that a user gets, or the one that is kept.
    fn hear(&self, user: &str, topic: &str) -> String {
        let mut client = self.client("mosquitto_sub", user);
        let heard = client.args(["-t", &format!("airball/rig1/{topic}"), "-C", "1", "-W", "20"]).output();
        Ran::from(heard.unwrap()).output
    }

    fn state(&self, user: &str) -> Value {
        serde_json::from_str(&self.hear(user, "state")).unwrap_or_default()
    }
}

#[test]
fn a_watcher_cannot_command_nobody_but_the_rig_can_forge_and_a_pilot_flies() {
    let bench = Bench::default();
    let encrypted = Encrypted::start(&bench);
    bench.write("password", "rig\n");
    let config = bench.read("config.toml").replace("port = 1883", &format!("port = {}", encrypted.broker.port));
    let login = "user = \"rig\"\npassword_file = \"password\"\ntls.ca_file = \"certificates/ca.pem\"";
    bench.write("config.toml", config.replace("host = \"localhost\"", &format!("host = \"127.0.0.1\"\n{login}")));
    let mut run = bench.airball(&["run", "--sim", "--log", "f.mcap"]);
    let mut flight = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    eventually("the watcher sees the ball fly", || (encrypted.state("watcher")["mode"] == "flying").then_some(()));

    for user in ["watcher", "pilot"] {
        for topic in ["about", "status", "state", "reply"] {
            encrypted.say(user, topic, "forged", true);
        }
    }
    encrypted.say("watcher", "set/setpoint_mm", "111", false);
    encrypted.say("watcher", "set/mode", "stop", false);
    for topic in ["about", "status", "state"] {
        assert_ne!(encrypted.hear("pilot", topic).trim(), "forged", "{topic}");
    }
    encrypted.say("pilot", "set/setpoint_mm", "333", false);
    let state = eventually("the rig obeys the pilot", || {
        let state = encrypted.state("watcher");
        (state["setpoint_mm"] == 333.0).then_some(state)
    });
    assert_eq!((&state["mode"], &state["commands_received"]), (&"flying".into(), &1.into()), "{state}");

    encrypted.say("pilot", "set/mode", "stop", false);
    eventually("the pilot stops the fan", || (encrypted.state("watcher")["mode"] == "stopped").then_some(()));
    flight.kill().unwrap();
    flight.wait().unwrap();
}
