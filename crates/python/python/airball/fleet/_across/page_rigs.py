"""Each rig on the page: its numbers over time, and its logs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._diagnosis import Interval
from .documents import Log
from .drawn import drift
from .effects import Presence
from .markup import count, escaped, link, of, percent, table
from .numbers import Number, OfRig
from .segments import FEWEST

if TYPE_CHECKING:
    from .compare import Across

#: Plots up to which numbers without a change are drawn too.
_MOST_PLOTS = 300


def rig_by_rig(found: Across) -> str:
    plots = sum(len(its.segments) > 0 and _is_long(its) for one in found.numbers.values() for its in one.rigs.values())
    everything = plots <= _MOST_PLOTS
    words = (
        f"Rigs with {FEWEST} logs or more have plots over time: dots are logs with their intervals, hollow ones have none; "
        "blue is the mean between changes; a dashed line is a change. Each dot leads to the page of its log."
    )
    text = f'<p class="faint">{words}</p>\n'
    if not everything:
        text += f"<p>Of {plots} plots only those with a change are drawn.</p>\n"
    return text + "".join(_rig(found, rig, index, everything) for index, rig in enumerate(found.rigs))


def _is_long(its: OfRig) -> bool:
    return sum(len(segment.logs) for segment in its.segments) >= FEWEST


def _rig(found: Across, rig: str, index: int, everything: bool) -> str:
    logs = found.folder.rigs[rig]
    changed = "".join(_drawn_effect(effect, its) for one, effect, its in found.changed_effects if one == rig)
    steady = ""
    for one in found.numbers.values():
        of_rig = one.rigs.get(rig)
        if of_rig is None or not _is_long(of_rig):
            continue
        if len(of_rig.segments) > 1:
            changed += _drawn_number(one, of_rig)
        elif everything:
            steady += _drawn_number(one, of_rig)
    if steady:
        steady = f"<details><summary>Numbers without a change</summary>\n{steady}</details>\n"
    rows = [(link(log), escaped(log.verdict.replace("_", " ")), _named(log)) for log in logs]
    listed = table(f"Logs of {escaped(of(rig))}", ["log", "verdict", "effects"], rows)
    listed = f"<details><summary>{count(len(logs), 'log')}</summary>\n{listed}</details>\n"
    return f'<h3 id="rig-{index}">{escaped(of(rig))}</h3>\n{changed}{steady}{listed}'


def _named(log: Log) -> str:
    return ", ".join(f"{escaped(effect)} {percent(its.probability)}" for effect, its in log.effects.items())


def _drawn_number(one: Number, its: OfRig) -> str:
    segments = [(segment.logs[0], segment.logs[-1], segment.value) for segment in its.segments]
    return f"<p><code>{escaped(one.name)}</code></p>\n" + drift(one.name, its.points, segments, one.is_log)


def _drawn_effect(effect: str, its: Presence) -> str:
    points = [(log, Interval(100 * one, None, None)) for log, one in zip(its.logs, its.series, strict=True)]
    segments = []
    for first, last in zip(its.begins, [*its.begins[1:], len(points)], strict=True):
        mean = 100 * sum(its.series[first:last]) / (last - first)
        segments.append((its.logs[first], its.logs[last - 1], Interval(mean, None, None)))
    words = f"probability of {effect}, %"
    return f"<p>Probability of <code>{escaped(effect)}</code>, %</p>\n" + drift(words, points, segments, False, (0.0, 100.0))
