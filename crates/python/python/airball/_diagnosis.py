"""The diagnosis of the gap between a model and a rig."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from . import _airball
from ._model import Model, _Path
from ._progress import shown
from ._recording import Experiment, model_of, recordings

#: Height of the report's first screen in a notebook, pixels.
_HEIGHT = 760


@dataclass(frozen=True)
class Interval:
    """A value with its 90 % interval; an end is None where the record does not identify it."""

    value: float
    low: float | None
    high: float | None

    def __str__(self) -> str:
        if self.low is None or self.high is None:
            return f"{self.value:.4g} (not identified)"
        return f"{self.value:.4g} ({self.low:.4g} to {self.high:.4g})"


@dataclass(frozen=True)
class Effect:
    """An effect that the rig has and the model lacks, or the other way round."""

    name: str
    #: What is to be done in the model: `added`, `removed` or `changed`.
    change: str
    probability: float
    #: Effects that this record does not tell from it.
    indistinguishable_from: tuple[str, ...]
    parameters: dict[str, Interval]

    def __getitem__(self, parameter: str) -> Interval:
        return self.parameters[parameter]

    def __str__(self) -> str:
        numbers = ", ".join(f"{name} = {value}" for name, value in self.parameters.items())
        return f"{self.name}, {100 * self.probability:.0f} % sure: {numbers}"


class Ladder(tuple[dict[str, Any], ...]):
    """The models from the belief to the mended one, each with its forecast errors on stretches that it was not fitted to."""

    def to_frame(self) -> Any:
        """The same as a frame of pandas, a row for each model."""
        import pandas

        rows = []
        for rung in self:
            share = rung["share"] or {}
            errors = dict(zip(("error_0.1s_mm", "error_0.5s_mm", "error_1s_mm"), rung["error_mm"], strict=True))
            step = rung.get("name", rung["step"])
            ends = {"share": share.get("value"), "share_low": share.get("low"), "share_high": share.get("high")}
            rows.append({"step": step, **errors, "free_run_10s_mm": rung["free_run_10s_mm"], **ends})
        return pandas.DataFrame(rows).set_index("step")


class Diagnosis:
    """What is wrong with a model, how sure that is, and the model that it should be."""

    def __init__(self, found: _airball.Diagnosed, belief: Model, call: Sequence[str]) -> None:
        self._found, self._belief, self._call = found, belief, list(call)
        self._document: dict[str, Any] = json.loads(found.document())

    def json(self) -> str:
        """The document that `airball diagnose --json` writes, letter for letter."""
        return self._found.document()

    def to_dict(self) -> dict[str, Any]:
        """The same as a dict."""
        return dict(json.loads(self._found.document()))

    @property
    def verdict(self) -> str:
        """`no_gap`, `parameters`, `effect`, `unexplained` or `insufficient_data`, as in the document."""
        return str(self._document["verdict"])

    @property
    def effects(self) -> list[Effect]:
        """The effects that were found, the most important first."""
        return [
            Effect(
                one["name"],
                one["change"],
                one["probability"],
                tuple(one["indistinguishable_from"]),
                {name: _interval(value) for name, value in one["parameters"].items()},
            )
            for one in self._document["effects"]
        ]

    @property
    def parameters(self) -> dict[str, Interval]:
        """Gain, drag and hover of the mended model."""
        return {name: _interval(value) for name, value in self._document["parameters"].items()}

    @property
    def ladder(self) -> Ladder:
        """The models from the belief to the mended one."""
        return Ladder(self._document["ladder"])

    @property
    def closed(self) -> Interval | None:
        """The share of the gap at 1 s that the mended model closes; None where there is no gap."""
        closed = self._document["gap"]["closed"]
        return None if closed is None else _interval(closed)

    @property
    def findings(self) -> list[str]:
        """What the record cannot answer, and what is odd in it."""
        return list(self._document["check"]["findings"])

    @property
    def next_experiment(self) -> Experiment | None:
        """The experiment to fly next, where one is needed."""
        text = self._found.next_experiment()
        return None if text is None else Experiment(text)

    @property
    def patch(self) -> str:
        """The mended model as a patch of the config; empty where nothing changes."""
        return self._found.patch()

    @property
    def model(self) -> Model:
        """The mended model."""
        patch = self.patch
        return self._belief.patched(patch, "the diagnosis") if patch else self._belief

    def report(self, path: _Path) -> None:
        """Writes the report as one self-contained page. Only an older report is replaced."""
        self._found.write_page(os.fspath(path), self._call)

    def plot(self, axes: Any = None) -> Any:
        """Draws the recorded position with free runs of the believed and of the mended model, the duty, and the force
        that the believed model lacks. Returns the figure. `axes`: three of matplotlib, to draw into."""
        from ._plot import diagnosis

        return diagnosis(self._found.picture(), axes)

    def _repr_html_(self) -> str:
        page = html.escape(self._found.first_screen(), quote=True)
        style = f"width:100%;height:{_HEIGHT}px;border:0"
        return f'<iframe sandbox srcdoc="{page}" style="{style}" title="Diagnosis"></iframe>'

    def __str__(self) -> str:
        return self._found.words()

    def __repr__(self) -> str:
        named = ", ".join(effect.name for effect in self.effects) or "no effect"
        return f"Diagnosis({self.verdict}: {named})"


def _interval(entry: dict[str, Any]) -> Interval:
    return Interval(entry["value"], entry["low"], entry["high"])


def diagnose(
    model: Model | _Path,
    logs: Any,
    *,
    without: Sequence[str] = (),
    without_formula: bool = False,
    progress: bool | Callable[[int, int, str], None] | None = None,
) -> Diagnosis:
    """Finds the effect that a model lacks, from logs of the rig, and how much of the gap it closes.

    `logs`: one or several recordings of one rig, or names of files, which `[import]` of the model says how to read.
    `without`: effects that are left out of the search. `progress`: True for a bar, False for none, or a function of
    fits made, fits planned and the step in words; by default a bar in a notebook. Python's lock is released, and Ctrl-C
    ends it.
    """
    belief = model_of(model)
    found_in = recordings(belief, logs)
    left_out = [without] if isinstance(without, str) else list(without)
    with shown(progress) as heard:
        found = _airball.diagnose(
            belief._belief, [log._log for log in found_in], left_out, bool(without_formula), heard
        )
    flags = [flag for name in left_out for flag in ("--without", name)] + ["--without-formula"] * bool(without_formula)
    call = ["diagnose", *(log.name for log in found_in), "--config", belief.name, *flags]
    return Diagnosis(found, belief, call)
