"""Pictures by matplotlib, in the colours of the report."""

from __future__ import annotations

from typing import Any

import numpy as np

_INK = {"recorded": "#222222", "believed": "#c4572e", "mended": "#1f77b4", "duty": "#555555"}


def diagnosis(picture: dict[str, Any], axes: Any = None) -> Any:
    """Position with free runs, duty, and missing force, over time."""
    import matplotlib.pyplot as plt

    if axes is None:
        _, axes = plt.subplots(3, 1, sharex=True, figsize=(9, 7), layout="constrained")
    position, duty, force = axes
    t = picture["time_s"]
    seen = ~np.isnan(picture["position_mm"])
    position.plot(t[seen], picture["position_mm"][seen], color=_INK["recorded"], lw=1, label="recorded")
    for name in ("believed", "mended"):
        runs = picture[name]
        starts = np.flatnonzero(np.diff(runs["run"])) + 1
        # A gap between two runs: each begins anew at a reading.
        times, values = (np.insert(column, starts, np.nan) for column in (t[runs["row"]], runs["position_mm"]))
        position.plot(times, values, color=_INK[name], lw=1, label=f"{name}, free runs of 10 s")
    position.set_ylabel("position, mm")
    position.legend(loc="upper right", fontsize="small")
    duty.step(t, picture["duty_percent"], where="post", color=_INK["duty"], lw=0.8)
    duty.set_ylabel("duty, percent")
    middle, spread = picture["force_mm_per_s2"], picture["force_sigma_mm_per_s2"]
    times = picture["force_time_s"]
    force.fill_between(times, middle - spread, middle + spread, color=_INK["believed"], alpha=0.25, lw=0)
    force.plot(times, middle, color=_INK["believed"], lw=0.8)
    force.axhline(0.0, color="#999999", lw=0.6)
    force.set_ylabel("residual force, mm/s²")
    force.set_xlabel("time, s")
    return position.figure
