"""The page `class.html`: outliers first, then changes, effects, numbers, rigs that are alike, and the logs of each rig."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .effects import Presence
from .markup import MAKER, count, dated, escaped, four, framed, interval, link, of, percent, rig_link, table
from .numbers import Number, OfRig
from .page_class import alike, effects, numbers
from .page_rigs import rig_by_rig
from .segments import FEWEST

if TYPE_CHECKING:
    from .compare import Across

__all__ = ["MAKER", "page"]

#: Rows of the largest residuals, where none is an outlier.
_LARGEST = 5


def page(found: Across) -> str:
    """The page as HTML."""
    rigs, logs = found.rigs, sum(map(len, found.folder.rigs.values()))
    odd = {rig for rig, _, _ in found.outliers}
    changed = {rig for rig, *_ in [*found.changed_numbers, *found.changed_effects]}
    answer = f"{count(len(rigs), 'rig')} in {count(logs, 'log')}: "
    answer += f"{count(len(odd), 'rig')} unlike the class, {count(len(changed), 'rig')} with a change"
    sections = [
        ("outliers", "Outliers", _outliers(found)),
        ("changes", "Changes over time", _changes(found)),
        ("effects", "Which effect acts in which rig", effects(found)),
        ("numbers", "Numbers of the class", numbers(found)),
        ("alike", "Rigs that are alike", alike(found)),
        ("rigs", "Rig by rig", rig_by_rig(found)),
    ]
    return framed(answer, _first(found), sections)


def _first(found: Across) -> str:
    folder = found.folder
    words = ["Intervals are of 90 %. The name or the date of a log leads to its own page."]
    if folder.untimed:
        which = "all rigs" if len(folder.untimed) == len(found.rigs) else ", ".join(map(of, folder.untimed))
        words.append(f"Names of logs have no date, so their order is that of the names, numbers by size: {which}.")
    if found.rigs == (".",):
        words.append("No log is in a folder of its own, so all are taken as logs of one rig; rig_of (--rig) tells rigs apart.")
    elif len(found.rigs) == 1:
        words.append("With one rig there is no class to compare it with.")
    text = "".join(f"<p>{escaped(line)}</p>\n" for line in words)
    if folder.unread:
        rows = [(escaped(log), escaped(reason)) for log, reason in folder.unread]
        text += table("Documents that cannot be read", ["log", "reason"], rows)
    return text


def _outliers(found: Across) -> str:
    alone = "".join(
        f"<li>{rig_link(rig, found.rigs)} is the only rig with <code>{escaped(effect)}</code>: "
        f"{percent(found.effects[rig][effect].probability)}, {escaped(found.effects[rig][effect].words())}</li>\n"
        for rig, effect in found.lone_effects
    )
    return _outlying(found) + (f"<ul>\n{alone}</ul>\n" if alone else "")


def _outlying(found: Across) -> str:
    rows = found.outliers
    if not found.residuals:
        return "<p>Fewer than three rigs have an estimate of the same number: no rig can be called unlike the others.</p>\n"
    words = (
        "A rig is compared with what the other rigs let expect. The residual is the difference over its standard deviation. "
        "An outlier is one so large that in a class without outliers no rig has it in 95 % of the cases, for each number. "
        "Two rigs that differ alike can hide each other."
    )
    if max(one.pooled.rigs for one in found.numbers.values()) < 5:
        words += " With three or four rigs hardly any difference is large enough."
    if not rows:
        words = "No rig is an outlier; the largest residuals are these. " + words
        rows = found.residuals[:_LARGEST]
    heads = ["rig", "number", "its own estimate", "mean of the class", "residual", "newest log"]
    cells = [
        (
            rig_link(rig, found.rigs),
            f"<code>{escaped(one.name)}</code>",
            interval(its.own),
            four(one.back(one.pooled.mean)),
            f"{its.residual or 0.0:+.1f}".replace("-", "−"),
            link(its.segments[-1].logs[-1]),
        )
        for rig, one, its in rows
    ]
    return f"<p>{words}</p>\n" + table("Rigs by the size of the residual", heads, cells)


def _changes(found: Across) -> str:
    longest = max((len(logs) for logs in found.folder.rigs.values()), default=0)
    if longest < FEWEST:
        return f"<p>Changes are sought in rigs with {FEWEST} logs or more; no rig has as many.</p>\n"
    rows = [_effect_row(found, *row) for row in found.changed_effects]
    rows += [row for changed in found.changed_numbers for row in _number_rows(found, *changed)]
    words = (
        f"Of rigs with {FEWEST} logs or more. A number of a rig that does not change gets a change point in about 1 % of the "
        "cases, an effect in at most 5 %. A steady drift shows as several changes in one direction. "
        "A change to a single log is an odd log until another one confirms it."
    )
    if not rows:
        return f"<p>No change was found. {words}</p>\n"
    heads = ["rig", "what", "since", "before", "after", "logs to the next change"]
    return f"<p>{words} Plots are with each rig, below.</p>\n" + table("Changes", heads, rows)


def _effect_row(found: Across, rig: str, effect: str, its: Presence) -> tuple[str, ...]:
    begin, end = its.begins[-1], its.begins[-2]
    before = its.series[end:begin]
    what = f"<code>{escaped(effect)}</code> {'is named less often' if not its.has_risen else 'sets in' if its.is_present else 'is named more often'}"
    after = its.series[begin:]
    return (
        rig_link(rig, found.rigs),
        what,
        dated(its.logs[begin]),
        percent(sum(before) / len(before)),
        percent(its.probability),
        str(len(after)),
    )


def _number_rows(found: Across, rig: str, one: Number, its: OfRig) -> list[tuple[str, ...]]:
    pairs = zip(its.segments, its.segments[1:], strict=False)
    return [
        (
            rig_link(rig, found.rigs),
            f"<code>{escaped(one.name)}</code>",
            dated(after.logs[0]),
            interval(before.value),
            interval(after.value),
            str(len(after.logs)),
        )
        for before, after in pairs
    ]
