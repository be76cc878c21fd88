"""Models, exceptions, threads and signals."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import airball as ab


def test_errors_have_the_text_of_the_command_line(binary, stuck, tmp_path):
    log = str(tmp_path / "stuck.mcap")
    stuck.save(log)
    cases = [
        (ab.ConfigError, lambda: ab.Model.load("nosuch.toml"), ["replay", "x.csv", "--config", "nosuch.toml"]),
        (ab.LogError, lambda: ab.read("nosuch.csv"), ["replay", "nosuch.csv"]),
        (ab.Error, lambda: ab.design.lqr(ab.Model.example(), control=0), ["design", "lqr", "--control", "0"]),
        (
            ab.UsageError,
            lambda: ab.diagnose(ab.Model.example(), log, without="nosuch"),
            ["diagnose", log, "--without", "nosuch"],
        ),
    ]
    for kind, fails, arguments in cases:
        with pytest.raises(kind) as raised:
            fails()
        assert f"error: {raised.value}\n" == binary(*arguments, fails=True)


def test_a_model_in_code_equals_one_of_a_file_and_says_what_is_wrong_with_it(rig):
    made = ab.Model(827.2, 3.896, 21.4, effects={"fan_lag": 0.257}, base=rig)
    assert (made.gain, made.drag, made.hover) == (827.2, 3.896, 21.4) and made.effects == {"fan_lag": {"time_constant_s": 0.257}}
    assert "[loop]" in made.to_toml() and ab.Model.from_toml(made.to_toml()).to_toml() == made.to_toml()
    with pytest.raises(ab.ConfigError, match="gain_mm_per_s2_per_percent"):
        ab.Model(-1.0, 3.896, 21.4)
    with pytest.raises(ab.ArgumentError, match="several numbers"):
        ab.Model(827.2, 3.896, 21.4, effects={"dead_zone": 0.3})
    with pytest.raises(ab.ArgumentError, match="^gain_mm_per_s2_per_percent is nan"):
        ab.Model(float("nan"), 3.896, 21.4)
    with pytest.raises(ab.ConfigError, match=r"the table \[loop\] is missing"):
        ab.simulate(ab.Model(827.2, 3.896, 21.4))


def test_effects_are_put_on_and_taken_off(rig):
    stale = rig.with_effects(sensor_delay=0.04)
    assert "sensor_delay" in stale.effects and "sensor_delay" not in rig.effects
    assert stale.without_effects("sensor_delay") == rig
    with pytest.raises(ab.ArgumentError, match="'sensor_delay' is not on"):
        rig.without_effects("sensor_delay")


def test_a_simulation_is_arrays_and_the_same_for_one_seed(rig, tmp_path):
    one, same, other = (ab.simulate(rig, ab.experiments["square"], seed=seed, duration=5.0) for seed in (7, 7, 8))
    assert isinstance(one["velocity_mm_per_s"], np.ndarray) and one["velocity_mm_per_s"].dtype == np.float64
    assert all(one[name].tobytes() == same[name].tobytes() for name in one.columns)
    assert one["position_mm"].tobytes() != other["position_mm"].tobytes()
    one.save(tmp_path / "f.mcap")
    with pytest.raises(ab.Error, match="exists and is kept"):
        one.save(tmp_path / "f.mcap")
    with pytest.raises(ab.ArgumentError, match="^seed is -1"):
        ab.simulate(rig, seed=-1)
    with pytest.raises(ab.ConfigError, match="nosuch.toml"):
        ab.simulate(rig, "nosuch.toml")


def test_a_diagnosis_shows_itself(found, tmp_path):
    assert found.verdict == "effect" and found.effects[0].name == "dead_zone" and found.effects[0].probability > 0.9
    assert found.effects[0]["upper_percent"].low <= 0.3 <= found.effects[0]["upper_percent"].high
    assert str(found).startswith("The rig has a dead zone")
    shown = found._repr_html_()
    assert "srcdoc" in shown and "&lt;svg" in shown and "&lt;script" not in shown and len(shown) < 1_500_000
    found.report(tmp_path / "report.html")
    assert "dead zone" in (tmp_path / "report.html").read_text()
    (tmp_path / "mine.html").write_text("mine")
    with pytest.raises(ab.Error, match="is no page that airball wrote"):
        found.report(tmp_path / "mine.html")


def test_the_ladder_is_a_frame(found):
    pytest.importorskip("pandas")
    frame = found.ladder.to_frame()
    assert frame.index[-1] == "dead_zone" and frame["error_1s_mm"].is_monotonic_decreasing


def test_a_diagnosis_is_drawn(found):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    figure = found.plot()
    assert len(figure.axes) == 3 and {line.get_label() for line in figure.axes[0].lines} >= {"recorded"}


def test_the_linear_part_is_that_of_the_design(rig):
    control = pytest.importorskip("control")
    system = rig.to_state_space()
    poles = sorted(np.linalg.eigvals(system.A).real)
    lag = rig.effects["fan_lag"]["time_constant_s"]
    assert poles == pytest.approx(sorted([0.0, -rig.drag, -1 / lag]))
    plant = rig.to_control()
    s = 0.7j
    expected = rig.gain / (s * (s + rig.drag) * (1 + s * lag))
    assert complex(plant(s)) == pytest.approx(expected)
    delayed = rig.with_effects(transport_delay=0.05)
    with pytest.warns(UserWarning, match="delay of"):
        delayed.to_control()
    assert complex(delayed.to_control(pade=3)(s)) == pytest.approx(expected * np.exp(-0.05 * s), rel=1e-6)
    assert isinstance(plant, control.StateSpace)


def test_other_threads_run_during_a_diagnosis(rig, stuck):
    done, counted = threading.Event(), 0
    worker = threading.Thread(target=lambda: (ab.diagnose(rig, stuck, without_formula=True), done.set()))
    worker.start()
    while not done.wait(0.001):
        counted += 1
    worker.join()
    # With the lock held this thread would count once.
    assert counted > 50


def test_progress_is_told_and_an_error_in_it_ends_the_diagnosis(rig, stuck):
    heard = []
    ab.diagnose(rig, stuck, without_formula=True, progress=lambda *told: heard.append(told))
    made, planned, step = heard[-1]
    assert 0 < made <= planned and step

    def fails(*_):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        ab.diagnose(rig, stuck, progress=fails)


def test_ctrl_c_ends_a_diagnosis_and_the_next_one_works(rig, stuck, found):
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(1000):
            ab.diagnose(rig, stuck)
    assert ab.diagnose(rig, stuck, without_formula=True).json() == found.json()


def test_a_forked_process_diagnoses_as_its_parent_does(rig, stuck, found):
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        said = ab.diagnose(rig, stuck, without_formula=True).json()
        os.write(writing, b"same" if said == found.json() else b"other")
        os._exit(0)
    os.close(writing)
    assert os.read(reading, 10) == b"same"
    os.waitpid(child, 0)


def test_the_command_line_ends_at_ctrl_c(tmp_path, stuck):
    log = tmp_path / "f.mcap"
    stuck.save(log)
    root = os.path.dirname(os.environ["AIRBALL_CONFIG"])
    command = [sys.executable, "-m", "airball", "diagnose", str(log)]
    with subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        time.sleep(1.0)
        running.send_signal(signal.SIGINT)
        assert running.wait() == -signal.SIGINT


def test_a_flight_by_the_wheel_is_guarded_by_a_process_of_its_own(tmp_path):
    """The socket of an emulated bus stands for the rig; the flight is killed, and the guard turns the fan off."""
    import shutil

    shutil.copy(os.environ["AIRBALL_CONFIG"], tmp_path / "config.toml")
    program = [sys.executable, "-m", "airball"]
    text = (tmp_path / "config.toml").read_text()
    assert 'device = "/dev/i2c-1"' in text
    (tmp_path / "bus.toml").write_text('[bus]\ndevice = "unix:bus"\n')
    emulator = subprocess.Popen([*program, "emulate", "--socket", "bus"], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    try:
        wait_for(lambda: (tmp_path / "bus").exists())
        flight = subprocess.Popen(
            [*program, "run", "--patch", "bus.toml", "--log", "f.mcap"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
        )
        lines = iter(emulator.stdout.readline, "")
        assert any(is_on(line) for line in lines)
        flight.kill()
        flight.wait()
        assert any(is_off(line) for line in lines)
    finally:
        emulator.kill()
        emulator.wait()


def wait_for(condition):
    for _ in range(600):
        if condition():
            return
        time.sleep(0.05)
    raise AssertionError("it did not happen within 30 s")


def is_on(line):
    return "fan" in line and not is_off(line)


def is_off(line):
    return "fan 0.00 %" in line
