"""A model of a rig, with its loop and the way its logs are read: a config as a value."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _airball
from ._files import write_new
from ._innovations import Innovations, innovations
from ._linear import StateSpace, state_space
from .errors import ArgumentError, Error

_Path = str | os.PathLike[str]
#: An effect: its one number, or its numbers by their names in the config.
Effect = float | Mapping[str, float]


class Model:
    """The believed model of a rig.

    From numbers, or with `Model.load` from a config file. A model in code has the table `[plant]` alone; a `base`
    lends it its other tables, such as the control loop that `simulate` flies.

    >>> import airball as ab
    >>> rig = ab.Model(gain=827.2, drag=3.896, hover=21.4, effects={"fan_lag": 0.257})
    >>> rig.gain, rig.effects
    (827.2, {'fan_lag': {'time_constant_s': 0.257}})
    >>> ab.Model(gain=827.2, drag=3.896, hover=21.4, effects={"fan_lagg": 0.257})
    Traceback (most recent call last):
    airball.errors.ArgumentError: effects: there is no effect 'fan_lagg'; did you mean 'fan_lag'?
    """

    def __init__(
        self,
        gain: float,
        drag: float,
        hover: float,
        *,
        pipe_length: float = 583.0,
        sensor_noise: float = 2.5,
        acceleration_noise: float = 360.0,
        effects: Mapping[str, Effect] | None = None,
        base: Model | None = None,
    ) -> None:
        """`gain` in mm/s² per percent, `drag` in 1/s, `hover` in percent of duty, `pipe_length` and `sensor_noise` (the
        standard deviation of a reading) in mm, `acceleration_noise` (white) in mm²/s³. Defaults are the shown rig's."""
        numbers = {
            "gain_mm_per_s2_per_percent": gain,
            "drag_per_s": drag,
            "hover_duty_percent": hover,
            "pipe_length_mm": pipe_length,
        }
        noise = {"sensor_mm": sensor_noise, "acceleration_psd_mm2_per_s3": acceleration_noise}
        lines = ["[plant]", *_lines(numbers), "[plant.noise]", *_lines(noise), *_effects(effects or {})]
        if base is None:
            self._belief = _airball.Belief.of_texts([("the model", "\n".join(lines))])
        else:
            if base.effects:
                gone = [f"plant.effects.{name}" for name in base.effects]
                lines.insert(0, f"remove = {json.dumps(gone)}")
            self._belief = base._belief.patched("the model", "\n".join(lines))

    @classmethod
    def _of(cls, belief: _airball.Belief) -> Model:
        made = cls.__new__(cls)
        made._belief = belief
        return made

    @classmethod
    def load(cls, path: _Path, patches: Sequence[_Path] = ()) -> Model:
        """Reads a config file, with patches over it, as `--config` and `--patch` do."""
        return cls._of(_airball.Belief.read(os.fspath(path), [os.fspath(patch) for patch in patches]))

    @classmethod
    def from_toml(cls, text: str, name: str = "the model") -> Model:
        """The same of a text; `name` stands for the file in messages."""
        return cls._of(_airball.Belief.of_texts([(name, text)]))

    @classmethod
    def example(cls) -> Model:
        """The ball-in-pipe rig of the project: the model that its simulator flies, and its control loop.

        >>> import airball as ab
        >>> ab.Model.example().hover
        21.4
        """
        return cls.from_toml(_airball.example(), "config.toml")

    def patched(self, patch: str | Mapping[str, Any] | _Path, name: str = "the patch") -> Model:
        """This model with a patch over it: a file, or TOML, such as `Diagnosis.patch`."""
        if isinstance(patch, os.PathLike):
            patch, name = Path(patch).read_text(encoding="utf-8"), os.fspath(patch)
        return self._of(self._belief.patched(name, str(patch)))

    def with_effects(self, **effects: Effect) -> Model:
        """This model with these effects on.

        >>> import airball as ab
        >>> stuck = ab.Model.example().with_effects(dead_zone={"lower_percent": -0.3, "upper_percent": 0.3})
        >>> sorted(stuck.effects)
        ['dead_zone', 'fan_lag']
        """
        return self.patched("\n".join(_effects(effects, self._parameters())))

    def without_effects(self, *names: str) -> Model:
        """This model with these effects off."""
        for name in names:
            if name not in self.effects:
                raise ArgumentError(f"{name!r} is not on in this model; on are {', '.join(self.effects) or 'none'}")
        return self.patched(f"remove = {json.dumps([f'plant.effects.{name}' for name in names])}")

    def _parameters(self) -> dict[str, list[str]]:
        return dict(_airball.catalogue()) | {name: list(values) for name, values in self.effects.items()}

    def _plant(self) -> dict[str, Any]:
        plant = self._belief.plant()
        if plant is None:
            raise Error(f"{self.name}: there is no table [plant], so no model")
        return dict(json.loads(plant))

    @property
    def name(self) -> str:
        """The name of its file, as messages give it."""
        return self._belief.name

    @property
    def gain(self) -> float:
        """Acceleration per percent of duty about hover, mm/s² per percent."""
        return float(self._plant()["gain_mm_per_s2_per_percent"])

    @property
    def drag(self) -> float:
        """Linear drag of the ball in the air stream, 1/s."""
        return float(self._plant()["drag_per_s"])

    @property
    def hover(self) -> float:
        """Duty at which the ball hovers, percent."""
        return float(self._plant()["hover_duty_percent"])

    @property
    def pipe_length(self) -> float:
        """Length of the pipe, mm."""
        return float(self._plant()["pipe_length_mm"])

    @property
    def noise(self) -> dict[str, float]:
        """What is random: `sensor_mm` and `acceleration_psd_mm2_per_s3`."""
        return dict(self._plant()["noise"])

    @property
    def effects(self) -> dict[str, dict[str, float]]:
        """The effects that are on, with their numbers by their names in the config."""
        return dict(self._plant().get("effects", {}))

    def to_toml(self) -> str:
        """The config in force."""
        return self._belief.to_toml()

    def save(self, path: _Path) -> None:
        """Writes the config in force. A file that exists is kept."""
        write_new(path, self.to_toml().encode())

    def to_state_space(self) -> StateSpace:
        """The linear part about hover: matrices, states, inputs and outputs by name, and the delay."""
        numbers = self._belief.linear()
        if numbers is None:
            raise Error(f"{self.name}: there is no table [plant], so no model")
        return state_space(numbers, self._belief.period_s)

    def to_control(self, pade: int = 0) -> Any:
        """The same as a system of python-control: from duty about hover, percent, to the reading, mm.

        `pade`: order of the approximation of the delay; with 0 the delay is left out, and a warning says so.
        """
        return self.to_state_space().to_control(pade)

    def to_innovations(self, period: float | None = None) -> Innovations:
        """The linear part in discrete time, its noise as the steady Kalman gain K. `period` in seconds: by default that of
        the control loop."""
        return innovations(self.to_state_space(), self.noise, self.hover, period)

    def to_mat(self, path: _Path, period: float | None = None) -> None:
        """Writes A, B, C, D, K and Ts as a file of MATLAB (version 5), for `idss(A, B, C, D, K, zeros(size(K)), Ts)`. A
        file that exists is kept."""
        self.to_innovations(period).to_mat(path)

    def to_fmu(self, path: _Path) -> None:
        """Writes the simulated rig as an FMU (FMI 2.0, co-simulation, for 64-bit Linux and Windows), as
        `airball export fmu` does. A file that exists is kept."""
        self._belief.export_fmu(os.fspath(Path(__file__).parent), os.fspath(path))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._belief.texts(),)

    def __repr__(self) -> str:
        on = ", ".join(self.effects)
        return f"Model(gain={self.gain}, drag={self.drag}, hover={self.hover}, effects: {on or 'none'}; of {self.name})"


def _restored(texts: list[tuple[str, str]]) -> Model:
    return Model._of(_airball.Belief.of_texts(texts))


def _number(name: str, value: Any) -> str:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name} is {value!r}, not a number") from None
    if number != number or number in (float("inf"), float("-inf")):
        raise ArgumentError(f"{name} is {number}, not a finite number")
    # A whole number stays one: some parameters count.
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else repr(number)


def _lines(numbers: Mapping[str, Any]) -> list[str]:
    return [f"{name} = {_number(name, value)}" for name, value in numbers.items()]


def _effects(effects: Mapping[str, Effect], known: Mapping[str, list[str]] | None = None) -> list[str]:
    known = known if known is not None else dict(_airball.catalogue())
    lines = []
    for name, given in effects.items():
        if name not in known:
            import difflib

            near = difflib.get_close_matches(name, known, 1)
            hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}"
            raise ArgumentError(f"effects: there is no effect {name!r}; {hint}")
        if not isinstance(given, Mapping):
            if len(known[name]) != 1:
                needed = ", ".join(known[name])
                raise ArgumentError(f"effects: {name} has several numbers; give a dict of {needed}")
            given = {known[name][0]: given}
        lines += [f"[plant.effects.{name}]", *_lines(given)]
    return lines
