"""Recordings of a rig, experiments, and simulated flights."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _airball
from ._columns import column, of_frame, same_length
from ._files import write_new
from ._model import Model, _Path
from .errors import ArgumentError, Error

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_QUANTITIES = {
    "t": "time_s",
    "u": "duty_percent",
    "y": "position_mm",
    "setpoint": "setpoint_mm",
    "control": "control_percent",
    "fan_speed": "fan_rpm",
    "y2": "position2_mm",
}


class Recording:
    """What a rig recorded: time in s, input in percent, position in mm, and what else the log has.

    >>> import numpy as np, airball as ab
    >>> t = np.arange(0, 10, 0.02)
    >>> log = ab.Recording(t, 21.4 + np.sin(t), 300 + 40 * np.cos(t))
    >>> len(log), log.duration
    (500, 9.98)
    >>> ab.Recording(t, t[1:], t)
    Traceback (most recent call last):
    airball.errors.ArgumentError: u has 499 values and t has 500; give columns of one length
    """

    def __init__(
        self,
        t: Any,
        u: Any,
        y: Any,
        *,
        setpoint: Any = None,
        control: Any = None,
        fan_speed: Any = None,
        y2: Any = None,
        missing: Literal["raise", "skip"] = "raise",
        name: str = "recording",
    ) -> None:
        """Columns of one length: arrays, lists, or columns of pandas, polars or Arrow. With `missing="skip"` a row whose
        `y` is not a number is one without a reading; `t` and `u` are needed in every row."""
        if missing not in ("raise", "skip"):
            raise ArgumentError(f"missing is {missing!r}; give 'raise' or 'skip'")
        given = {"t": t, "u": u, "y": y, "setpoint": setpoint, "control": control, "fan_speed": fan_speed, "y2": y2}
        skip = missing == "skip"
        columns = {
            argument: None if values is None else column(argument, values, allow_nan=skip and argument not in ("t", "u"))
            for argument, values in given.items()
        }
        for argument in ("t", "u", "y"):
            if columns[argument] is None:
                raise ArgumentError(f"{argument} is None; a recording needs time, input and position")
        same_length(columns)
        needed, others = list(columns.values())[:3], list(columns.values())[3:]
        self._log = _airball.Log.of_columns(name, needed, others)

    @classmethod
    def _of(cls, log: _airball.Log) -> Recording:
        made = cls.__new__(cls)
        made._log = log
        return made

    @classmethod
    def from_frame(
        cls,
        frame: Any,
        *,
        time: str,
        input: str,
        position: str,
        setpoint: str | None = None,
        fan_speed: str | None = None,
        time_scale: float = 1.0,
        input_scale: float = 1.0,
        scale: float = 1.0,
        missing: Literal["raise", "skip"] = "raise",
        name: str = "recording",
    ) -> Recording:
        """A frame of pandas or polars, or a table of Arrow. The scales turn its columns into seconds, percent and mm;
        `scale` is that of position and setpoint: 1000 for metres."""

        def scaled(argument: str, named: str | None, by: float, needs: bool = False) -> Any:
            if named is None:
                return None
            values = of_frame(frame, argument, named)
            return column(f"{argument} (column {named!r})", values, allow_nan=missing == "skip" and not needs) * by

        return cls(
            scaled("time", time, time_scale, True),
            scaled("input", input, input_scale, True),
            scaled("position", position, scale),
            setpoint=scaled("setpoint", setpoint, scale),
            fan_speed=scaled("fan_speed", fan_speed, 1.0),
            missing=missing,
            name=name,
        )

    @property
    def name(self) -> str:
        """The name that messages give it."""
        return self._log.name

    def _column(self, name: str) -> NDArray[np.float64]:
        values = self._log.column(name)
        assert values is not None
        return values

    @property
    def t(self) -> NDArray[np.float64]:
        """Time, seconds."""
        return self._column("time_s")

    @property
    def u(self) -> NDArray[np.float64]:
        """Input from each row to the next, percent."""
        return self._column("duty_percent")

    @property
    def y(self) -> NDArray[np.float64]:
        """Position, mm, upward; not a number in rows without a reading."""
        return self._column("position_mm")

    @property
    def setpoint(self) -> NDArray[np.float64]:
        """Commanded position, mm; not a number where there is none."""
        return self._column("setpoint_mm")

    @property
    def duration(self) -> float:
        """Time from the first row to the last, seconds."""
        t = self.t
        return float(t[-1] - t[0])

    def to_frame(self) -> Any:
        """The columns that hold numbers, as a frame of pandas."""
        import pandas

        columns = {name: self._column(name) for name in _QUANTITIES.values()}
        return pandas.DataFrame(columns).dropna(axis="columns", how="all")

    def __len__(self) -> int:
        return len(self._log)

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        """Time, input and position: `t, u, y = recording`."""
        return iter((self.t, self.u, self.y))

    def __reduce__(self) -> tuple[Any, ...]:
        if not self._log.is_plain:
            raise TypeError(f"{self.name} holds more than rows; hand its file to the other process, not the recording")
        columns = {argument: self._column(name) for argument, name in _QUANTITIES.items()}
        return _restored, (columns, self.name)

    def __repr__(self) -> str:
        return f"Recording({len(self)} rows, {self.duration:.1f} s, of {self.name})"


def _restored(columns: dict[str, NDArray[np.float64]], name: str) -> Recording:
    return Recording(**columns, missing="skip", name=name)  # type: ignore[arg-type]


def read(path: _Path, model: Model | None = None) -> Recording:
    """Reads a log: MCAP of this program, or a CSV, packed with zstd or gzip or not.

    A CSV has the columns `time_s`, `duty_percent` and `position_mm`, or those that `[import]` of the `model` names.
    """
    log = _airball.Log.read(os.fspath(path), None if model is None else model._belief)
    if log.truncated:
        warnings.warn(f"{log.name}: {log.truncated}", stacklevel=2)
    return Recording._of(log)


class Experiment:
    """What is flown over time: setpoints, excitations or duties, as a text of TOML."""

    def __init__(self, text: str) -> None:
        self.text = text

    @classmethod
    def load(cls, path: _Path) -> Experiment:
        """Reads an experiment file."""
        return cls(Path(path).read_text(encoding="utf-8"))

    def save(self, path: _Path) -> None:
        """Writes it, for `airball run --experiment`. A file that exists is kept."""
        write_new(path, self.text.encode())

    @property
    def title(self) -> str:
        """Its purpose, in a line."""
        return _airball.experiment_title(self.text)

    def __repr__(self) -> str:
        return f"Experiment({self.title!r})"

    def __str__(self) -> str:
        return self.text


class Simulation(Recording):
    """A simulated flight: a recording, and every quantity of its cycles as an array, `simulation["velocity_mm_per_s"]`."""

    _flown: _airball.Flown

    @property
    def columns(self) -> list[str]:
        """The names of the quantities, as in the log."""
        return self._flown.columns()

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        values = self._flown.column(name)
        if values is None:
            raise KeyError(f"{name!r}; known are {', '.join(self.columns)}")
        return values

    @property
    def fault(self) -> str | None:
        """The fault that ended the flight, if one did."""
        return self._flown.fault

    def save(self, path: _Path) -> None:
        """Writes the flight as MCAP, as `airball simulate --log` does. A file that exists is kept."""
        self._flown.save(os.fspath(path))


def simulate(
    model: Model,
    experiment: Experiment | _Path | None = None,
    *,
    seed: int = 1,
    duration: float | None = None,
) -> Simulation:
    """Flies the simulated rig by its control loop, in virtual time: the flight of `airball simulate` with this seed.

    Without an experiment, the reference of the config is flown, for 60 s or `duration` seconds.

    >>> import airball as ab
    >>> flight = ab.simulate(ab.Model.example(), seed=7, duration=5.0)
    >>> len(flight), flight["velocity_mm_per_s"].shape
    (250, (250,))
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64:
        raise ArgumentError(f"seed is {seed!r}; give a whole number from 0 to 2**64 - 1")
    if duration is not None and not 0 < duration < float("inf"):
        raise ArgumentError(f"duration is {duration}; give a number of seconds above 0, for instance 60")
    text = experiment.text if isinstance(experiment, Experiment) else None
    file = None if experiment is None or text is not None else os.fspath(experiment)  # type: ignore[arg-type]
    flown = _airball.simulate(model._belief, file, text, seed, duration)
    made = Simulation._of(flown.log)
    assert isinstance(made, Simulation)
    made._flown = flown
    if flown.fault:
        warnings.warn(f"the flight was ended, with the fan off: {flown.fault}", stacklevel=2)
    return made


#: The experiments of the project, by name.
experiments: dict[str, Experiment] = {name: Experiment(text) for name, text in _airball.experiments()}


def recordings(model: Model, logs: Any) -> list[Recording]:
    """Logs as recordings: one or several, recordings or names of files."""
    several = [logs] if isinstance(logs, (Recording, str, os.PathLike)) else list(logs)
    if not several:
        raise ArgumentError("logs is empty; give at least one recording or file")
    made = []
    for number, log in enumerate(several):
        if isinstance(log, (str, os.PathLike)):
            log = read(log, model)
        if not isinstance(log, Recording):
            raise ArgumentError(f"logs[{number}] is a {type(log).__name__}; give a Recording, or the name of a file")
        made.append(log)
    return made


def model_of(model: Any) -> Model:
    """A model, or the config file of one."""
    if isinstance(model, (str, os.PathLike)):
        return Model.load(model)
    if not isinstance(model, Model):
        raise ArgumentError(f"model is a {type(model).__name__}; give a Model, or the name of a config file")
    return model


__all__ = ["Error", "Experiment", "Recording", "Simulation", "experiments", "read", "simulate"]
