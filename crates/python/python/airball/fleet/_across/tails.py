"""Quantiles of Student's t and of chi-square for whole degrees of freedom, since NumPy has none.

Source: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 1964, 26.7.3 and 26.7.4 (t), 6.5.29 (chi-square).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import NormalDist

#: Halvings of a bracket: more than a double has digits.
_HALVINGS = 120


def root(falling: Callable[[float], float], high: float) -> float:
    """Where a function that falls over 0 … ∞ is 0, or 0 where it is not above 0 there. `high`: a first upper end."""
    if not falling(0.0) > 0:
        return 0.0
    low = 0.0
    while falling(high) > 0:
        low, high = high, 2 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if falling(middle) > 0 else (low, middle)
    return high


def normal(probability: float) -> float:
    """The quantile of the standard normal distribution."""
    return NormalDist().inv_cdf(probability)


def student(probability: float, freedom: int) -> float:
    """The quantile of Student's t, for a probability above ½."""
    return root(lambda t: (2 * probability - 1) - _student_within(t, freedom), 2.0)


def chi_square(probability: float, freedom: int) -> float:
    """The quantile of chi-square."""
    return root(lambda x: probability - _chi_square_below(x, freedom), float(freedom))


def _student_within(t: float, freedom: int) -> float:
    """The probability of −t … t."""
    angle = math.atan2(t, math.sqrt(freedom))
    sine, cosine = math.sin(angle), math.cos(angle)
    is_odd = freedom % 2
    term = cosine if is_odd else 1.0
    total = 0.0
    for step in range(3 if is_odd else 2, freedom + 1, 2):
        total += term
        term *= cosine**2 * (step - 1) / step
    return (angle + sine * total) * 2 / math.pi if is_odd else sine * total


def _chi_square_below(x: float, freedom: int) -> float:
    """The probability of 0 … x: the series of the incomplete gamma function, whose terms are all positive."""
    if x <= 0:
        return 0.0
    shape, half = 0.5 * freedom, 0.5 * x
    term = total = math.exp(shape * math.log(half) - half - math.lgamma(shape + 1))
    if total == 0.0:
        # So far out that the first term is below the smallest double.
        return 1.0 if half > shape else 0.0
    while term > 1e-17 * total:
        shape += 1
        term *= half / shape
        total += term
    return total
