"""Where a function that falls over 0 … ∞ is 0, by Brent's method."""

from __future__ import annotations

import sys
from collections.abc import Callable

from scipy.optimize import brentq

#: More halvings than lie between the largest double and the smallest, 2098.
_MOST_STEPS = 2100


def root(falling: Callable[[float], float], high: float) -> float:
    """The root, or 0 where the function is not above 0 there. `high`: a first upper end."""
    if not falling(0.0) > 0:
        return 0.0
    low = 0.0
    while falling(high) > 0:
        low, high = high, 2 * high
    # To the last digit, however small the root is.
    return float(brentq(falling, low, high, xtol=sys.float_info.min, rtol=4 * sys.float_info.epsilon, maxiter=_MOST_STEPS))
