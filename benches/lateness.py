"""Times how late the control loop begins its cycles beside cyclictest, in turn, and prints both and their ratio.

`airball run --sim` flies with its log on and a broker; cyclictest sleeps to the same deadlines at the same priority. All along a broker
runs, a publisher floods it with setpoints for the rig, and a subscriber takes what passes. The threads of airball that take the flood and write
the log come on top, for airball alone. Lateness is that of every cycle in the flight's log, and of every cycle in cyclictest's histogram:
wake-up minus deadline, microseconds, the processor's power states as they are.

The ratio is of the 99.9 % quantiles of a pair of runs; its median has an interval from the order of the pairs, without further assumptions.
"""

import argparse
import json
import math
import os
import re
import resource
import socket
import statistics
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from mcap.reader import make_reader

ROOT = Path(__file__).resolve().parent.parent
PRIORITY = 45  # of the loop: real_time.rs
TARGET = 1.2
HISTOGRAM_US = 100_000
"""cyclictest counts single microseconds up to here."""


class Permitted(NamedTuple):
    """What this machine permits both programs."""

    real_time: bool
    locked: bool

    def __str__(self):
        priority = f"SCHED_FIFO {PRIORITY}" if self.real_time else "no real-time priority is permitted: both go without"
        return f"{priority}; memory {'locked' if self.locked else 'may not be locked without limit: both go without'}"


def may_have_priority():
    """Whether this user may have the loop's priority."""
    probe = f"import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param({PRIORITY}))"
    return subprocess.run([sys.executable, "-c", probe], stderr=subprocess.DEVNULL).returncode == 0


def may_lock_memory():
    """Asks for what airball wants, memory locked without limit; what is given is inherited. Returns whether it was given."""
    try:
        resource.setrlimit(resource.RLIMIT_MEMLOCK, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    except (ValueError, OSError):
        return False
    return True


@contextmanager
def flooded_broker(commands_per_s):
    """A broker, a publisher of setpoints and a subscriber. Yields the port."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    path = os.environ["PATH"] + ":/usr/sbin"
    broker = subprocess.Popen(["mosquitto", "-p", str(port)], env={**os.environ, "PATH": path}, **quiet)
    await_port(port)
    subscriber = subprocess.Popen(["mosquitto_sub", "-p", str(port), "-t", "airball/#"], **quiet)
    topic = ["-t", "airball/rig1/set/setpoint_mm"]
    publisher = subprocess.Popen(["mosquitto_pub", "-p", str(port), "-l", *topic], stdin=subprocess.PIPE, **quiet)
    end = threading.Event()
    flood = threading.Thread(target=pour, args=(publisher.stdin, commands_per_s, end))
    flood.start()
    try:
        yield port
    finally:
        end.set()
        flood.join()
        for process in (publisher, subscriber, broker):
            process.terminate()
            process.wait()


def await_port(port):
    for _ in range(200):
        try:
            return socket.create_connection(("127.0.0.1", port)).close()
        except OSError:
            time.sleep(0.05)
    sys.exit("bench-lateness: mosquitto does not listen after 10 s")


def pour(pipe, per_s, end):
    """Writes setpoints until told to end, a batch every 20 ms."""
    batch = b"".join(b"%d\n" % (200 + i % 200) for i in range(max(1, round(per_s * 0.02))))
    while not end.wait(0.02):
        pipe.write(batch)
        pipe.flush()


def fly(airball, folder, port, period_s, duration_s):
    """Lateness of every cycle of a flight, microseconds."""
    log = folder / "flight.mcap"
    log.unlink(missing_ok=True)
    patch = f"[loop]\nperiod_s = {period_s}\n[mqtt]\nhost = \"127.0.0.1\"\nport = {port}\n[safety]\nstall_s = 10.0\n"
    (folder / "bench.toml").write_text(patch, encoding="utf-8")
    flags = ["--sim", "--config", ROOT / "config.toml", "--patch", "bench.toml", "--duration", str(duration_s), "--log", log.name, "--json"]
    flown = subprocess.run([airball, "run", *flags], cwd=folder, check=True, capture_output=True, text=True)
    summary = json.loads(flown.stdout)
    with open(log, "rb") as file:
        cycles = [json.loads(message.data) for _, _, message in make_reader(file).iter_messages(topics=["cycle"])]
    if len(cycles) != summary["cycles"]:
        sys.exit(f"bench-lateness: the log has {len(cycles)} of {summary['cycles']} cycles; is the disk too slow?")
    return sorted(1e6 * cycle["lateness_s"] for cycle in cycles)


def cyclictest(period_s, duration_s, permitted):
    """The same of cyclictest, with what airball is permitted."""
    policy = ["--policy=fifo", "-p", str(PRIORITY)] if permitted.real_time else ["--policy=other"]
    flags = ["-q", "-t1", "--default-system", "-i", str(round(1e6 * period_s)), "-l", str(round(duration_s / period_s))]
    memory = ["-m"] if permitted.locked else []
    command = ["cyclictest", *flags, *memory, *policy, f"--histogram={HISTOGRAM_US}"]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    counts = [(int(us), int(count)) for us, count in re.findall(r"^(\d{6}) (\d+)$", said, re.MULTILINE)]
    late = list(chain.from_iterable([us] * count for us, count in counts))
    worst = int(re.search(r"# Max Latencies: *(\d+)", said).group(1))
    beyond = int(re.search(r"# Histogram Overflows: *(\d+)", said).group(1))
    return late + [worst] * beyond


def quantile(in_order, share):
    """The smallest value that at least this share does not exceed."""
    return in_order[math.ceil(share * len(in_order)) - 1]


def median_and_interval(values):
    """The median, and the narrowest interval of order statistics that holds it in at least 95 % of such experiments."""
    values, n = sorted(values), len(values)
    outside = lambda k: 2 * sum(math.comb(n, i) for i in range(k + 1)) / 2**n
    k = max((k for k in range(n // 2) if outside(k) <= 0.05), default=0)
    return statistics.median(values), values[k], values[n - 1 - k], 1 - outside(k)


def compare(arguments, port, period_s, permitted):
    """Pairs of runs of one period; each is begun by the other than the last."""
    folder = arguments.folder
    runs = {"airball": [], "cyclictest": []}
    turns = {
        "airball": lambda: fly(arguments.airball, folder, port, period_s, arguments.seconds),
        "cyclictest": lambda: cyclictest(period_s, arguments.seconds, permitted),
    }
    for pair in range(arguments.pairs):
        for name in sorted(turns, reverse=pair % 2 == 1):
            runs[name].append(turns[name]())
    print(f"\nperiod {1e3 * period_s:g} ms, {arguments.pairs} pairs of {arguments.seconds:g} s; lateness in µs")
    print(f"{'':12}{'cycles':>9}{'p50':>9}{'p99':>9}{'p99.9':>9}{'max':>9}")
    for name, of in runs.items():
        late = sorted(chain.from_iterable(of))
        shares = "".join(f"{quantile(late, share):9.0f}" for share in (0.5, 0.99, 0.999, 1.0))
        print(f"{name:12}{len(late):9}{shares}")
    pairs = zip(runs["airball"], runs["cyclictest"], strict=True)
    ratios = [quantile(ours, 0.999) / max(1, quantile(theirs, 0.999)) for ours, theirs in pairs]
    median, low, high, sure = median_and_interval(ratios)
    verdict = "met" if median <= TARGET else "missed"
    print(f"ratio of p99.9: median {median:.2f}, {100 * sure:.0f} % interval {low:.2f} to {high:.2f}; at most {TARGET} is {verdict}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("airball", type=Path, help="the binary")
    parser.add_argument("--folder", type=Path, required=True, help="where flights are logged")
    parser.add_argument("--pairs", type=int, default=9, help="pairs of runs for each period (%(default)s)")
    parser.add_argument("--seconds", type=float, default=60, help="length of a run (%(default)s)")
    parser.add_argument("--periods-ms", type=float, nargs="+", default=[20, 5], help="periods of the loop (20 5)")
    parser.add_argument("--flood", type=float, default=500, help="commands a second (%(default)s)")
    arguments = parser.parse_args()
    permitted = Permitted(may_have_priority(), may_lock_memory())
    print(f"{os.cpu_count()} processors, load before {os.getloadavg()[0]:.2f}; {arguments.flood:g} commands a second; {permitted}")
    with flooded_broker(arguments.flood) as port:
        for period_ms in arguments.periods_ms:
            compare(arguments, port, period_ms / 1e3, permitted)


if __name__ == "__main__":
    main()
