"""Figures, where matplotlib is present."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._swimmer import Gait

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .experiment import Comparison
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


def comparison(of: "Comparison", ax: "Axes | None", **points: Any) -> "Axes":
    """Displacement of a cycle of each gait: measured with its interval, and predicted."""
    ax = _axes(ax)
    place = np.arange(len(of.gaits))
    predicted = [1e3 * gait.predicted_m for gait in of.gaits]
    ax.hlines(predicted, place - 0.35, place + 0.35, color="C1", label="predicted")
    for number, gait in enumerate(of.gaits):
        trials = [1e3 * trial.displacement_m for trial in gait.trials]
        ax.plot([number + 0.15] * len(trials), trials, ".", color="0.6", markersize=4)
    measured = [(number, gait) for number, gait in enumerate(of.gaits) if gait.measured_m is not None]
    style: dict[str, Any] = {"fmt": "o", "color": "C0", "capsize": 3, "label": "measured", **points}
    ax.errorbar(
        [number for number, _ in measured],
        [1e3 * gait.measured_m for _, gait in measured],
        [1e3 * (gait.interval_m or 0.0) for _, gait in measured],
        **style,
    )
    ax.set_xticks(place, [gait.gait for gait in of.gaits], rotation=45, ha="right")
    ax.set_ylabel("displacement of a cycle [mm]")
    ax.legend()
    return ax
