"""The diagnoses of a folder across rigs and time: what a class of rigs has in common, and which rig differs, since when."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..._files import write_whole
from ..._model import _Path
from ...errors import ArgumentError
from .alike import alike
from .documents import Folder, RigOf, read
from .effects import Presence, presences
from .numbers import Number, OfRig, number
from .page import MAKER, page
from .record import SCHEMA, document

#: The mark of a file of this program stands within its first so many characters; only such a file is replaced.
_WITHIN = 2048


@dataclass(frozen=True)
class Across:
    """A class of rigs. Numbers have 90 % intervals, in the units of their names."""

    #: Folder of the reports, in which `class.html` and `class.json` are.
    out: Path
    folder: Folder
    #: Base numbers, then the numbers of effects that some rig has, by name. One that no log has with an interval is missing.
    numbers: dict[str, Number]
    #: Numbers that are missing there although a rig may have them.
    unsized: tuple[str, ...]
    #: By rig, then by effect.
    effects: dict[str, dict[str, Presence]]
    #: The rigs in an order in which those that are alike stand together, and the distances between them in that order.
    order: tuple[str, ...]
    distances: tuple[tuple[float, ...], ...]

    @property
    def page(self) -> Path:
        """The page `class.html`."""
        return self.out / "class.html"

    @property
    def rigs(self) -> tuple[str, ...]:
        """The rigs, in the order of their names."""
        return tuple(self.folder.rigs)

    @property
    def effect_names(self) -> tuple[str, ...]:
        """Effects that some log names, those of the most rigs first."""
        return tuple(dict.fromkeys(effect for its in self.effects.values() for effect in its))

    @property
    def residuals(self) -> list[tuple[str, Number, OfRig]]:
        """Each rig and number with a leave-one-out residual, the largest first."""
        rows = [(rig, one, its) for one in self.numbers.values() for rig, its in one.rigs.items()]
        found = [row for row in rows if row[2].residual is not None]
        return sorted(found, key=lambda row: -abs(row[2].residual or 0.0))

    @property
    def outliers(self) -> list[tuple[str, Number, OfRig]]:
        """Those of them that are too large to be chance."""
        return [row for row in self.residuals if row[2].is_outlier]

    @property
    def changed_numbers(self) -> list[tuple[str, Number, OfRig]]:
        """Each rig and number with a change point, in the order of the rigs."""
        return [
            (rig, one, one.rigs[rig])
            for rig in self.rigs
            for one in self.numbers.values()
            if rig in one.rigs and len(one.rigs[rig].segments) > 1
        ]

    @property
    def changed_effects(self) -> list[tuple[str, str, Presence]]:
        """Each rig and effect with a change point, in the order of the rigs."""
        return [(rig, effect, its) for rig in self.rigs for effect, its in self.effects[rig].items() if its.since is not None]

    @property
    def lone_effects(self) -> list[tuple[str, str]]:
        """Each rig and effect that acts now in no other rig, of three rigs or more that can tell."""
        telling = {rig: its for rig, its in self.effects.items() if its}
        having = {effect: [rig for rig, its in telling.items() if its[effect].is_present] for effect in self.effect_names}
        return [(rigs[0], effect) for effect, rigs in having.items() if len(rigs) == 1 and len(telling) >= 3]

    def nearest(self, rig: str) -> tuple[str, float] | None:
        """The rig that is most like it, and the distance; None for the only rig."""
        place = self.order.index(rig)
        others = [(apart, name) for name, apart in zip(self.order, self.distances[place], strict=True) if name != rig]
        return min(((name, apart) for apart, name in others), key=lambda pair: pair[1], default=None)

    def to_dict(self) -> dict[str, Any]:
        """The document `class.json` as a dict."""
        return document(self)

    def json(self) -> str:
        """The document `class.json`."""
        return json.dumps(self.to_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def across(out: _Path, rig_of: RigOf = None) -> Across:
    """Compares the diagnoses in the folder `out` across rigs and time, and writes `class.html` and `class.json` into it.

    `rig_of`: the rig of a log, by the log's name below `out`: a function, or a regular expression whose first group, or
    whole match, is the rig. By default a rig is a folder of logs. The time of a log is the date in its name; without one
    the logs of a rig have the order of their names.
    """
    target = Path(out)
    folder = read(target, rig_of)
    found = compared(target, folder)
    files = [(found.page, page(found), MAKER), (target / "class.json", found.json(), f'"schema": "{SCHEMA}"')]
    for path, _, mark in files:
        _may_replace(path, mark)
    for path, text, _ in files:
        write_whole(path, text)
    return found


def compared(out: Path, folder: Folder) -> Across:
    """The comparison, without files."""
    rigs = folder.rigs
    named = sorted({effect for logs in rigs.values() for log in logs for effect in log.effects})
    effects = {rig: presences(logs, named) for rig, logs in rigs.items()}
    # Effects of the most rigs first.
    spread = {name: sum(its[name].probability for its in effects.values() if its) for name in named}
    by_spread = sorted(named, key=lambda name: -spread[name])
    effects = {rig: {name: its[name] for name in by_spread} if its else {} for rig, its in effects.items()}
    numbers: dict[str, Number] = {}
    unsized: list[str] = []
    for name in _names(folder, by_spread):
        # A number of an effect is asked of the rigs that have the effect.
        effect = name.partition(".")[0] if "." in name else None
        having = {rig: logs for rig, logs in rigs.items() if effect is None or _has(effects[rig], effect)}
        one = number(name, having)
        if one is not None:
            numbers[name] = one
        elif having:
            unsized.append(name)
    order, apart = _alike(list(rigs), numbers, effects, by_spread)
    return Across(out, folder, numbers, tuple(unsized), effects, order, apart)


def _has(its: dict[str, Presence], effect: str) -> bool:
    return effect in its and its[effect].is_present


def _names(folder: Folder, effects: list[str]) -> list[str]:
    """Base numbers, then those of the effects in their order."""
    all_names = sorted({name for logs in folder.rigs.values() for log in logs for name in log.numbers})
    place = {effect: index for index, effect in enumerate(effects)}
    return sorted(all_names, key=lambda name: place.get(name.partition(".")[0], -1))


def _alike(
    rigs: list[str], numbers: dict[str, Number], effects: dict[str, dict[str, Presence]], named: list[str]
) -> tuple[tuple[str, ...], tuple[tuple[float, ...], ...]]:
    columns = [_deviations(one, rigs) for name, one in numbers.items() if "." not in name]
    for effect in named:
        known = [its[effect].probability for its in effects.values() if its]
        # A rig that cannot tell is as the class.
        usual = sum(known) / max(len(known), 1)
        columns.append([2 * (its[effect].probability if its else usual) for its in effects.values()])
    features = np.array(columns, dtype=float).T.reshape(len(rigs), -1)
    order, between = alike(features)
    apart = tuple(tuple(float(between[one, other]) for other in order) for one in order)
    return tuple(rigs[index] for index in order), apart


def _deviations(one: Number, rigs: list[str]) -> list[float]:
    """Shrunken estimates about the mean of the class, in spreads; 0 where the rigs do not differ."""
    spread = one.pooled.spread
    if not spread:
        return [0.0] * len(rigs)
    return [(one.forward(one.rigs[rig].shrunken.value) - one.pooled.mean) / spread for rig in rigs]


def _may_replace(path: Path, mark: str) -> None:
    if path.exists() and mark not in path.read_text(encoding="utf-8", errors="replace")[:_WITHIN]:
        raise ArgumentError(f"out: {path} exists and is no file that airball wrote; it is kept: move it away")
