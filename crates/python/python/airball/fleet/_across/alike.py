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
from scipy.cluster import hierarchy
from scipy.spatial.distance import pdist, squareform

Array = NDArray[np.float64]


def alike(features: Array) -> tuple[list[int], Array]:
    """The order of the rigs, and the distances between them. `features`: a row for each rig."""
    rigs = len(features)
    if rigs < 2:
        return list(range(rigs)), np.zeros((rigs, rigs))
    between = pdist(features)
    order = hierarchy.leaves_list(hierarchy.average(between))
    return [int(rig) for rig in order], squareform(between)
