"""Practice rigs that are no ball in a pipe: carts, axes, pendulums and lifts with one degree of freedom, made as real ones are.

    python tests/machines.py OUT TRUTH --seed TEXT --count N      OUT/case-NNN.csv and .toml, and the truth in the file TRUTH

Each rig has one to four effects that its builder would name, and four to seven small unmodelled pieces: friction
that falls with speed, cogging, a lag of the amplifier, a nonlinear scale, a load on a spring. Its sensor is good, so that
every piece is significant. All ranges were chosen by hand, so that most effects show. Its owner believes in a linear machine,
whose numbers are off by up to 30 %. The equations are written here, and share none with the program.
"""

import argparse
import hashlib
import json
import math
import random
from collections import deque
from pathlib import Path

STEP_S = 2e-4
# What may not act together: a record cannot tell one from the other.
TWINS = [{"transport_delay", "sensor_delay"}, {"fan_lag", "sensor_lag"}, {"wall_friction", "dead_zone", "hysteresis"}]
EFFECTS = [
    "wall_friction", "dead_zone", "hysteresis", "saturation", "fan_lag", "transport_delay", "sensor_delay", "sensor_lag",
    "quadratic_drag", "thrust_curve", "force_asymmetry", "gain_drift", "hover_drift", "height_dependent_flow",
    "sensor_quantisation", "sensor_outliers",
]  # fmt: skip
# Each piece, and the effect that it may rightly be called by.
PIECES = {
    "stribeck": "wall_friction",
    "slight_friction": "wall_friction",
    "cogging": None,
    "amplifier_lag": "fan_lag",
    "load_on_a_spring": None,
    "bent_scale": None,
    "warming": "gain_drift",
    "tilt": None,
    "jitter": None,
    "slight_air_drag": "quadratic_drag",
    "slight_curve": "thrust_curve",
    "slight_spring": "height_dependent_flow",
    "uneven_noise": "sensor_noise",
}

LATE = [("transport_delay", "delay"), ("sensor_delay", "delay"), ("fan_lag", "tau"), ("sensor_lag", "tau")]


class Rig:
    """A rig drawn by chance: its numbers, effects and pieces. Lengths in mm (or tenths of a degree), input in percent."""

    def __init__(self, chance):
        u = chance.uniform
        self.kind = chance.choice(["axis", "axis", "pendulum", "lift"])
        self.gain = math.exp(u(math.log(10.0), math.log(80.0)))  # mm/s² per percent
        self.drag = math.exp(u(math.log(0.6), math.log(6.0)))  # 1/s
        self.hover = u(35.0, 60.0) if self.kind == "lift" else u(-1.0, 1.0)
        self.span = 0.5 * self.gain * u(6.0, 14.0)  # mm; what a good push covers in a second
        self.noise = self.span * math.exp(u(math.log(1e-4), math.log(3e-3)))
        self.gust = self.gain * math.exp(u(math.log(0.02), math.log(0.5)))  # mm/s², of 0.2 s
        self.rate_hz = chance.choice([40.0, 50.0, 100.0])
        self.seconds = u(45.0, 80.0)
        self.effects, self.pieces = {}, {}
        if self.kind == "pendulum":
            self.add("height_dependent_flow", chance)
        count = chance.choice([1, 1, 2, 2, 3, 4])
        while len(self.effects) < count:
            name = chance.choice(EFFECTS)
            if not any(name in twins and twins & set(self.effects) for twins in TWINS):
                self.add(name, chance)
        for name in chance.sample(sorted(PIECES), chance.randint(4, 7)):
            self.add_piece(name, chance)

    def add(self, name, chance):
        u, span = chance.uniform, self.span
        sign = chance.choice([-1.0, 1.0])
        self.effects[name] = {
            "wall_friction": lambda: {"force": self.gain * u(2.0, 9.0)},
            "dead_zone": lambda: {"width": u(2.0, 9.0)},
            "hysteresis": lambda: {"half_width": u(1.5, 5.0)},
            "saturation": lambda: {"limit": u(8.0, 16.0)},
            "fan_lag": lambda: {"tau": u(0.08, 0.4)},
            "transport_delay": lambda: {"delay": u(0.05, 0.2)},
            "sensor_delay": lambda: {"delay": u(0.05, 0.2)},
            "sensor_lag": lambda: {"tau": u(0.05, 0.25)},
            "quadratic_drag": lambda: {"per_mm": u(0.5, 3.0) / span},
            "thrust_curve": lambda: {"per_percent": sign * u(0.015, 0.04)},
            "force_asymmetry": lambda: {"ratio": u(1.3, 2.0) ** sign},
            "gain_drift": lambda: {"share": -u(0.15, 0.5)},
            "hover_drift": lambda: {"percent": sign * u(2.0, 6.0)},
            "height_dependent_flow": lambda: {"per_s2": u(3.0, 12.0) * self.gain / span, "turn": 6.0 * span * (self.kind == "pendulum")},
            "sensor_quantisation": lambda: {"step": self.noise * u(8.0, 30.0)},
            "sensor_outliers": lambda: {"share": u(0.005, 0.03), "size": span * u(0.1, 0.4)},
        }[name]()

    def add_piece(self, name, chance):
        u, span = chance.uniform, self.span
        self.pieces[name] = {
            "stribeck": lambda: {"share": u(0.1, 0.5), "speed": span * u(0.01, 0.06)},
            "slight_friction": lambda: {"force": self.gain * u(0.1, 0.6)},
            "cogging": lambda: {"force": self.gain * u(0.1, 0.6), "pitch": span * u(0.03, 0.2)},
            "amplifier_lag": lambda: {"tau": u(0.003, 0.02)},
            "load_on_a_spring": lambda: {"hz": u(6.0, 15.0), "mass": u(0.05, 0.3)},
            "bent_scale": lambda: {"share": u(-0.01, 0.01)},
            "warming": lambda: {"share": u(-0.04, 0.04), "tau": u(10.0, 40.0)},
            "tilt": lambda: {"percent": u(-0.5, 0.5), "wave": span * u(0.5, 2.0)},
            "jitter": lambda: {"seconds": u(0.0005, 0.004)},
            "slight_air_drag": lambda: {"per_mm": u(0.02, 0.15) / span},
            "slight_curve": lambda: {"per_percent": u(-0.004, 0.004)},
            "slight_spring": lambda: {"per_s2": u(0.05, 0.4)},
            "uneven_noise": lambda: {"share": u(0.5, 2.0)},
        }[name]()

    def of(self, name, key, otherwise=0.0):
        return self.effects.get(name, self.pieces.get(name, {})).get(key, otherwise)

    def force_by_place(self, x):
        """Springs, gravity of a pendulum, cogging and a floor that is not level, mm/s²."""
        stiff, turn = self.of("height_dependent_flow", "per_s2"), self.of("height_dependent_flow", "turn")
        back = stiff * turn / math.tau * math.sin(math.tau * x / turn) if turn else stiff * x
        cog, pitch = self.of("cogging", "force"), self.of("cogging", "pitch", 1.0)
        tilt, wave = self.of("tilt", "percent"), self.of("tilt", "wave", 1.0)
        return (
            -back
            - self.of("slight_spring", "per_s2") * x
            + cog * math.sin(math.tau * x / pitch)
            + tilt * self.gain * math.sin(math.tau * x / wave)
        )


def delay_line(seconds, value):
    line = deque([value] * max(1, round(seconds / STEP_S)))

    def through(now):
        line.append(now)
        return line.popleft()

    return through if seconds > 0.0 else lambda now: now


def actuator(rig):
    """From the input about hover, percent, to the drive about hover, percent."""
    zone, half = rig.of("dead_zone", "width"), rig.of("hysteresis", "half_width")
    limit = rig.of("saturation", "limit", math.inf)
    lags = [tau for tau in (rig.of("fan_lag", "tau"), rig.of("amplifier_lag", "tau")) if tau > 0.0]
    curve = rig.of("thrust_curve", "per_percent") + rig.of("slight_curve", "per_percent")
    up_over_down = math.sqrt(rig.of("force_asymmetry", "ratio", 1.0))
    delayed = delay_line(rig.of("transport_delay", "delay"), 0.0)
    state = {"play": 0.0, "lags": [0.0] * len(lags)}

    def drive(u, t):
        u = max(-limit, min(limit, delayed(u)))
        u = math.copysign(max(abs(u) - zone, 0.0), u)
        state["play"] = max(u - half, min(u + half, state["play"]))
        u = state["play"]
        for k, tau in enumerate(lags):
            state["lags"][k] += STEP_S / tau * (u - state["lags"][k])
            u = state["lags"][k]
        u += curve * u * u
        u *= up_over_down if u > 0.0 else 1.0 / up_over_down
        u *= 1.0 + rig.of("gain_drift", "share") * t / rig.seconds
        u *= 1.0 + rig.of("warming", "share") * (1.0 - math.exp(-t / rig.of("warming", "tau", 1.0)))
        return u + rig.of("hover_drift", "percent") * (t / rig.seconds - 0.5)

    return drive


def body(rig, chance):
    """Motion of the driven mass and, if there is one, of a load on a spring behind it: drive to position and speed."""
    friction = rig.of("wall_friction", "force") or rig.of("slight_friction", "force")
    extra, slow = rig.of("stribeck", "share"), rig.of("stribeck", "speed", 1.0)
    air = rig.of("quadratic_drag", "per_mm") + rig.of("slight_air_drag", "per_mm")
    mass, pulse = rig.of("load_on_a_spring", "mass"), math.tau * rig.of("load_on_a_spring", "hz")
    keep = math.exp(-STEP_S / 0.2)
    stir = rig.gust * math.sqrt(1.0 - keep * keep)
    rest = 1e-4 * rig.span
    s = {"x": 0.0, "v": 0.0, "gust": 0.0, "y": 0.0, "w": 0.0}

    def move(drive):
        x, v = s["x"], s["v"]
        s["gust"] = keep * s["gust"] + stir * chance.gauss(0.0, 1.0)
        net = rig.gain * drive - rig.drag * v - air * v * abs(v) + rig.force_by_place(x) + s["gust"]
        if mass:
            pull = pulse * pulse * (s["y"] - x) + 0.06 * pulse * (s["w"] - v)
            net += mass * pull
            s["w"] -= STEP_S * pull
            s["y"] += STEP_S * s["w"]
        held = friction * (1.0 + extra)
        if friction and abs(v) < rest and abs(net) <= held:
            s["v"] = 0.0
            return x, 0.0
        against = friction * (1.0 + extra * math.exp(-((v / slow) ** 2)))
        after = v + STEP_S * (net - math.copysign(against, v if abs(v) >= rest else net))
        s["v"] = 0.0 if friction and after * v < 0.0 else after
        s["x"] = x + STEP_S * s["v"]
        return s["x"], s["v"]

    return move


def sensor(rig, chance):
    """From the position at every step to a reading, mm."""
    tau, delayed = rig.of("sensor_lag", "tau"), delay_line(rig.of("sensor_delay", "delay"), 0.0)
    step = rig.of("sensor_quantisation", "step") or rig.noise / 3.0
    state = {"slow": 0.0}

    def see(x):
        seen = delayed(x)
        state["slow"] += STEP_S / tau * (seen - state["slow"]) if tau else 0.0
        return state["slow"] if tau else seen

    def read(seen):
        bent = seen * (1.0 + rig.of("bent_scale", "share") * abs(seen) / rig.span)
        noise = rig.noise * (1.0 + rig.of("uneven_noise", "share") * abs(seen) / rig.span)
        if chance.random() < rig.of("sensor_outliers", "share"):
            bent += rig.of("sensor_outliers", "size") * chance.gauss(0.0, 1.0)
        return step * round((bent + noise * chance.gauss(0.0, 1.0)) / step)

    return see, read


def fly(rig, chance):
    """Rows of time, input in percent and reading: a controller of the owner's own follows random steps."""
    drive, move, (see, read) = actuator(rig), body(rig, chance), sensor(rig, chance)
    late_s = sum(rig.of(name, key) for name, key in LATE)
    pace = chance.uniform(1.5, 3.0) / (1.0 + 4.0 * late_s)  # 1/s, of the loop
    kp, kd = pace**2 / rig.gain, max(1.4 * pace - rig.drag, 0.2 * pace) / rig.gain
    rows, u, ref, until, last, speed = [], 0.0, 0.0, 0.0, 0.0, 0.0
    period, due = 1.0 / rig.rate_hz, 0.0
    sum_u = 0.0
    for k in range(int(rig.seconds / STEP_S)):
        t = k * STEP_S
        seen = see(move(drive(u, t))[0])
        if t < due:
            continue
        due = t + period + chance.gauss(0.0, rig.of("jitter", "seconds"))
        if t >= until:
            ref, until = chance.uniform(-rig.span, rig.span), t + chance.uniform(0.8, 4.0)
        y = read(seen)
        speed += 0.2 * ((y - last) * rig.rate_hz - speed)
        last = y
        sum_u += 0.15 * pace * kp * (ref - y) * period * (abs(u) < 18.0)
        u = max(-20.0, min(20.0, kp * (ref - y) - kd * speed + sum_u))
        u = round(rig.hover + u, 3) - rig.hover
        rows.append((t, rig.hover + u, y))
    return rows


def write(out, name, rig, rows, chance):
    """The record, and what the owner believes: a linear machine. Gives the believed noise of a reading, mm."""
    length = 6.0 * max(abs(y) for _, _, y in rows)
    off = lambda: math.exp(chance.uniform(-0.3, 0.3))
    lines = [f"{t:.4f},{u:.3f},{y + length / 2:.6f}" for t, u, y in rows]
    (out / f"{name}.csv").write_text("time_s,duty_percent,position_mm\n" + "\n".join(lines) + "\n")
    turn = rig.of("height_dependent_flow", "turn")
    gain, drag, hover = rig.gain * off(), rig.drag * off(), rig.hover + chance.uniform(-0.5, 0.5)
    noise = rig.noise * math.exp(chance.uniform(-0.7, 0.7))
    (out / f"{name}.toml").write_text(
        f"[plant]\ngain_mm_per_s2_per_percent = {gain:.4g}\ndrag_per_s = {drag:.3g}\n"
        f"hover_duty_percent = {hover:.2f}\npipe_length_mm = {length:.0f}\n"
        + (f"turn_mm = {turn:.6g}\n" if turn else "")
        + f"\n[plant.noise]\nsensor_mm = {noise:.3g}\n"
        f"acceleration_psd_mm2_per_s3 = {2 * 0.2 * rig.gust**2 * off():.3g}\n"
    )
    return noise


def truth(name, rig, believed_noise):
    effects = [{"name": effect, "change": "added", "drawn": drawn} for effect, drawn in rig.effects.items()]
    pieces = [{"name": piece, "kin": PIECES[piece], "drawn": drawn} for piece, drawn in rig.pieces.items()]
    # The gusts last 0.2 s, and the owner believes in white ones.
    pieces.append({"name": "gusts", "kin": "turbulence", "drawn": {"force": rig.gust}})
    if believed_noise < 0.8 * rig.noise:
        pieces.append({"name": "noise_above_the_believed", "kin": "sensor_noise", "drawn": {"mm": rig.noise}})
    return {"case": name, "kind": rig.kind, "effects": effects, "clutter": pieces}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("out", type=Path)
    arguments.add_argument("truth", type=Path)
    arguments.add_argument("--seed", required=True)
    arguments.add_argument("--count", type=int, default=40)
    asked = arguments.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    cases = []
    for number in range(asked.count):
        name = f"case-{number:03}"
        chance = random.Random(hashlib.sha256(f"{asked.seed}\n{number}".encode()).digest())
        rig = Rig(chance)
        believed_noise = write(asked.out, name, rig, fly(rig, chance), chance)
        cases.append(truth(name, rig, believed_noise))
    asked.truth.write_text(json.dumps({"seed": asked.seed, "cases": cases}, indent=1) + "\n")


if __name__ == "__main__":
    main()
