//! Flights in real time: signals, a real broker, no broker, no bus. Slow, a few seconds each, because they test timing.

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;
use std::io::Write;
use std::process::{Child, Command, Stdio};
use system_tests::{Bench, Broker, Ran, collect, eventually};

fn start(bench: &Bench, arguments: &[&str]) -> Child {
    let flags = [&["run", "--sim", "--log", "f.mcap"], arguments].concat();
    bench.airball(&flags).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn end(flight: Child, signal: Signal) -> Ran {
    kill(Pid::from_raw(flight.id().try_into().unwrap()), signal).unwrap();
    Ran::from(flight.wait_with_output().unwrap())
}

/// A config with this broker.
fn with_broker(bench: &Bench, broker: &Broker) {
    let config = bench.read("config.toml");
    bench.write("config.toml", config.replace("port = 1883", &format!("port = {}", broker.port)));
}

fn state(broker: &Broker) -> Value {
    serde_json::from_str(&broker.next("airball/rig1/state")).unwrap()
}

#[test]
fn a_signal_lands_the_ball_and_keeps_the_log() {
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP, Signal::SIGQUIT] {
        let bench = Bench::default();
        let flight = start(&bench, &[]);
        eventually("the flight has begun", || bench.path("f.mcap").exists().then_some(()));
        std::thread::sleep(std::time::Duration::from_secs(2));
        let ran = end(flight, signal);
        assert_eq!(ran.code, Some(0), "{}", ran.errors);
        assert!(ran.output.contains("flight ") && ran.output.contains("f.mcap"), "{}", ran.output);
        let info = bench.output(&["log", "info", "f.mcap"]);
        assert!(info.contains("waiting → flying") && info.contains("end      signal"), "{info}");
        let csv = bench.output(&["log", "export", "f.mcap"]);
        assert!(csv.lines().count() > 50, "{}", csv.lines().count());
    }
}

#[test]
fn without_a_broker_it_flies_all_the_same_and_says_so_once() {
    let bench = Bench::default();
    let config = bench.read("config.toml").replace("port = 1883", "port = 1");
    bench.write("config.toml", config);
    let ran = Ran::from(start(&bench, &["--duration", "3"]).wait_with_output().unwrap());
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    assert_eq!(ran.errors.matches("localhost:1").count(), 1, "{}", ran.errors);
}

#[test]
fn mosquitto_pub_moves_the_ball_and_nonsense_is_refused_with_the_reason() {
    let (bench, broker) = (Bench::default(), Broker::default());
    with_broker(&bench, &broker);
    let flight = start(&bench, &[]);
    eventually("the ball flies", || (state(&broker)["mode"] == "flying").then_some(()));

    let replies = broker.subscribe("airball/rig1/reply", 4);
    broker.publish("airball/rig1/set/setpoint_mm", "300");
    broker.publish("airball/rig1/set/setpoint_mm", "NaN");
    broker.publish("airball/rig1/set/setpoint_mm", "5000");
    broker.publish("airball/rig1/set/gains", r#"{"kp_per_mm": 0.011, "ti_s": 5.0}"#);
    let replies: Vec<Value> = collect(replies).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let accepted: Vec<bool> = replies.iter().map(|reply| reply["accepted"].as_bool().unwrap()).collect();
    assert_eq!(accepted.iter().filter(|yes| **yes).count(), 2, "{replies:?}");
    let reasons: String = replies.iter().filter_map(|reply| reply["reason"].as_str()).collect();
    assert!(reasons.contains("NaN") && reasons.contains("5000") && reasons.contains("30 to 550"), "{reasons}");
    let gains = replies.iter().find(|reply| reply["topic"] == "set/gains").unwrap();
    assert_eq!(gains["in_force"]["kp_per_mm"], 0.011);

    eventually("the ball stays at 300 mm for a second", || {
        let states = collect(broker.subscribe("airball/rig1/state", 10));
        let near = |line: &str| {
            let state: Value = serde_json::from_str(line).unwrap();
            (state["position_mm"].as_f64().unwrap() - 300.0).abs() < 20.0 && state["setpoint_mm"] == 300.0
        };
        states.lines().all(near).then_some(())
    });

    let ran = end(flight, Signal::SIGTERM);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    assert_eq!(broker.next("airball/rig1/status").trim(), "offline");
    let info = bench.output(&["log", "info", "f.mcap"]);
    assert!(info.contains("setpoint_mm 300: accepted") && info.contains("setpoint_mm 5000: refused"), "{info}");
}

#[test]
fn stop_turns_the_fan_off_and_fly_lifts_the_ball_again() {
    let (bench, broker) = (Bench::default(), Broker::default());
    with_broker(&bench, &broker);
    let flight = start(&bench, &[]);
    let until = |mode: &str| {
        eventually(mode, || Some(state(&broker)).filter(|state| state["mode"] == mode));
    };
    until("flying");
    broker.publish("airball/rig1/set/mode", "stop");
    until("stopped");
    assert_eq!(state(&broker)["duty_percent"], 0.0);
    broker.publish("airball/rig1/set/mode", "fly");
    until("flying");
    assert_eq!(end(flight, Signal::SIGINT).code, Some(0));
}

#[test]
fn a_flight_goes_on_under_a_flood_with_rubbish_and_megabytes_in_it_and_every_message_is_counted() {
    const COMMANDS: u64 = 10_000;
    const MEGABYTES: u64 = 3;
    let bench = Bench::default();
    // Messages that the broker drops are not in our counts.
    let unlimited = |port: u16| format!("listener {port} 127.0.0.1\nallow_anonymous true\nmax_queued_messages 0\n");
    let broker = Broker::with_config(&bench.path("mosquitto.conf"), unlimited);
    with_broker(&bench, &broker);
    let flight = start(&bench, &["--json"]);
    eventually("the ball flies", || (state(&broker)["mode"] == "flying").then_some(()));

    let publish = |topic: &str, how: &[&str]| {
        let mut client = Command::new("mosquitto_pub");
        client.args(["-p", &broker.port.to_string(), "-q", "0", "-t", topic]).args(how).stdin(Stdio::piped());
        client.spawn().expect("mosquitto_pub runs; scripts/test installs it")
    };
    let mut flood = publish("airball/rig1/set/setpoint_mm", &["-l"]);
    let mut pipe = flood.stdin.take().unwrap();
    for k in 0..COMMANDS {
        // Every eighth is not a number.
        let line = if k % 8 == 0 { "\u{1}\u{7f}nonsense".to_owned() } else { format!("{}", 250 + k % 100) };
        writeln!(pipe, "{line}").unwrap();
    }
    drop(pipe);
    bench.write("megabyte", "\u{3}".repeat(1_000_000));
    for _ in 0..MEGABYTES {
        let huge = publish("airball/rig1/set/gains", &["-f", bench.path("megabyte").to_str().unwrap()]);
        assert!(huge.wait_with_output().unwrap().status.success());
    }
    assert!(flood.wait().unwrap().success());
    eventually("all are counted", || (state(&broker)["commands_received"] == COMMANDS + MEGABYTES).then_some(()));
    assert_eq!((&state(&broker)["mode"], &state(&broker)["fault"]), (&Value::from("flying"), &Value::Null));

    let ran = end(flight, Signal::SIGINT);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    let flown: Value = serde_json::from_str(&ran.output).unwrap();
    assert_eq!(flown["logged_cycles"], flown["cycles"]);
    assert_eq!(flown["commands_received"], COMMANDS + MEGABYTES);
}

#[test]
fn a_second_rig_of_the_same_name_on_a_broker_refuses_to_fly_and_the_first_flies_on() {
    let (bench, broker) = (Bench::default(), Broker::default());
    with_broker(&bench, &broker);
    let flight = start(&bench, &[]);
    eventually("the ball flies", || (state(&broker)["mode"] == "flying").then_some(()));
    let second = bench.run(&["run", "--sim", "--log", "second.mcap", "--duration", "5"]);
    assert_eq!(second.code, Some(1), "{}", second.errors);
    for words in ["another program flies a rig named rig1", "[rig] name"] {
        assert!(second.errors.contains(words), "{}", second.errors);
    }
    assert!(!bench.path("second.mcap").exists(), "it did not fly");
    assert_eq!(state(&broker)["mode"], "flying");
    assert_eq!(broker.next("airball/rig1/status").trim(), "online");
    assert_eq!(end(flight, Signal::SIGINT).code, Some(0));
}

#[test]
fn numbers_change_in_flight_together_are_said_to_those_who_come_later_and_are_undone() {
    let (bench, broker) = (Bench::default(), Broker::default());
    with_broker(&bench, &broker);
    let flight = start(&bench, &[]);
    eventually("the ball flies", || (state(&broker)["mode"] == "flying").then_some(()));
    let numbers = || -> Value { serde_json::from_str(&broker.next("airball/rig1/numbers")).unwrap() };
    let of = |numbers: Value| [numbers["pid.kp_per_mm"].clone(), numbers["observer.sensor_mm"].clone()];
    assert_eq!(of(numbers()), [Value::from(0.018), Value::from(2.5)]);
    let send = |text: &str| broker.publish("airball/rig1/set/numbers", text);
    send(r#"{"pid.kp_per_mm": 0.02, "observer.sensor_mm": 3.0}"#);
    eventually("both are said", || (of(numbers()) == [Value::from(0.02), Value::from(3.0)]).then_some(()));
    send(r#"{"pid.kp_per_mm": 0.03, "observer.sensor_mm": -3.0}"#);
    send("undo");
    eventually("both are undone", || (of(numbers()) == [Value::from(0.018), Value::from(2.5)]).then_some(()));
    assert_eq!(end(flight, Signal::SIGINT).code, Some(0));
    let info = bench.output(&["log", "info", "f.mcap"]);
    for words in ["pid.kp_per_mm 0.02, observer.sensor_mm 3", "observer.sensor_mm = -3 is outside", "numbers undo"] {
        assert!(info.contains(words), "{words}: {info}");
    }
}

#[test]
fn a_broker_that_is_killed_in_flight_is_no_fault_and_its_successor_is_obeyed() {
    let (bench, mut broker) = (Bench::default(), Broker::default());
    with_broker(&bench, &broker);
    let flight = start(&bench, &[]);
    eventually("the ball flies", || (state(&broker)["mode"] == "flying").then_some(()));
    broker.replace();
    assert_eq!(state(&broker)["mode"], "flying");
    broker.publish("airball/rig1/set/setpoint_mm", "250");
    eventually("the command is in force", || (state(&broker)["setpoint_mm"] == 250.0).then_some(()));
    let ran = end(flight, Signal::SIGTERM);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    let count = |what: &str| ran.errors.matches(what).count();
    assert_eq!((count("connected to the broker"), count("lost the broker")), (2, 1), "{}", ran.errors);
    let info = bench.output(&["log", "info", "f.mcap"]);
    assert!(!info.contains("fault") && info.contains("setpoint_mm 250: accepted"), "{info}");
}

#[test]
fn a_flight_in_several_files_is_summed_up_and_drawn_as_one() {
    let bench = Bench::default();
    let config = bench.read("config.toml");
    bench.write("config.toml", config.replace("# part_s = 3600.0", "part_s = 10.0").replace("port = 1883", "port = 1"));
    let ran = Ran::from(start(&bench, &["--duration", "12", "--plot", "f.svg"]).wait_with_output().unwrap());
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    let cycles = |log| bench.output(&["log", "export", log]).lines().count() - 1;
    let all = cycles("f.mcap") + cycles("f-2.mcap");
    assert!(ran.output.contains(&format!("s, {all} cycles")), "{all}: {}", ran.output);
    assert!(ran.output.contains("f.mcap to f-2.mcap, 2 files"), "{}", ran.output);
    assert!(bench.read("f.svg").starts_with("<svg"));
}

#[test]
fn a_machine_without_the_bus_is_told_which_file_is_missing_and_what_to_do() {
    let bench = Bench::default();
    let config = bench.read("config.toml").replace("/dev/i2c-1", "/dev/i2c-that-is-not-there");
    bench.write("config.toml", config);
    let ran = bench.run(&["run"]);
    assert_eq!(ran.code, Some(1));
    for word in ["/dev/i2c-that-is-not-there", "raspi-config", "--sim"] {
        assert!(ran.errors.contains(word), "{word}: {}", ran.errors);
    }
}
