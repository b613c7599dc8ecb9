"""Experiments without an operator: gaits × repeats in randomised blocks, measured against the prediction.

A spec (TOML) names swimmer, tank, start pose and gaits. `plan` computes the gaits and fixes the order of the trials, `run` plays those
that are left, `status` reports the progress, and `report` compares the gaits.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _swimmer
from ._messages import Text, warn
from ._swimmer import Gait
from .optimize import Angle
from .results import Result
from .robot import settings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Comparison", "Plan", "PlannedGait", "plan", "report", "run", "status"]


class PlannedGait(Result):
    """A gait of an experiment with its prediction.

    Examples
    --------
    >>> import swimmer as sw
    >>> planned = sw.experiment.plan("missing.toml")  # doctest: +SKIP
    >>> sw.simulate("robot", planned.gaits[0].gait)  # doctest: +SKIP
    """

    __slots__ = ("_gait",)
    _gait: Gait

    def __init__(self, document: Mapping[str, Any], gait: Gait) -> None:
        super().__init__(document)
        object.__setattr__(self, "_gait", gait)

    @property
    def gait(self) -> Gait:
        """The `Gait`, to simulate, certify or play."""
        return self._gait

    def plot(self, ax: "Axes | None" = None, **line: Any) -> "Axes":
        """Draws the gait in the plane of joint angles (matplotlib).

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in; a new figure unless given.
        **line
            Style, for `Axes.plot`.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            If matplotlib is missing.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.experiment.plan("missing.toml").gaits[0].plot()  # doctest: +SKIP
        """
        from . import _plot

        return _plot.gait(self._gait, ax, **line)


class Plan(Result):
    """A planned experiment: its ``gaits`` are a table of `PlannedGait`, its ``trials`` the order in which they are played.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.experiment.plan("missing.toml").gaits.to_pandas()  # doctest: +SKIP
    """

    __slots__ = ()


class Comparison(Result):
    """Measured against predicted displacement, and each optimum against its neighbours.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.experiment.report("missing.toml").gaits.to_pandas()  # doctest: +SKIP
    """

    __slots__ = ()

    def plot(self, ax: "Axes | None" = None, **points: Any) -> "Axes":
        """Draws the displacement of each gait with its interval, and the prediction (matplotlib).

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in; a new figure unless given.
        **points
            Style of the measured points, for `Axes.errorbar`.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            If matplotlib is missing.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.experiment.report("missing.toml").plot()  # doctest: +SKIP
        """
        from . import _plot

        return _plot.comparison(self, ax, **points)


def plan(spec: Text, *, folder: Text | None = None) -> Plan:
    """Computes the gaits of a spec and fixes the order of the trials.

    Parameters
    ----------
    spec : path
        Spec of the experiment (TOML).
    folder : path, optional
        New folder of the experiment; without it, named as the spec and next to it.

    Returns
    -------
    Plan
        ``gaits`` with their predictions, ``trials``, ``left_out``, ``tank_time_s``, ``folder``.

    Raises
    ------
    BadInput
        If the spec is invalid, a gait cannot be played, or the folder exists.
    Failed
        If a gait cannot be found.

    Examples
    --------
    >>> import swimmer as sw
    >>> planned = sw.experiment.plan("missing.toml")  # doctest: +SKIP
    >>> [gait.name for gait in planned.gaits]  # doctest: +SKIP
    ['a', 'b', 'b-10', 'b+10', 'fastest', …]
    """
    document = _document(_swimmer.experiment_plan(os.fspath(spec), _path(folder)))
    home = Path(document["folder"])
    document["gaits"] = [PlannedGait(gait, Gait.load(home / gait["file"])) for gait in document["gaits"]]
    return Plan(document)


def run(
    spec: Text,
    port: str | Sequence[str] = (),
    *,
    folder: Text | None = None,
    track: str | None = None,
    front: str | None = None,
    back: str | None = None,
    body: str | None = None,
    facing: Angle | None = None,
    axes: str | None = None,
    scale: float | None = None,
    key: Text | None = None,
    baud: int | None = None,
) -> Result:
    """Plays the trials that are not finished yet, each from the start pose.

    Every event is on the disk before the next begins. The run may end at any time, by Ctrl-C, a low battery or a lost link: the same
    call goes on, and repeats the trial that was under way. Ctrl-C stops the robot first.

    Parameters
    ----------
    spec : path
        Spec of the experiment, planned before.
    port : str or sequence of str, optional
        Port of the robot, as for `Robot`; ``twin`` for a virtual one in virtual time.
    folder : path, optional
        Folder of the experiment.
    track : str, optional
        Source of the cameras' frames, as for `Robot`.
    front, back, body : str, optional
        Names of what the cameras see, as for `Robot`.
    facing : float or str, optional
        Heading of the robot at the start [rad], or as ``90deg``, for reflectors without names.
    axes, scale : optional
        Axes and unit of the source, as for `Robot`.
    key : path, optional
        File of the robot's key.
    baud : int, optional
        Speed of the serial line.

    Returns
    -------
    Result
        ``runs``, ``done``, ``given_up``, ``finished_now``, ``duration_s``.

    Raises
    ------
    BadInput
        If the experiment is not planned, or no source of frames is named.
    Failed
        The reason for which the run ended early.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.experiment.run("missing.toml", "twin").done  # doctest: +SKIP
    55
    """
    robot = settings(port, locals())
    return Result(_document(_swimmer.experiment_run(os.fspath(spec), _path(folder), robot)))


def status(spec: Text, *, folder: Text | None = None) -> Result:
    """Reports the progress of an experiment.

    Parameters
    ----------
    spec : path
        Spec of the experiment.
    folder : path, optional
        Folder of the experiment.

    Returns
    -------
    Result
        ``runs``, ``done``, ``given_up``, ``failed_attempts``, ``next``, ``interruption``.

    Raises
    ------
    BadInput
        If the experiment is not planned, or its journal is damaged.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.experiment.status("missing.toml").done  # doctest: +SKIP
    17
    """
    return Result(_document(_swimmer.experiment_status(os.fspath(spec), _path(folder))))


def report(spec: Text, *, folder: Text | None = None) -> Comparison:
    """Compares the measured gaits with the prediction, and each optimum with its neighbours.

    Writes ``report.json`` and ``report.html`` into the folder of the experiment, also while trials are missing.

    Parameters
    ----------
    spec : path
        Spec of the experiment.
    folder : path, optional
        Folder of the experiment.

    Returns
    -------
    Comparison
        ``gaits`` with ``measured_m``, ``interval_m`` and ``predicted_m``; ``comparisons`` with ``p`` and ``shown``; ``report``.

    Raises
    ------
    BadInput
        If the experiment is not planned, or its journal is damaged.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.experiment.report("missing.toml").plot()  # doctest: +SKIP
    """
    return Comparison(_document(_swimmer.experiment_report(os.fspath(spec), _path(folder))))


def _path(folder: Text | None) -> str | None:
    return None if folder is None else os.fspath(folder)


def _document(reply: tuple[Any, list[str]]) -> dict[str, Any]:
    document, notes = reply
    warn(notes, stacklevel=4)
    return dict(document)
