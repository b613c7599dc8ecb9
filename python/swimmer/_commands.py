"""The commands that are functions of the package itself."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from . import _swimmer
from ._run import Run, Text, warn
from ._swimmer import BadInput, Gait, Swimmer
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
    """Swims a gait in the model and returns the results of the first cycle.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    gait : Gait, str or path
        A gait, ``circle:70deg``, or a gait file; with a passive joint also ``sine:AMPLITUDE``.
    cycles : int, optional
        Number of cycles of the trajectory and of the picture.
    played : bool, optional
        Also forecast the cycle as the robot plays it: ``played``.
    period : float, optional
        Duration of a cycle [s], 30 unless given.
    knots, pulse_step : int, optional
        Knots of the robot's table, and step of its timer [ns]; with `played`.
    picture : path, optional
        New file: snapshots along the way (.svg, .png, .pdf), or one cycle in motion (.gif).
    passive : {"front", "back"}, optional
        Joint with a spring in place of a servo, which follows the other one.
    stiffness, relaxation : float, optional
        Stiffness of the spring [N m/rad], or its relaxation time [s].
    output : path, optional
        New gait file of the limit cycle of a passive joint.

    Returns
    -------
    Simulation
        ``displacement_over_length``, ``rotation_rad``, ``efficiency``, … and the ``trajectory``.

    Raises
    ------
    BadInput
        If an argument or a file cannot be used.

    Examples
    --------
    >>> import swimmer as sw
    >>> swum = sw.simulate("purcell", sw.Gait.circle(1.1), cycles=2)
    >>> swum.trajectory.pose.shape
    (1001, 3)
    """
    drawn = [picture, passive, stiffness, relaxation, output]
    if any(option is not None for option in drawn) or (isinstance(gait, str) and gait.startswith("sine:")):
        return _simulate_by_command(swimmer, gait, cycles, played, period, knots, pulse_step, picture, passive, stiffness, relaxation, output)
    if (knots is not None or pulse_step is not None) and not played:
        raise BadInput("knots and pulse_step belong to a forecast on the robot: add played=True")
    document, (cycle, u, phi, pose), notes = _swimmer.simulate(swimmer, gait, cycles, period, played, knots, pulse_step)
    warn(notes, stacklevel=3)
    return Simulation(document, Trajectory(cycle, u, phi, pose))


def _simulate_by_command(
    swimmer: Swimmer | Text,
    gait: Gait | Text,
    cycles: int,
    played: bool,
    period: float | None,
    knots: int | None,
    pulse_step: int | None,
    picture: Text | None,
    passive: str | None,
    stiffness: float | None,
    relaxation: float | None,
    output: Text | None,
) -> Simulation:
    """Pictures and passive joints, which the command draws and reads."""
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
        document = run.document(stacklevel=4)
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
    """Checks a gait against the necessary conditions of an optimum.

    A gait that fails is a result, not an error.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    gait : Gait, str or path
        A gait, ``circle:70deg``, or a gait file.
    objective : str, optional
        Objective, that of the gait file unless given. A gait for speed has to be the fastest of any period unless its file states one.
    fixed_period : bool, optional
        For speed: the gait has to be the farthest in its own period.
    max_angle, min_angle : float or str, optional
        Bounds of the joints [rad], or as ``70deg``; naming one bound replaces all of the file's.
    sector, no_overlap, playable : bool, optional
        Each quarter stays in its sector; links may not cross; the robot's own bounds.
    clearance : float, optional
        Least distance of the side links [m].

    Returns
    -------
    Result
        ``pass_``, ``verdict`` and ``checks``, each with its value and tolerance.

    Raises
    ------
    BadInput
        If an argument or a file cannot be used, or neither names an objective.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.certify("purcell", sw.optimize.displacement("purcell").gait).verdict
    'pass'
    """
    document, notes = _swimmer.certify(
        swimmer, gait, objective, fixed_period, max_angle, min_angle, sector, no_overlap, clearance, playable
    )
    warn(notes, stacklevel=3)
    certificate = Result(document)
    if not certificate.pass_:
        failed = sum(not check["pass"] for check in certificate.checks)
        doubt = f"{certificate.verdict}: {failed} of {len(certificate.checks)} conditions do not hold"
        warn([f"note: the gait is no certified optimum ({doubt})"], stacklevel=3)
    return certificate


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
    """Maps the height function in minimum-perturbation coordinates over |φᵢ| ≤ max_angle.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    row : {"x", "y", "theta"}, optional
        Component of the displacement: along the swimmer, across it, or rotation.
    max_angle : float or str, optional
        Half width of the map [rad], or as ``160deg``.
    gait : Gait, str, path or a sequence of them, optional
        Gaits whose enclosed height is compared with what they swim: ``gaits``.

    Returns
    -------
    HeightMap
        ``zero_on_diagonal``, ``zero_curves``, … with the arrays ``phi`` and ``height``.

    Raises
    ------
    BadInput
        If an argument or a file cannot be used, or a gait leaves the map.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.height_map("purcell", max_angle=2.5).height.shape
    (201, 201)
    """
    gaits = [gait] if isinstance(gait, Gait | str | os.PathLike) else list(gait)
    document, phi, height, notes = _swimmer.height_map(swimmer, row, max_angle, gaits)
    warn(notes, stacklevel=3)
    return HeightMap(document, phi, height)


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
