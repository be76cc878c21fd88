"""What identification, replay and design give: a document, words, and a patch of the config."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from . import _airball
from ._model import Model, _Path
from ._recording import model_of, recordings
from .errors import ArgumentError


class Result:
    """The result of a command: `result["key"]` of its document, its words by `print`, and the model with its patch."""

    def __init__(self, told: tuple[str, str, str, list[str]], belief: Model, name: str) -> None:
        self._text, self._words, self.patch, self.notes = told
        self._belief, self._name = belief, name

    def json(self) -> str:
        """The document that the command writes with `--json`, letter for letter."""
        return self._text

    def to_dict(self) -> dict[str, Any]:
        """The same as a dict."""
        return dict(json.loads(self._text))

    def __getitem__(self, key: str) -> Any:
        return self.to_dict()[key]

    @property
    def model(self) -> Model:
        """The model with the result in it."""
        return self._belief.patched(self.patch, self._name) if self.patch else self._belief

    def __str__(self) -> str:
        return self._words

    def __repr__(self) -> str:
        return f"<{self._name}>\n{self._words}" if self._words else f"<{self._name}>"


def flags(options: dict[str, Any]) -> list[str]:
    """Options as flags of the command line: its names, defaults and checks."""
    words: list[str] = []
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(flag)
        elif isinstance(value, (list, tuple)):
            words.append(f"{flag}={','.join(map(_word, value))}")
        else:
            words.append(f"{flag}={_word(value)}")
    return words


def _word(value: Any) -> str:
    if isinstance(value, str):
        return value
    try:
        return repr(float(value)) if not isinstance(value, int) else str(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{value!r} is not a number") from None


def identify(
    model: Model | _Path,
    logs: Any,
    *,
    poles: int | None = None,
    open_loop: bool = False,
    per_control: bool = False,
    about_duty: float | None = None,
    about_height: float | None = None,
) -> Result:
    """Identifies gain, drag, hover and lag of the fan, with 90 % intervals, as `airball identify grey-box` does.

    `poles`: 2 for the ball, 3 for ball and fan; by default the better of both. The options are those of the command.
    """
    belief = model_of(model)
    words = flags(
        {
            "poles": poles,
            "open_loop": open_loop,
            "per_control": per_control,
            "about_duty": about_duty,
            "about_height": about_height,
        }
    )
    told = _airball.identify(belief._belief, [log._log for log in recordings(belief, logs)], words)
    return Result(told, belief, "identification")


def replay(model: Model | _Path, log: Any) -> Result:
    """Compares forecasts of a model with a log, and their errors with those that noise alone gives, as `airball replay`."""
    belief = model_of(model)
    several = recordings(belief, log)
    if len(several) != 1:
        raise ArgumentError(f"log holds {len(several)} recordings; give one")
    return Result(_airball.replay(belief._belief, several[0]._log), belief, "replay")


def propose(
    logs: _Path | Sequence[_Path], out: _Path = "rig.toml", *, force: bool = False, **columns: str | float
) -> Model:
    """Proposes a config for a CSV of a rig that has none, writes it to `out`, and returns it, as `airball init` does.

    `columns` are the flags of the command: `time`, `period`, `input`, `position`, `speed`, `setpoint`,
    `input_scale`, `position_scale`, `length`. Prints what was found, and what to look at before it is believed.
    """
    import os

    named = [logs] if isinstance(logs, (str, os.PathLike)) else list(logs)
    words = flags({**columns, "force": force})
    lines, warned = _airball.propose([os.fspath(log) for log in named], os.fspath(out), words)
    print(*lines, *(f"note: {line}" for line in warned), sep="\n")
    return Model.load(out)
