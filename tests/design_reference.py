"""Compares `airball design --json` with python-control and SciPy, which share no line with it.

python-control computes frequency responses, margins, step responses, zero-order holds, pole placement and Riccati equations of its own.
Usage: design_reference.py AIRBALL CONFIG; prints what was compared, ends with status 1 at the first difference.
"""

import json
import subprocess
import sys

import control
import numpy
import scipy.linalg

AIRBALL, CONFIG = sys.argv[1:3]
PSD, SENSOR = 360.0, 2.5
compared = 0


def design(*arguments):
    command = [AIRBALL, "design", *arguments, "--json", "--config", CONFIG]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def same(what, found, reference, relative=1e-6, absolute=0.0):
    """Ends the program where the two differ."""
    global compared
    found, reference = numpy.asarray(found, float), numpy.asarray(reference, float)
    if found.shape != reference.shape or not numpy.allclose(found, reference, rtol=relative, atol=absolute):
        sys.exit(f"{what}: airball says {found}, the reference {reference}")
    compared += 1


def plant_of(found):
    p = found["plant"]
    lags = numpy.polymul([p["fan_lag_s"], 1.0], [p["sensor_lag_s"], 1.0])
    ball = [1.0, p["drag_per_s"], p["gradient_per_s2"]]
    return control.tf([p["gain_mm_per_s2_per_control"]], numpy.trim_zeros(numpy.polymul(ball, lags), "f"))


def laws(pid, period=None):
    """Feedback and setpoint law of a PID: continuous, or as the firmware computes them."""
    kp, ti, td, n = pid["kp_per_mm"], pid["ti_s"], pid["td_s"], pid["derivative_n"]
    if period is None:
        integral = control.tf([1.0], [ti, 0.0]) if ti else control.tf([0.0], [1.0])
        derivative = control.tf([td, 0.0], [td / n, 1.0]) if td else control.tf([0.0], [1.0])
    else:
        integral = control.tf([period / ti], [1.0, -1.0], period) if ti else control.tf([0.0], [1.0], period)
        pole = numpy.exp(-n * period / td) if td else 0.0
        derivative = control.tf([n, -n], [1.0, -pole], period) if td else control.tf([0.0], [1.0], period)
    setpoint, rate = pid["setpoint_weight"], pid["derivative_weight"]
    return kp * (1 + integral + derivative), kp * (setpoint + integral + rate * derivative)


def stable(loop, gain):
    poles = numpy.roots(numpy.polyadd(loop.den[0][0], gain * numpy.asarray(loop.num[0][0])))
    return numpy.all(numpy.abs(poles) < 1) if loop.isdtime(strict=True) else numpy.all(poles.real < 0)


def edge(is_stable, low, high):
    """The gain at which a stable loop stops being stable, by bisection of the closed loop's poles."""
    while high / low > 1 + 1e-10:
        middle = numpy.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return low


def assess(name, found, plant, period=None):
    of = found["continuous" if period is None else "sampled"]
    feedback, setpoint = laws(found["pid"], period)
    loop = feedback * plant
    gain, phase, _, at_half_turn, at_one, _ = control.stability_margins(loop, returnall=True)
    above = lambda pairs: sorted(pair for pair in pairs if pair[0] > 1e-3)
    reference = above(zip(at_half_turn, gain))
    same(f"{name}: gain margins", [(m["omega"], m["factor"]) for m in of["gain_margins"]], reference, 1e-4)
    reference = above(zip(at_one, phase))
    same(f"{name}: phase margins", [(m["omega"], m["phase_deg"]) for m in of["phase_margins"]], reference, 1e-4)
    if of["stable"]:
        omega = numpy.geomspace(1e-2, numpy.pi / period if period else 1e3, 20001)
        point = numpy.exp(1j * omega * period) if period else 1j * omega
        same(f"{name}: peak sensitivity", of["peak_sensitivity"], numpy.max(1 / numpy.abs(1 + loop(point))), 1e-3)
    kp = found["pid"]["kp_per_mm"]
    same(f"{name}: critical K_p", of["critical_kp_per_mm"], kp * edge(lambda k: stable(loop, k), 1.0, 1e4), 1e-6)

    states = [control.ss(system) for system in (setpoint, plant, feedback)]
    closed = states[0] * control.feedback(states[1], states[2])
    times = numpy.arange(0, 40, period or 1e-3)
    times, values = control.step_response(closed, times)
    peak = numpy.argmax(values)
    # What never goes beyond by a thousandth is no overshoot.
    beyond = max(100 * (values[peak] - 1), 0.0)
    same(f"{name}: overshoot", of["step"]["overshoot_percent"], beyond if beyond > 0.1 else 0.0, 1e-3, 1e-2)
    outside = times[numpy.nonzero(numpy.abs(values - 1) > 0.05)[0][-1]]
    same(f"{name}: settling", of["step"]["settling_s"], outside, 0, 2 * (period or 5e-3))
    rise = times[numpy.argmax(values >= 0.9)] - times[numpy.argmax(values >= 0.1)]
    same(f"{name}: rise", of["step"]["rise_s"], rise, 0, 2 * (period or 5e-3))


def gains_of_states():
    pair = ["--pole=-2+2i", "--pole=-2-2i"]
    found = design("poles", *pair)
    p = found["plant"]
    k, a, tau = p["gain_mm_per_s2_per_control"], p["drag_per_s"], p["fan_lag_s"]
    two = numpy.array([[0, 1], [0, -a]]), numpy.array([[0], [k]])
    three = numpy.array([[0, 1, 0], [0, -a, 1], [0, 0, -1 / tau]]), numpy.array([[0], [0], [k / tau]])
    same("two poles", found["state_feedback"]["gain"], control.place(*two, [-2 + 2j, -2 - 2j]).ravel())
    found = design("poles", *pair, "--pole=-6")
    same("three poles", found["state_feedback"]["gain"], control.place(*three, [-2 + 2j, -2 - 2j, -6]).ravel())
    for (matrices, flags) in ((two, []), (three, ["--with-fan"])):
        q = numpy.diag([1.0, 0.01, 0.0][: len(matrices[0])])
        found = design("lqr", *flags)
        same(f"lqr {flags}", found["state_feedback"]["gain"], control.lqr(*matrices, q, 1e4)[0].ravel())
        period = found["period_s"]
        sampled = control.c2d(control.ss(*matrices, numpy.eye(len(q))[:1], 0), period)
        found = design("lqr", "--sampled", *flags)
        same(f"sampled lqr {flags}", found["state_feedback"]["gain"], control.dlqr(sampled.A, sampled.B, q, 1e4)[0].ravel())
    observer(three[0], period)


def lqg():
    """The loop of an LQG as a state space of plant and observer, from the gains alone."""
    found = design("lqr", "--with-fan")
    p, period, of = found["plant"], found["period_s"], found["sampled"]
    k, a, tau = p["gain_mm_per_s2_per_control"], p["drag_per_s"], p["fan_lag_s"]
    believed = numpy.array([[0, 1, 0, 0], [0, -a, k, k], [0, 0, -1 / tau, 0], [0, 0, 0, 0]])
    plant = control.c2d(control.ss(believed, [[0], [0], [1 / tau], [0]], [[1, 0, 0, 0]], 0), period)
    phi, gamma, c = plant.A, plant.B, plant.C
    first, second, fan = (found["lqg"]["feedback"][key] for key in ("position_per_mm", "velocity_s_per_mm", "fan"))
    gain = numpy.array([[first, second, fan, fan + 1]])
    l = numpy.array(found["lqg"]["observer_gain"])[:, None]
    keep = numpy.eye(4) - l @ c
    inner = keep @ (phi - gamma @ gain)
    # The flight itself: reading, estimate, control value, and the ball moves on.
    ball, seen, moved = numpy.zeros((4, 1)), numpy.zeros((4, 1)), numpy.zeros((4, 1))
    values = []
    for _ in range(1000):
        values.append(ball[0, 0])
        seen = moved + l * (ball[0, 0] - moved[0, 0])
        value = first - (gain @ seen)[0, 0]
        ball, moved = phi @ ball + gamma * value, phi @ seen + gamma * value
    values = numpy.array(values)
    same("lqg: overshoot", of["step"]["overshoot_percent"], max(100 * (values.max() - 1), 0), 1e-3, 0.1)
    same("lqg: settling", of["step"]["settling_s"], period * numpy.nonzero(numpy.abs(values - 1) > 0.05)[0][-1], 0, 2 * period)
    # Margins from the frequency response on the circle.
    omega = numpy.geomspace(1e-2, 0.999 * numpy.pi / period, 200_000)
    z = numpy.exp(1j * omega * period)
    compensator, ball = control.ss(inner, l, gain @ inner, gain @ l, period), control.ss(phi[:3, :3], gamma[:3], c[:, :3], 0, period)
    loop = compensator(z) * ball(z)
    ones = numpy.nonzero(numpy.diff(numpy.sign(numpy.abs(loop) - 1)))[0]
    phase = [(omega[i], numpy.degrees(numpy.angle(-loop[i]))) for i in ones]
    same("lqg: phase margins", [(m["omega"], m["phase_deg"]) for m in of["phase_margins"]], phase, 1e-3)
    turns = numpy.nonzero((numpy.diff(numpy.sign(loop.imag)) != 0) & (loop.real[1:] < 0))[0]
    gains = [(omega[i], -1 / loop[i].real) for i in turns]
    same("lqg: gain margins", [(m["omega"], m["factor"]) for m in of["gain_margins"]], gains, 1e-3)


def observer(a, period):
    found = design("observer")
    n = len(a)
    w, c = numpy.diag([0.0, PSD, 0.0]), numpy.eye(n)[:1]
    gain = control.lqe(a, numpy.eye(n), c, w, [[SENSOR**2 * period]])[0]
    same("observer", found["continuous"], gain.ravel())
    # Van Loan's block matrix gives the noise over a period.
    block = scipy.linalg.expm(numpy.block([[-a, w], [numpy.zeros((n, n)), a.T]]) * period)
    phi = block[n:, n:].T
    q = phi @ block[:n, n:]
    p = scipy.linalg.solve_discrete_are(phi.T, c.T, q, [[SENSOR**2]])
    same("sampled observer", found["sampled"], (p @ c.T / (c @ p @ c.T + SENSOR**2)).ravel())


def critical_gains():
    found = design("critical-gain")
    models = {
        "G_a": control.tf([254.598], [1, 1.889, 0]),
        "G_b": control.tf([423.4], [1, 1.595, 0]),
        "G_c": control.tf([3222.8], numpy.polymul([1, 3.896, 0], [1, 3.896])),
    }
    ti, kp, period = found["ti_s"], found["kp_per_mm"], found["period_s"]
    for row in found["rows"]:
        if row["model"] not in models:
            continue
        plant = models[row["model"]]
        pi = lambda ti_s: control.tf([1.0, 1 / ti_s], [1.0, 0.0])
        if row["critical_kp_per_mm"] is None:
            assert stable(pi(ti) * plant, 1e6), row
        else:
            same("K_u", row["critical_kp_per_mm"], edge(lambda k: stable(pi(ti) * plant, k), 1e-4, 10.0))
        slowest = 1 / edge(lambda rate: stable(pi(1 / rate) * plant, kp), 1e-3, 1e3)
        same("critical T_i", row["critical_ti_s"], slowest)
        sampled = control.tf([1.0, period / ti - 1], [1.0, -1.0], period) * control.c2d(plant, period)
        same("sampled K_u", row["sampled_critical_kp_per_mm"], edge(lambda k: stable(sampled, k), 1e-4, 10.0), 1e-5)


for arguments in (["loop"], ["pid"], ["pid", "--omega", "2", "--damping", "0.5"], ["poles", "--pole=-2+2i", "--pole=-2-2i"]):
    found = design(*arguments)
    plant, period = plant_of(found), found["period_s"]
    assess(" ".join(arguments), found, plant)
    assess(" ".join(arguments) + ", sampled", found, control.c2d(plant, period), period)
gains_of_states()
lqg()
critical_gains()
print(f"{compared} designs and figures agree with python-control {control.__version__} and SciPy {scipy.__version__}")
