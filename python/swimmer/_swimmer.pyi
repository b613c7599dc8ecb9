import os
from collections.abc import Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "BadInput",
    "Error",
    "Failed",
    "Gait",
    "RobotLink",
    "RobotSettings",
    "Swimmer",
    "__version__",
    "atlas",
    "calibrate",
    "certify",
    "experiment_plan",
    "experiment_report",
    "experiment_run",
    "experiment_status",
    "height_map",
    "optimize",
    "passive_waveform",
    "plan",
    "run",
    "simulate",
    "steer_gaits",
    "sweep_map",
    "sweep_merge",
    "sweep_plan",
    "sweep_run",
    "sweep_status",
    "tracks",
]

__version__: str

class Error(Exception):
    """Base class of the errors of this package; the text says what failed, and what to do next."""

class BadInput(Error):
    """A value, or a file that it names, cannot be used (exit status 2 of the command)."""

class Failed(Error):
    """The computation or the robot failed: no optimum, no convergence, a refusal (exit status 1 of the command)."""

@final
class Swimmer:
    """A three-link swimmer: links, drag, sphere, and where known its fluid and servos. It never changes; `replace` returns another one.

    Lengths are in metres and angles in radians; drag and power are over the viscosity. `Swimmer(middle=0.07, side=0.14)` makes a viscous
    swimmer; `preset` and `load` return others.

    Parameters
    ----------
    middle : float
        Length of the middle link [m].
    side : float, optional
        Length of both side links [m].
    front, back : float, optional
        Lengths of the side links [m], in place of `side`.
    chi : float, optional
        Ratio of normal to tangential drag.
    sphere_radius : float, optional
        Radius of the sphere on the middle link [m]; 0 for none.
    log_aspect, half_thickness, over_viscosity : float, optional
        Forms of the tangential drag coefficient, of which at most one is given: ln(l/a), a [m], or the coefficient over the viscosity. Without
        them ``over_viscosity=1``.
    kinematic_viscosity, density : float, optional
        Fluid [m²/s, kg/m³], for torques and power.
    name : str, optional
        Name for people.

    Raises
    ------
    BadInput
        If a value is invalid or missing.

    Examples
    --------
    >>> import swimmer as sw
    >>> robot = sw.Swimmer(middle=0.071, side=0.137, chi=3.6, sphere_radius=0.069)
    >>> round(robot.length, 3)
    0.345
    >>> robot.A([0.5, -0.3]).shape
    (3, 2)
    """

    def __new__(
        cls,
        *,
        middle: float,
        side: float | None = None,
        front: float | None = None,
        back: float | None = None,
        chi: float = 2.0,
        sphere_radius: float = 0.0,
        log_aspect: float | None = None,
        half_thickness: float | None = None,
        over_viscosity: float | None = None,
        kinematic_viscosity: float | None = None,
        density: float | None = None,
        name: str = "swimmer",
    ) -> Swimmer: ...
    @staticmethod
    def preset(name: str) -> Swimmer:
        """Returns a preset.

        Parameters
        ----------
        name : str
            ``purcell``, ``robot``, ``robot-slender``, ``perfect-fluid``, ``kinematic-snake`` or ``elastic-tail``.

        Returns
        -------
        Swimmer
            The swimmer.

        Raises
        ------
        BadInput
            If there is no such preset.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("purcell").chi
        2.0
        """
    @staticmethod
    def load(preset_or_path: str | os.PathLike[str]) -> Swimmer:
        """Reads a swimmer file, or returns a preset.

        Parameters
        ----------
        preset_or_path : str or path
            Name of a preset, or path of a swimmer file (TOML).

        Returns
        -------
        Swimmer
            The swimmer.

        Raises
        ------
        BadInput
            If the file cannot be read or is invalid.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.load("robot").name
        'robot'
        """
    @staticmethod
    def from_toml(text: str) -> Swimmer:
        """Reads the text of a swimmer file.

        Parameters
        ----------
        text : str
            Content of a swimmer file (TOML).

        Returns
        -------
        Swimmer
            The swimmer.

        Raises
        ------
        BadInput
            If the text is invalid.

        Examples
        --------
        >>> import swimmer as sw
        >>> robot = sw.Swimmer.preset("robot")
        >>> sw.Swimmer.from_toml(robot.to_toml()) == robot
        True
        """
    def replace(
        self,
        *,
        name: str | None = None,
        middle: float | None = None,
        side: float | None = None,
        front: float | None = None,
        back: float | None = None,
        chi: float | None = None,
        sphere_radius: float | None = None,
        log_aspect: float | None = None,
        half_thickness: float | None = None,
        over_viscosity: float | None = None,
        kinematic_viscosity: float | None = None,
        density: float | None = None,
    ) -> Swimmer:
        """Returns this swimmer with other values; what is not named stays.

        Parameters
        ----------
        name : str, optional
            Name for people.
        middle, side, front, back : float, optional
            Lengths of the links [m]; `side` is both side links.
        chi : float, optional
            Ratio of normal to tangential drag.
        sphere_radius : float, optional
            Radius of the sphere [m]; 0 takes it away.
        log_aspect, half_thickness, over_viscosity : float, optional
            Forms of the tangential drag coefficient, of which at most one is given.
        kinematic_viscosity, density : float, optional
            Fluid [m²/s, kg/m³].

        Returns
        -------
        Swimmer
            The other swimmer.

        Raises
        ------
        BadInput
            If a value is invalid.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("robot").replace(chi=2.6, name="slow").chi
        2.6
        """
    def A(self, phi: ArrayLike) -> NDArray[np.float64]:
        """Returns the local connection A(Φ): body velocity (v_x, v_y, θ̇) per joint rate.

        Parameters
        ----------
        phi : array_like
            Joint angles [rad], shape (…, 2).

        Returns
        -------
        numpy.ndarray
            Shape (…, 3, 2).

        Raises
        ------
        BadInput
            If the last dimension is not 2.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("purcell").A([[0.5, -0.3], [1.0, 1.0]]).shape
        (2, 3, 2)
        """
    def W(self, phi: ArrayLike) -> NDArray[np.float64]:
        """Returns the power matrix W(Φ) over the viscosity: power = Φ̇ᵀWΦ̇.

        Parameters
        ----------
        phi : array_like
            Joint angles [rad], shape (…, 2).

        Returns
        -------
        numpy.ndarray
            Shape (…, 2, 2).

        Raises
        ------
        BadInput
            If the last dimension is not 2.

        Examples
        --------
        >>> import swimmer as sw
        >>> W = sw.Swimmer.preset("purcell").W([0.5, -0.3])
        >>> bool(W[0, 1] == W[1, 0])
        True
        """
    def dA(self, phi: ArrayLike) -> NDArray[np.float64]:
        """Returns the exact derivatives of A: ``[..., i, j, k]`` is ∂A_ij/∂φ_k.

        Parameters
        ----------
        phi : array_like
            Joint angles [rad], shape (…, 2).

        Returns
        -------
        numpy.ndarray
            Shape (…, 3, 2, 2).

        Raises
        ------
        BadInput
            If the last dimension is not 2.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("purcell").dA([0.5, -0.3]).shape
        (3, 2, 2)
        """
    def dW(self, phi: ArrayLike) -> NDArray[np.float64]:
        """Returns the exact derivatives of W: ``[..., i, j, k]`` is ∂W_ij/∂φ_k.

        Parameters
        ----------
        phi : array_like
            Joint angles [rad], shape (…, 2).

        Returns
        -------
        numpy.ndarray
            Shape (…, 2, 2, 2).

        Raises
        ------
        BadInput
            If the last dimension is not 2.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("purcell").dW([0.5, -0.3]).shape
        (2, 2, 2)
        """
    def F(self, phi: ArrayLike) -> NDArray[np.float64]:
        """Returns the curvature dA + [A₁, A₂], rows (x, y, θ): body displacement of a small counter-clockwise loop over its area.

        Parameters
        ----------
        phi : array_like
            Joint angles [rad], shape (…, 2).

        Returns
        -------
        numpy.ndarray
            Shape (…, 3).

        Raises
        ------
        BadInput
            If the last dimension is not 2.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("purcell").F([0.5, -0.3]).shape
        (3,)
        """
    @property
    def name(self) -> str:
        """Name of the swimmer for people."""
    @property
    def middle(self) -> float:
        """Length of the middle link [m]."""
    @property
    def front(self) -> float:
        """Length of the front link [m]."""
    @property
    def back(self) -> float:
        """Length of the back link [m]."""
    @property
    def length(self) -> float:
        """Length of all links L [m]."""
    @property
    def chi(self) -> float:
        """Ratio of normal to tangential drag, of the middle link if the links differ in it."""
    @property
    def sphere_radius(self) -> float:
        """Radius of the sphere on the middle link [m]; 0 for none."""
    @property
    def c_t(self) -> dict[str, float | dict[str, float]]:
        """Form of the tangential drag coefficient with its value, as in the swimmer file: ``log_aspect``, ``half_thickness`` or ``over_viscosity``,
        the last as one number or with one for ``middle``, ``front`` and ``back``.
        """
    @property
    def medium(self) -> str:
        """Medium of the links: "viscous", "perfect" or "wheels"."""
    @property
    def hash(self) -> str:
        """Fingerprint that gait files carry: SHA-256 of links, drag and sphere."""
    def to_toml(self) -> str:
        """Returns the text of the swimmer file.

        Returns
        -------
        str
            Content of a swimmer file (TOML).

        Examples
        --------
        >>> import swimmer as sw
        >>> print(sw.Swimmer.preset("purcell").to_toml().splitlines()[0])
        name = "purcell"
        """
    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the swimmer file. A file that exists is replaced.

        Parameters
        ----------
        path : str or path
            Path of the file (.toml).

        Raises
        ------
        Failed
            If the file cannot be written.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Swimmer.preset("robot").save("mine.toml")  # doctest: +SKIP
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Gait:
    """One cycle of joint angles. It never changes.

    Parameters
    ----------
    phi : array_like
        Samples of one cycle [rad], shape (n, 2). If the last sample is not the first one, the cycle is closed.
    u : sequence of float, optional
        Fractions of the period of the samples; evenly spaced unless given.
    corners : sequence of float, optional
        Those of `u` at which the direction jumps.

    Raises
    ------
    BadInput
        If the samples are no closed curve.

    Examples
    --------
    >>> import numpy as np
    >>> import swimmer as sw
    >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    >>> gait = sw.Gait(np.column_stack([np.cos(t), np.sin(t)]))
    >>> gait.at(0.125).round(4)
    array([0.7071, 0.7071])
    """

    def __new__(
        cls,
        phi: ArrayLike,
        u: Sequence[float] | NDArray[np.float64] | None = None,
        corners: Sequence[float] | NDArray[np.float64] | None = None,
    ) -> Gait: ...
    @staticmethod
    def circle(amplitude: float, *, clockwise: bool = False) -> Gait:
        """Returns a circle in the plane of joint angles, at uniform speed from φ₁ = φ₂ > 0.

        Parameters
        ----------
        amplitude : float
            Radius [rad].
        clockwise : bool, optional
            With True, runs clockwise.

        Returns
        -------
        Gait
            The gait.

        Raises
        ------
        BadInput
            If the amplitude is no angle.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Gait.circle(1.2)
        <Gait circle:1.2>
        """
    @staticmethod
    def square(amplitude: float, *, clockwise: bool = False) -> Gait:
        """Returns a square with corners (±`amplitude`, ±`amplitude`), at uniform speed along each edge from φ₁ = φ₂ > 0.

        Parameters
        ----------
        amplitude : float
            Half edge [rad].
        clockwise : bool, optional
            With True, runs clockwise.

        Returns
        -------
        Gait
            The gait.

        Raises
        ------
        BadInput
            If the amplitude is no angle.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Gait.square(1.2, clockwise=True)
        <Gait square:1.2:cw>
        """
    @staticmethod
    def load(gait: str | os.PathLike[str]) -> Gait:
        """Reads a gait file, or returns a closed form.

        Parameters
        ----------
        gait : str or path
            Path of a gait file, ``circle:70deg`` or ``square:1.2``; ``:cw`` at the end reverses it.

        Returns
        -------
        Gait
            The gait.

        Raises
        ------
        BadInput
            If the file cannot be read or is invalid.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Gait.load("circle:70deg").phi.shape
        (201, 2)
        """
    @staticmethod
    def from_text(text: str) -> Gait:
        """Reads the text of a gait file.

        Parameters
        ----------
        text : str
            Content of a gait file.

        Returns
        -------
        Gait
            The gait.

        Raises
        ------
        BadInput
            If the text is invalid.

        Examples
        --------
        >>> import swimmer as sw
        >>> best = sw.optimize.turning("purcell", max_angle=1.0).gait
        >>> sw.Gait.from_text(best.to_text()) == best
        True
        """
    @property
    def u(self) -> NDArray[np.float64]:
        """Fractions of the period of the samples, from 0 to 1: shape (n,)."""
    @property
    def phi(self) -> NDArray[np.float64]:
        """Joint angles of the samples [rad], the last the first again: shape (n, 2)."""
    def at(self, u: ArrayLike) -> NDArray[np.float64]:
        """Returns the joint angles at fractions of the period, also between the samples.

        Parameters
        ----------
        u : array_like
            Fractions of the period; 1.25 is 0.25 of the second cycle.

        Returns
        -------
        numpy.ndarray
            Joint angles [rad], shape (…, 2).

        Raises
        ------
        BadInput
            If a fraction is not finite.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Gait.circle(1.0).at([0.0, 0.5]).round(6)
        array([[ 0.707107,  0.707107],
               [-0.707107, -0.707107]])
        """
    @property
    def objective(self) -> str:
        """Objective of the optimisation: `displacement`, `efficiency`, `turning`, `sideways`, `speed`, or `unspecified`."""
    @property
    def corners(self) -> list[float]:
        """Fractions of the period where the direction jumps."""
    @property
    def closed_form(self) -> str | None:
        """Closed form as `load` reads it, ``circle:1.2`` or ``square:1.2:cw``; None for samples."""
    def reversed(self) -> Gait:
        """Returns the same cycle, run the other way from the same start.

        Returns
        -------
        Gait
            The reversed gait.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Gait.circle(1.2).reversed()
        <Gait circle:1.2:cw>
        """
    def to_text(self) -> str:
        """Returns the text of the gait file; a closed form is sampled.

        Returns
        -------
        str
            Content of a gait file.

        Examples
        --------
        >>> import swimmer as sw
        >>> "u,phi1,phi2" in sw.Gait.circle(1.2).to_text()
        True
        """
    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the gait file. A file that exists is replaced.

        Parameters
        ----------
        path : str or path
            Path of the file.

        Raises
        ------
        Failed
            If the file cannot be written.

        Examples
        --------
        >>> import swimmer as sw
        >>> sw.Gait.circle(1.2).save("mine.gait")  # doctest: +SKIP
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class RobotSettings:
    """Port of a robot, and the cameras that see it."""

    def __new__(cls, ports: Sequence[str], keywords: dict[str, Any]) -> RobotSettings: ...

@final
class RobotLink:
    """A robot that was greeted. Calls release the interpreter's lock; Ctrl-C stops the robot and raises `KeyboardInterrupt`.

    Each call returns its value and its messages.
    """

    def __new__(cls, settings: RobotSettings) -> RobotLink: ...
    @property
    def port(self) -> str:
        """Name of the port."""
    @property
    def notes(self) -> list[str]:
        """Messages of the connection."""
    def status(self) -> tuple[dict[str, Any], list[str]]:
        """State of the robot."""
    def upload(self, gait: Gait, period: float) -> tuple[dict[str, Any], list[str]]:
        """Checks, forecasts and uploads a gait."""
    def play(self, cycles: int | None, period: float) -> tuple[None, list[str]]:
        """Begins a play."""
    def wait(self) -> tuple[dict[str, Any], list[str]]:
        """Waits for the end of a play."""
    def stop(self) -> tuple[dict[str, Any], list[str]]:
        """Stops, also while another thread is in a call, which then fails."""
    def next_telemetry(self) -> tuple[dict[str, Any] | None, list[str]]:
        """Next report of the robot; None if there is none within a second."""
    def next_poses(self) -> tuple[list[tuple[float, float, float, float, float, float]], list[str]]:
        """Next poses by the cameras: time, x, y, heading, and the deviations of position and heading of each."""
    def is_moving(self) -> bool:
        """True if a play has begun and no report has shown its end."""
    def now(self) -> float:
        """Time on the port's clock [s]."""
    def close(self) -> list[str]:
        """Stops the robot if it moves, and closes the port; nothing happens the second time."""

def simulate(
    swimmer: Swimmer | str | os.PathLike[str], gait: Gait | str | os.PathLike[str], keywords: dict[str, Any]
) -> tuple[
    dict[str, Any],
    tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    list[str],
]:
    """One cycle of a gait, and the trajectory of all cycles."""

def certify(
    swimmer: Swimmer | str | os.PathLike[str], gait: Gait | str | os.PathLike[str], keywords: dict[str, Any]
) -> tuple[dict[str, Any], list[str]]:
    """Certificate of a gait."""

def height_map(
    swimmer: Swimmer | str | os.PathLike[str],
    gaits: Sequence[Gait | str | os.PathLike[str]],
    keywords: dict[str, Any],
) -> tuple[dict[str, Any], NDArray[np.float64], NDArray[np.float64], list[str]]:
    """A component of the height function: document, angles of the nodes, and heights."""

def optimize(
    objective: str, swimmer: Swimmer | str | os.PathLike[str], keywords: dict[str, Any]
) -> tuple[dict[str, Any], Gait, Swimmer, list[str]]:
    """The best gait of an objective."""

def steer_gaits(
    swimmer: Swimmer | str | os.PathLike[str], keywords: dict[str, Any]
) -> tuple[dict[str, Any], list[Gait], Swimmer, list[str]]:
    """The gaits to steer by: document, gaits, swimmer and messages."""

def passive_waveform(
    swimmer: Swimmer | str | os.PathLike[str], keywords: dict[str, Any]
) -> tuple[dict[str, Any], Gait, Swimmer, list[str]]:
    """The best waveform of one servo: document, gait, swimmer and messages."""

def atlas(
    swimmer: Swimmer | str | os.PathLike[str], keywords: dict[str, Any]
) -> tuple[dict[str, Any], list[Gait], Swimmer, list[str]]:
    """Document, gaits of the optima, swimmer and messages."""

def tracks(file: str | os.PathLike[str], keywords: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Survey of a tracking file."""

def calibrate(
    file: str | os.PathLike[str],
    gait: Gait | str | os.PathLike[str] | None,
    swimmer: Swimmer | str | os.PathLike[str] | None,
    keywords: dict[str, Any],
) -> tuple[dict[str, Any], Swimmer | None, list[str]]:
    """The fit of a campaign, or the cycles of a recording."""

def experiment_plan(
    spec: str | os.PathLike[str], folder: str | os.PathLike[str] | None
) -> tuple[dict[str, Any], list[str]]:
    """Computes the gaits of a spec, and fixes the order of the trials."""

def experiment_run(
    spec: str | os.PathLike[str], folder: str | os.PathLike[str] | None, robot: RobotSettings
) -> tuple[dict[str, Any], list[str]]:
    """Plays the trials that are left. Ctrl-C stops the robot, and the same call goes on."""

def experiment_status(
    spec: str | os.PathLike[str], folder: str | os.PathLike[str] | None
) -> tuple[dict[str, Any], list[str]]:
    """Progress by the journal."""

def experiment_report(
    spec: str | os.PathLike[str], folder: str | os.PathLike[str] | None
) -> tuple[dict[str, Any], list[str]]:
    """Compares the gaits, and writes report.json and report.html."""

def plan(swimmer: Swimmer | str | os.PathLike[str], keywords: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Gaits that lead to a target one after the other: document and messages."""

def sweep_plan(
    spec: str | os.PathLike[str], folder: str | os.PathLike[str]
) -> tuple[dict[str, Any], list[str]]:
    """Makes a plan of a spec."""

def sweep_run(folder: str | os.PathLike[str], keywords: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Solves the designs of a shard that are not solved yet. Ctrl-C ends it after the blocks in work, and the same call goes on."""

def sweep_status(folder: str | os.PathLike[str]) -> tuple[dict[str, Any], list[str]]:
    """Progress of all shards."""

def sweep_merge(
    folder: str | os.PathLike[str], table: str | os.PathLike[str]
) -> tuple[dict[str, Any], list[str]]:
    """Writes all designs of a finished sweep as one Parquet table."""

def sweep_map(folder: str | os.PathLike[str], keywords: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Maps a finished grid over two of its axes, and writes its files."""

def run(words: Sequence[str]) -> int:
    """The whole `swimmer` command, the program's name first; gives its exit status."""
