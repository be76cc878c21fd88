"""A simulator of a ball-in-pipe rig, and a diagnosis of the gap between simulator and rig.

>>> import airball as ab
>>> rig = ab.Model.example()
>>> stuck = rig.with_effects(dead_zone={"lower_percent": -0.3, "upper_percent": 0.3})
>>> log = ab.simulate(stuck, seed=1)
>>> found = ab.diagnose(rig, log)
>>> found.effects[0].name
'dead_zone'
"""

from . import design, errors
from ._airball import VERSION as __version__
from ._diagnosis import Diagnosis, Effect, Interval, Ladder, diagnose
from ._innovations import Innovations
from ._linear import StateSpace
from ._model import Model
from ._recording import Experiment, Recording, Simulation, experiments, read, simulate
from ._results import Result, identify, propose, replay
from .errors import ArgumentError, ConfigError, Error, LogError, MissingLibraryError, RecordingError, UsageError

__all__ = [
    "ArgumentError",
    "ConfigError",
    "Diagnosis",
    "Effect",
    "Error",
    "Experiment",
    "Innovations",
    "Interval",
    "Ladder",
    "LogError",
    "MissingLibraryError",
    "Model",
    "Recording",
    "RecordingError",
    "Result",
    "Simulation",
    "StateSpace",
    "UsageError",
    "__version__",
    "design",
    "diagnose",
    "errors",
    "experiments",
    "identify",
    "propose",
    "read",
    "replay",
    "simulate",
]
