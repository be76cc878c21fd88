"""The rig and the flights that several tests use, and the binary that they are compared with."""

import os
import subprocess
from pathlib import Path

import pytest

import airball as ab

ROOT = Path(__file__).resolve().parents[3]
CONFIG = ROOT / "config.toml"
#: Exit status of a diagnosis whose record cannot answer.
NO_ANSWER = 3


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def rig():
    return ab.Model.load(CONFIG)


@pytest.fixture(scope="session")
def stuck(rig):
    """A rig with a dead zone, and a flight of it."""
    return ab.simulate(rig.with_effects(dead_zone={"lower_percent": -0.3, "upper_percent": 0.3}), seed=1)


@pytest.fixture(scope="session")
def found(rig, stuck):
    return ab.diagnose(rig, stuck, without_formula=True)


@pytest.fixture(scope="session")
def binary():
    """Runs the binary of `AIRBALL_BINARY` in the folder of the project; returns what it printed, and on failure its error."""

    def run(*arguments, fails=False):
        program = os.environ["AIRBALL_BINARY"]
        ran = subprocess.run([program, *map(str, arguments)], cwd=ROOT, capture_output=True, text=True, check=False)
        # A record that cannot answer has a diagnosis, too: it says so.
        is_done = ran.returncode in (0, NO_ANSWER)
        assert is_done != fails, ran.stderr
        return ran.stderr if fails else ran.stdout

    return run
