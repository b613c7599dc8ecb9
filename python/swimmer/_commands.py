"""The commands that are functions of the package itself."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from ._run import Run, Text
from ._swimmer import Gait, Swimmer
from .optimize import Angle
from .results import Atlas, Calibration, HeightMap, OptimalGait, Result, Simulation, Trajectory


def simulate(
    swimmer: Swimmer | Text,
    gait: Gait | Text,
    *,
    cycles: int = 1,
    played: bool = False,
    period: float | None = None,
    knots: int | None = None,
    pulse_step: int | None = None,
    picture: Text | None = None,
    passive: Literal["front", "back"] | None = None,
    stiffness: float | None = None,
    relaxation: float | None = None,
    output: Text | None = None,
) -> Simulation:
    """Swims a gait in the model: `displacement_over_length`, `rotation_rad`, `efficiency`, … of the first cycle, and the `trajectory`.

    With `played` also what the robot will make of it, at `period` seconds a cycle. `picture` is a new file: snapshots along the way
    as .svg or .png, one cycle in motion as .gif.

    A `passive` joint has a spring of this `stiffness` [N m/rad] or `relaxation` time [s] and follows the other one, which the gait
    or `sine:AMPLITUDE` drives. `output` is a new gait file of its limit cycle.
    """
    with Run("simulate") as run:
        run.swimmer(swimmer)
        run.gait(gait)
        run.options(
            {
                "cycles": cycles,
                "played": played,
                "period": period,
                "knots": knots,
                "pulse_step": pulse_step,
                "picture": picture,
                "passive": passive,
                "stiffness": stiffness,
                "relaxation": relaxation,
                "output": output,
            }
        )
        table = run.place("trajectory.csv")
        run.words(f"--trajectory={table}")
        document = run.document()
        rows = np.loadtxt(table, delimiter=",", skiprows=1, ndmin=2)
    trajectory = Trajectory(rows[:, 0].astype(np.int64), rows[:, 1], rows[:, 2:4], rows[:, 4:7])
    return Simulation(document, trajectory)


def certify(
    swimmer: Swimmer | Text,
    gait: Gait | Text,
    *,
    objective: Literal["displacement", "efficiency", "turning", "sideways", "speed"] | None = None,
    fixed_period: bool = False,
    max_angle: Angle | None = None,
    min_angle: Angle | None = None,
    sector: bool = False,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
) -> Result:
    """Checks a gait against the necessary conditions: `pass_`, `verdict` and `checks`, each with its number.

    Objective and bounds are those of the gait's file unless given. A gait for speed has to be the fastest of any period unless its file
    states a period; with `fixed_period` it has to be the farthest in its own. A gait that fails is a result, not an error.
    """
    with Run("certify") as run:
        run.swimmer(swimmer)
        run.gait(gait)
        run.options(
            {
                "objective": objective,
                "fixed_period": fixed_period,
                "max_angle": max_angle,
                "min_angle": min_angle,
                "sector": sector,
                "no_overlap": no_overlap,
                "clearance": clearance,
                "playable": playable,
            }
        )
        return Result(run.document())


def atlas(
    swimmer: Swimmer | Text,
    *,
    objective: Literal["displacement", "efficiency", "speed"],
    max_rate: Angle | Sequence[Angle] | None = None,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
    starts: int = 200,
    seed: int = 1,
    continue_: str | None = None,
    gait: Sequence[Gait | Text] = (),
    steps: int | None = None,
) -> Atlas:
    """Every local optimum that seeded starts find, with and without the paper's symmetries, each certified: `optima`, best first.

    `max_rate`, an angle a second, one for both servos or one each, is needed for speed and tells the speed of the others.
    `continue_="max-angle=2.8..1.2"` follows them as a parameter changes; `gait` names those to follow.
    """
    with Run("atlas") as run:
        run.swimmer(swimmer)
        run.options(
            {
                "objective": objective,
                "max_rate": max_rate,
                "max_angle": max_angle,
                "no_overlap": no_overlap,
                "clearance": clearance,
                "playable": playable,
                "starts": starts,
                "seed": seed,
                "continue": continue_,
                "steps": steps,
            }
        )
        for one in gait:
            run.gait(one)
        folder = run.place("atlas")
        run.words(f"--output={folder}")
        document = run.document()
        document.pop("picture", None)
        made_for = swimmer if isinstance(swimmer, Swimmer) else Swimmer.load(swimmer)
        document["optima"] = [
            OptimalGait(optimum, Gait.load(run.found(optimum["gait"])), made_for)
            for optimum in document["optima"]
        ]
    return Atlas(document)


def height_map(
    swimmer: Swimmer | Text,
    *,
    row: Literal["x", "y", "theta"] = "x",
    max_angle: Angle = 2.8,
    gait: Gait | Text | Sequence[Gait | Text] = (),
) -> HeightMap:
    """The height function in minimum-perturbation coordinates over |φᵢ| ≤ max_angle: `zero_on_diagonal`, `zero_curves`, … and H."""
    gaits = [gait] if isinstance(gait, Gait | str | os.PathLike) else gait
    with Run("height-map") as run:
        run.swimmer(swimmer)
        run.options({"row": row, "max_angle": max_angle})
        for one in gaits:
            run.gait(one)
        table = run.place("heights.csv")
        run.words(f"--output={table}")
        document = run.document()
        rows = np.loadtxt(table, delimiter=",", skiprows=1)
    phi = np.unique(rows[:, 0])
    order = np.lexsort((rows[:, 1], rows[:, 0]))
    return HeightMap(document, phi, rows[order, 2].reshape(len(phi), len(phi)))


def calibrate(
    file: Text,
    *,
    gait: Gait | Text | None = None,
    period: float | None = None,
    swimmer: Swimmer | Text | None = None,
    front: str | None = None,
    back: str | None = None,
    body: str | None = None,
    level: float = 0.95,
    fit_also: Sequence[str] = (),
    advise: bool = False,
    scale: float | None = None,
    rate: float | None = None,
    axes: str | None = None,
    likelihood: float | None = None,
    output: Text | None = None,
) -> Calibration:
    """Cycles of a campaign or of one recording, and for a campaign the fit: `sphere_radius_m`, `chi`, `intervals`, `verdict`, …

    A campaign is a TOML file. A single recording needs `gait`, `period` and `swimmer` here, and either the reflectors `front` and
    `back` or the rigid `body` that is the middle link. `output` is a folder for the report.
    """
    with Run("calibrate", os.fspath(file)) as run:
        if gait is not None:
            run.gait(gait)
        if swimmer is not None:
            run.swimmer(swimmer)
        run.options(
            {
                "period": period,
                "front": front,
                "back": back,
                "body": body,
                "level": level,
                "fit_also": ",".join(fit_also) or None,
                "advise": advise,
                "scale": scale,
                "rate": rate,
                "axes": axes,
                "likelihood": likelihood,
            }
        )
        if Path(file).suffix != ".toml":
            run.options({"output": output})
            return Calibration(run.document(), None)
        folder = Path(output) if output is not None else run.place("fit")
        run.words(f"--output={folder}")
        document = run.document()
        return Calibration(document, Swimmer.load(folder / "fitted.toml"))


def tracks(
    file: Text,
    *,
    scale: float | None = None,
    rate: float | None = None,
    axes: str | None = None,
    likelihood: float | None = None,
) -> Result:
    """What a tracking file holds, without fitting: `format`, `rate_hz`, `unit`, `frames`, `points`."""
    with Run("tracks", os.fspath(file)) as run:
        run.options({"scale": scale, "rate": rate, "axes": axes, "likelihood": likelihood})
        return Result(run.document())


def plan(
    swimmer: Swimmer | Text,
    *,
    to: Sequence[float] | str,
    from_: Sequence[float] | str | None = None,
    tank: Sequence[float] | str | None = None,
    margin: float | None = None,
    gaits: Text | None = None,
    shape: Sequence[float] | str | None = None,
    max_rate: Angle | Sequence[Angle] | None = None,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
    output: Text | None = None,
) -> Result:
    """Strings the gaits of `optimize.steer` together to a target: `steps`, `duration_s`, `reached`, `off_m`, …

    `to` and `from_` are (x, y) or (x, y, heading), `tank` is (length, width), all in metres and radians. `gaits` is a folder that
    `optimize.steer` wrote; `output` a new playlist, which `swimmer robot play --playlist` plays.
    """
    with Run("plan") as run:
        run.swimmer(swimmer)
        run.options(
            {
                "to": _joined(to, ","),
                "from_": _joined(from_, ","),
                "tank": _joined(tank, "x"),
                "margin": margin,
                "gaits": gaits,
                "shape": _joined(shape, ","),
                "max_rate": max_rate,
                "max_angle": max_angle,
                "no_overlap": no_overlap,
                "clearance": clearance,
                "playable": playable,
                "output": output,
            }
        )
        return Result(run.document())


def _joined(numbers: Sequence[float] | str | None, by: str) -> str | None:
    if numbers is None or isinstance(numbers, str):
        return numbers
    return by.join(repr(float(number)) for number in numbers)
