"""The blind proof on the workers of Dask has the page that one machine makes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import airball as ab
from conftest import ROOT

pytest.importorskip("distributed")
from airball import fleet  # noqa: E402

PROGRAM = ROOT / "crates/score/blind_fleet.py"


def run(folder, *command):
    ran = subprocess.run([*map(str, command)], cwd=folder, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    """Two rigs with an effect; the record of one cannot be read."""
    folder = tmp_path_factory.mktemp("blind")
    (folder / "sealed").mkdir()
    beside = Path(os.environ["AIRBALL_BINARY"]).parent
    sealed = ["--truth", "sealed/truth.json", "--bounds", "sealed/bounds.json"]
    run(folder, beside / "world", "--out", "cases", *sealed, "--seed", "c", "--count", 2, "--only", "duty_quantisation")
    record = sorted((folder / "cases").glob("*.csv*"))[-1]
    record.write_text("time_s\n0\n")
    return folder, beside / "blind", ["cases", "--leave-out", 1, *sealed]


def test_workers_give_the_page_that_one_machine_gives(cases):
    folder, blind, judged = cases
    alone = run(folder, blind, *judged, "--out", "alone")
    assert alone.startswith("2 cases: 1 effect, 1 unreadable\n"), alone
    (folder / "plan").write_text(run(folder, blind, *judged, "--plan"))
    with fleet.local(2) as client:
        run(folder, sys.executable, PROGRAM, "plan", "--out", "fleet", "--scheduler", client.scheduler.address)
    assert run(folder, blind, *judged, "--verdicts", "fleet") == alone
    verdicts = sorted(path.relative_to(folder / "alone") for path in (folder / "alone").rglob("*.json"))
    assert len(verdicts) == 2 and "left-out" in str(verdicts[-1])
    for verdict in verdicts:
        assert (folder / "alone" / verdict).read_bytes() == (folder / "fleet" / verdict).read_bytes()


def test_workers_with_another_build_are_refused(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(PROGRAM.parent))
    import blind_fleet

    class Client:
        def run(self, work):
            return {"tcp://a:1": work(), "tcp://b:2": "0" * 64}

    with pytest.raises(ab.Error, match=r"^the worker tcp://b:2 has another build .*sha256 000000000000, .*PYTHONPATH="):
        blind_fleet.check_builds(Client())
