"""Figures, where matplotlib is present."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._swimmer import Gait

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .results import HeightMap

SAMPLES = 400


def _axes(ax: "Axes | None") -> "Axes":
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError(
            "plots are drawn by matplotlib, which is not installed; run `pip install matplotlib`"
        ) from error
    return pyplot.figure().add_subplot()


def plane(ax: "Axes | None") -> "Axes":
    """Axes of the two joint angles."""
    ax = _axes(ax)
    ax.set_xlabel("$\\phi_1$ [rad]")
    ax.set_ylabel("$\\phi_2$ [rad]")
    ax.set_aspect("equal")
    return ax


def gait(gait: Gait, ax: "Axes | None", **line: Any) -> "Axes":
    """A closed curve of shapes."""
    ax = plane(ax)
    corners = np.union1d(np.linspace(0.0, 1.0, SAMPLES + 1), gait.corners)
    phi = gait.at(corners)
    ax.plot(phi[:, 0], phi[:, 1], **line)
    return ax


def way(pose: NDArray[np.float64], ax: "Axes | None", **line: Any) -> "Axes":
    """The middle link's centre in the tank."""
    ax = _axes(ax)
    ax.plot(pose[:, 0], pose[:, 1], **line)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    ax.set_aspect("equal", adjustable="datalim")
    return ax


def height_map(of: "HeightMap", ax: "Axes | None", **filling: Any) -> "Axes":
    """Filled levels, the zero-level curves over them."""
    ax = plane(ax)
    largest = float(np.abs(of.height).max())
    levels = np.linspace(-largest, largest, 21)
    style: dict[str, Any] = {"levels": levels, "cmap": "RdBu_r", **filling}
    filled = ax.contourf(of.phi, of.phi, of.height.T, **style)
    ax.figure.colorbar(filled, ax=ax, label="H")
    for curve in of.zero_curves:
        vertices = np.array(curve.vertices)
        ax.plot(vertices[:, 0], vertices[:, 1], "k-", linewidth=1)
    return ax
