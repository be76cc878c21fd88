"""Compares `airball identify grey-box --json` with a fit by SciPy, which shares no line with it.

The record is a flight of the simulated rig; the reference discretises the plant by the matrix exponential, filters, and lets a general optimiser
find the most likely numbers.
Usage: identify_reference.py AIRBALL CONFIG EXPERIMENT FOLDER; prints what was compared, ends with status 1 at the first difference.
"""

import csv
import json
import pathlib
import subprocess
import sys

import numpy
import scipy.linalg
import scipy.optimize

AIRBALL, CONFIG, EXPERIMENT, FOLDER = sys.argv[1:5]
# The ball has left the bottom, and the filters have forgotten their beginning.
FROM_S, FORGOTTEN_S = 4.0, 1.5
# Of half of the 90 % interval: wild readings count a little less in one of the two.
NEAR = 0.2


def airball(*arguments):
    return subprocess.run([AIRBALL, *arguments], check=True, capture_output=True, text=True).stdout


def record():
    """Flies, and writes the rows after take-off as CSV; returns time, duty and position."""
    log, cut = pathlib.Path(FOLDER, "flight.mcap"), pathlib.Path(FOLDER, "flight.csv")
    airball("simulate", "--config", CONFIG, "--experiment", EXPERIMENT, "--seed", "3", "--log", str(log), "--json")
    rows = [r for r in csv.DictReader(airball("log", "export", str(log)).splitlines()) if float(r["time_s"]) >= FROM_S]
    keys = ("time_s", "duty_percent", "position_mm")
    rows = [[float(row[key]) for key in keys] for row in rows if row["position_mm"]]
    with open(cut, "w", newline="") as file:
        csv.writer(file).writerows([keys, *rows])
    return cut, *numpy.array(rows).T


def steps(theta, dt):
    """Transition, input and noise of (y, v, A) over dt, by Van Loan's block matrix."""
    k, a, tau, _, _, psd = theta
    f = numpy.array([[0, 1, 0, 0], [0, -a, 1, 0], [0, 0, -1 / tau, k / tau], [0, 0, 0, 0]])
    w = numpy.diag([0, psd, 0, 0])
    block = scipy.linalg.expm(numpy.block([[-f, w], [numpy.zeros((4, 4)), f.T]]) * dt)
    phi = block[4:, 4:].T
    return phi[:3, :3], phi[:3, 3], (phi @ block[:4, 4:])[:3, :3]


def unscaled(x, start):
    """Logarithms of all but hover, which is in tenths of a percent."""
    ratios = numpy.exp(x)
    return [start[0] * ratios[0], start[1] * ratios[1], start[2] * ratios[2], start[3] + 0.1 * x[3], start[4] * ratios[4], start[5] * ratios[5]]


def minus_log_likelihood(x, start, time, duty, position):
    theta = unscaled(x, start)
    hover, sensor = theta[3], theta[4]
    known = {}
    state, p = numpy.array([position[0], 0.0, 0.0]), numpy.diag([sensor**2, 1e6, 1e6])
    total = 0.0
    for k in range(1, len(time)):
        dt = round(time[k] - time[k - 1], 6)
        if dt not in known:
            known[dt] = steps(theta, dt)
        phi, b, q = known[dt]
        state = phi @ state + b * (duty[k - 1] - hover)
        p = phi @ p @ phi.T + q
        s = p[0, 0] + sensor**2
        innovation = position[k] - state[0]
        if time[k] >= time[0] + FORGOTTEN_S:
            total += 0.5 * (numpy.log(2 * numpy.pi * s) + innovation**2 / s)
        gain = p[:, 0] / s
        state = state + gain * innovation
        p = p - numpy.outer(gain, p[0])
    return total


cut, time, duty, position = record()
found = json.loads(airball("identify", "grey-box", str(cut), "--poles", "3", "--config", CONFIG, "--json"))
estimates = {estimate["name"]: estimate for estimate in found["models"][0]["estimates"]}
# From another place than airball's.
start = [500.0, 2.5, 0.15, numpy.mean(duty), 2.0, 600.0]
best = scipy.optimize.minimize(minus_log_likelihood, numpy.zeros(6), (start, time, duty, position), "BFGS", options={"gtol": 0.05})
names = ["gain_mm_per_s2_per_percent", "drag_per_s", "fan_lag.time_constant_s", "hover_duty_percent"]
for name, reference in zip(names, unscaled(best.x, start)):
    own = estimates[name]
    if not abs(own["value"] - reference) < NEAR * 0.5 * (own["high"] - own["low"]):
        sys.exit(f"{name}: airball says {own}, the reference {reference}")
    print(f"{name}: {own['value']:.4f} ({own['low']:.4f} to {own['high']:.4f}), the reference {reference:.4f}")
print(f"{len(names)} numbers agree with a fit by SciPy {scipy.__version__}")
