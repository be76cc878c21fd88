"""Random effects over rigs: what the rigs of a class have in common in a number, and what each rig gains from it.

```text
yᵢ = μ + bᵢ + eᵢ      yᵢ the estimate of rig i, eᵢ ~ N(0, vᵢ) its error, bᵢ ~ N(0, τ²) the difference of the rig
wᵢ = 1/(vᵢ + τ²)      μ = Σ wᵢ yᵢ / Σ wᵢ, with variance 1/Σ wᵢ
Q(τ²) = Σ wᵢ (yᵢ − μ)² = k − 1                     τ² of Paule and Mandel, 0 where Q(0) is less; k rigs
Q(τ²) = quantiles of χ² with k − 1                 interval of τ²
I² = τ²/(τ² + s²), s² = (k − 1) Σ 1/vᵢ / ((Σ 1/vᵢ)² − Σ 1/vᵢ²)
θᵢ = B yᵢ + (1 − B) μ, B = τ²/(τ² + vᵢ)            shrunken estimate, with variance B vᵢ + (1 − B)²/Σ wᵢ
rᵢ = (yᵢ − μ₍ᵢ₎) / √(vᵢ + τ²₍ᵢ₎ + 1/Σ w₍ᵢ₎)   leave-one-out residual: μ and τ² of the other rigs
```

The interval of μ has Student's t with k − 1, by Hartung and Knapp. Their factor of the variance is Q(τ²)/(k − 1): 1 with
this τ², and not let below 1 where τ² is 0. Assumes normal differences; two outliers can hide each other.

Sources: Paule and Mandel, J. Res. NBS 87, 1982; DerSimonian and Laird, Controlled Clinical Trials 7, 1986; Knapp and
Hartung, Stat. Med. 22, 2003; Viechtbauer, Stat. Med. 26, 2007 (interval of τ²); Higgins and Thompson, Stat. Med. 21,
2002 (I²); Higgins, Thompson and Spiegelhalter, JRSS A 172, 2009 (a new rig); Raudenbush and Bryk, J. Educ. Stat. 10, 1985
(shrunken estimates); Viechtbauer and Cheung, Res. Synth. Meth. 1, 2010 (residuals).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scipy.special import chdtri, stdtrit

from .solve import root

Array = NDArray[np.float64]

#: Intervals are of 90 %, as in a diagnosis: the probability below their upper end.
UPPER = 0.95
#: Chance that any rig of a class without outliers is called one.
ALPHA_OF_OUTLIERS = 0.05


@dataclass(frozen=True)
class Pooled:
    """A number over rigs, in its own unit or as a natural logarithm."""

    #: How many rigs have an estimate.
    rigs: int
    #: μ with its standard error and its 90 % interval; the interval is None for one rig.
    mean: float
    mean_error: float
    mean_interval: tuple[float, float] | None
    #: τ with its 90 % interval; None for one rig. There is no interval where the rigs are more equal than chance allows.
    spread: float | None
    spread_interval: tuple[float, float] | None
    #: The share of the differences between the estimates that is not their own error.
    i_squared: float | None
    #: Where a new rig of the class is expected with 90 %; None below three rigs.
    new_rig: tuple[float, float] | None

    def shrunken(self, value: float | None, variance: float) -> tuple[float, float, float]:
        """θ of a rig, its standard error, and the weight B of the rig's own estimate. Without a value B is 0."""
        if self.spread is None:
            # A class of one rig adds nothing to it.
            return (self.mean, self.mean_error, 0.0) if value is None else (value, math.sqrt(variance), 1.0)
        between = self.spread**2
        if value is None:
            return self.mean, math.hypot(self.spread, self.mean_error), 0.0
        own = between / (between + variance)
        error = math.sqrt(own * variance + (1 - own) ** 2 * self.mean_error**2)
        return own * value + (1 - own) * self.mean, error, own


def pooled(values: Sequence[float], variances: Sequence[float]) -> Pooled:
    """The class of at least one estimate."""
    y, v = np.asarray(values, dtype=float), np.asarray(variances, dtype=float)
    rigs = len(y)
    if rigs == 1:
        return Pooled(1, float(y[0]), math.sqrt(v[0]), None, None, None, None, None)
    between = between_rigs(y, v)
    mean, variance = _mean(y, v + between)
    error = math.sqrt(variance)
    within = float(stdtrit(rigs - 1, UPPER)) * error
    new = float(stdtrit(rigs - 2, UPPER)) * math.sqrt(between + variance) if rigs > 2 else None
    low, high = (math.sqrt(_solved(y, v, chdtri(rigs - 1, 1 - level))) for level in (UPPER, 1 - UPPER))
    return Pooled(
        rigs,
        mean,
        error,
        (mean - within, mean + within),
        math.sqrt(between),
        (low, high) if high > 0 else None,
        i_squared(v, between),
        None if new is None else (mean - new, mean + new),
    )


def between_rigs(values: Array, variances: Array) -> float:
    """τ² of Paule and Mandel, for two rigs or more."""
    return _solved(values, variances, len(values) - 1)


def i_squared(variances: Array, between: float) -> float:
    """I² of a τ², for two rigs or more."""
    weights = 1 / variances
    typical = (len(weights) - 1) * weights.sum() / (weights.sum() ** 2 - (weights**2).sum())
    return float(between / (between + typical))


def residuals(values: Sequence[float], variances: Sequence[float]) -> list[float] | None:
    """The leave-one-out residual of each rig; None below three rigs."""
    y, v = np.asarray(values, dtype=float), np.asarray(variances, dtype=float)
    if len(y) < 3:
        return None
    found = []
    for rig in range(len(y)):
        others, errors = np.delete(y, rig), np.delete(v, rig)
        between = between_rigs(others, errors)
        mean, variance = _mean(others, errors + between)
        found.append(float((y[rig] - mean) / math.sqrt(v[rig] + between + variance)))
    return found


def outlying(rigs: int) -> float:
    """The size from which a residual is an outlier: Student's t with k − 2, as τ² comes from the k − 1 other rigs, by
    Bonferroni over the k rigs. For three rigs or more."""
    return float(stdtrit(rigs - 2, 1 - ALPHA_OF_OUTLIERS / (2 * rigs)))


def _mean(values: Array, variances: Array) -> tuple[float, float]:
    weights = 1 / variances
    return float((weights * values).sum() / weights.sum()), float(1 / weights.sum())


def _solved(values: Array, variances: Array, target: float) -> float:
    """The τ² at which Q is the target, 0 where it is less at 0. Q falls with τ²."""

    def above(between: float) -> float:
        weights = 1 / (variances + between)
        mean = (weights * values).sum() / weights.sum()
        return float((weights * (values - mean) ** 2).sum()) - target

    return root(above, float(variances.max()))
