"""Forecast errors of the linear belief data/quarter_drone/linear.toml, computed without any of the project's code.

ÿ = gain·(u − hover) − drag·ẏ has a closed form between two rows, so that nothing is integrated numerically. The numbers below are those of
linear.toml; stops at 0 and at the pipe's length. Forecasts start 0.05 s apart. Prints JSON: rms errors at 0.1, 0.5 and 1 s, "stay put", and the noise floor.
"""

import csv
import json
import math
import sys

GAIN, DRAG, HOVER, LENGTH = 15.77, 1.546, 34.68, 180.0
SENSOR, PSD = 0.03, 10.0
WARM_UP_S, HORIZONS = 2.0, (0.1, 0.5, 1.0)
APART_S = 0.05

with open(sys.argv[1], encoding="utf-8") as file:
    rows = [(float(r["t_s"]), float(r["u_pct"]), float(r["angle_deg"])) for r in csv.DictReader(file)]


def move(y, v, u, dt):
    """The closed form over dt under a constant duty, and the stops."""
    decay = math.exp(-DRAG * dt)
    end = GAIN * (u - HOVER) / DRAG
    y, v = y + end * dt + (v - end) * (1 - decay) / DRAG, end + (v - end) * decay
    if y < 0:
        return 0.0, max(v, 0.0)
    if y > LENGTH:
        return LENGTH, min(v, 0.0)
    return y, v


def spread(p, dt):
    """Covariance (yy, yv, vv) after dt: Φ·P·Φᵀ + Q, with Q integrated exactly."""
    yy, yv, vv = p
    e = math.exp(-DRAG * dt)
    f = (1 - e) / DRAG
    g = (1 - e * e) / (2 * DRAG)
    qvv = PSD * g
    qyv = PSD * (f - g) / DRAG
    qyy = PSD * (dt - 2 * f + g) / DRAG**2
    return yy + 2 * f * yv + f * f * vv + qyy, e * (yv + f * vv) + qyv, e * e * vv + qvv


state, p, known, wild = None, None, [], 0
for k, (t, u, z) in enumerate(rows):
    if state is None:
        state, p = (z, 0.0), (LENGTH**2, 0.0, 1000.0**2)
    else:
        dt = t - rows[k - 1][0]
        state, p = move(*state, rows[k - 1][1], dt), spread(p, dt)
    s = p[0] + SENSOR**2
    residual = z - state[0]
    # As far as a reading is a wild one, from ten times wider noise with a prior of 0.2 %, it is not taken; but two in a row are the arm.
    good = 0.998 * math.exp(-residual**2 / s / 2) if residual**2 < 1000 * s else 0.0
    bad = 0.002 / 10 * math.exp(-residual**2 / s / 200) if residual**2 < 100000 * s else 1e-300
    weight = good / (good + bad)
    taken = max(weight, 1e-6) if wild < 2 else 1.0
    wild = wild + 1 if weight < 0.5 else 0
    ky, kv = p[0] / s * taken, p[1] / s * taken
    state = (state[0] + ky * residual, state[1] + kv * residual)
    p = ((1 - ky) * p[0], (1 - ky) * p[1], p[2] - kv * p[1])
    known.append((state, p))

steps = [round(h * 100) for h in HORIZONS]
sums = {key: [0.0] * 3 for key in ("error_mm", "stay_put_mm", "floor_mm")}
counts = [0] * 3
warm = [k for k in range(len(known)) if rows[k][0] >= rows[0][0] + WARM_UP_S]
for k in warm[:: round(100 * APART_S)]:
    state, p = known[k]
    for j in range(k + 1, min(k + steps[-1], len(rows) - 1) + 1):
        dt = rows[j][0] - rows[j - 1][0]
        state, p = move(*state, rows[j - 1][1], dt), spread(p, dt)
        if j - k in steps:
            h = steps.index(j - k)
            counts[h] += 1
            sums["error_mm"][h] += (state[0] - rows[j][2]) ** 2
            sums["stay_put_mm"][h] += (rows[k][2] - rows[j][2]) ** 2
            sums["floor_mm"][h] += p[0] + SENSOR**2
print(json.dumps({key: [math.sqrt(total / n) for total, n in zip(values, counts)] for key, values in sums.items()}))
