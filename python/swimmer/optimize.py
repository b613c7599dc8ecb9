"""Optimal gaits, each with its certificate."""

from collections.abc import Sequence
from typing import Literal, TypeAlias

from . import _swimmer
from ._messages import Text, warn
from ._swimmer import Swimmer
from .results import OptimalGait, Result

__all__ = ["displacement", "efficiency", "passive", "sideways", "speed", "steer", "turning"]

Angle: TypeAlias = float | str
"""Number of radians, or a text with its unit: ``70deg``."""


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
    """Finds the simple gait of most net displacement per cycle.

    The gaits have the paper's symmetries; if the side links differ, they are any simple closed curves. Without `sign` the farthest gait
    of either sense is returned, run so that it swims forwards. If it is ``clockwise``, its arcs are those of the counter-clockwise
    quarter.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    min_angle : float or str, optional
        Least angle of the leading joint of each quarter.
    sector, no_overlap, playable : bool, optional
        Each quarter stays in its sector; links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].
    sign : {"+", "-"}, optional
        Sign of the displacement of the counter-clockwise gait: its local optimum, as in the paper.
    robust : Calibration or path, optional
        A fit, or its ``fit.json``, for whose intervals the gait is designed.
    gain : pair of float, optional
        Least and largest ratio of actual to commanded angle for which the gait is designed.
    over : {"worst", "mean"}, optional
        Statistic that a robust design maximises, the worst case unless given.
    max_rate : float or str, optional
        Largest rate of the servos [rad/s], or as ``200deg``; with `period`. The gait is then timed for it.
    period : float, optional
        Duration of a cycle with servos of that rate [s].

    Returns
    -------
    OptimalGait
        ``displacement_over_length``, ``displacement_m``, ``start_angle_rad``, ``arcs``, ``certificate``, … and the ``gait``.

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If there is no optimum within the bounds.

    Examples
    --------
    >>> import swimmer as sw
    >>> farthest = sw.optimize.displacement("purcell")
    >>> round(farthest.displacement_over_length, 10)
    0.10353224
    >>> farthest.certificate.verdict
    'pass'
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
    """Finds a gait of most Lighthill efficiency.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    gait : {"small", "large"}, optional
        Local optimum: the large one swims backwards and starts above 2 rad.
    method : {"auto", "fourier", "collocation", "shooting"}, optional
        Method of the initial guess.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].
    robust, gain, over
        Uncertainty to design for, as in `displacement`.
    order : int, optional
        Order of the Fourier series of a robust gait, 6 unless given.
    max_rate, period
        Timing under a limit on the rate of the servos, as in `displacement`.

    Returns
    -------
    OptimalGait
        ``efficiency``, ``displacement_over_length``, ``residual``, ``power_variation``, ``certificate``, … and the ``gait``.

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If the search does not converge, or the branch of optima ends before the bound.

    Examples
    --------
    >>> import swimmer as sw
    >>> round(sw.optimize.efficiency("purcell").efficiency, 9)
    0.012364155
    """
    return _optimal("efficiency", swimmer, locals())


def turning(
    swimmer: Swimmer | Text,
    *,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
) -> OptimalGait:
    """Finds the simple closed gait of most net rotation per cycle.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].

    Returns
    -------
    OptimalGait
        ``rotation_rad``, ``regions``, ``arcs``, ``certificate``, … and the ``gait``.

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If the search finds no gait.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.optimize.turning("purcell", max_angle=1.0).rotation_rad > 0
    True
    """
    return _optimal("turning", swimmer, locals())


def sideways(
    swimmer: Swimmer | Text,
    *,
    max_angle: Angle | None = None,
    no_overlap: bool = False,
    clearance: float | None = None,
    playable: bool = False,
) -> OptimalGait:
    """Finds the gait of most displacement across the heading at its start, without net rotation.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].

    Returns
    -------
    OptimalGait
        ``lateral_over_length``, ``rotation_rad``, ``loops``, ``certificate``, … and the ``gait``.

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If the search finds no gait.

    Examples
    --------
    >>> import swimmer as sw
    >>> abs(sw.optimize.sideways("purcell", max_angle=1.0).rotation_rad) < 1e-8
    True
    """
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
    width: Literal[85, 170] | None = None,
) -> OptimalGait:
    """Finds the fastest gait of servos with limited rates: most net displacement per time, without net rotation.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    max_rate : float, str or a pair of them, optional
        Largest rate of the servos [rad/s], or as ``200deg``: one for both, or one for each. It may be left out with ``playable=True``.
    heading : {"any", "forward", "sideways"}, optional
        Direction of the displacement, relative to the mean heading.
    period : float, optional
        Period of the farthest gait [s], in place of the fastest gait of any period.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].
    robust, gain, over
        Uncertainty to design for, as in `displacement`.
    front : path, optional
        New file (.svg, .png, .pdf or .csv): displacement per cycle against speed, of the farthest gaits in shorter and longer periods.
    width : {85, 170}, optional
        Width of that figure in print [mm]: one column of a journal, or both; 170 unless given.

    Returns
    -------
    OptimalGait
        ``speed_over_length_per_s``, ``period_s``, ``heading_rad``, ``corners``, ``certificate``, … and the ``gait``.

    Raises
    ------
    BadInput
        If a value cannot be used, or the rates are missing.
    Failed
        If no gait is certified.

    Examples
    --------
    >>> import swimmer as sw
    >>> fastest = sw.optimize.speed("robot", max_rate="200deg", max_angle="60deg", no_overlap=True)
    >>> fastest.certificate.verdict
    'pass'
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
    """Finds the fastest gaits forward, backward, to either side and round, which join at one shape.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    max_rate : float, str or a pair of them, optional
        Largest rate of the servos [rad/s], or as ``200deg``: one for both, or one for each. It may be left out with ``playable=True``.
    max_angle : float or str, optional
        Largest joint angle [rad], or as ``70deg``.
    no_overlap, playable : bool, optional
        Links may not cross; the bounds of the robot.
    clearance : float, optional
        Least distance of the side links [m].
    shape : pair of float or str, optional
        Shape at which the gaits join [rad], or as ``80deg,32deg``; the best one unless given.
    output : path, optional
        New folder for the gait files, which `plan` takes.

    Returns
    -------
    Result
        ``shape_rad``, ``shapes``, and ``gaits``, a table of six `OptimalGait` with ``name``, ``x_m``, ``y_m`` and ``rotation_rad``.

    Raises
    ------
    BadInput
        If a value cannot be used, or the rates are missing.
    Failed
        If a gait cannot be certified.

    Examples
    --------
    >>> import swimmer as sw
    >>> steering = sw.optimize.steer("robot", playable=True, shape=(0, 0))  # doctest: +SKIP
    >>> [gait.name for gait in steering.gaits]  # doctest: +SKIP
    ['forward', 'backward', 'left', 'right', 'turn-left', 'turn-right']
    """
    document, gaits, made_for, notes = _swimmer.steer_gaits(swimmer, _keywords(locals()))
    warn(notes, stacklevel=3)
    steering = zip(document["gaits"], gaits, strict=True)
    return Result({**document, "gaits": [OptimalGait(described, gait, made_for) for described, gait in steering]})


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
) -> OptimalGait:
    """Finds the best waveform of one servo, while the other joint has a spring.

    Missing values come from the tables ``[passive]`` and ``[servo]`` of the swimmer file.

    Parameters
    ----------
    swimmer : Swimmer, str or path
        A swimmer, the name of a preset, or a swimmer file.
    passive : {"front", "back"}, optional
        The joint with the spring.
    stiffness : float, optional
        Stiffness of the spring [N m/rad].
    relaxation : float or "free", optional
        Relaxation time of the joint on the straight swimmer [s], in place of a stiffness; with ``free`` the best spring is found.
    most : {"displacement", "speed", "efficiency"}, optional
        Quantity to maximise, the displacement unless given.
    period : float, optional
        Duration of a cycle [s]; the best one is found unless it is given.
    max_angle, max_rate : float or str, optional
        Largest angle [rad] and rate [rad/s] of the driven joint, or as ``70deg``.
    harmonics : int, optional
        Number of odd harmonics of the waveform, 3 unless given.
    output : path, optional
        New gait file: the waveform with the response of the passive joint.

    Returns
    -------
    OptimalGait
        ``waveform``, ``period_s``, ``displacement_m``, ``gain_over_sine``, ``conditions``, … and the ``gait``.

    Raises
    ------
    BadInput
        If a value cannot be used or is missing.
    Failed
        If the search does not converge.

    Examples
    --------
    >>> import swimmer as sw
    >>> best = sw.optimize.passive("elastic-tail", max_angle=1.0)
    >>> best.gain_over_sine >= 0
    True
    """
    document, gait, made_for, notes = _swimmer.passive_waveform(swimmer, _keywords(locals()))
    warn(notes, stacklevel=3)
    return OptimalGait(document, gait, made_for)


def _keywords(given: dict[str, object]) -> dict[str, object]:
    """Keywords of a call, from its local names."""
    return {key: value for key, value in given.items() if key != "swimmer"}


def _optimal(objective: str, swimmer: Swimmer | Text, given: dict[str, object]) -> OptimalGait:
    keywords = _keywords(given)
    fit = keywords.get("robust")
    if isinstance(fit, Result):
        keywords["robust"] = fit.to_dict()
    document, gait, made_for, notes = _swimmer.optimize(objective, swimmer, keywords)
    warn(notes, stacklevel=4)
    return OptimalGait(document, gait, made_for)
