"""Results of the functions: frozen, with the JSON keys of the commands as attributes."""

import html
import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._swimmer import BadInput, Gait, Swimmer

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

Floats: TypeAlias = NDArray[np.float64]


class Result(Mapping[str, Any]):
    """A result: its keys are attributes and items, and it never changes.

    The keys are those of the command's JSON document. Lists are tuples, and lists of results are a `Table`. Numbers that are not defined
    are None. A key that is a word of Python takes an underscore as an attribute: ``certificate.pass_``.

    Examples
    --------
    >>> import swimmer as sw
    >>> swum = sw.simulate("purcell", "circle:70deg")
    >>> swum.links_cross == swum["links_cross"]
    True
    """

    __slots__ = ("_document",)
    _document: dict[str, Any]

    def __init__(self, document: Mapping[str, Any]) -> None:
        frozen = {key: _frozen(value) for key, value in document.items()}
        object.__setattr__(self, "_document", frozen)

    def __getattr__(self, name: str) -> Any:
        for key in (name, name.removesuffix("_")):
            if key in self._document:
                return self._document[key]
        raise AttributeError(
            f"this {type(self).__name__} has no {name}: it has {', '.join(self._document)}"
        )

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__} is frozen: {name} stays as it is")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a {type(self).__name__} is frozen: {name} stays")

    def __getitem__(self, key: str) -> Any:
        return self._document[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def __len__(self) -> int:
        return len(self._document)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._document]

    def __hash__(self) -> int:
        return hash(repr(self))

    def __getstate__(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in self._slots()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, value)

    @classmethod
    def _slots(cls) -> list[str]:
        return [name for kind in cls.__mro__ for name in getattr(kind, "__slots__", ()) if name.startswith("_") and not name.startswith("__")]

    def to_dict(self) -> dict[str, Any]:
        """Returns the result as a dictionary of Python's own types.

        Returns
        -------
        dict
            The JSON document.

        Examples
        --------
        >>> import json
        >>> import swimmer as sw
        >>> text = json.dumps(sw.simulate("purcell", "circle:70deg").to_dict())
        """
        return {key: _thawed(value) for key, value in self._document.items()}

    def __repr__(self) -> str:
        rows = [f"{key}={_short(value)}" for key, value in self._document.items()]
        return f"{type(self).__name__}({', '.join(rows)})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(key)}</th>"
            f"<td style='text-align:left'>{_cell(value)}</td></tr>"
            for key, value in self._document.items()
        )
        return f"<table>{rows}</table>"


class Table(tuple[Any, ...]):
    """A tuple of results, which pandas takes as a table.

    Examples
    --------
    >>> import swimmer as sw
    >>> checks = sw.optimize.turning("purcell", max_angle=1.0).certificate.checks
    >>> list(checks.to_pandas().columns)
    ['name', 'value', 'tolerance', 'pass']
    """

    __slots__ = ()

    def to_pandas(self) -> "pandas.DataFrame":
        """Returns a table with a row for each result, and a column for each of its keys.

        Keys of results inside a result are joined by a dot: ``certificate.pass``.

        Returns
        -------
        pandas.DataFrame
            The table; a key that a result does not have is missing there.

        Raises
        ------
        ImportError
            If pandas is missing.

        Examples
        --------
        >>> import swimmer as sw
        >>> atlas = sw.atlas("purcell", objective="displacement", max_angle=1.2, starts=2)
        >>> bool(atlas.optima.to_pandas()["certificate.pass"].all())
        True
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError("tables are made by pandas, which is not installed; run `pip install pandas`") from error
        return pandas.DataFrame([_row(result) for result in self])


class OptimalGait(Result):
    """An optimised gait with its certificate.

    Examples
    --------
    >>> import swimmer as sw
    >>> best = sw.optimize.displacement("purcell", max_angle=1.2)
    >>> swum = sw.simulate(best.swimmer, best.gait)
    >>> abs(swum.displacement_over_length - best.displacement_over_length) < 1e-8
    True
    """

    __slots__ = ("_gait", "_swimmer")
    _gait: Gait
    _swimmer: Swimmer

    def __init__(self, document: Mapping[str, Any], gait: Gait, swimmer: Swimmer) -> None:
        super().__init__({key: value for key, value in document.items() if key != "gait"})
        object.__setattr__(self, "_gait", gait)
        object.__setattr__(self, "_swimmer", swimmer)

    @property
    def gait(self) -> Gait:
        """The `Gait`, to simulate, certify, save or sample."""
        return self._gait

    @property
    def swimmer(self) -> Swimmer:
        """The `Swimmer` of the gait."""
        return self._swimmer

    def to_gait_file(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the gait file.

        Parameters
        ----------
        path : str or path
            New file.
        overwrite : bool, optional
            With True, replaces a file that exists.

        Raises
        ------
        BadInput
            If the file exists.
        Failed
            If the file cannot be written.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.optimize.displacement("purcell").to_gait_file("best.gait")  # doctest: +SKIP
        """
        if Path(path).exists() and not overwrite:
            raise BadInput(f"{os.fspath(path)} exists; name a new file, or replace it with overwrite=True")
        self._gait.save(path)

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
        >>> sw.optimize.displacement("purcell").plot()  # doctest: +SKIP
        """
        from . import _plot

        return _plot.gait(self._gait, ax, **line)


class Atlas(Result):
    """Every local optimum that was found: ``optima``, a table of `OptimalGait`, the best first.

    Examples
    --------
    >>> import swimmer as sw
    >>> atlas = sw.atlas("purcell", objective="displacement", max_angle=1.2, starts=2)
    >>> all(optimum.certificate.pass_ for optimum in atlas.optima)
    True
    """

    __slots__ = ()

    def plot(self, ax: "Axes | None" = None, **line: Any) -> "Axes":
        """Draws all gaits in the plane of joint angles (matplotlib).

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
        >>> sw.atlas("purcell", objective="efficiency", starts=20).plot()  # doctest: +SKIP
        """
        from . import _plot

        ax = _plot.plane(ax)
        for number, optimum in enumerate(self.optima, 1):
            _plot.gait(optimum.gait, ax, **{"label": f"{number}", **line})
        if self.optima:
            ax.legend()
        return ax


class Trajectory(NamedTuple):
    """Path of the middle link: a row for each instant.

    Examples
    --------
    >>> import swimmer as sw
    >>> path = sw.simulate("purcell", "circle:70deg").trajectory
    >>> path.phi.shape[1], path.pose.shape[1]
    (2, 3)
    """

    cycle: NDArray[np.int64]
    """Number of the cycle, from 0: shape (n,)."""
    u: Floats
    """Fraction of its period: shape (n,)."""
    phi: Floats
    """Joint angles [rad]: shape (n, 2)."""
    pose: Floats
    """x, y [m] and heading [rad], from (0, 0, 0) on: shape (n, 3)."""


class Simulation(Result):
    """A gait that was swum in the model: the results of one cycle, and the trajectory.

    Examples
    --------
    >>> import swimmer as sw
    >>> swum = sw.simulate("purcell", "circle:70deg")
    >>> bool(abs(swum.trajectory.pose[-1, 0] - swum.displacement_m) < 1e-9)
    True
    """

    __slots__ = ("_trajectory",)
    _trajectory: Trajectory

    def __init__(self, document: Mapping[str, Any], trajectory: Trajectory) -> None:
        super().__init__({key: value for key, value in document.items() if key != "trajectory"})
        object.__setattr__(self, "_trajectory", trajectory)

    @property
    def trajectory(self) -> Trajectory:
        """`Trajectory` of the middle link through all cycles."""
        return self._trajectory

    def plot(self, ax: "Axes | None" = None, **line: Any) -> "Axes":
        """Draws the path of the middle link in the tank (matplotlib).

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
        >>> sw.simulate("purcell", "circle:70deg", cycles=3).plot()  # doctest: +SKIP
        """
        from . import _plot

        return _plot.way(self._trajectory.pose, ax, **line)


class HeightMap(Result):
    """A height function over the square of joint angles, with its zero-level curves.

    Examples
    --------
    >>> import swimmer as sw
    >>> heights = sw.height_map("purcell", max_angle=2.5)
    >>> bool(abs(heights.height[100, 100] - heights.at_origin_over_length) < 1e-9)
    True
    """

    __slots__ = ("_phi", "_height")
    _phi: Floats
    _height: Floats

    def __init__(self, document: Mapping[str, Any], phi: Floats, height: Floats) -> None:
        super().__init__({key: value for key, value in document.items() if key != "written"})
        object.__setattr__(self, "_phi", phi)
        object.__setattr__(self, "_height", height)

    @property
    def phi(self) -> Floats:
        """Nodes of either joint [rad]: shape (201,)."""
        return self._phi

    @property
    def height(self) -> Floats:
        """Heights at the nodes, over L if they are lengths: shape (201, 201). ``[i, j]`` is at φ₁ = ``phi[i]``, φ₂ = ``phi[j]``."""
        return self._height

    def plot(self, ax: "Axes | None" = None, **filling: Any) -> "Axes":
        """Draws the map with its zero-level curves (matplotlib).

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in; a new figure unless given.
        **filling
            Style, for `Axes.contourf`.

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
        >>> sw.height_map("purcell").plot()  # doctest: +SKIP
        """
        from . import _plot

        return _plot.height_map(self, ax, **filling)


class Calibration(Result):
    """Cycles measured in recordings and, for a campaign, the fitted parameters with their intervals.

    Examples
    --------
    >>> import swimmer as sw
    >>> fit = sw.calibrate("campaign.toml")  # doctest: +SKIP
    >>> sw.optimize.displacement(fit.swimmer, robust=fit)  # doctest: +SKIP
    """

    __slots__ = ("_swimmer",)
    _swimmer: Swimmer | None

    def __init__(self, document: Mapping[str, Any], swimmer: Swimmer | None) -> None:
        super().__init__(document)
        object.__setattr__(self, "_swimmer", swimmer)

    @property
    def swimmer(self) -> Swimmer | None:
        """The fitted `Swimmer`; None for a single recording, which is not fitted."""
        return self._swimmer


def _frozen(value: Any) -> Any:
    if isinstance(value, Result):
        return value
    if isinstance(value, Mapping):
        return Result(value)
    if isinstance(value, list | tuple):
        items = [_frozen(item) for item in value]
        return Table(items) if all(isinstance(item, Result) for item in items) else tuple(items)
    # As in JSON: a number that is not defined is missing.
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _thawed(value: Any) -> Any:
    if isinstance(value, Result):
        return value.to_dict()
    if isinstance(value, tuple):
        return [_thawed(item) for item in value]
    return value


def _row(result: Result, before: str = "") -> dict[str, Any]:
    """Keys and values of a row, with those of results inside it."""
    row: dict[str, Any] = {}
    for key, value in result.items():
        if isinstance(value, Result):
            row.update(_row(value, f"{before}{key}."))
        else:
            row[before + key] = value
    return row


MANY = 8


def _short(value: Any) -> str:
    if isinstance(value, tuple) and len(value) > MANY:
        return f"<{len(value)} of them>"
    return repr(value)


def _cell(value: Any) -> str:
    if isinstance(value, Result):
        return value._repr_html_()
    if isinstance(value, tuple) and any(isinstance(item, Result) for item in value):
        return "".join(map(_cell, value)) if len(value) <= MANY else html.escape(_short(value))
    return html.escape(_short(value))
