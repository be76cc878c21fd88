"""Times `airball diagnose` against SciPy's least squares, in turn on one record, and prints the ratio.

`airball diagnose` tries the whole catalogue of effects on the record and scores each on stretches that it was not fitted to. SciPy's
`least_squares` fits one effect, `fan_lag`, with gain, drag, hover and the noise ratio to the same rows: the one-step innovations of a
Kalman filter in numpy, exactly discretised (state: position, velocity, fan). Both start from the same belief, which lacks the lag.

The record is a flight of `airball simulate` with a rig whose fan lags; faster than `airball` flies (1 kHz), the same rig is flown here.
Peak memory is that of the largest process; that of a child is at least what this Python held when it started it.
"""

import argparse
import csv
import json
import os
import resource
import statistics
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
from scipy.linalg import expm
from scipy.optimize import least_squares

ROOT = Path(__file__).resolve().parent.parent
LAG_S = 0.2
SIZES = {
    "80s-55hz": (80.0, 55.0),
    "80s-1khz": (80.0, 1000.0),
    "1h-55hz": (3600.0, 55.0),
    "1h-1khz": (3600.0, 1000.0),
}
# Faster than this no loop of `airball` flies.
FASTEST_HZ = 200.0
# One run of the filter in Python takes seconds even so.
MOST_ROWS_FOR_SCIPY = 250_000


def make_record(airball, folder, duration_s, rate_hz):
    """Flies a rig with a fan lag; returns the record (CSV) and the belief, which lacks it."""
    if rate_hz > FASTEST_HZ:
        return fly_fast(folder, duration_s, rate_hz)
    plant = write_belief(folder, rate_hz)
    (folder / "rig.toml").write_text(f"[plant.effects.fan_lag]\ntime_constant_s = {LAG_S}\n", encoding="utf-8")
    flags = ["--config", "belief.toml", "--patch", "rig.toml", "--duration", str(duration_s), "--seed", "5"]
    subprocess.run([airball, "simulate", *flags, "--log", "f.mcap"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    with open(folder / "f.csv", "wb") as file:
        subprocess.run([airball, "log", "export", "f.mcap"], cwd=folder, check=True, stdout=file)
    return plant


def write_belief(folder, rate_hz):
    """Writes config.toml without its fan lag, at this rate; returns the plant in it."""
    config = (ROOT / "config.toml").read_text(encoding="utf-8")
    base, found, _ = config.partition("[plant.effects.fan_lag]")
    assert found, "config.toml has no table [plant.effects.fan_lag]"
    base = base.replace("period_s = 0.02 ", f"period_s = {1 / rate_hz} ", 1)
    late = min(0.002, 0.1 / rate_hz)
    base = base.replace("late_after_s = 0.002 ", f"late_after_s = {late} ", 1)
    parsed = tomllib.loads(base)
    assert parsed["loop"]["period_s"] == 1 / rate_hz, "config.toml has another [loop]"
    (folder / "belief.toml").write_text(base, encoding="utf-8")
    return parsed["plant"]


def fly_fast(folder, duration_s, rate_hz):
    """Record and belief for a clock that no loop of `airball` has: the rig in small steps under a PD law, between two heights."""
    plant = write_belief(folder, FASTEST_HZ)
    gain, drag, hover = (plant[key] for key in ("gain_mm_per_s2_per_percent", "drag_per_s", "hover_duty_percent"))
    dt, random = 1 / rate_hz, np.random.default_rng(5)
    count = round(duration_s * rate_hz)
    read = plant["noise"]["sensor_mm"] * random.standard_normal(count)
    pushed = np.sqrt(plant["noise"]["acceleration_psd_mm2_per_s3"] * dt) * random.standard_normal(count)
    y, v, fan, seen = 250.0, 0.0, 0.0, 250.0
    with open(folder / "f.csv", "w", encoding="utf-8") as file:
        file.write("time_s,duty_percent,position_mm\n")
        for k in range(count):
            position = y + read[k]
            before, seen = seen, seen + 0.05 * (position - seen)
            wanted = 350.0 if k * dt % 12 < 6 else 250.0
            duty = hover + 0.02 * (wanted - seen) - 0.02 * (seen - before) / dt
            file.write(f"{k * dt:.4f},{duty:.4f},{position:.2f}\n")
            fan += (gain * (duty - hover) - fan) * dt / LAG_S
            v += (fan - drag * v) * dt + pushed[k]
            y += v * dt
    return plant


def time_diagnose(airball, folder):
    """Wall time in s, peak memory in MB, and the names that were found."""
    start = time.perf_counter()
    command = [airball, "diagnose", "f.csv", "--config", "belief.toml", "--json"]
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    said = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - start
    status = os.waitstatus_to_exitcode(status)
    # 3: the record cannot answer, which is an answer too.
    if status not in (0, 3):
        sys.exit(f"bench-diagnose: {' '.join(command)} ended with status {status}; run it in {folder} to see why")
    found = json.loads(said)
    return wall, usage.ru_maxrss / 1024, [effect["name"] for effect in found["effects"]] or [found["verdict"]]


def innovations(theta, belief, rows):
    """Standardised one-step innovations, with ln S folded in so that their squares sum to the likelihood's negative double."""
    gain, drag = belief["gain_mm_per_s2_per_percent"] * np.exp(theta[0]), belief["drag_per_s"] * np.exp(theta[1])
    hover, lag = belief["hover_duty_percent"] + theta[2], max(abs(theta[3]), 1e-3)
    sensor, psd = belief["noise"]["sensor_mm"] * np.exp(theta[4]), belief["noise"]["acceleration_psd_mm2_per_s3"]
    t, duty, position = rows
    dt = (t[-1] - t[0]) / (len(t) - 1)
    rate = np.array([[0, 1, 0, 0], [0, -drag, 1, 0], [0, 0, -1 / lag, gain / lag], [0, 0, 0, 0]])
    step = expm(rate * dt)
    phi, gamma = step[:3, :3], step[:3, 3]
    white = np.zeros((6, 6))
    white[:3, :3], white[3:, 3:], white[1, 4] = -rate[:3, :3], rate[:3, :3].T, psd
    van_loan = expm(white * dt)
    noise = phi @ van_loan[:3, 3:]
    x, p = np.array([position[0], 0.0, gain * (duty[0] - hover)]), np.diag([sensor**2, 1e6, (20 * gain) ** 2])
    whitened = np.empty(len(t) - 1)
    for k in range(1, len(t)):
        x, p = phi @ x + gamma * (duty[k - 1] - hover), phi @ p @ phi.T + noise
        s = p[0, 0] + sensor**2
        residual = position[k] - x[0]
        gained = p[:, 0] / s
        x, p = x + gained * residual, p - np.outer(gained, p[0])
        # ν²/S + ln S as one square; 20 keeps it positive for any S down to e⁻²⁰ mm².
        whitened[k - 1] = np.sqrt(residual**2 / s + np.log(s) + 20)
    return whitened


def read_rows(folder):
    """Time, duty and position, where the sensor saw the ball, after take-off."""
    with open(folder / "f.csv", encoding="utf-8") as file:
        rows = [r for r in csv.DictReader(file) if r["position_mm"] and float(r["time_s"]) > 2]
    return [np.array([float(r[key]) for r in rows]) for key in ("time_s", "duty_percent", "position_mm")]


def time_scipy(belief, rows):
    """Wall time in s, the fitted lag, and how often the filter ran."""
    start = time.perf_counter()
    fit = least_squares(innovations, [0, 0, 0, 0.1, 0], args=(belief, rows), x_scale=[0.1, 0.1, 0.1, 0.1, 0.1])
    return time.perf_counter() - start, abs(fit.x[3]), fit.nfev + fit.njev * len(fit.x)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("airball", type=Path)
    parser.add_argument("--size", choices=[*SIZES, "all"], default="80s-55hz", help="length and rate of the record")
    parser.add_argument("--rounds", type=int, default=3, help="how often both are timed, in turn")
    parser.add_argument("--without-scipy", action="store_true", help="time only airball")
    parser.add_argument("--folder", type=Path, required=True, help="where records are written")
    args = parser.parse_args()
    for size in SIZES if args.size == "all" else [args.size]:
        bench(args, size)


def bench(args, size):
    duration_s, rate_hz = SIZES[size]
    folder = args.folder / size
    folder.mkdir(parents=True, exist_ok=True)
    belief = make_record(args.airball, folder, duration_s, rate_hz)
    count = round(duration_s * rate_hz)
    print(f"{size}: about {count} readings of a rig whose fan lags by {LAG_S} s; {os.cpu_count()} cores", flush=True)
    # A child's peak begins with that of who starts it: the rows are read after the first diagnosis, and only for SciPy.
    rows = None
    ours, theirs = [], []
    for round_ in range(args.rounds):
        wall, peak_mb, names = time_diagnose(args.airball, folder)
        ours.append(wall)
        line = f"  airball diagnose {wall:8.2f} s, {peak_mb:.0f} MB: {', '.join(names)}"
        if not args.without_scipy and count <= MOST_ROWS_FOR_SCIPY:
            rows = rows or read_rows(folder)
            seconds, lag, runs = time_scipy(belief, rows)
            theirs.append(seconds)
            line += f"    SciPy {seconds:8.2f} s: fan_lag {lag:.3f} s after {runs} runs of its filter"
        print(line, flush=True)
    print(f"  airball, all effects: {statistics.median(ours):.2f} s (median of {len(ours)})")
    if theirs:
        ratios = sorted(a / b for a, b in zip(ours, theirs))
        print(f"  SciPy, one effect:    {statistics.median(theirs):.2f} s")
        print(f"  airball / SciPy = {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})")
    own_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"  (this Python with its arrays: {own_mb:.0f} MB)", flush=True)


if __name__ == "__main__":
    main()
