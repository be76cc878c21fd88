"""The diagnoses in a folder of results: which log belongs to which rig, when it was recorded, and what was found.

Only the documents are read, `NAME.json` of the schema below; `NAME.html` is only looked for, so that no link leads nowhere.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any

from ..._diagnosis import Interval
from ...errors import ArgumentError

SCHEMA = "airball.diagnosis/2"

#: Which rig a log belongs to, by the log's name: a function, or a regular expression whose first group is the rig.
RigOf = Callable[[str], str] | str | None

#: A date in a name, with or without a time: 2026-03-01, 20260301, 2026-03-01T14:05:30, 2026-03-01_1405.
_DATE = re.compile(
    r"(?<!\d)(\d{4})(-?)(0[1-9]|1[0-2])\2(0[1-9]|[12]\d|3[01])(?:[T_ -]([01]\d|2[0-3])[:.-]?([0-5]\d)(?:[:.-]?([0-5]\d))?)?(?!\d)"
)


@dataclass(frozen=True)
class Named:
    """An effect that a log names."""

    probability: float
    #: Effects that the log does not tell from it.
    indistinguishable_from: tuple[str, ...]


@dataclass(frozen=True)
class Log:
    """A diagnosed log."""

    name: str
    rig: str
    #: When it was recorded, by its name; without a zone.
    time: datetime | None
    has_page: bool
    verdict: str
    #: Base numbers by name, numbers of effects as `effect.number`, with 90 % intervals. An end is None where it is unknown.
    numbers: dict[str, Interval]
    effects: dict[str, Named]

    @property
    def can_tell(self) -> bool:
        """Whether an effect that is not named is absent; a record that cannot answer says nothing of effects."""
        return self.verdict != "insufficient_data"


@dataclass(frozen=True)
class Folder:
    """The diagnosed logs of a folder."""

    #: By rig, in the order of time.
    rigs: dict[str, list[Log]]
    #: Rigs whose logs have the order of their names, since a name has no date.
    untimed: tuple[str, ...]
    #: Documents that cannot be read, with the reason.
    unread: tuple[tuple[str, str], ...]


def read(out: Path, rig_of: RigOf) -> Folder:
    """The documents below `out`. Files of other schemas are passed over."""
    if not out.is_dir():
        raise ArgumentError(f"out: {out} is no folder; give the folder of the reports")
    asked = _asked(rig_of)
    logs: list[Log] = []
    unread: list[tuple[str, str]] = []
    for path in sorted(out.rglob("*.json"), key=lambda path: natural(path.relative_to(out).as_posix())):
        name = path.relative_to(out).as_posix().removesuffix(".json")
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            unread.append((name, "its JSON is damaged; delete it and diagnose the log again"))
            continue
        if not isinstance(found, dict) or found.get("schema") != SCHEMA:
            continue
        try:
            logs.append(_log(name, asked(name), found, path.with_name(path.name.removesuffix(".json") + ".html").exists()))
        except (KeyError, TypeError, AttributeError) as error:
            unread.append((name, f"it is no {SCHEMA}: {type(error).__name__} {error}"))
    if not logs:
        raise ArgumentError(f"out: no diagnosis ({SCHEMA}) is in {out}; diagnose logs into it first")
    return _in_order(logs, tuple(unread))


def natural(name: str) -> list[tuple[bool, int, str]]:
    """A key that sorts names with numbers by size: log 9 before log 10."""
    parts = re.split(r"(\d+)", name)
    return [(not part.isdecimal(), int(part) if part.isdecimal() else 0, part) for part in parts if part]


def time_of(name: str) -> datetime | None:
    """The last date in the name of a log, its folders included."""
    found = None
    for year, _, month, day, hour, minute, second in _DATE.findall(name):
        try:
            found = datetime(int(year), int(month), int(day), int(hour or 0), int(minute or 0), int(second or 0))
        except ValueError:
            # As February 30.
            continue
    return found


def _asked(rig_of: RigOf) -> Callable[[str], str]:
    if rig_of is None:
        return lambda name: PurePosixPath(name).parent.as_posix()
    if isinstance(rig_of, str):
        try:
            pattern = re.compile(rig_of)
        except re.error as error:
            raise ArgumentError(f"rig_of: {rig_of!r} is no regular expression: {error}") from None

        def by_pattern(name: str) -> str:
            match = pattern.search(name)
            if match is None:
                raise ArgumentError(f"rig_of: {rig_of!r} matches no part of the log {name!r}")
            return _checked(match.group(1) if pattern.groups else match.group(), name)

        return by_pattern
    if not callable(rig_of):
        raise ArgumentError(f"rig_of: {type(rig_of).__name__} is neither a function nor a regular expression")
    return lambda name: _checked(rig_of(name), name)


def _checked(rig: Any, name: str) -> str:
    if not isinstance(rig, str) or not rig:
        raise ArgumentError(f"rig_of: it gives {rig!r} for the log {name!r}; it must give the name of a rig")
    return rig


def _log(name: str, rig: str, found: dict[str, Any], has_page: bool) -> Log:
    numbers = {key: _interval(entry) for key, entry in found.get("parameters", {}).items()}
    effects: dict[str, Named] = {}
    for one in found.get("effects", []):
        # An effect that is believed and absent is another statement than one that is present, and has no size.
        is_removed = one.get("change") == "removed"
        effect = f"{one['name']} removed" if is_removed else str(one["name"])
        effects[effect] = Named(_number(one.get("probability")) or 0.0, tuple(one.get("indistinguishable_from", [])))
        if not is_removed:
            sizes = one.get("parameters", {}).items()
            numbers.update({f"{effect}.{key}": _interval(entry) for key, entry in sizes})
    known = {key: number for key, number in numbers.items() if number is not None}
    return Log(name, rig, time_of(name), has_page, str(found.get("verdict")), known, effects)


def _interval(entry: dict[str, Any]) -> Interval | None:
    value, low, high = (_number(entry.get(key)) for key in ("value", "low", "high"))
    if value is None:
        return None
    # A value at a limit of the record is the limit, and not an estimate.
    return Interval(value, None, None) if "at_bound" in entry else Interval(value, low, high)


def _number(value: Any) -> float | None:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if is_number else None


def _in_order(logs: list[Log], unread: tuple[tuple[str, str], ...]) -> Folder:
    rigs: dict[str, list[Log]] = {rig: [] for rig in sorted({log.rig for log in logs}, key=natural)}
    for log in logs:
        rigs[log.rig].append(log)
    untimed = tuple(rig for rig, its in rigs.items() if any(log.time is None for log in its))
    for rig, its in rigs.items():
        if rig not in untimed:
            # Logs of the same time keep the order of their names.
            its.sort(key=lambda log: log.time or datetime.min)
    return Folder(rigs, untimed, unread)
