"""Change points of a number over the logs of a rig, and of whether an effect is named.

```text
minimise over the change points   Σ over segments of cost(segment) + β · (number of change points)
cost = Σ (y − ȳ)² / v               a number y with the known variance v, ȳ weighted by 1/v
cost = −2 Σ ln P(named or not)      the effect of a log, P the share of the segment
β = z², z the normal quantile of 1 − α / (2 (n − 1)), n logs
```

The minimum is exact, by optimal partitioning. β is the test of one change at n − 1 places (Bonferroni): a rig that does
not change gets a change point in about a share α of the cases. The 2 ln n of Schwarz's criterion gives one to every
fifth such rig with 5 to 10 logs. `ruptures` is not used: it does not take the variance of each value.

Assumes steps. A steady drift becomes several steps in one direction.

Sources: Jackson et al., "An algorithm for optimal partitioning of data on an interval", 2005; Killick, Fearnhead and
Eckley, "Optimal detection of changepoints with a linear computational cost", 2012, whose pruning so few logs do not need.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scipy.special import ndtri

from .solve import root

Array = NDArray[np.float64]

#: Fewest logs in which changes are sought.
FEWEST = 5
#: α of a number. Numbers always scatter, and a class has many of them.
ALPHA_OF_NUMBERS = 0.01
#: α of an effect. The test is too bold with few logs: with this α at most 5 % of the rigs in which an effect is named now
#: and then get a change point, by simulation from 5 to 50 logs. Most effects are named in all logs or in none.
ALPHA_OF_EFFECTS = 0.025
#: Median of chi-square with one degree of freedom.
_MEDIAN = 0.454936423119572


def of_number(values: Sequence[float], variances: Sequence[float]) -> list[int]:
    """Where the segments of a constant number begin; the first is 0."""
    weights = 1 / np.asarray(variances, dtype=float)
    # About the mean, so that the difference of squares below keeps its digits.
    centred = np.asarray(values, dtype=float) - np.average(values, weights=weights)
    sums = [_sums(weights), _sums(weights * centred), _sums(weights * centred**2)]

    def cost(starts: Any, end: int) -> Array:
        weight, first, second = (total[end] - total[starts] for total in sums)
        return np.asarray(second - first**2 / weight)

    return _partition(cost, len(centred), _penalty(len(centred), ALPHA_OF_NUMBERS))


def of_effect(named: Sequence[bool]) -> list[int]:
    """Where the segments begin in which an effect is named about equally often; the first is 0."""
    sums = _sums(np.asarray(named, dtype=float))

    def cost(starts: Any, end: int) -> Array:
        logs, yes = end - starts, sums[end] - sums[starts]
        no = logs - yes
        return np.asarray(-2 * (_times_log(yes, yes / logs) + _times_log(no, no / logs)))

    return _partition(cost, len(named), _penalty(len(named), ALPHA_OF_EFFECTS))


def scatter(series: Sequence[tuple[Sequence[float], Sequence[float]]]) -> float | None:
    """ω², the variance from log to log of a rig beyond the intervals, which the rigs of a class have in common.

    From the median of the squared differences of successive logs over their variances: a few change points do not move
    it. Of m differences the one at (m + √m)/2 is taken, which is one standard error of a median above the middle: from
    few logs ω² is rather too large, so that chance makes no change point. None where no rig has two logs.
    """
    pairs = [
        (later - earlier, before + after)
        for values, variances in series
        for earlier, later, before, after in zip(values, values[1:], variances, variances[1:], strict=False)
    ]
    if not pairs:
        return None
    squared, known = np.asarray([[step**2, variance] for step, variance in pairs]).T
    share = min(1.0, 0.5 + 0.5 / np.sqrt(len(pairs)))
    return root(lambda omega: float(np.quantile(squared / (known + 2 * omega), share)) - _MEDIAN, float(known.max()))


def _penalty(logs: int, alpha: float) -> float:
    return float(ndtri(1 - alpha / (2 * (logs - 1)))) ** 2


def _partition(cost: Callable[[Any, int], Array], logs: int, penalty: float) -> list[int]:
    """The beginnings of the segments of the least total. `best[end]` is the least cost of the logs before `end`."""
    best, begins = np.full(logs + 1, -penalty), np.zeros(logs + 1, dtype=int)
    for end in range(1, logs + 1):
        totals = best[:end] + cost(np.arange(end), end) + penalty
        begins[end] = np.argmin(totals)
        best[end] = totals[begins[end]]
    segments, end = [], logs
    while end > 0:
        end = int(begins[end])
        segments.append(end)
    return segments[::-1]


def _sums(values: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(values)])


def _times_log(count: Array, share: Array) -> Array:
    """count · ln(share), and 0 · ln 0 = 0."""
    return count * np.log(np.where(count > 0, share, 1.0))
