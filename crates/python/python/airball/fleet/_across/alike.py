"""Which rigs are alike: distances between rigs, and an order in which rigs that are alike stand together.

```text
d² = Σ over base numbers ((θ − θ')/τ)² + Σ over effects (2 (P − P'))²
```

θ is the shrunken estimate of a number and τ its spread between rigs, so that a rig whose record says little is near the
class and not far from it by chance. An effect that one rig certainly has and another lacks is a distance of 2: two standard
deviations of a coin toss. The order is that of average linkage (Sokal and Michener, 1958).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def distances(features: Array) -> Array:
    """Euclidean distances between the rows of `features`, a row for each rig."""
    squares = np.zeros((len(features), len(features)))
    # Column by column, since all differences of many rigs at once do not fit into memory.
    for column in features.T:
        squares += (column[:, None] - column[None, :]) ** 2
    return np.asarray(np.sqrt(squares))


def linkage(between: Array) -> tuple[list[int], list[float]]:
    """The order of the rigs by average linkage, and the heights of the joins in the order in which they are made."""
    rigs = len(between)
    groups: dict[int, list[int]] = {rig: [rig] for rig in range(rigs)}
    mean = np.where(np.eye(rigs, dtype=bool), np.inf, between)
    heights: list[float] = []
    while len(groups) > 1:
        # The first of equals, so that the order is the same everywhere.
        one, other = sorted(int(index) for index in np.unravel_index(np.argmin(mean), mean.shape))
        heights.append(float(mean[one, other]))
        sizes = len(groups[one]), len(groups[other])
        row = (sizes[0] * mean[one] + sizes[1] * mean[other]) / sum(sizes)
        row[one] = np.inf
        mean[one], mean[:, one] = row, row
        mean[other], mean[:, other] = np.inf, np.inf
        groups[one] += groups.pop(other)
    return next(iter(groups.values())), heights
