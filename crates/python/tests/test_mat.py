"""The linear part with its steady Kalman gain, in a file of MATLAB."""

import sys

import numpy as np
import pytest

import airball as ab

scipy_io = pytest.importorskip("scipy.io")
linalg = pytest.importorskip("scipy.linalg")

GAIN, DRAG, HOVER, TS = 827.2, 3.896, 21.4, 0.02
DELAYS = {"none": 0.0, "within a period": 0.007, "whole periods": 0.06, "both": 0.047}


def model(**effects):
    return ab.Model(GAIN, DRAG, HOVER, effects=effects, base=ab.Model.example())


def written(path, model, **options):
    model.to_mat(path, **options)
    return scipy_io.loadmat(path, squeeze_me=False)


def step(read, cycles):
    """Readings after a step of 1 % of duty, without noise."""
    x, y = np.zeros((len(read["A"]), 1)), []
    for _ in range(cycles):
        y.append((read["C"] @ x + read["D"]).item())
        x = read["A"] @ x + read["B"]
    return np.array(y)


@pytest.mark.parametrize("delay", DELAYS.values(), ids=DELAYS)
def test_a_step_of_the_file_is_the_closed_form_at_each_sample(delay, tmp_path):
    read = written(tmp_path / "rig.mat", model(**({"transport_delay": delay} if delay else {})))
    t = np.maximum(TS * np.arange(100) - delay, 0.0)
    exact = GAIN / DRAG * (t - (1 - np.exp(-DRAG * t)) / DRAG)
    np.testing.assert_allclose(step(read, 100), exact, rtol=1e-10, atol=1e-10)
    assert read["Ts"].item() == TS and read["hover_duty_percent"].item() == HOVER
    assert read["A"].shape == (len(read["A"]),) * 2 and read["K"].shape == read["B"].shape == read["C"].T.shape


def test_lags_of_fan_and_sensor_are_those_of_the_continuous_part(tmp_path):
    rig = model(fan_lag=0.257, sensor_lag=0.05)
    read = written(tmp_path / "rig.mat", rig, period=0.01)
    linear = rig.to_state_space()
    gained = np.linalg.matrix_power(read["A"], 50)
    np.testing.assert_allclose(gained, linalg.expm(linear.A * 0.5), rtol=1e-10, atol=1e-12)
    names = [name.item() for name in read["StateName"].ravel()]
    assert names == ["position, mm", "velocity, mm/s", "acceleration by the fan, mm/s²", "reading, mm"]


def riccati(rig, read, steps=3000):
    """Gain and variance of the Kalman filter after many steps, from the noise of the simulator: a force that is white in
    each of many short parts of a period."""
    linear, noise, parts = rig.to_state_space(), rig.noise, 2000
    size = len(linear.A)
    short = linalg.expm(linear.A * TS / parts)
    force = np.zeros_like(linear.A)
    force[1, 1] = noise["acceleration_psd_mm2_per_s3"] * TS / parts
    added, moved = np.zeros_like(force), np.eye(size)
    for _ in range(parts):
        added, moved = added + moved @ force @ moved.T, short @ moved
    covariance = np.eye(size) * 1e3
    for _ in range(steps):
        variance = (linear.C @ covariance @ linear.C.T).item() + noise["sensor_mm"] ** 2
        gain = moved @ covariance @ linear.C.T / variance
        covariance = moved @ covariance @ moved.T + added - gain @ gain.T * variance
    return gain, variance


@pytest.mark.parametrize("effects", [{}, {"fan_lag": 0.257, "transport_delay": 0.047}], ids=["bare", "lag and delay"])
def test_the_gain_is_that_of_a_filter_that_has_run_for_long(effects, tmp_path):
    rig = model(**effects)
    read = written(tmp_path / "rig.mat", rig)
    gain, variance = riccati(rig, read)
    size = len(gain)
    np.testing.assert_allclose(read["K"][:size], gain, rtol=2e-3, atol=1e-6)
    assert not read["K"][size:].any(), "past inputs are known"
    assert read["NoiseVariance"].item() == pytest.approx(variance, rel=1e-3)
    assert max(abs(np.linalg.eigvals(read["A"] - read["K"] @ read["C"]))) < 1, "the predictor forgets"


def test_the_gain_solves_the_riccati_equation_of_scipy(tmp_path):
    rig = model()
    read = written(tmp_path / "rig.mat", rig)
    q, e = rig.noise["acceleration_psd_mm2_per_s3"], np.exp(-DRAG * TS)
    # The covariance of a force that is white over a period, on velocity and position with drag, in closed form.
    vv = (1 - e**2) / (2 * DRAG)
    xv = (1 - e) ** 2 / (2 * DRAG**2)
    xx = (TS - 2 * (1 - e) / DRAG + (1 - e**2) / (2 * DRAG)) / DRAG**2
    phi, c, r = np.array([[1, (1 - e) / DRAG], [0, e]]), read["C"], rig.noise["sensor_mm"] ** 2
    solved = linalg.solve_discrete_are(phi.T, c.T, q * np.array([[xx, xv], [xv, vv]]), np.array([[r]]))
    np.testing.assert_allclose(read["K"], phi @ solved @ c.T / (c @ solved @ c.T + r), rtol=1e-8)


def test_innovations_of_a_simulated_flight_are_white_and_of_the_stated_variance(tmp_path):
    rig = model(transport_delay=0.04)
    read = written(tmp_path / "rig.mat", rig)
    flight = ab.simulate(rig, seed=3, duration=120.0)
    x, e = np.zeros((len(read["A"]), 1)), []
    x[0] = flight.y[0]
    for u, y in zip(flight.u - HOVER, flight.y, strict=True):
        e.append(y - (read["C"] @ x).item())
        x = read["A"] @ x + read["B"] * u + read["K"] * e[-1]
    e = np.array(e[200:])
    assert np.var(e) == pytest.approx(read["NoiseVariance"].item(), rel=0.08)
    assert abs(np.corrcoef(e[1:], e[:-1])[0, 1]) < 0.05


def test_a_model_without_noise_or_period_is_refused_with_the_reason(tmp_path):
    bare = ab.Model(GAIN, DRAG, HOVER)
    with pytest.raises(ab.ArgumentError, match="no period.* give period in seconds"):
        bare.to_mat(tmp_path / "a.mat")
    with pytest.raises(ab.ArgumentError, match="period is -1; give a number of seconds above 0"):
        bare.to_mat(tmp_path / "a.mat", period=-1)
    with pytest.raises(ab.Error, match="plant.noise.sensor_mm is 0.0, and a steady Kalman gain needs it above 0"):
        ab.Model(GAIN, DRAG, HOVER, sensor_noise=0.0).to_mat(tmp_path / "a.mat", period=TS)
    bare.to_mat(tmp_path / "a.mat", period=TS)
    with pytest.raises(FileExistsError):
        bare.to_mat(tmp_path / "a.mat", period=TS)


def test_what_is_not_linear_is_named_in_the_file(tmp_path):
    read = written(tmp_path / "rig.mat", model(dead_zone={"lower_percent": -0.3, "upper_percent": 0.3}))
    assert [name.item() for name in read["NotLinear"].ravel()] == ["dead_zone"]


def test_without_scipy_the_error_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.linalg", None)
    with pytest.raises(ab.MissingLibraryError, match=r"^scipy is not installed; .* airball\[mat\]$"):
        model().to_mat(tmp_path / "a.mat")
