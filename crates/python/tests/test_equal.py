"""Results are the binary's to the last letter."""

import pytest
import zstandard

import airball as ab
from conftest import CONFIG, ROOT

BLIND = ROOT / "tests/blind/round-1"
HOOP, DRONE = ROOT / "data/hoop_motor", ROOT / "data/quarter_drone"

#: Flights of the simulated rig: their seeds and what is wrong with them.
FLIGHTS = {
    "nothing": (4, ""),
    "dead_zone": (1, "[plant.effects.dead_zone]\nlower_percent = -0.3\nupper_percent = 0.3\n"),
    "transport_delay": (2, "[plant.effects.transport_delay]\ndelay_s = 0.08\n"),
    "sensor_delay": (3, "[plant.effects.sensor_delay]\ndelay_s = 0.06\n"),
}
#: Records in files, each with its config, of which so many rows are taken: a short record is diagnosed as a long one is.
RECORDS = {
    "hoop": (HOOP / "fixed_steps.csv", HOOP / "linear.toml", 200),
    "drone": (DRONE / "steps.csv", DRONE / "linear.toml", 600),
    **{f"blind-{number}": (BLIND / f"case-{number}.csv.zst", CONFIG, 600) for number in ("000", "003", "012", "020")},
}


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_and_its_diagnosis_are_those_of_the_binary(name, rig, binary, tmp_path):
    seed, text = FLIGHTS[name]
    patch, log = tmp_path / "patch.toml", tmp_path / "f.mcap"
    patch.write_text(text)
    binary("simulate", "--patch", patch, "--seed", seed, "--duration", 12, "--log", log)
    flown = ab.simulate(rig.patched(patch), seed=seed, duration=12.0)
    read = ab.read(log)
    for ours, theirs in zip(flown, read, strict=True):
        assert ours.tobytes() == theirs.tobytes()
    said = binary("diagnose", "--json", log)
    assert ab.diagnose(rig, flown).json() + "\n" == said


def cut(name, folder):
    """The first rows of a record, as a file, and its config."""
    log, config, rows = RECORDS[name]
    text = zstandard.ZstdDecompressor().stream_reader(log.open("rb")).read() if log.suffix == ".zst" else log.read_bytes()
    short = folder / f"{name}.csv"
    short.write_bytes(b"".join(text.splitlines(keepends=True)[: rows + 1]))
    return short, config


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_in_a_file_gets_the_diagnosis_of_the_binary(name, binary, tmp_path):
    log, config = cut(name, tmp_path)
    said = binary("diagnose", "--json", "--without-formula", "--config", config, log)
    assert ab.diagnose(config, log, without_formula=True).json() + "\n" == said


def test_columns_of_a_log_get_the_diagnosis_of_its_file(tmp_path):
    log, config = cut("blind-000", tmp_path)
    read = ab.read(log)
    control = read._column("control_percent")
    rows = ab.Recording(read.t, read.u, read.y, setpoint=read.setpoint, control=control, missing="skip")
    flags = {"without_formula": True, "without": ["dead_zone"]}
    assert ab.diagnose(config, rows, **flags).json() == ab.diagnose(config, log, **flags).json()


def test_replay_identification_and_designs_are_those_of_the_binary(rig, binary, tmp_path):
    log = tmp_path / "f.mcap"
    ab.simulate(rig, seed=3, duration=20.0).save(log)
    assert ab.replay(rig, log).json() + "\n" == binary("replay", "--json", log)
    assert ab.identify(rig, log).json() + "\n" == binary("identify", "grey-box", "--json", log)
    assert ab.design.lqr(rig, control=5000).json() + "\n" == binary("design", "lqr", "--json", "--control", 5000)
    assert ab.design.loop(rig).json() + "\n" == binary("design", "loop", "--json")
    made = ab.design.poles(rig, [-2 + 1.5j, -2 - 1.5j])
    assert made.json() + "\n" == binary("design", "poles", "--json", "--pole", "-2+1.5i", "--pole=-2-1.5i")
    assert ab.design.observer(rig).json() + "\n" == binary("design", "observer", "--json")


def test_the_mended_model_is_the_config_with_the_binarys_patch(rig, stuck, found, binary, tmp_path):
    log, patch = tmp_path / "f.mcap", tmp_path / "mended.toml"
    stuck.save(log)
    binary("diagnose", "--without-formula", "--patch-out", patch, log)
    mended = found.model
    assert mended.effects["dead_zone"]["upper_percent"] == pytest.approx(0.26, abs=0.1)
    # The file's numbers are rounded.
    assert ab.Model.load(CONFIG, [patch]).gain == pytest.approx(mended.gain, rel=1e-3)


def test_the_command_line_of_the_wheel_prints_what_the_binary_prints(binary, tmp_path):
    import subprocess
    import sys

    for arguments, status in ((["--version"], 0), (["config", "check"], 0), (["replay", "nosuch.csv"], 1), (["x"], 2)):
        ran = subprocess.run([sys.executable, "-m", "airball", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
        assert ran.returncode == status, ran.stderr
        said = binary(*arguments, fails=status != 0)
        assert (ran.stderr if status else ran.stdout) == said
