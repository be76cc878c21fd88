"""Results are the binary's to the last letter."""

import pytest

import airball as ab
from conftest import CONFIG, ROOT

BLIND = ROOT / "tests/blind/round-1"
HOOP, DRONE = ROOT / "data/hoop_motor", ROOT / "data/quarter_drone"

#: Flights of the simulated rig: their seeds and what is wrong with them.
FLIGHTS = {
    "nothing": (4, ""),
    "dead_zone": (1, "[plant.effects.dead_zone]\nlower_percent = -0.3\nupper_percent = 0.3\n"),
    "delay": (2, "[plant.effects.transport_delay]\ndelay_s = 0.06\n"),
}
#: Records of other rigs, each with its config.
RECORDS = {
    "hoop": (HOOP / "fixed_steps.csv", HOOP / "linear.toml"),
    "drone": (DRONE / "steps.csv", DRONE / "linear.toml"),
    **{f"blind-{number}": (BLIND / f"case-{number}.csv.zst", CONFIG) for number in ("000", "003", "012", "020", "042")},
}


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_and_its_diagnosis_are_those_of_the_binary(name, rig, binary, tmp_path):
    seed, text = FLIGHTS[name]
    patch, log = tmp_path / "patch.toml", tmp_path / "f.mcap"
    patch.write_text(text)
    binary("simulate", "--patch", patch, "--seed", seed, "--duration", 30, "--log", log)
    flown = ab.simulate(rig.patched(patch), seed=seed, duration=30.0)
    read = ab.read(log)
    for ours, theirs in zip(flown, read, strict=True):
        assert ours.tobytes() == theirs.tobytes()
    said = binary("diagnose", "--json", "--without-formula", log)
    for recording in (flown, read):
        assert ab.diagnose(rig, recording, without_formula=True).json() + "\n" == said


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_of_a_file_gets_the_diagnosis_of_the_binary(name, binary):
    log, config = RECORDS[name]
    said = binary("diagnose", "--json", "--without-formula", "--config", config, log)
    model = ab.Model.load(config)
    assert ab.diagnose(model, log, without_formula=True).json() + "\n" == said


def test_columns_of_a_log_get_the_diagnosis_of_its_file(binary):
    log = BLIND / "case-000.csv.zst"
    model = ab.Model.load(CONFIG)
    read = ab.read(log, model)
    rows = ab.Recording(read.t, read.u, read.y, setpoint=read.setpoint, control=read._column("control_percent"), missing="skip")
    flags = {"without_formula": True, "without": ["dead_zone"]}
    assert ab.diagnose(model, rows, **flags).json() == ab.diagnose(model, log, **flags).json()


def test_replay_identification_and_designs_are_those_of_the_binary(rig, binary, tmp_path):
    log = tmp_path / "f.mcap"
    ab.simulate(rig, seed=3, duration=40.0).save(log)
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
