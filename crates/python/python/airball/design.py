"""Design of controllers and observers for a model: the methods of `airball design`, with its options and defaults.

>>> import airball as ab
>>> made = ab.design.lqr(ab.Model.example(), control=5000)
>>> sorted(made["state_feedback"])[:1]
['gain']
>>> ab.design.lqr(ab.Model.example(), control=-1)
Traceback (most recent call last):
airball.errors.Error: --control -1: give a number above 0
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from . import _airball
from ._model import Model, _Path
from ._recording import model_of
from ._results import Result, flags


def _design(model: Model | _Path, method: str, words: list[str]) -> Result:
    belief = model_of(model)
    return Result(_airball.design(belief._belief, method, words), belief, f"design of {method}")


def loop(model: Model | _Path, **about: float) -> Result:
    """Margins, critical gain and step response of the loop of the config."""
    return _design(model, "loop", flags(about))


def pid(
    model: Model | _Path,
    *,
    damping: float | None = None,
    omega: float | None = None,
    real_pole: float | None = None,
    setpoint_weight: float | None = None,
    derivative_n: float | None = None,
    **about: float,
) -> Result:
    """A PID by pole placement: a pair of poles by `damping` and `omega` (rad/s), and a real one (1/s)."""
    options = {
        "damping": damping,
        "omega": omega,
        "real_pole": real_pole,
        "setpoint_weight": setpoint_weight,
        "derivative_n": derivative_n,
    }
    return _design(model, "pid", flags({**options, **about}))


def poles(model: Model | _Path, poles: Sequence[complex], **about: float) -> Result:
    """State feedback by pole placement: two poles for position and velocity, three with the fan."""
    words = [f"--pole={_pole(complex(pole))}" for pole in poles]
    return _design(model, "poles", [*words, *flags(about)])


def _pole(pole: complex) -> str:
    return repr(pole.real) if pole.imag == 0 else f"{pole.real!r}{pole.imag:+}i"


def lqr(
    model: Model | _Path,
    *,
    position: float | None = None,
    velocity: float | None = None,
    control: float | None = None,
    with_fan: bool = False,
    sampled: bool = False,
    **about: float,
) -> Result:
    """State feedback of least cost: weights of squared position, velocity and control value."""
    options: dict[str, Any] = {"position": position, "velocity": velocity, "control": control}
    return _design(model, "lqr", flags({**options, "with_fan": with_fan, "sampled": sampled, **about}))


def observer(
    model: Model | _Path, *, w: Sequence[float] | None = None, v: float | None = None, **about: float
) -> Result:
    """A steady-state Kalman observer, from the noise of the model or from the intensities `w` and `v`."""
    return _design(model, "observer", flags({"w": None if w is None else list(w), "v": v, **about}))
