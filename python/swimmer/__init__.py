"""Purcell's three-link swimmer and its robot: model, optimal gaits with certificates, height maps, calibration.

>>> import swimmer as sw
>>> purcell = sw.Swimmer.preset("purcell")
>>> purcell.A([0.5, -0.3]).shape
(3, 2)
>>> best = sw.optimize.displacement(purcell)
>>> round(best.displacement_over_length, 10)
0.10353224

Lengths are in metres, angles in radians; `70deg` is understood where a number is. What a command of the same name takes as
`--max-angle` is `max_angle` here, and what it prints with `--json` are the attributes of its result.
"""

from . import experiment, optimize, sweep
from ._commands import atlas, calibrate, certify, height_map, plan, simulate, tracks
from ._messages import Doubt
from ._swimmer import BadInput, Error, Failed, Gait, Swimmer, __version__
from .results import Atlas, Calibration, HeightMap, OptimalGait, Result, Simulation, Table, Trajectory
from .robot import Pose, Robot, Telemetry

__all__ = [
    "Atlas",
    "BadInput",
    "Calibration",
    "Doubt",
    "Error",
    "Failed",
    "Gait",
    "HeightMap",
    "OptimalGait",
    "Pose",
    "Result",
    "Robot",
    "Simulation",
    "Swimmer",
    "Table",
    "Telemetry",
    "Trajectory",
    "__version__",
    "atlas",
    "calibrate",
    "certify",
    "experiment",
    "height_map",
    "optimize",
    "plan",
    "simulate",
    "sweep",
    "tracks",
]
