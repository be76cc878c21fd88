"""Pictures of the page as inline SVG: estimates of the rigs, a number over time, distances between rigs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..._diagnosis import Interval
from .documents import Log
from .effects import when
from .markup import address, escaped, interval, of
from .numbers import Number

#: Width of a picture, pixels; a phone shrinks it. Margins at its left, without and with names of rigs, and at its right.
_WIDTH = 500
_LEFT, _NAMES, _RIGHT = 66, 136, 12
#: Width of a letter of a plot's words, from above: half of their size is a usual mean.
_WIDTH_OF_LETTER = 7
#: From this ratio of the greatest to the least value on, the axis of a positive number is logarithmic.
_WIDE = 8.0


@dataclass(frozen=True)
class Axis:
    """A scale from values to pixels."""

    low: float
    high: float
    start: float
    end: float
    is_log: bool = False

    def __call__(self, value: float) -> float:
        """The place of a value, at the end of the axis where it lies beyond."""
        inside = min(max(value, self.low), self.high)
        scaled = [math.log(one) if self.is_log else one for one in (inside, self.low, self.high)]
        return self.start + (self.end - self.start) * (scaled[0] - scaled[1]) / (scaled[2] - scaled[1])

    def ticks(self) -> list[float]:
        """Round values within the axis."""
        if self.is_log:
            decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
            return [m * 10.0**d for d in decades for m in (1, 2, 5) if self.low <= m * 10.0**d <= self.high]
        rough = (self.high - self.low) / 5
        size = 10 ** math.floor(math.log10(rough))
        step = next(m * size for m in (1, 2, 5, 10) if m * size >= rough)
        first = math.ceil(self.low / step)
        return [step * index for index in range(first, math.floor(self.high / step) + 1)]


def _axis(values: Sequence[float], start: float, end: float, is_log: bool = False) -> Axis:
    """An axis with a margin around all values, also where they are equal."""
    low, high = min(values), max(values)
    if is_log and low > 0 and high > _WIDE * low:
        return Axis(low / 1.1, high * 1.1, start, end, True)
    margin = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
    return Axis(low - margin, high + margin, start, end)


def _svg(height: float, words: str, parts: Sequence[str], width: float = _WIDTH, shrinks: bool = True) -> str:
    body = "\n".join(parts)
    size = f'style="width:100%;max-width:{width:.0f}px"' if shrinks else f'width="{width:.0f}" height="{height:.0f}"'
    return (
        f'<div class="scroll"><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" {size}>'
        f"<title>{escaped(words)}</title>\n{body}\n</svg></div>\n"
    )


def _line(x1: float, y1: float, x2: float, y2: float, kind: str, width: float = 1) -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{kind}" stroke-width="{width}"/>'


def _text(x: float, y: float, words: str, anchor: str = "start", kind: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{kind}">{escaped(words)}</text>'


def _band(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    width, height = max(abs(x2 - x1), 1.0), max(abs(y2 - y1), 1.0)
    return f'<rect x="{min(x1, x2):.1f}" y="{min(y1, y2):.1f}" width="{width:.1f}" height="{height:.1f}" class="{kind} band"/>'


def _label(words: str, most: int) -> str:
    return words if len(words) <= most else words[: most - 1] + "…"


def _tick(value: float) -> str:
    return f"{value:.6g}".replace("-", "−")


def forest(one: Number) -> str:
    """The rigs' own estimates and shrunken ones, about the mean of the class. The order is that of the shrunken estimate."""
    rows = sorted(one.rigs.items(), key=lambda row: row[1].shrunken.value)
    mean = one.pooled.mean_interval
    shown = [end for _, its in rows for end in _ends(its.shrunken)] + [its.own.value for _, its in rows if its.own]
    middle = one.back(one.pooled.mean)
    shown += [middle] if mean is None else [one.back(end) for end in mean]
    bottom = 22 + 22 * len(rows)
    place = _axis(shown, _NAMES + 8, _WIDTH - _RIGHT, one.is_log)
    parts = [_line(place(tick), 10, place(tick), bottom, "axis") for tick in place.ticks()]
    parts += [_text(place(tick), bottom + 16, _tick(tick), "middle") for tick in place.ticks()]
    if mean is not None:
        parts.append(_band(place(one.back(mean[0])), 10, place(one.back(mean[1])), bottom, "class"))
    parts.append(_line(place(middle), 10, place(middle), bottom, "class"))
    for row, (rig, its) in enumerate(rows):
        y = 26 + 22 * row
        parts.append(_text(_NAMES, y + 4, _label(of(rig), 18), "end", "name"))
        if its.own is not None:
            low, high = _ends(its.own)
            parts.append(_line(place(low), y - 3, place(high), y - 3, "own"))
            parts.append(f'<circle cx="{place(its.own.value):.1f}" cy="{y - 3}" r="3" class="own"/>')
        low, high = _ends(its.shrunken)
        parts.append(_line(place(low), y + 4, place(high), y + 4, "shrunken", 2))
        parts.append(f'<rect x="{place(its.shrunken.value) - 3:.1f}" y="{y + 1}" width="6" height="6" class="shrunken"/>')
    return _svg(bottom + 24, f"{one.name} of each rig", parts)


def _ends(one: Interval) -> tuple[float, float]:
    return (one.value if one.low is None else one.low, one.value if one.high is None else one.high)


def drift(
    words: str,
    points: Sequence[tuple[Log, Interval]],
    segments: Sequence[tuple[Log, Log, Interval]],
    is_log: bool,
    also: Sequence[float] = (),
) -> str:
    """A number of a rig over its logs: dots with intervals, hollow without one; segments with theirs, dashed changes.
    `also`: further values that the axis shows."""
    top, bottom = 22 if len(segments) > 1 else 8, 170
    shown = [end for _, one in points for end in _usual(one, points)] + [end for *_, one in segments for end in _ends(one)]
    y = _axis([*shown, *also], bottom, top, is_log)
    x, ticks = _over_time([log for log, _ in points])
    parts = [part for tick in y.ticks() for part in _y_tick(y(tick), _tick(tick))]
    parts += [_text(place, bottom + 18, label, "middle") for place, label in ticks]
    for first, last, value in segments:
        low, high = _ends(value)
        parts.append(_band(x(first) - 4, y(low), x(last) + 4, y(high), "shrunken"))
        parts.append(_line(x(first) - 4, y(value.value), x(last) + 4, y(value.value), "shrunken", 2))
    parts += _changes([(x(first) - 7, f"since {_label(when(first), 30)}") for first, _, _ in segments[1:]], top, bottom)
    parts += [_dot(log, one, x(log), y) for log, one in points]
    return _svg(bottom + 26, words, parts)


def _changes(changes: Sequence[tuple[float, str]], top: float, bottom: float) -> list[str]:
    """Dashed lines with their dates, from left to right. A date that would lie on the one before is left out: the table of
    changes has it."""
    parts, taken = [], 0.0
    for x, words in changes:
        parts.append(_line(x, top, x, bottom, "change"))
        # At the right edge the words end at the line.
        ends_there = x > 0.7 * _WIDTH
        left = x - _WIDTH_OF_LETTER * len(words) if ends_there else x
        if left >= taken:
            parts.append(_text(x, top - 7, words, "end" if ends_there else "start"))
            taken = left + _WIDTH_OF_LETTER * (len(words) + 1)
    return parts


def _usual(one: Interval, points: Sequence[tuple[Log, Interval]]) -> tuple[float, float]:
    """The interval of a log, for the height of the plot; its value alone where it is far wider than those of the others."""
    widths = sorted(high - low for low, high in (_ends(other) for _, other in points))
    low, high = _ends(one)
    return (low, high) if high - low <= 3 * widths[len(widths) // 2] else (one.value, one.value)


def _y_tick(y: float, label: str) -> list[str]:
    return [_line(_LEFT, y, _WIDTH - _RIGHT, y, "axis"), _text(_LEFT - 6, y + 4, label, "end")]


def _dot(log: Log, one: Interval, x: float, y: Axis) -> str:
    """A log as a dot, which is a link to its page."""
    low, high = _ends(one)
    kind = "own" if low < high else "open"
    bar = _line(x, y(low), x, y(high), "own") if low < high else ""
    dot = (
        f'{bar}<circle cx="{x:.1f}" cy="{y(one.value):.1f}" r="3.5" class="{kind}">'
        f"<title>{escaped(log.name)}: {interval(one)}</title></circle>"
    )
    return f'<a href="{escaped(address(log.name))}">{dot}</a>' if log.has_page else dot


def _over_time(logs: Sequence[Log]) -> tuple[Callable[[Log], float], list[tuple[float, str]]]:
    """Places of logs on the time axis, and labels: dates, or the number of the log where one has no date."""
    times = [log.time for log in logs if log.time is not None]
    start, end = _LEFT + 24.0, _WIDTH - _RIGHT - 24.0
    by_time = len(times) == len(logs) and times[-1] > times[0]
    place = {
        log.name: (log.time - times[0]) / (times[-1] - times[0]) if by_time and log.time else index / max(len(logs) - 1, 1)
        for index, log in enumerate(logs)
    }
    ticks: list[tuple[float, str]] = []
    for index, log in enumerate(logs):
        x = start + (end - start) * place[log.name]
        if not ticks or x - ticks[-1][0] > 90:
            ticks.append((x, log.time.strftime("%Y-%m-%d") if by_time and log.time else f"log {index + 1}"))
    return lambda log: start + (end - start) * place[log.name], ticks


def heat(order: Sequence[str], distances: Sequence[Sequence[float]]) -> str:
    """Distances between rigs, the darker the more alike."""
    size, left, top = 22, 160, 22
    most = max(max(row) for row in distances) or 1.0
    parts: list[str] = []
    for row, rig in enumerate(order):
        y = top + size * row
        parts.append(_text(left - 8, y + 15, f"{_label(of(rig), 18)}  {row + 1}", "end", "name"))
        parts.append(_text(left + size * (row + 0.5), top - 6, str(row + 1), "middle"))
        for column, other in enumerate(order):
            near = 1 - distances[row][column] / most
            words = f"{of(rig)} and {of(other)}: {distances[row][column]:.2f}"
            parts.append(
                f'<rect x="{left + size * column}" y="{y}" width="{size - 1}" height="{size - 1}" class="shrunken" '
                f'stroke="none" style="stroke:none;fill-opacity:{0.06 + 0.9 * near:.2f}"><title>{escaped(words)}</title></rect>'
            )
    side = size * len(order)
    return _svg(top + side + 6, "Distances between rigs", parts, left + side + 10, shrinks=False)
