"""The linear part of a model in discrete time, with its steady Kalman gain: the innovations form, as MATLAB's `idss`.

```text
x[k+1] = A·x[k] + B·u[k] + K·e[k]        y[k] = C·x[k] + D·u[k] + e[k]
```

The input is held from each sample to the next. The delay is exact, also as a fraction of the period: the last inputs are
states. K = Φ·P·Cᵀ/(C·P·Cᵀ + r), with P of the Riccati equation in discrete time, the white force of the model integrated
over a period (Van Loan 1978), and r the variance of a reading. Inputs are known, so that their rows of K are zero.
"""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ._extras import extra
from ._files import write_new
from .errors import ArgumentError, Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._linear import StateSpace

    Matrix = NDArray[np.float64]

#: Share of a period below which a delay counts as a whole number of periods.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Innovations:
    """x[k+1] = A·x[k] + B·u[k] + K·e[k], y[k] = C·x[k] + D·u[k] + e[k], with e white."""

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    K: Matrix
    #: Period, seconds.
    Ts: float
    #: Variance of e, mm².
    noise_variance: float
    #: Duty about which the input counts, percent.
    hover: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    #: Effects that are on in the model and left out here.
    not_linear: tuple[str, ...]

    def to_mat(self, path: str | os.PathLike[str]) -> None:
        """Writes it as a file of MATLAB, version 5, with the names that `idss` has. A file that exists is kept."""
        with extra("mat"):
            from scipy.io import savemat

        def cells(names: tuple[str, ...]) -> NDArray[np.object_]:
            return np.array(names, dtype=object).reshape(-1, 1)

        numbers = {name: getattr(self, name) for name in ("A", "B", "C", "D", "K", "Ts")}
        words = {"StateName": self.states, "InputName": self.inputs, "OutputName": self.outputs, "NotLinear": self.not_linear}
        rest = {"NoiseVariance": self.noise_variance, "hover_duty_percent": self.hover}
        content = io.BytesIO()
        savemat(content, numbers | rest | {name: cells(several) for name, several in words.items()}, format="5")
        write_new(path, content.getvalue())


@extra("mat")
def innovations(linear: StateSpace, noise: dict[str, float], hover: float, period: float | None) -> Innovations:
    """The innovations form of a linear part and its noise, sampled with a period."""
    period_s = _period(linear.period_s if period is None else period)
    for name, value in noise.items():
        if value <= 0:
            raise Error(f"plant.noise.{name} is {value}, and a steady Kalman gain needs it above 0; give the model's noise")
    from scipy.linalg import solve_discrete_are

    phi, force = _sampled_noise(linear.A, noise["acceleration_psd_mm2_per_s3"], period_s)
    reading = noise["sensor_mm"] ** 2
    covariance = solve_discrete_are(phi.T, linear.C.T, force, np.array([[reading]]))
    variance = float((linear.C @ covariance @ linear.C.T).item() + reading)
    gain = phi @ covariance @ linear.C.T / variance
    a, b, past = _with_past_inputs(phi, *_sampled_input(linear, period_s))
    none = np.zeros((past, 1))
    return Innovations(
        A=a,
        B=b,
        C=np.hstack([linear.C, none.T]),
        D=linear.D.copy(),
        K=np.vstack([gain, none]),
        Ts=period_s,
        noise_variance=variance,
        hover=hover,
        states=linear.states + tuple(f"input {k} periods ago, percent" for k in range(1, past + 1)),
        inputs=linear.inputs,
        outputs=linear.outputs,
        not_linear=linear.not_linear,
    )


def _period(period: float | None) -> float:
    if period is None:
        raise ArgumentError("the model has no period, since its config has no table [loop]; give period in seconds")
    if not 0 < period < float("inf"):
        raise ArgumentError(f"period is {period}; give a number of seconds above 0, for instance 0.02")
    return float(period)


def _sampled_noise(a: Matrix, psd: float, period_s: float) -> tuple[Matrix, Matrix]:
    """Transition over a period, and the covariance that a white force on the velocity adds in it."""
    from scipy.linalg import expm

    count = len(a)
    force = np.zeros_like(a)
    force[1, 1] = psd
    both = expm(np.block([[-a, force], [np.zeros_like(a), a.T]]) * period_s)
    phi = both[count:, count:].T
    covariance = phi @ both[:count, count:]
    return phi, (covariance + covariance.T) / 2


def _sampled_input(linear: StateSpace, period_s: float) -> tuple[list[Matrix], int]:
    """What the inputs add in a period: that of the whole periods of the delay, and where there is a fraction the one
    before it; and how many whole periods the delay has."""
    from scipy.linalg import expm

    count = len(linear.A)

    def held(duration: float) -> tuple[Matrix, Matrix]:
        """Transition and effect of an input that is held for a time."""
        both = np.block([[linear.A, linear.B], [np.zeros((1, count + 1))]])
        moved = expm(both * duration)
        return moved[:count, :count], moved[:count, count:]

    periods = linear.delay_s / period_s
    whole = int(np.floor(periods + _ROUNDING))
    fraction = periods - whole
    if fraction < _ROUNDING:
        return [held(period_s)[1]], whole
    later, new = held((1 - fraction) * period_s)
    old = later @ held(fraction * period_s)[1]
    return [new, old], whole


def _with_past_inputs(phi: Matrix, effects: list[Matrix], whole: int) -> tuple[Matrix, Matrix, int]:
    """A and B with the past inputs as states, the latest first, and their number."""
    count, past = len(phi), whole + len(effects) - 1
    a, b = np.zeros((count + past, count + past)), np.zeros((count + past, 1))
    a[:count, :count] = phi
    for back, effect in enumerate(effects, start=whole):
        if back == 0:
            b[:count] = effect
        else:
            a[:count, count + back - 1 : count + back] = effect
    if past:
        b[count, 0] = 1.0
        a[count + 1 :, count:-1] = np.eye(past - 1)
    return a, b, past
