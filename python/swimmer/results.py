"""What the functions return: frozen, with the JSON keys of the command line as attributes."""

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
    from matplotlib.axes import Axes

Floats: TypeAlias = NDArray[np.float64]


class Result(Mapping[str, Any]):
    """One JSON document, or an object inside one: its keys are attributes and items, and nothing can be changed.

    Lists are tuples. A key that is a word of Python takes an underscore as an attribute: `certificate.pass_`.
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
        """The document, as `json` reads it."""
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


class OptimalGait(Result):
    """An optimised gait with its certificate."""

    __slots__ = ("_gait", "_swimmer")
    _gait: Gait
    _swimmer: Swimmer

    def __init__(self, document: Mapping[str, Any], gait: Gait, swimmer: Swimmer) -> None:
        super().__init__({key: value for key, value in document.items() if key != "gait"})
        object.__setattr__(self, "_gait", gait)
        object.__setattr__(self, "_swimmer", swimmer)

    @property
    def gait(self) -> Gait:
        """The gait itself, to simulate, certify, save or sample."""
        return self._gait

    @property
    def swimmer(self) -> Swimmer:
        """The swimmer that it was made for."""
        return self._swimmer

    def to_gait_file(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the gait file that the command writes with `-o`."""
        if Path(path).exists() and not overwrite:
            raise BadInput(f"{os.fspath(path)} exists; name a new file, or replace it with overwrite=True")
        self._gait.save(path)

    def plot(self, ax: "Axes | None" = None, **line: Any) -> "Axes":
        """The gait in the plane of joint angles (matplotlib)."""
        from . import _plot

        return _plot.gait(self._gait, ax, **line)


class Atlas(Result):
    """Every local optimum that was found, best first: `optima` are `OptimalGait`s."""

    __slots__ = ()

    def plot(self, ax: "Axes | None" = None, **line: Any) -> "Axes":
        """All gaits in the plane of joint angles (matplotlib)."""
        from . import _plot

        ax = _plot.plane(ax)
        for number, optimum in enumerate(self.optima, 1):
            _plot.gait(optimum.gait, ax, **{"label": f"{number}", **line})
        if self.optima:
            ax.legend()
        return ax


class Trajectory(NamedTuple):
    """The middle link's way: a row for each instant."""

    cycle: NDArray[np.int64]
    """Number of the cycle, from 0: shape (n,)."""
    u: Floats
    """Fraction of its period: shape (n,)."""
    phi: Floats
    """Joint angles [rad]: shape (n, 2)."""
    pose: Floats
    """x, y [m] and heading [rad], from (0, 0, 0) on: shape (n, 3)."""


class Simulation(Result):
    """One cycle swum in the model."""

    __slots__ = ("_trajectory",)
    _trajectory: Trajectory

    def __init__(self, document: Mapping[str, Any], trajectory: Trajectory) -> None:
        super().__init__({key: value for key, value in document.items() if key != "trajectory"})
        object.__setattr__(self, "_trajectory", trajectory)

    @property
    def trajectory(self) -> Trajectory:
        """The middle link's way through all `cycles`."""
        return self._trajectory

    def plot(self, ax: "Axes | None" = None, **line: Any) -> "Axes":
        """The middle link's way in the tank (matplotlib)."""
        from . import _plot

        return _plot.way(self._trajectory.pose, ax, **line)


class HeightMap(Result):
    """A height function over the square of joint angles, with its zero-level curves."""

    __slots__ = ("_phi", "_height")
    _phi: Floats
    _height: Floats

    def __init__(self, document: Mapping[str, Any], phi: Floats, height: Floats) -> None:
        super().__init__({key: value for key, value in document.items() if key != "written"})
        object.__setattr__(self, "_phi", phi)
        object.__setattr__(self, "_height", height)

    @property
    def phi(self) -> Floats:
        """The nodes of either joint [rad]: shape (201,)."""
        return self._phi

    @property
    def height(self) -> Floats:
        """H at the nodes, over L where the row is a length; [i, j] is at φ₁ = phi[i], φ₂ = phi[j]: shape (201, 201)."""
        return self._height

    def plot(self, ax: "Axes | None" = None, **filling: Any) -> "Axes":
        """The map with its zero-level curves (matplotlib)."""
        from . import _plot

        return _plot.height_map(self, ax, **filling)


class Calibration(Result):
    """Cycles measured in recordings and, for a campaign, the fitted parameters with their intervals."""

    __slots__ = ("_swimmer",)
    _swimmer: Swimmer | None

    def __init__(self, document: Mapping[str, Any], swimmer: Swimmer | None) -> None:
        super().__init__(document)
        object.__setattr__(self, "_swimmer", swimmer)

    @property
    def swimmer(self) -> Swimmer | None:
        """The fitted swimmer; None for a single run, which is not fitted."""
        return self._swimmer


def _frozen(value: Any) -> Any:
    if isinstance(value, Result):
        return value
    if isinstance(value, Mapping):
        return Result(value)
    if isinstance(value, list | tuple):
        return tuple(_frozen(item) for item in value)
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
