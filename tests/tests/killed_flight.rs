//! The fan after a flight is killed, hangs, or loses its guard. The rig is emulated in a separate process, so that it
//! outlives the flight; the binary and its bus access are those of a real flight.

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::os::unix::net::UnixDatagram;
use std::process::{Child, Stdio};
use system_tests::{Bench, Broker, Emulated, Ran, eventually};

fn start(bench: &Bench, log: &str) -> Child {
    bench.airball(&["run", "--log", log]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn send(process: u32, signal: Signal) {
    kill(Pid::from_raw(process.try_into().unwrap()), signal).unwrap();
}

fn guard_of(flight: &Child) -> u32 {
    let id = flight.id();
    let children = std::fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap();
    children.split_whitespace().next().expect("a flight has a guard").parse().unwrap()
}

#[test]
fn a_flight_that_is_killed_leaves_the_fan_off_and_the_next_one_knows_why() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let mut flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    flight.kill().unwrap();
    rig.until_it_is_off();
    let _ = flight.wait();
    eventually("the cause is kept", || bench.path("flights/last-fault.json").exists().then_some(()));
    assert!(bench.read("flights/last-fault.json").contains("died in flight"));

    eventually("the guard gives the bus free", || {
        let ran = bench.run(&["run", "--duration", "1", "--log", "g.mcap"]);
        let taken = ran.errors.contains("is taken by another program");
        assert!(taken || (ran.code == Some(0) && ran.errors.contains("died in flight")), "{}", ran.errors);
        (!taken).then_some(())
    });
}

#[test]
fn a_loop_that_hangs_has_its_fan_turned_off_and_lands_when_it_wakes() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    send(flight.id(), Signal::SIGSTOP);
    rig.until_it_is_off();
    send(flight.id(), Signal::SIGCONT);
    let ran = Ran::from(flight.wait_with_output().unwrap());
    assert_eq!(ran.code, Some(1), "{}", ran.errors);
    assert!(ran.errors.contains("behind their deadlines"), "{}", ran.errors);
    rig.until_it_is_off();
    assert!(bench.output(&["log", "info", "f.mcap"]).contains("end      fault"));
    assert!(bench.read("flights/last-fault.json").contains("behind their deadlines"));
}

#[test]
fn a_flight_without_its_guard_lands() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    send(guard_of(&flight), Signal::SIGKILL);
    let ran = Ran::from(flight.wait_with_output().unwrap());
    assert_eq!(ran.code, Some(1), "{}", ran.errors);
    assert!(ran.errors.contains("ended in flight, so the ball was landed"), "{}", ran.errors);
    rig.until_it_is_off();
    let kept = bench.read("flights/last-fault.json");
    assert!(kept.contains("so the ball was landed") && kept.contains("f.mcap"), "{kept}");
}

#[test]
fn fan_off_stops_a_fan_that_nobody_guards_any_more() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let mut flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    let guard = guard_of(&flight);
    // Both are stopped before either is killed: a loop would land without its guard, and a guard that was stopped alone
    // wakes when its loop dies.
    send(flight.id(), Signal::SIGSTOP);
    send(guard, Signal::SIGKILL);
    flight.kill().unwrap();
    let _ = flight.wait();
    // Nothing turned it off: the PCA9685 keeps its last duty when its program dies.
    rig.until("the fan keeps its duty", |percent| percent >= 10.0);
    assert!(bench.output(&["fan-off"]).contains("is off"));
    rig.until_it_is_off();
}

#[test]
fn output_enable_stops_the_fan_when_flight_and_guard_are_both_killed() {
    let bench = Bench::default();
    bench.write("config.toml", bench.read("config.toml") + "\n[rig.output_enable]\nline = 4\n");
    let rig = Emulated::on(&bench);
    let mut flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    let guard = guard_of(&flight);
    send(flight.id(), Signal::SIGSTOP);
    send(guard, Signal::SIGKILL);
    flight.kill().unwrap();
    let _ = flight.wait();
    // The kernel has closed their handles, and the line has returned to its pull-up.
    rig.until_it_is_off();
    assert!(bench.output(&["fan-off"]).contains("is off"));
}

#[test]
fn signals_are_for_the_loop_and_its_guard_ends_with_it() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    for process in [guard_of(&flight), flight.id()] {
        send(process, Signal::SIGTERM);
    }
    let ran = Ran::from(flight.wait_with_output().unwrap());
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    rig.until_it_is_off();
    assert!(!bench.path("flights/last-fault.json").exists());
}

#[test]
fn a_second_flight_of_the_same_rig_is_refused() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    let second = bench.run(&["run", "--log", "g.mcap"]);
    assert!(second.code == Some(1) && second.errors.contains("is taken by another program"), "{}", second.errors);
    send(flight.id(), Signal::SIGTERM);
    assert_eq!(Ran::from(flight.wait_with_output().unwrap()).code, Some(0));
}

#[test]
fn the_service_manager_hears_that_it_flies_and_holds_up_nobody_when_it_then_listens_no_more() {
    let bench = Bench::default();
    let rig = Emulated::on(&bench);
    let manager = UnixDatagram::bind(bench.path("notify.sock")).unwrap();
    let mut command = bench.airball(&["run", "--duration", "2", "--log", "f.mcap"]);
    let flight = command.env("NOTIFY_SOCKET", bench.path("notify.sock")).stderr(Stdio::piped()).spawn().unwrap();
    rig.until_it_flies();
    let mut word = [0; 256];
    let length = manager.recv(&mut word).unwrap();
    let word = String::from_utf8_lossy(&word[..length]).into_owned();
    assert!(word.contains("READY=1") && word.contains("WATCHDOG=1"), "{word}");
    assert_eq!(Ran::from(flight.wait_with_output().unwrap()).code, Some(0));
}

#[test]
fn the_fault_that_ended_a_flight_is_published_and_stays() {
    let (bench, broker) = (Bench::default(), Broker::default());
    let rig = Emulated::on(&bench);
    let config = bench.read("config.toml");
    bench.write("config.toml", config.replace("port = 1883", &format!("port = {}", broker.port)));
    let flight = start(&bench, "f.mcap");
    rig.until_it_flies();
    let guard = guard_of(&flight);
    assert!(!broker.next("airball/rig1/state").is_empty());
    // Without the emulated rig, the bus fails at both chips; its guard would try for a minute.
    drop(rig);
    eventually("the flight ends", || bench.path("flights/last-fault.json").exists().then_some(()));
    assert_eq!(broker.next("airball/rig1/fault").trim(), bench.read("flights/last-fault.json").trim());
    send(guard, Signal::SIGKILL);
    let ran = Ran::from(flight.wait_with_output().unwrap());
    assert!(ran.code == Some(1) && ran.errors.contains("switch off its supply now"), "{}", ran.errors);
}
