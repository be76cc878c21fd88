"""The document `class.json`: the comparison as lists and numbers.

Numbers have ten significant digits, so that the last bits of a processor's logarithm do not show.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..._diagnosis import Interval
from .documents import Log
from .effects import Presence
from .numbers import Number, OfRig

if TYPE_CHECKING:
    from .compare import Across

SCHEMA = "airball.class/1"

_Ends = tuple[float, float] | None


def document(found: Across) -> dict[str, Any]:
    """The document, in the order of the page."""
    return {
        "schema": SCHEMA,
        "rigs": [_rig(found, rig, logs) for rig, logs in found.folder.rigs.items()],
        "outliers": [
            {"rig": rig, "number": one.name, "residual": _digits(its.residual)} for rig, one, its in found.outliers
        ],
        "effects": [
            {"name": effect, "rigs": [_presence(rig, its[effect]) for rig, its in found.effects.items() if its]}
            for effect in found.effect_names
        ],
        "numbers": [_number(one) for one in found.numbers.values()],
        "alike": {
            "order": list(found.order),
            "distances": [[_digits(apart) for apart in row] for row in found.distances],
        },
        "unread": [{"log": log, "reason": reason} for log, reason in found.folder.unread],
    }


def _rig(found: Across, rig: str, logs: list[Log]) -> dict[str, Any]:
    nearest = found.nearest(rig)
    return {
        "name": rig,
        "order": "names" if rig in found.folder.untimed else "time",
        "logs": [
            {"name": log.name, "time": None if log.time is None else log.time.isoformat(), "verdict": log.verdict}
            for log in logs
        ],
        "nearest": None if nearest is None else {"rig": nearest[0], "distance": _digits(nearest[1])},
    }


def _presence(rig: str, its: Presence) -> dict[str, Any]:
    return {
        "rig": rig,
        "probability": _digits(its.probability),
        "indistinguishable_from": list(its.indistinguishable_from),
        "named": its.named,
        "logs": len(its.series),
        "changes": [its.logs[begin].name for begin in its.begins[1:]],
    }


def _number(one: Number) -> dict[str, Any]:
    pooled = one.pooled
    return {
        "name": one.name,
        # On the scale "log" the standard error, the spread and the scatter are those of the natural logarithm.
        "scale": "log" if one.is_log else "linear",
        "rigs_with_estimate": pooled.rigs,
        "mean": {"value": _digits(one.back(pooled.mean)), **_back(one, pooled.mean_interval)},
        "standard_error": _digits(pooled.mean_error),
        "spread": {"value": _digits(pooled.spread), **_ends(pooled.spread_interval)},
        "i_squared": _digits(pooled.i_squared),
        "new_rig": _back(one, pooled.new_rig),
        "scatter": _digits(one.scatter),
        "rigs": [_of_rig(rig, its) for rig, its in one.rigs.items()],
    }


def _of_rig(rig: str, its: OfRig) -> dict[str, Any]:
    return {
        "rig": rig,
        "own": None if its.own is None else _interval(its.own),
        "shrunken": _interval(its.shrunken),
        "from_class": _digits(its.from_class),
        "borrows": its.borrows,
        "residual": _digits(its.residual),
        "is_outlier": its.is_outlier,
        "segments": [
            {"first": one.logs[0].name, "last": one.logs[-1].name, "logs": len(one.logs), **_interval(one.value)}
            for one in its.segments
        ],
    }


def _interval(one: Interval) -> dict[str, float | None]:
    return {"value": _digits(one.value), "low": _digits(one.low), "high": _digits(one.high)}


def _back(one: Number, ends: _Ends) -> dict[str, float | None]:
    """An interval in the unit of the number."""
    return _ends(None if ends is None else (one.back(ends[0]), one.back(ends[1])))


def _ends(ends: _Ends) -> dict[str, float | None]:
    low, high = ends or (None, None)
    return {"low": _digits(low), "high": _digits(high)}


def _digits(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.10g}")
