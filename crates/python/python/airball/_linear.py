"""The linear part of a model as matrices."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class StateSpace:
    """dx/dt = A·x + B·u, y = C·x + D·u, with u delayed by `delay_s`."""

    A: NDArray[np.float64]
    B: NDArray[np.float64]
    C: NDArray[np.float64]
    D: NDArray[np.float64]
    #: Delays of actuator and sensor together, seconds.
    delay_s: float
    states: tuple[str, ...]
    inputs: tuple[str, ...] = ("duty about hover, percent",)
    outputs: tuple[str, ...] = ("reading, mm",)
    #: Effects that are on in the model and not in its linear part.
    not_linear: tuple[str, ...] = field(default=())
    #: Period of the control loop, seconds, where the config has it.
    period_s: float | None = None

    def to_control(self, pade: int = 0) -> Any:
        """A system of python-control; see `Model.to_control`."""
        import control

        system = control.ss(self.A, self.B, self.C, self.D, states=[name.split(",")[0] for name in self.states])
        if self.delay_s and not pade:
            warnings.warn(f"the delay of {self.delay_s} s is left out; give pade=2 for an approximation", stacklevel=3)
        if self.delay_s and pade:
            system = system * control.ss(control.tf(*control.pade(self.delay_s, pade)))
        return system


def state_space(linear: tuple[list[float], list[str]], period_s: float | None) -> StateSpace:
    """Matrices of gain, drag, gradient, lag of the fan, lag of the sensor and delay."""
    (gain, drag, gradient, fan_lag_s, sensor_lag_s, delay_s), not_linear = linear
    names = ["position, mm", "velocity, mm/s"]
    fan = len(names) if fan_lag_s else None
    names += ["acceleration by the fan, mm/s²"] if fan_lag_s else []
    sensor = len(names) if sensor_lag_s else None
    names += ["reading, mm"] if sensor_lag_s else []
    count = len(names)
    a, b, c = np.zeros((count, count)), np.zeros((count, 1)), np.zeros((1, count))
    a[0, 1], a[1, 0], a[1, 1] = 1.0, -gradient, -drag
    if fan is None:
        b[1, 0] = gain
    else:
        a[1, fan], a[fan, fan], b[fan, 0] = 1.0, -1.0 / fan_lag_s, gain / fan_lag_s
    if sensor is None:
        c[0, 0] = 1.0
    else:
        a[sensor, 0], a[sensor, sensor], c[0, sensor] = 1.0 / sensor_lag_s, -1.0 / sensor_lag_s, 1.0
    d = np.zeros((1, 1))
    return StateSpace(a, b, c, d, delay_s, tuple(names), not_linear=tuple(not_linear), period_s=period_s)
