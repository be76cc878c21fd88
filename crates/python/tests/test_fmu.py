"""The FMU, stepped by FMPy, gives the cycles of the simulated flight."""

import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

import airball as ab

fmpy = pytest.importorskip("fmpy")
from fmpy.fmi2 import FMU2Slave  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

PERIOD = 0.02
SEED = 7


@pytest.fixture(scope="module")
def mended(rig):
    return rig.with_effects(
        dead_zone={"lower_percent": -0.3, "upper_percent": 0.3}, transport_delay=0.03, stale_samples={"hold_s": 0.04}
    )


@pytest.fixture(scope="module")
def flight(mended):
    return ab.simulate(mended, ab.experiments["square"], seed=SEED, duration=20.0)


@pytest.fixture(scope="module")
def file(mended, tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "rig.fmu"
    mended.to_fmu(path)
    return path


class Stepped:
    """An instance by its variables' names."""

    def __init__(self, file, folder, name="rig"):
        about = fmpy.read_model_description(file)
        self.variables = {one.name: one for one in about.modelVariables}
        self.slave = FMU2Slave(
            guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier, instanceName=name
        )
        self.slave.instantiate()

    def start(self, seed=SEED, **parameters):
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.set(seed=seed, **parameters)
        self.slave.exitInitializationMode()
        self.step_number = 0

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.slave, f"set{variable.type}")([variable.valueReference], [value])

    def get(self, name):
        variable = self.variables[name]
        return getattr(self.slave, f"get{variable.type}")([variable.valueReference])[0]

    def cycle(self, duty, setpoint):
        """What is read before the duty is written, and then a step."""
        seen = self.get("position_mm"), self.get("fresh")
        self.set(duty_percent=duty, setpoint_mm=setpoint)
        self.slave.doStep(currentCommunicationPoint=self.step_number * PERIOD, communicationStepSize=PERIOD)
        self.step_number += 1
        return (*seen, self.get("held_duty_percent"))

    def end(self):
        self.slave.terminate()
        self.slave.freeInstance()


@pytest.fixture
def stepped(file, tmp_path):
    folder = fmpy.extract(file, tmp_path / "rig")
    made = []

    def start(name="rig", **parameters):
        one = Stepped(file, folder, name)
        one.start(**parameters)
        made.append(one)
        return one

    yield start
    for one in made:
        one.end()


def duties(flight):
    return list(zip(flight["commanded_duty_percent"], flight["setpoint_mm"], strict=True))


def cycles(flight):
    """Reading, whether it is new, and the duty in the chip, of each cycle."""
    fresh = flight["fresh"] != 0
    return list(zip(flight["position_mm"], fresh, flight["duty_percent"], strict=True))


def test_the_validator_finds_nothing(file):
    assert validate_fmu(str(file)) == []


def test_its_steps_are_the_cycles_of_the_flight(stepped, flight):
    rig = stepped()
    flown = [rig.cycle(*one) for one in duties(flight)]
    assert len(flown) == 1000
    assert flown == cycles(flight)


def test_two_instances_at_once_are_two_rigs(stepped, flight):
    one, other = stepped("one"), stepped("other", seed=SEED + 1)
    both = [(one.cycle(*given), other.cycle(*given)) for given in duties(flight)[:300]]
    assert [first for first, _ in both] == cycles(flight)[:300]
    assert [second for _, second in both] != cycles(flight)[:300]


def test_a_reset_rig_flies_again_from_the_start(stepped, flight):
    rig = stepped(seed=3)
    for given in duties(flight)[:50]:
        rig.cycle(*given)
    rig.slave.reset()
    rig.start()
    assert [rig.cycle(*given) for given in duties(flight)[:300]] == cycles(flight)[:300]


def test_a_state_that_is_set_again_goes_on_from_there(stepped, flight):
    rig, given, wanted = stepped(), duties(flight), cycles(flight)
    for one in given[:100]:
        rig.cycle(*one)
    state = rig.slave.getFMUState()
    for _ in range(40):
        rig.cycle(0.0, 300.0)
    rig.slave.setFMUState(state)
    rig.slave.freeFMUState(state)
    rig.step_number = 100
    assert [rig.cycle(*one) for one in given[100:300]] == wanted[100:300]


def test_parameters_are_the_numbers_of_the_model(stepped, flight, mended, file):
    rig = stepped()
    names = [name for name in rig.variables if name.startswith("plant.")]
    assert rig.get("plant.gain_mm_per_s2_per_percent") == mended.gain
    assert rig.get("plant.effects.stale_samples.hold_s") == 0.04
    assert len(names) >= 10
    other = mended.with_effects(transport_delay=0.06)
    changed = stepped(**{"plant.effects.transport_delay.delay_s": 0.06})
    expected = ab.simulate(other, ab.experiments["square"], seed=SEED, duration=4.0)
    assert [changed.cycle(*one) for one in duties(expected)] == cycles(expected)


def test_without_noise_two_seeds_fly_alike(stepped, flight):
    rigs = [stepped(name, seed=seed, noise=False) for name, seed in (("one", 1), ("two", 2))]
    flown = [[rig.cycle(*one) for one in duties(flight)[:200]] for rig in rigs]
    assert flown[0] == flown[1] != cycles(flight)[:200]


def test_what_is_wrong_is_refused_and_told(stepped, file, tmp_path):
    with pytest.raises(Exception, match="failed"):
        stepped(**{"plant.gain_mm_per_s2_per_percent": -1.0})
    rig = stepped()
    with pytest.raises(Exception, match="failed"):
        rig.set(**{"plant.gain_mm_per_s2_per_percent": 800.0})
    with pytest.raises(Exception, match="failed"):
        rig.set(duty_percent=float("nan"))
    with pytest.raises(Exception, match="failed"):
        rig.slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.0)
    # It can go on.
    rig.cycle(20.0, 300.0)


def test_fmpy_simulates_it_with_another_step(file):
    result = fmpy.simulate_fmu(
        str(file), stop_time=2.0, step_size=0.013, start_values={"duty_percent": 25.0}, output=["position_mm", "ball_mm", "velocity_mm_per_s"]
    )
    assert len(result) > 100 and np.isfinite(result["ball_mm"]).all()
    assert result["ball_mm"][-1] > 100


def test_the_binary_writes_the_same_file_and_keeps_one_that_exists(file, mended, binary, tmp_path):
    (tmp_path / "rig.toml").write_text(mended.to_toml())
    out = tmp_path / "theirs.fmu"
    binary("export", "fmu", "--config", tmp_path / "rig.toml", "--out", out, *libraries(file, tmp_path))
    assert out.read_bytes() == file.read_bytes()
    said = binary("export", "fmu", "--config", tmp_path / "rig.toml", "--out", out, fails=True)
    assert "exists and is kept" in said
    said = binary("export", "fmu", "--out", tmp_path / "x.fmu", "--library", "config.toml", fails=True)
    assert "is no library for 64-bit Linux" in said


def libraries(file, tmp_path):
    """The libraries of the package: beside a binary of another build lie others."""
    folder = Path(fmpy.extract(file, tmp_path / "parts"))
    return [word for path in folder.glob("binaries/*/*") for word in ("--library", path)]


def test_nothing_of_a_broker_or_a_folder_is_in_it(file, tmp_path):
    folder = fmpy.extract(file, tmp_path / "parts")
    text = (tmp_path / "parts/resources/model.toml").read_text()
    assert "[plant]" in text and "[mqtt]" not in text and "[log]" not in text
    assert ET.parse(f"{folder}/modelDescription.xml").getroot().get("fmiVersion") == "2.0"


def test_a_rig_without_chips_is_stepped_directly(tmp_path):
    plain = ab.Model(827.2, 3.896, 21.4)
    plain.to_fmu(tmp_path / "plain.fmu")
    assert validate_fmu(str(tmp_path / "plain.fmu")) == []
    result = fmpy.simulate_fmu(str(tmp_path / "plain.fmu"), stop_time=1.0, start_values={"duty_percent": 30.0}, output=["ball_mm"])
    assert result["ball_mm"][-1] == 583.0


def test_the_library_needs_nothing_but_the_c_library(file, tmp_path):
    if shutil.which("ldd") is None:
        pytest.skip("no ldd")
    folder = fmpy.extract(file, tmp_path / "parts")
    said = subprocess.run(["ldd", f"{folder}/binaries/linux64/airball.so"], capture_output=True, text=True, check=True).stdout
    allowed = ("linux-vdso", "libc.", "libm.", "libgcc_s", "ld-linux", "libdl", "libpthread", "librt", "statically linked")
    assert all(any(name in line for name in allowed) for line in said.splitlines()), (said, sys.platform)
