"""The workers of a fleet as jobs of Slurm: here of programs of its names, which run a job as a process of this machine."""

import os
import subprocess
import sys
import time

import pytest

from conftest import ROOT
from fake_slurm import FakeSlurm

dask = pytest.importorskip("dask")
pytest.importorskip("dask_jobqueue")
pytest.importorskip("pyarrow")
import airball as ab  # noqa: E402
from airball import fleet  # noqa: E402
from test_fleet_inputs import STILL, reports  # noqa: E402

#: The test's machine may have no other address.
HERE = {"scheduler_options": {"host": "127.0.0.1", "dashboard_address": ":0"}}


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    made = FakeSlurm(tmp_path)
    for name, value in made.environment.items():
        monkeypatch.setenv(name, value)
    yield made
    for job in made.running():
        made.kill(job)


@pytest.fixture
def logs(tmp_path):
    folder = tmp_path / "logs"
    folder.mkdir()
    for name in ("a.csv", "b.csv"):
        (folder / name).write_text(STILL)
    return folder


def until(what, seconds=30.0):
    """Waits until something holds."""
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "it does not come about"
        time.sleep(0.05)


def test_the_command_diagnoses_by_jobs_and_ends_them(slurm, logs, binary, tmp_path):
    binary("diagnose", logs, "--each", "--out", tmp_path / "alone")
    asked = [logs, "--config", "config.toml", "--out", tmp_path / "out", "--slurm", "2", "--walltime", "00:09:00", "--memory", "1GB"]
    command = [sys.executable, "-W", "ignore", "-m", "airball.fleet", *map(str, asked)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=120)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.startswith("0 logs are diagnosed, 2 cannot answer, 0 cannot be read")
    assert reports(tmp_path / "out") == reports(tmp_path / "alone")
    scripts = slurm.submitted()
    assert len(scripts) == 2
    for line in ("#SBATCH -t 00:09:00", "#SBATCH --mem=954M", "export RAYON_NUM_THREADS=1", "PROFILE__ENABLED=False", "--nthreads 1"):
        assert line in scripts[0], scripts[0]
    until(lambda: not slurm.running())


def test_a_job_that_ends_is_submitted_again_and_its_log_is_diagnosed(slurm, logs, rig, tmp_path):
    # How long the scheduler waits for a worker that it lost, before it has another job submitted.
    soon = dask.config.set({"distributed.deploy.lost-worker-timeout": "1s"})
    with soon, fleet.slurm(1, memory="1GB", **HERE) as client:
        client.wait_for_workers(1, timeout=60)
        assert client.submit(os.getenv, "RAYON_NUM_THREADS").result() == "1"
        [first] = slurm.running()
        slurm.kill(first)
        made = fleet.diagnose(logs / "a.csv", model=rig, out=tmp_path / "out", client=client)
        assert (made.diagnosed, made.cannot_answer, made.failed) == (0, 1, 0)
        assert len(slurm.running()) == 1 and first not in slurm.running()
    until(lambda: not slurm.running())


def test_a_job_that_slurm_refuses_is_an_error_with_its_reason(slurm):
    reason = "^Slurm refuses the job: sbatch: error: invalid partition specified: nowhere; check memory"
    with pytest.raises(ab.Error, match=reason), fleet.slurm(1, queue="nowhere", **HERE):
        pass
    assert not slurm.submitted()
