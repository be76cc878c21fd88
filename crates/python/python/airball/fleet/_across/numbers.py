"""A number over rigs and time: its segments in each rig, what the class has in common, and each rig's estimate.

A rig's own estimate is the mean of its logs since the last change point, weighted by 1/(v + ω²): v of the interval of the
log, ω² the scatter from log to log that the rigs have in common. A number that is positive in all logs is a natural
logarithm in all of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.special import ndtri

from ..._diagnosis import Interval
from .documents import Log
from .pooled import UPPER, Pooled, outlying, pooled, residuals
from .segments import FEWEST, of_number, scatter

#: Half of a 90 % interval in standard errors.
_HALF = float(ndtri(UPPER))
#: Logarithms are cut off here, just below that of the largest double, 709.8: an interval of few rigs can reach beyond.
HIGHEST_LOG = 700.0


@dataclass(frozen=True)
class Segment:
    """Logs of a rig, one after the other, between which a number does not change."""

    logs: tuple[Log, ...]
    #: The mean over them with its 90 % interval.
    value: Interval


@dataclass(frozen=True)
class OfRig:
    """A number of one rig."""

    #: Logs with a value, and the segments of those with an interval.
    points: tuple[tuple[Log, Interval], ...]
    segments: tuple[Segment, ...]
    #: The rig's own estimate, as it is now; None where no log has an interval.
    own: Interval | None
    #: The shrunken estimate, and the share of it that comes from the class.
    shrunken: Interval
    from_class: float
    #: The leave-one-out residual in standard deviations; None without an own estimate, or below three rigs.
    residual: float | None
    is_outlier: bool

    @property
    def borrows(self) -> bool:
        """Whether the shrunken estimate comes more from the class than from the rig's own record."""
        return self.from_class > 0.5


@dataclass(frozen=True)
class Number:
    """A number of the class."""

    name: str
    #: Whether it is pooled as a natural logarithm.
    is_log: bool
    #: ω, the scatter from log to log, in the unit of the number or of its logarithm; None where no rig has two logs.
    scatter: float | None
    pooled: Pooled
    rigs: dict[str, OfRig]

    def back(self, value: float) -> float:
        """From the scale on which it is pooled to its own unit."""
        return math.exp(min(value, HIGHEST_LOG)) if self.is_log else value

    def forward(self, value: float) -> float:
        """From its own unit to the scale on which it is pooled."""
        return math.log(value) if self.is_log else value

    def interval(self, value: float, error: float) -> Interval:
        """An estimate with its 90 % interval, in its own unit."""
        return Interval(self.back(value), self.back(value - _HALF * error), self.back(value + _HALF * error))


_Series = list[tuple[Log, Interval]]


def number(name: str, rigs: dict[str, list[Log]]) -> Number | None:
    """The number in those of the rigs that may have it; None where no log has it with an interval."""
    points = {rig: [(log, log.numbers[name]) for log in logs if name in log.numbers] for rig, logs in rigs.items()}
    is_log = all(one.value > 0 for its in points.values() for _, one in its)
    known = {rig: [(log, one) for log, one in its if _error(one, is_log) > 0] for rig, its in points.items()}
    series = {rig: _scaled(its, is_log) for rig, its in known.items() if its}
    if not series:
        return None
    omega = scatter(list(series.values()))
    begins: dict[str, list[int]] = {}
    own: dict[str, tuple[float, float]] = {}
    for rig, (values, variances) in series.items():
        total = [variance + (omega or 0.0) for variance in variances]
        begins[rig] = of_number(values, total) if len(values) >= FEWEST else [0]
        own[rig] = _mean(values[begins[rig][-1] :], total[begins[rig][-1] :])
    common = pooled([value for value, _ in own.values()], [variance for _, variance in own.values()])
    made = Number(name, is_log, None if omega is None else math.sqrt(omega), common, {})
    left_out = dict(zip(own, residuals(*zip(*own.values(), strict=True)) or [], strict=False))
    for rig in rigs:
        segments = _segments(made, known[rig], begins[rig], omega or 0.0) if rig in own else ()
        made.rigs[rig] = _of_rig(made, points[rig], segments, own.get(rig), left_out.get(rig))
    return made


def _of_rig(
    made: Number,
    points: _Series,
    segments: tuple[Segment, ...],
    own: tuple[float, float] | None,
    residual: float | None,
) -> OfRig:
    value, variance = own or (None, 0.0)
    shrunken, error, weight = made.pooled.shrunken(value, variance)
    is_outlier = residual is not None and abs(residual) > outlying(made.pooled.rigs)
    interval = None if own is None else made.interval(own[0], math.sqrt(own[1]))
    return OfRig(tuple(points), segments, interval, made.interval(shrunken, error), 1 - weight, residual, is_outlier)


def _segments(made: Number, known: _Series, begins: list[int], omega: float) -> tuple[Segment, ...]:
    found = []
    for first, last in zip(begins, [*begins[1:], len(known)], strict=True):
        values, variances = _scaled(known[first:last], made.is_log)
        mean, variance = _mean(values, [one + omega for one in variances])
        found.append(Segment(tuple(log for log, _ in known[first:last]), made.interval(mean, math.sqrt(variance))))
    return tuple(found)


def _scaled(its: _Series, is_log: bool) -> tuple[list[float], list[float]]:
    """Values and variances on the scale on which the number is pooled."""
    values = [math.log(one.value) if is_log else one.value for _, one in its]
    return values, [_error(one, is_log) ** 2 for _, one in its]


def _error(one: Interval, is_log: bool) -> float:
    """The standard error of a value; 0 where its interval says none, as without an end or without a width."""
    if one.low is None or one.high is None:
        return 0.0
    if not is_log:
        return (one.high - one.low) / (2 * _HALF)
    if one.low > 0:
        return (math.log(one.high) - math.log(one.low)) / (2 * _HALF)
    # An interval that reaches 0 has no logarithm there: the first order of the logarithm at the value.
    return (one.high - one.low) / (2 * _HALF * one.value)


def _mean(values: list[float], variances: list[float]) -> tuple[float, float]:
    weights = [1 / variance for variance in variances]
    return sum(w * value for w, value in zip(weights, values, strict=True)) / sum(weights), 1 / sum(weights)
