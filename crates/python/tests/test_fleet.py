"""A fleet of logs on processes of Dask: the files are those of one machine, whatever happens to the workers."""

import functools
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import pytest

import airball as ab
from conftest import CONFIG, ROOT

distributed = pytest.importorskip("distributed")
pytest.importorskip("pyarrow")
cloudpickle = pytest.importorskip("cloudpickle")
from airball import fleet  # noqa: E402

FLAGS = {"without_formula": True}


@pytest.fixture(scope="module")
def logs(rig, tmp_path_factory):
    """Six flights, two of them in a folder of their own, and a file that is no log."""
    folder = tmp_path_factory.mktemp("logs")
    (folder / "monday").mkdir()
    for number in range(6):
        effects = {"transport_delay": 0.08} if number % 2 else {}
        flight = ab.simulate(rig.with_effects(**effects), seed=number + 1, duration=12.0)
        flight.save(folder / ("monday" if number < 2 else ".") / f"{number}.mcap")
    (folder / "poison.csv").write_text("time_s,duty_percent\n0,\x00\n")
    return folder


@pytest.fixture(scope="module")
def alone(logs, binary, tmp_path_factory):
    """What `airball diagnose --each` writes."""
    out = tmp_path_factory.mktemp("alone")
    binary("diagnose", logs, "--each", "--out", out, "--without-formula")
    return files(out)


def files(folder):
    kept = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "results.parquet")
    return {str(path.relative_to(folder)): path.read_bytes() for path in kept}


@pytest.fixture(scope="module")
def model():
    os.chdir(ROOT)
    return ab.Model.load("config.toml")


def counted(tally, model, path, name, flags):
    """The work of a worker, noted in a file."""
    with open(tally, "a") as file:
        file.write(f"{name}\n")
    return fleet.report(model, path, name, flags)


def test_workers_write_what_one_machine_writes_and_do_nothing_twice(logs, alone, model, tmp_path_factory, tmp_path, monkeypatch):
    tally = tmp_path_factory.mktemp("tally") / "done"
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    monkeypatch.setattr(fleet, "report", functools.partial(counted, tally))
    with fleet.local(2) as client:
        made = fleet.diagnose(logs, model=model, out=tmp_path, client=client, **FLAGS)
        assert files(tmp_path) == alone
        assert sorted(tally.read_text().split()) == sorted(made.to_frame()["log"])
        assert (made.diagnosed, made.cannot_answer, made.failed) == (6, 0, 1)
        frame = made.to_frame()
        assert list(frame["log"]) == sorted(frame["log"]) and frame["error"].notna().sum() == 1
        # Only the log without a diagnosis is tried again, and one that is gone.
        (tmp_path / "3.mcap.json").unlink()
        before = {name: (tmp_path / name).stat().st_mtime_ns for name in alone if name.endswith(".json") and name != "3.mcap.json"}
        fleet.diagnose(logs, model=model, out=tmp_path, client=client, **FLAGS)
        assert files(tmp_path) == alone
        assert before == {name: (tmp_path / name).stat().st_mtime_ns for name in before}


def test_a_worker_that_is_killed_changes_nothing(logs, alone, model, tmp_path):
    with fleet.local(3) as client:
        killed = []

        def kill():
            while not list(tmp_path.rglob("*.json")):
                time.sleep(0.05)
            worker, process = next(iter(client.run(os.getpid).items()))
            os.kill(process, signal.SIGKILL)
            killed.append(worker)

        killer = threading.Thread(target=kill)
        killer.start()
        fleet.diagnose(logs, model=model, out=tmp_path, client=client, **FLAGS)
        killer.join()
        assert killed and files(tmp_path) == alone


def deadly(model, path, name, flags):
    """A log that takes more memory than any worker has."""
    if name == "4.mcap":
        held = []
        for _ in range(200):
            held.append(b"x" * (20 << 20))
            time.sleep(0.01)
    return "", "", f"{name}: tried"


def test_a_log_that_kills_its_workers_by_memory_is_given_up_and_the_others_are_not(logs, model, tmp_path, monkeypatch):
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    monkeypatch.setattr(fleet, "report", deadly)
    monkeypatch.setattr(fleet._clusters, "DEATHS", 1)
    with fleet.local(2, memory_limit="600MB") as client:
        made = fleet.diagnose(logs, model=model, out=tmp_path, client=client)
    assert made.failed == 7
    errors = {path.name: path.read_text() for path in tmp_path.rglob("*.error")}
    assert errors["4.mcap.error"] == "4.mcap: its worker died 2 times; it may need more memory, the log of the worker says why\n"
    assert all(text.endswith(": tried\n") for name, text in errors.items() if name != "4.mcap.error")


@contextmanager
def processes(folder):
    """A scheduler and a worker, each a process of its own; the scheduler and its address."""

    def start(program, *flags):
        command = [sys.executable, "-W", "ignore", "-m", f"distributed.cli.{program}", *flags, "--no-dashboard"]
        return subprocess.Popen([*command, "--scheduler-file", file], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    file = str(folder / "scheduler.json")
    scheduler = start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
    worker = start("dask_worker", "--nthreads", "1", "--no-nanny", "--death-timeout", "20")
    try:
        while not (os.path.exists(file) and os.path.getsize(file)):
            time.sleep(0.05)
        with open(file) as written:
            yield scheduler, json.load(written)["address"]
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()


def test_a_run_whose_scheduler_is_killed_ends_and_goes_on_from_what_is_written(logs, alone, model, tmp_path_factory, tmp_path):
    places = [logs / name for name in ("2.mcap", "3.mcap", "5.mcap")]
    with processes(tmp_path_factory.mktemp("cluster")) as (scheduler, address), distributed.Client(address) as client:

        def kill():
            while not list(tmp_path.glob("*.json")):
                time.sleep(0.02)
            scheduler.kill()

        killer = threading.Thread(target=kill)
        killer.start()
        with pytest.raises(ab.Error, match="^the connection to the scheduler is lost; what is written is kept"):
            fleet.diagnose(places, model=model, out=tmp_path, client=client, **FLAGS)
        killer.join()
    written = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.json")}
    assert 1 <= len(written) < 3 and not list(tmp_path.glob("*.error"))
    with fleet.local(2) as client:
        made = fleet.diagnose(places, model=model, out=tmp_path, client=client, **FLAGS)
    assert (made.diagnosed, made.failed) == (3, 0)
    assert written == {path: path.stat().st_mtime_ns for path in written}, "no log is diagnosed twice"
    reports = {name: text for name, text in files(tmp_path).items() if ".mcap." in name}
    assert reports == {name: alone[name] for name in reports} and len(reports) == 6


def test_a_model_crosses_to_a_worker_with_its_files():
    model = ab.Model.load(CONFIG).with_effects(transport_delay=0.08)
    assert pickle.loads(pickle.dumps(model))._belief.texts() == model._belief.texts()


def test_an_empty_list_and_a_folder_without_logs_are_refused(tmp_path, model):
    with pytest.raises(ab.ArgumentError, match="^logs is empty"):
        fleet.diagnose([], model=model, out=tmp_path, client=None)
    with pytest.raises(ab.UsageError, match="no log is in there"):
        fleet.diagnose(tmp_path, model=model, out=tmp_path, client=None)


def test_a_damaged_result_is_a_row_with_its_cause_beside_the_others(alone, tmp_path):
    from pyarrow import parquet

    good = alone["3.mcap.json"]
    (tmp_path / "good.json").write_bytes(good if isinstance(good, bytes) else good.encode())
    (tmp_path / "empty.json").write_text("")
    (tmp_path / "other.json").write_text('{"effects": [], "gap": []}')
    fleet._table(tmp_path, ["empty", "good", "other"])
    rows = parquet.read_table(tmp_path / "results.parquet").to_pylist()
    assert [row["log"] for row in rows] == ["empty", "good", "other"]
    assert rows[1]["verdict"] and rows[1]["error"] is None
    assert all("is damaged" in row["error"] and "delete it" in row["error"] for row in (rows[0], rows[2]))
    assert [path.name for path in tmp_path.iterdir() if path.name.endswith(".part")] == []
