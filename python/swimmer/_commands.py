"""Functions of the package itself, one for each command of the same name."""

import os
from collections.abc import Sequence
from typing import Literal

from . import _swimmer
from ._messages import Text, warn
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
    width: Literal[85, 170] | None = None,
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
        With True, also forecast the cycle as the robot plays it: ``played``.
    period : float, optional
        Duration of a cycle [s], 30 unless given.
    knots, pulse_step : int, optional
        Knots of the robot's table, and step of its timer [ns]; with `played`.
    picture : path, optional
        New file: snapshots along the way (.svg, .png, .pdf), or one cycle in motion (.gif).
    width : {85, 170}, optional
        Width of the snapshots in print [mm]: one column of a journal, or both; 170 unless given.
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
        If a value or a file cannot be used.

    Examples
    --------
    >>> import swimmer as sw
    >>> swum = sw.simulate("purcell", sw.Gait.circle(1.1), cycles=2)
    >>> swum.trajectory.pose.shape
    (1001, 3)
    """
    document, (cycle, u, phi, pose), notes = _swimmer.simulate(
        swimmer,
        gait,
        {
            "cycles": cycles,
            "played": played,
            "period": period,
            "knots": knots,
            "pulse_step": pulse_step,
            "picture": picture,
            "width": width,
            "passive": passive,
            "stiffness": stiffness,
            "relaxation": relaxation,
            "output": output,
        },
    )
    warn(notes, stacklevel=3)
    return Simulation(document, Trajectory(cycle, u, phi, pose))


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
        If a value or a file cannot be used, or neither names an objective.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.certify("purcell", sw.optimize.displacement("purcell").gait).verdict
    'pass'
    """
    document, notes = _swimmer.certify(
        swimmer,
        gait,
        {
            "objective": objective,
            "fixed_period": fixed_period,
            "max_angle": max_angle,
            "min_angle": min_angle,
            "sector": sector,
            "no_overlap": no_overlap,
            "clearance": clearance,
            "playable": playable,
        },
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
    gait: str | Sequence[str] = (),
    steps: int | None = None,
) -> Atlas:
    """Finds every local optimum, with and without the paper's symmetries, each with its certificate.

    Random closed curves are optimised, and duplicates by the swimmer's symmetries are merged. The same seed gives the same atlas.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    objective : {"displacement", "efficiency", "speed"}
        Quantity to maximise.
    max_rate : float, str or a pair of them, optional
        Largest rate of the servos [rad/s], or as ``200deg``: one for both, or one for each. Speed needs it; for the other objectives it
        adds the speed of each gait in its shortest period.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].
    starts, seed : int, optional
        Number of random starts, and their seed.
    continue_ : str, optional
        Parameter along which gaits are followed, with its range: ``max-angle=2.8..1.2``, ``chi=2..1.5``, ``sphere=0.07..0`` or
        ``link-ratio=1..2``. For displacement, or with `gait`, no atlas is computed.
    gait : {"small", "large"} or a sequence of them, optional
        Efficiency gaits to follow.
    steps : int, optional
        Number of equal steps of the parameter, 20 unless given.

    Returns
    -------
    Atlas
        ``optima``, a table of `OptimalGait`, the best first; ``continuation`` with `continue_`.

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If there is no gait to follow.

    Examples
    --------
    >>> import swimmer as sw
    >>> atlas = sw.atlas("purcell", objective="displacement", max_angle=1.2, starts=2)
    >>> round(atlas.optima[0].displacement_over_length, 6)
    0.078224
    >>> table = atlas.optima.to_pandas()
    """
    document, gaits, made_for, notes = _swimmer.atlas(
        swimmer,
        {
            "objective": objective,
            "max_rate": max_rate,
            "max_angle": max_angle,
            "no_overlap": no_overlap,
            "clearance": clearance,
            "playable": playable,
            "starts": starts,
            "seed": seed,
            "continue_": continue_,
            "gait": gait or None,
            "steps": steps,
        },
    )
    warn(notes, stacklevel=3)
    optima = zip(document.get("optima", ()), gaits, strict=True)
    return Atlas({**document, "optima": [OptimalGait(optimum, one, made_for) for optimum, one in optima]})


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
        If a value or a file cannot be used, or a gait leaves the map.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.height_map("purcell", max_angle=2.5).height.shape
    (201, 201)
    """
    gaits = [gait] if isinstance(gait, Gait | str | os.PathLike) else list(gait)
    document, phi, height, notes = _swimmer.height_map(swimmer, gaits, {"row": row, "max_angle": max_angle})
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
    fit_also: str | Sequence[str] = (),
    advise: bool = False,
    scale: float | None = None,
    rate: float | None = None,
    axes: str | None = None,
    likelihood: float | None = None,
    output: Text | None = None,
) -> Calibration:
    """Fits the radius of the sphere and chi to a campaign, or evaluates the cycles of one recording.

    Parameters
    ----------
    file : path
        A campaign (.toml), or a recording of cameras.
    gait : Gait, str or path, optional
        Gait of a single recording.
    period : float, optional
        Duration of a cycle of a single recording [s].
    swimmer : Swimmer, str or path, optional
        Swimmer of a single recording.
    front, back : str, optional
        Reflectors of a single recording: names, pairs of columns, or places ``X,Y`` in the first frame [m].
    body : str, optional
        Rigid body that is the middle link, instead of reflectors.
    level : float, optional
        Level of the intervals.
    fit_also : str or sequence of str, optional
        Nuisance parameters to fit in addition: ``gain``, ``gains``, ``offsets``, ``deadband``, ``ct``, ``marker``, ``scale``, …
    advise : bool, optional
        With True, rank further runs by how much each would narrow the intervals: ``advice``.
    scale : float, optional
        Metres per unit of a single recording.
    rate : float, optional
        Frames per second of a single recording.
    axes : str, optional
        Axes of a single recording that are the tank's x and y: ``x,-y`` for an image, ``z,x`` for Y up.
    likelihood : float, optional
        Least likelihood of a point that counts (DeepLabCut), 0.9 unless given.
    output : path, optional
        New folder for report, fitted swimmer and tables of a campaign.

    Returns
    -------
    Calibration
        ``runs``, a table of the recordings; for a campaign also ``sphere_radius_m``, ``chi``, ``intervals``, ``verdict`` and ``reasons``.

    Raises
    ------
    BadInput
        If a value or a file cannot be used, or the runs do not determine the parameters.
    Failed
        If the fit does not converge.

    Examples
    --------
    >>> import swimmer as sw
    >>> fit = sw.calibrate("campaign.toml")  # doctest: +SKIP
    >>> fit.chi, fit.intervals.chi  # doctest: +SKIP
    (3.596, (3.591, 3.601))
    >>> fit.runs.to_pandas()[["gait", "x_m", "x_sd_m"]]  # doctest: +SKIP
    """
    document, fitted, notes = _swimmer.calibrate(
        file,
        gait,
        swimmer,
        {
            "period": period,
            "front": front,
            "back": back,
            "body": body,
            "level": level,
            "fit_also": fit_also or None,
            "advise": advise,
            "scale": scale,
            "rate": rate,
            "axes": axes,
            "likelihood": likelihood,
            "output": output,
        },
    )
    warn(notes, stacklevel=3)
    return Calibration(document, fitted)


def tracks(
    file: Text,
    *,
    scale: float | None = None,
    rate: float | None = None,
    axes: str | None = None,
    likelihood: float | None = None,
) -> Result:
    """Reports what a recording holds, without a fit.

    Parameters
    ----------
    file : path
        A recording of cameras.
    scale : float, optional
        Metres per unit of the recording.
    rate : float, optional
        Frames per second.
    axes : str, optional
        Axes of the recording that are the tank's x and y: ``x,-y`` for an image, ``z,x`` for Y up.
    likelihood : float, optional
        Least likelihood of a point that counts (DeepLabCut), 0.9 unless given.

    Returns
    -------
    Result
        ``format``, ``rate_hz``, ``unit``, ``frames``, and ``points``, a table.

    Raises
    ------
    BadInput
        If a value or the file cannot be used.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.tracks("circle-070.csv").format  # doctest: +SKIP
    'table'
    """
    document, notes = _swimmer.tracks(
        file,
        {"scale": scale, "rate": rate, "axes": axes, "likelihood": likelihood},
    )
    warn(notes, stacklevel=3)
    return Result(document)


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
    """Plans a sequence of gaits that joins one pose to another.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    to : sequence of float or str
        Target (x, y) [m] or (x, y, heading) [m, rad], or as ``0.2,0.1,90deg``.
    from_ : sequence of float or str, optional
        Start, the origin along x unless given.
    tank : pair of float or str, optional
        Length and width of the tank [m], or as ``1.6x1.2``.
    margin : float, optional
        Distance that the swimmer keeps from the walls [m].
    gaits : path, optional
        Folder that `optimize.steer` wrote; the gaits are computed unless it is given.
    shape : pair of float or str, optional
        Shape at which computed gaits join [rad].
    max_rate : float, str or a pair of them, optional
        Largest rate of the servos [rad/s], or as ``200deg``: one for both, or one for each.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].
    output : path, optional
        New playlist, which `swimmer robot play` plays.

    Returns
    -------
    Result
        ``steps``, a table of gaits and cycles; ``duration_s``, ``reached``, ``off_m``, …

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If no plan reaches the target.

    Examples
    --------
    >>> import swimmer as sw
    >>> planned = sw.plan("robot", to=(0.2, 0.1), max_rate="200deg", max_angle="60deg", no_overlap=True)  # doctest: +SKIP
    >>> planned.steps.to_pandas()  # doctest: +SKIP
    """
    document, notes = _swimmer.plan(
        swimmer,
        {
            "to": to,
            "from_": from_,
            "tank": tank,
            "margin": margin,
            "gaits": gaits,
            "shape": shape,
            "max_rate": max_rate,
            "max_angle": max_angle,
            "no_overlap": no_overlap,
            "clearance": clearance,
            "playable": playable,
            "output": output,
        },
    )
    warn(notes, stacklevel=3)
    return Result(document)
