"""What the engine of `airball.fleet` costs beside the bare diagnoses: time, processor, memory of the scheduler, traffic.

Many short simulated logs, in rounds: two processes that take the logs from a shared counter and write the reports, and a
Dask scheduler with two workers of one thread; which goes first changes from round to round. The processes are started
before. Then tasks without work and with results as large show what scheduler and client can carry at most.
"""

import argparse
import json
import multiprocessing
import os
import pickle
import statistics
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import psutil
from distributed import Client

import airball as ab
from airball import fleet
from airball.fleet._run import Task, results

WORKERS = 2
#: Tasks without work: parts, and tasks in each.
PARTS, PART = 6, 1000
EFFECTS = ({}, {"transport_delay": 0.08}, {"dead_zone": {"lower_percent": -0.3, "upper_percent": 0.3}})
MEGABYTE = 1e6


def make_logs(folder, count, duration):
    """Flights of the shown rig, every third with nothing wrong."""
    rigs = [ab.Model.example().with_effects(**effects) for effects in EFFECTS]
    for number in range(count):
        ab.simulate(rigs[number % len(rigs)], seed=number + 1, duration=duration).save(folder / f"{number:05}.mcap")
    return sorted(folder.iterdir())


def share(counter):
    """Starts a process of the bare diagnoses."""
    global taken
    taken = counter


def diagnose_share(logs, out):
    """Diagnoses the logs that no other process has taken, and writes their reports."""
    model = ab.Model.example()
    while True:
        with taken.get_lock():
            number, taken.value = taken.value, taken.value + 1
        if number >= len(logs):
            return
        name = logs[number].name
        fleet._write(out, name, *fleet.report(model, str(logs[number]), name, {}))


@contextmanager
def cluster(folder):
    """A scheduler and its workers, each a process of its own, and a client."""
    file = folder / "scheduler.json"

    def start(program, *flags):
        command = [sys.executable, "-m", f"distributed.cli.{program}", "--no-dashboard", "--scheduler-file", str(file), *flags]
        return subprocess.Popen(command, env=os.environ | fleet.ENVIRONMENT, stderr=subprocess.DEVNULL)

    scheduler = start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
    workers = [start("dask_worker", "--nthreads", "1", "--no-nanny", "--death-timeout", "60") for _ in range(WORKERS)]
    try:
        while not file.exists() or not file.stat().st_size:
            time.sleep(0.05)
        with Client(json.loads(file.read_text())["address"]) as client:
            client.wait_for_workers(WORKERS)
            yield client, psutil.Process(scheduler.pid), [psutil.Process(worker.pid) for worker in workers]
    finally:
        for process in (*workers, scheduler):
            process.terminate()
            process.wait()


def processor(processes):
    """Seconds of processor that processes have used."""
    return [sum(process.cpu_times()[:2]) for process in processes]


def timed(work, processes):
    """Wall time of some work, and what each process used meanwhile."""
    before, start = processor(processes), time.perf_counter()
    work()
    wall = time.perf_counter() - start
    return wall, [now - then for now, then in zip(processor(processes), before, strict=True)]


def compare(args, folder, logs, client, scheduler, workers):
    """The rounds: of each the times of both ways and the scheduler's memory."""
    context = multiprocessing.get_context("spawn")
    counter = context.Value("i", 0)
    own, rounds = psutil.Process(), []
    with context.Pool(WORKERS, initializer=share, initargs=(counter,)) as pool:
        pool.map(abs, range(WORKERS))
        children = own.children()
        bare_processes = [child for child in children if child not in (scheduler, *workers)]
        for number in range(args.rounds):
            part = logs[number :: args.rounds]
            outs = [folder / f"{way}{number}" for way in ("bare", "fleet")]
            outs[0].mkdir()

            def bare(part=part, out=outs[0]):
                counter.value = 0
                pool.starmap(diagnose_share, [(part, out)] * WORKERS, chunksize=1)

            def engine(part=part, out=outs[1]):
                fleet.diagnose(part, model=ab.Model.example(), out=out, client=client)

            ways = {"bare": (bare, bare_processes), "fleet": (engine, [scheduler, own, *workers])}
            order = list(ways) if number % 2 else list(ways)[::-1]
            made = {way: timed(*ways[way]) for way in order}
            same = all((outs[0] / f"{log.name}.json").read_bytes() == (outs[1] / f"{log.name}.json").read_bytes() for log in part)
            memory = [process.memory_info().rss / MEGABYTE for process in (scheduler, own)]
            rounds.append((len(part), made, memory, same))
            tell_round(number, rounds[-1])
    return rounds


def tell_round(number, made):
    count, times, memory, same = made
    (bare, bare_used), (engine, engine_used) = times["bare"], times["fleet"]
    print(
        f"round {number + 1}: {count} logs, bare {bare:.1f} s, fleet {engine:.1f} s, {100 * (engine / bare - 1):+.1f} %; "
        f"processor {sum(bare_used):.1f} s, {100 * (sum(engine_used) / sum(bare_used) - 1):+.1f} %; "
        f"scheduler {memory[0]:.0f} MB, client {memory[1]:.0f} MB; documents {'equal' if same else 'DIFFER'}",
        flush=True,
    )


def echo(size, _model):
    """A task without work, whose result is as large as a report."""
    return "x" * size


def carried(client, scheduler, size):
    """Of tasks without work: their rate, the processor time of scheduler and client for each, and the scheduler's memory after
    each part."""
    memory, model = [], ab.Model.example()

    def run():
        for _ in range(PARTS):
            tasks = [Task(str(number), (size, model)) for number in range(PART)]
            assert sum(1 for _ in results(client, echo, tasks)) == PART
            memory.append(scheduler.memory_info().rss / MEGABYTE)

    wall, used = timed(run, [scheduler, psutil.Process()])
    return PARTS * PART / wall, [seconds / (PARTS * PART) for seconds in used], memory


def summary(rounds, logs, folder, carry):
    """What the rounds say, as lines."""
    count = sum(made[0] for made in rounds)
    ratios = sorted(100 * (times["fleet"][0] / times["bare"][0] - 1) for _, times, _, _ in rounds)
    bare, engine = (sum(times[way][0] for _, times, _, _ in rounds) for way in ("bare", "fleet"))
    bare_cpu = sum(sum(times["bare"][1]) for _, times, _, _ in rounds) / count
    scheduler, client, *workers = (sum(used) / count for used in zip(*(times["fleet"][1] for _, times, _, _ in rounds)))
    reports = [path.stat().st_size for path in folder.glob("fleet*/*.mcap.*")]
    size = sum(reports) / count
    sent = len(pickle.dumps((ab.Model.example(), str(logs[0]), logs[0].name, {})))
    memory = [made[2][0] for made in rounds]
    yield f"overhead, wall time of all rounds: {100 * (engine / bare - 1):+.1f} %"
    yield f"overhead, wall time, median of the rounds: {statistics.median(ratios):+.1f} %, from {ratios[0]:+.1f} to {ratios[-1]:+.1f} %"
    yield f"overhead, processor time: {100 * ((scheduler + client + sum(workers)) / bare_cpu - 1):+.1f} %"
    yield f"processor time of a log: bare {bare_cpu:.2f} s; worker {sum(workers):.2f} s, scheduler {1e3 * scheduler:.1f} ms, client {1e3 * client:.1f} ms"
    yield f"memory of the scheduler: {memory[0]:.0f} MB after the first round, {memory[-1]:.0f} MB after the last, at most {max(memory):.0f} MB"
    yield f"of a log: {logs[0].stat().st_size / 1e3:.0f} kB read, {sent / 1e3:.0f} kB to the worker, {size / 1e3:.0f} kB of reports back"
    rate, (scheduler_s, client_s), later = carry
    yield f"without work: {rate:.0f} logs a second; scheduler {1e3 * scheduler_s:.1f} ms, client {1e3 * client_s:.1f} ms of processor time a log"
    yield f"memory of the scheduler after each {PART} logs without work: {', '.join(f'{megabytes:.0f}' for megabytes in later)} MB"


def main():
    """Reads the flags and runs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, required=True, help="an empty folder for logs and reports")
    parser.add_argument("--logs", type=int, default=1000, help="number of logs [1000]")
    parser.add_argument("--rounds", type=int, default=10, help="parts in which they are diagnosed [10]")
    parser.add_argument("--duration", type=float, default=12.0, help="length of a log, seconds [12]")
    args = parser.parse_args()
    os.environ["RAYON_NUM_THREADS"] = "1"
    (args.folder / "logs").mkdir()
    logs = make_logs(args.folder / "logs", args.logs, args.duration)
    with cluster(args.folder) as (client, scheduler, workers):
        rounds = compare(args, args.folder, logs, client, scheduler, workers)
        reports = [path.stat().st_size for path in args.folder.glob("fleet*/*.mcap.*")]
        carry = carried(client, scheduler, sum(reports) // len(logs))
    print(*summary(rounds, logs, args.folder, carry), sep="\n")


if __name__ == "__main__":
    main()
