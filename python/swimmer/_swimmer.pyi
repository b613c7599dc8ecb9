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
    "certify",
    "experiment_plan",
    "experiment_report",
    "experiment_run",
    "experiment_status",
    "height_map",
    "options",
    "run",
    "run_captured",
    "simulate",
]

__version__: str

class Error(Exception):
    """Something was asked for and not done; the text says what, and what to do next."""

class BadInput(Error):
    """An argument, or a file that it names, cannot be used (exit status 2 of the command)."""

class Failed(Error):
    """It was tried and failed: no optimum, no convergence (exit status 1 of the command)."""

@final
class Swimmer:
    """A three-link swimmer: links, drag, sphere, and where known its fluid and servos. It never changes; `replace` gives another.

    Lengths are in metres, angles in radians, drag and power over the viscosity.

    `Swimmer(middle=0.07, side=0.14, chi=3.6)` makes a viscous one. `side` is both side links, in place of `front` and `back`;
    `log_aspect`, `half_thickness` and `over_viscosity` are the forms of c_t, of which at most one is given (`over_viscosity=1`
    unless one is); no sphere unless `sphere_radius` is given.
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
        """A preset that `swimmer swimmers` lists, such as `purcell`, `robot` or `perfect-fluid`."""
    @staticmethod
    def load(preset_or_path: str | os.PathLike[str]) -> Swimmer:
        """A swimmer file (TOML), or a preset by its name, as `--swimmer` takes them."""
    @staticmethod
    def from_toml(text: str) -> Swimmer:
        """The text of a swimmer file."""
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
        """This swimmer with other values; what is not named stays.

        `side` is both side links; `log_aspect`, `half_thickness` and `over_viscosity` are the forms of c_t, of which one holds;
        `sphere_radius=0` takes the sphere away.
        """
    def A(self, phi: ArrayLike) -> NDArray[np.float64]:
        """The local connection A(Φ), body velocity (v_x, v_y, θ̇) per joint rate: (…, 2) gives (…, 3, 2)."""
    def W(self, phi: ArrayLike) -> NDArray[np.float64]:
        """The power matrix W(Φ) over the viscosity, power = Φ̇ᵀWΦ̇: (…, 2) gives (…, 2, 2)."""
    def dA(self, phi: ArrayLike) -> NDArray[np.float64]:
        """The exact derivatives of A, [..., i, j, k] is ∂A_ij/∂φ_k: (…, 2) gives (…, 3, 2, 2)."""
    def dW(self, phi: ArrayLike) -> NDArray[np.float64]:
        """The exact derivatives of W, [..., i, j, k] is ∂W_ij/∂φ_k: (…, 2) gives (…, 2, 2, 2)."""
    def F(self, phi: ArrayLike) -> NDArray[np.float64]:
        """The curvature dA + [A₁, A₂], rows (x, y, θ): (…, 2) gives (…, 3)."""
    @property
    def name(self) -> str:
        """What people call it."""
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
        """L, the length of all links [m]."""
    @property
    def chi(self) -> float:
        """χ = c_n/c_t, of the middle link if the links have their own."""
    @property
    def sphere_radius(self) -> float:
        """Radius of the sphere on the middle link [m]; 0 for none."""
    @property
    def c_t(self) -> dict[str, float | dict[str, float]]:
        """The form of c_t and its value, as in the swimmer file."""
    @property
    def medium(self) -> str:
        """Medium of the links: "viscous", "perfect" or "wheels"."""
    @property
    def hash(self) -> str:
        """The fingerprint that gait files carry: SHA-256 of links, drag and sphere."""
    def to_toml(self) -> str:
        """The text of its swimmer file."""
    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes its swimmer file, in the place of one that is there."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Gait:
    """One cycle of joint angles. It never changes.

    `Gait(phi)` takes samples of one cycle, an array (n, 2) in radians; `u` are their fractions of the period, evenly spaced where
    they are left out, and `corners` those of `u` where the direction jumps. A cycle whose last sample is not its first is closed.
    """

    def __new__(
        cls,
        phi: ArrayLike,
        u: Sequence[float] | NDArray[np.float64] | None = None,
        corners: Sequence[float] | NDArray[np.float64] | None = None,
    ) -> Gait: ...
    @staticmethod
    def circle(amplitude: float, *, clockwise: bool = False) -> Gait:
        """Radius `amplitude` in the (φ₁, φ₂) plane [rad], at uniform angle, counter-clockwise unless told otherwise."""
    @staticmethod
    def square(amplitude: float, *, clockwise: bool = False) -> Gait:
        """Corners (±`amplitude`, ±`amplitude`) [rad], at constant speed along each edge."""
    @staticmethod
    def load(gait: str | os.PathLike[str]) -> Gait:
        """A gait file, or what `--gait` takes: `circle:70deg`, `square:1.2`, `best.gait`, each with `:cw` to reverse it."""
    @staticmethod
    def from_text(text: str) -> Gait:
        """The text of a gait file."""
    @property
    def u(self) -> NDArray[np.float64]:
        """Fractions of the period of the samples, from 0 to 1: shape (n,)."""
    @property
    def phi(self) -> NDArray[np.float64]:
        """Joint angles of the samples [rad], the last the first again: shape (n, 2)."""
    def at(self, u: ArrayLike) -> NDArray[np.float64]:
        """Joint angles [rad] at fractions of the period: (…,) gives (…, 2). Cycles go on: 1.25 is 0.25."""
    @property
    def objective(self) -> str:
        """What it was optimised for, or `unspecified`."""
    @property
    def corners(self) -> list[float]:
        """Fractions of the period where the direction jumps."""
    @property
    def closed_form(self) -> str | None:
        """Its word on the command line, `circle:1.2`; None for a gait from samples."""
    def reversed(self) -> Gait:
        """The same cycle run the other way, from the same start."""
    def to_text(self) -> str:
        """The text of its gait file; a closed form is sampled."""
    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes its gait file, in the place of one that is there."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class RobotSettings:
    """Port of a robot, and the cameras that see it."""

    def __new__(
        cls,
        ports: Sequence[str],
        *,
        swimmer: Swimmer | None,
        track: str | None,
        front: str | None,
        back: str | None,
        body: str | None,
        facing: float | None,
        key: str | os.PathLike[str] | None,
        baud: int | None,
        log: str | os.PathLike[str] | None,
        seed: int,
    ) -> RobotSettings: ...

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
    swimmer: Swimmer | str | os.PathLike[str],
    gait: Gait | str | os.PathLike[str],
    cycles: int,
    period: float | None,
    played: bool,
    knots: int | None,
    pulse_step: int | None,
) -> tuple[
    dict[str, Any],
    tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    list[str],
]:
    """One cycle of a gait, and the trajectory of all `cycles`. With `played` also a forecast on the robot."""

def certify(
    swimmer: Swimmer | str | os.PathLike[str],
    gait: Gait | str | os.PathLike[str],
    objective: str | None,
    fixed_period: bool,
    max_angle: float | str | None,
    min_angle: float | str | None,
    sector: bool,
    no_overlap: bool,
    clearance: float | None,
    playable: bool,
) -> tuple[dict[str, Any], list[str]]:
    """Certificate of a gait."""

def height_map(
    swimmer: Swimmer | str | os.PathLike[str],
    row: str,
    max_angle: float | str,
    gaits: Sequence[Gait | str | os.PathLike[str]],
) -> tuple[dict[str, Any], NDArray[np.float64], NDArray[np.float64], list[str]]:
    """A component of the height function: document, angles of the nodes, and heights."""

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

def run_captured(words: Sequence[str | os.PathLike[str]]) -> tuple[str, list[str]]:
    """The JSON document of a command, and the warnings that it gave.

    On Ctrl-C this raises `KeyboardInterrupt` at once; what was being computed ends by itself and is dropped.
    """

def run(words: Sequence[str]) -> int:
    """The whole `swimmer` command, the program's name first; gives its exit status."""

def options(path: Sequence[str]) -> list[str]:
    """The long options that a command takes."""
