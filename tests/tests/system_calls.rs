//! The system calls of the loop in flight, recorded by strace: writing the log, a listening broker and commands must
//! not cause a system call of the loop, which could block.

use std::collections::BTreeSet;
use std::fs;
use std::process::{Command, Stdio};
use system_tests::{Bench, Broker, Emulated, Ran};

/// The loop sleeps until an absolute time, not for a duration.
const DEADLINE: &str = "clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME";

/// The same command under strace, which writes a file `trace.ID` for each thread.
fn traced(command: &Command, bench: &Bench) -> Command {
    let mut traced = Command::new("strace");
    traced.args(["-ff", "-o", "trace"]).arg(command.get_program()).args(command.get_args());
    traced.current_dir(bench.path(".")).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    traced
}

/// The system calls of the thread of the loop, which is the program's first.
fn calls_of_the_loop(bench: &Bench) -> String {
    let files = fs::read_dir(bench.path(".")).unwrap().map(|entry| entry.unwrap());
    let traces = files.filter(|file| file.file_name().to_string_lossy().starts_with("trace."));
    let texts = traces.map(|file| String::from_utf8_lossy(&fs::read(file.path()).unwrap()).into_owned());
    let begun = |text: &String| text.starts_with("execve(") && text.lines().next().unwrap().contains("\"run\"");
    texts.into_iter().find(begun).expect("a trace of the flight")
}

/// The file number of a system call on an open file, such as `write(9, …) = 4`.
fn file_read_or_written(call: &str) -> Option<&str> {
    let (name, arguments) = call.split_once('(')?;
    ["read", "write", "recvfrom", "sendto"].contains(&name).then(|| first(arguments))
}

/// The files that were connected to the emulated rig.
fn files_of_the_bus(calls: &str) -> BTreeSet<&str> {
    let connected = calls.lines().filter(|call| call.contains("rig.sock"));
    connected.filter_map(|call| call.strip_prefix("connect(")).map(first).collect()
}

fn first(arguments: &str) -> &str {
    arguments.split([',', ')']).next().unwrap()
}

#[test]
fn in_a_cycle_the_loop_asks_the_kernel_for_the_bus_and_its_next_deadline_and_nothing_else() {
    let (bench, broker) = (Bench::default(), Broker::default());
    let rig = Emulated::on(&bench);
    let config = bench.read("config.toml");
    bench.write("config.toml", config.replace("port = 1883", &format!("port = {}", broker.port)));
    let flight = bench.airball(&["run", "--duration", "8", "--log", "f.mcap"]);
    let flight = traced(&flight, &bench).spawn().expect("strace runs; scripts/test installs it");
    rig.until_it_flies();
    assert!(!broker.next("airball/rig1/state").is_empty());
    for height_mm in [200, 250, 300] {
        broker.publish("airball/rig1/set/setpoint_mm", &height_mm.to_string());
    }
    let ran = Ran::from(flight.wait_with_output().unwrap());
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    assert!(bench.output(&["log", "info", "f.mcap"]).contains("setpoint_mm 300: accepted"));

    let calls = calls_of_the_loop(&bench);
    let begun = calls.find("flying ").expect("the loop says that it begins");
    let all = &calls[begun..];
    // From its first deadline to its last.
    let (from, to) = (all.find(DEADLINE).expect("a deadline"), all.rfind(DEADLINE).expect("a deadline"));
    let cycles: Vec<&str> = all[from..to].lines().collect();
    let deadlines = cycles.iter().filter(|call| call.starts_with(DEADLINE)).count();
    assert!(deadlines > 20, "{deadlines}");
    let files: BTreeSet<&str> = cycles.iter().filter_map(|call| file_read_or_written(call)).collect();
    assert_eq!(files, files_of_the_bus(&calls));
    let of_time = |call: &str| call.starts_with(DEADLINE) || call.starts_with("clock_gettime(");
    let mut others = cycles.iter().filter(|call| !of_time(call) && file_read_or_written(call).is_none());
    assert_eq!(others.next(), None);
}
