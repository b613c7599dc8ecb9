"""Optimal gaits, each with its certificate: `swimmer optimize …`."""

import json
from collections.abc import Sequence
from typing import Literal, TypeAlias

from ._run import Run, Text
from ._swimmer import Gait, Swimmer
from .results import OptimalGait, Result

__all__ = ["displacement", "efficiency", "passive", "sideways", "speed", "steer", "turning"]

Angle: TypeAlias = float | str
"""Radians, or a text with its unit: `70deg`."""


def displacement(
    swimmer: Swimmer | Text,
    *,
    max_angle: Angle | None = None,
    min_angle: Angle | None = None,
    sector: bool = False,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
    sign: Literal["+", "-"] | None = None,
    robust: Result | Text | None = None,
    gain: Sequence[float] | None = None,
    over: Literal["worst", "mean"] | None = None,
    max_rate: Angle | None = None,
    period: float | None = None,
) -> OptimalGait:
    """The simple gait of most net displacement of the doubly symmetric class: `displacement_over_length`, `start_angle_rad`, `arcs`, …

    Without `sign` the farthest of either sense, oriented so that it swims forwards; if it is `clockwise`, its arcs are those of the
    counter-clockwise quarter. With `sign` the local optimum whose counter-clockwise run has that sign of X, as in the paper.
    `clearance` in metres, `max_rate` an angle a second, `period` in seconds; `robust` a `Calibration` or its fit.json, `gain`
    the least and the most that servos turn over what they are told.
    """
    return _optimal("displacement", swimmer, locals())


def efficiency(
    swimmer: Swimmer | Text,
    *,
    gait: Literal["small", "large"] = "small",
    method: Literal["auto", "fourier", "collocation", "shooting"] = "auto",
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
    robust: Result | Text | None = None,
    gain: Sequence[float] | None = None,
    over: Literal["worst", "mean"] | None = None,
    order: int | None = None,
    max_rate: Angle | None = None,
    period: float | None = None,
) -> OptimalGait:
    """The gait of most Lighthill efficiency of the doubly symmetric class, the small or the large one: `efficiency`, `residual`, …"""
    return _optimal("efficiency", swimmer, locals())


def turning(
    swimmer: Swimmer | Text,
    *,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
) -> OptimalGait:
    """The simple closed gait of most net rotation: `rotation_rad`, `regions`, …"""
    return _optimal("turning", swimmer, locals())


def sideways(
    swimmer: Swimmer | Text,
    *,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
) -> OptimalGait:
    """The gait of most displacement across the heading at its start, without net rotation: `lateral_over_length`, …"""
    return _optimal("sideways", swimmer, locals())


def speed(
    swimmer: Swimmer | Text,
    *,
    max_rate: Angle | Sequence[Angle] | None = None,
    heading: Literal["any", "forward", "sideways"] = "any",
    period: float | None = None,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
    robust: Result | Text | None = None,
    gain: Sequence[float] | None = None,
    over: Literal["worst", "mean"] | None = None,
    front: Text | None = None,
) -> OptimalGait:
    """The fastest gait under servos' rates (an angle a second, one for both or one each): `speed_over_length_per_s`, `period_s`, …

    `front` is a new file (.svg or .csv): displacement of a cycle against speed, over the period.
    """
    return _optimal("speed", swimmer, locals())


def steer(
    swimmer: Swimmer | Text,
    *,
    max_rate: Angle | Sequence[Angle] | None = None,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
    shape: Sequence[float] | str | None = None,
    output: Text | None = None,
) -> Result:
    """The fastest gaits forward, to either side and round that join at one shape: `shape_rad`, `gaits`, …

    `output` is a new folder for their files, which `plan` takes.
    """
    with Run("optimize", "steer") as run:
        run.swimmer(swimmer)
        run.options(
            {
                "max_rate": max_rate,
                "max_angle": max_angle,
                "no_overlap": no_overlap,
                "clearance": clearance,
                "playable": playable,
                "shape": shape if shape is None or isinstance(shape, str) else ",".join(map(repr, map(float, shape))),
                "output": output,
            }
        )
        return Result(run.document())


def passive(
    swimmer: Swimmer | Text,
    *,
    passive: Literal["front", "back"] | None = None,
    stiffness: float | None = None,
    relaxation: float | Literal["free"] | None = None,
    most: Literal["displacement", "speed", "efficiency"] | None = None,
    period: float | None = None,
    max_angle: Angle | None = None,
    max_rate: Angle | None = None,
    harmonics: int | None = None,
    output: Text | None = None,
) -> Result:
    """The best waveform of one servo while the `passive` joint has a spring: `waveform`, `period_s`, `gain_over_sine`, …

    `output` is a new gait file.
    """
    options = {key: value for key, value in locals().items() if key != "swimmer"}
    with Run("optimize", "passive") as run:
        run.swimmer(swimmer)
        run.options(options)
        return Result(run.document())


def _optimal(objective: str, swimmer: Swimmer | Text, told: dict[str, object]) -> OptimalGait:
    options = {key: value for key, value in told.items() if key != "swimmer"}
    with Run("optimize", objective) as run:
        run.swimmer(swimmer)
        fit = options.get("robust")
        if isinstance(fit, Result):
            path = run.place("fit.json")
            path.write_text(json.dumps(fit.to_dict()))
            options["robust"] = path
        run.options(options)
        best = run.place("best.gait")
        run.words(f"--output={best}")
        document = run.document(stacklevel=4)
        made_for = swimmer if isinstance(swimmer, Swimmer) else Swimmer.load(swimmer)
        return OptimalGait(document, Gait.load(best), made_for)
