"""The robot: upload, play, stop, telemetry, and poses by the cameras."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from ._messages import Text, warn
from ._swimmer import BadInput, Gait, RobotLink, RobotSettings, Swimmer
from .optimize import Angle
from .results import Result


@dataclass(frozen=True, slots=True)
class Telemetry:
    """A report of the robot.

    Examples
    --------
    >>> import swimmer as sw
    >>> with sw.Robot("twin") as robot:
    ...     report = next(robot.telemetry(seconds=1))
    >>> report.state
    'stopped'
    """

    time: float
    """Time of arrival on the clock of the port [s]."""
    robot_time: float
    """Time on the robot's clock [s]."""
    state: str
    """``stopped``, ``holding``, ``starting``, ``playing``, ``paused``, ``stopping``, ``settling`` or ``e-stopped``."""
    cycles: float
    """Cycles done, with the fraction of the present one."""
    phi: tuple[float, float]
    """Commanded joint angles [rad]."""
    pose: tuple[float, float, float]
    """Pose that the robot computes for itself, from the start of the play: x, y [m] and heading [rad]."""
    battery: float | None
    """Battery voltage [V]; None if it is not measured."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Tracked pose of the middle link in the tank, with the standard deviations of its errors.

    Examples
    --------
    >>> import swimmer as sw
    >>> with sw.Robot("twin") as robot:
    ...     pose = next(robot.poses(seconds=1))
    >>> pose.sigma_position < 1e-3
    True
    """

    time: float
    """Time of the exposure on the clock of the port [s]."""
    x: float
    """Position along the tank [m]."""
    y: float
    """Position across the tank [m]."""
    heading: float
    """Heading [rad]."""
    sigma_position: float
    """Standard deviation of x and of y [m]."""
    sigma_heading: float
    """Standard deviation of the heading [rad]."""


def settings(port: str | Sequence[str], keywords: dict[str, object]) -> RobotSettings:
    """Port and cameras as the extension takes them; it reads the keywords that it knows."""
    return RobotSettings([port] if isinstance(port, str) else list(port), keywords)


class Robot:
    """A robot behind a port, and the cameras that see it.

    Use it as a context manager: at the end of the block the robot is stopped if it moves, and the port is closed. Ctrl-C during a call
    stops the robot before `KeyboardInterrupt` is raised. `stop` may be called from another thread at any time.

    The link is kept alive while a call or an iterator runs, and not between calls: a real robot that moves stops half a second after the
    last call. The clock of a virtual robot stands still between calls, and is faster than real time in them.

    Parameters
    ----------
    port : str or sequence of str, optional
        Serial port, pseudo-terminal, ``tcp:HOST:PORT``, or a fresh virtual robot: ``twin``, or ``emulator`` with the real firmware. Of
        several ports the one where a robot answers. Without a port, the one serial port where a robot answers.
    swimmer : Swimmer, str or path, optional
        The swimmer that the robot is, if no preset describes it. In the tank of a virtual robot it is the truth.
    track : str, optional
        Source of the cameras' frames: ``natnet[:HOST[,LOCAL]]`` (Motive), ``tcp:HOST:PORT`` or ``-`` (JSON lines). A virtual robot
        has cameras of its own.
    front, back : str, optional
        Names of the reflectors at the ends of the middle link, ``Front`` and ``Back`` unless given.
    body : str, optional
        Name of a rigid body instead.
    facing : float or str, optional
        Heading of the robot at the start [rad], or as ``90deg``, for reflectors without names.
    axes : str, optional
        Axes of the source that are the tank's x and y: ``x,-y`` for an image, ``z,x`` for Y up.
    scale : float, optional
        Metres per unit of the source.
    key : path, optional
        File of the robot's key.
    baud : int, optional
        Speed of the serial line.
    log : path, optional
        New file (.mcap) for every frame on the wire.
    seed : int, optional
        Seed of a virtual robot: its start pose, and the noise of its cameras.

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If the port cannot be opened, or no robot answers.

    Examples
    --------
    >>> import swimmer as sw
    >>> with sw.Robot("twin") as robot:
    ...     played = robot.play(sw.Gait.circle(1.2), cycles=2, period=6)
    >>> played.cycles, played.cause
    (2, 'finished')
    """

    def __init__(
        self,
        port: str | Sequence[str] = (),
        *,
        swimmer: Swimmer | Text | None = None,
        track: str | None = None,
        front: str | None = None,
        back: str | None = None,
        body: str | None = None,
        facing: Angle | None = None,
        axes: str | None = None,
        scale: float | None = None,
        key: Text | None = None,
        baud: int | None = None,
        log: Text | None = None,
        seed: int = 1,
    ) -> None:
        self._link = RobotLink(settings(port, locals()))
        warn(self._link.notes, stacklevel=3)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Robot at {self._link.port}>"

    @property
    def port(self) -> str:
        """Name of the port."""
        return self._link.port

    @property
    def is_moving(self) -> bool:
        """True if a play has begun and no report of the robot has shown its end."""
        return self._link.is_moving()

    def status(self) -> Result:
        """Returns the state of the robot.

        Returns
        -------
        Result
            ``state``, ``cause`` of the last stop, ``cycle``, ``period_s``, ``setpoint_rad``, ``battery_v``, ``gait``, …

        Raises
        ------
        Failed
            If the link is lost.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     robot.status().state
        'stopped'
        """
        return self._result(self._link.status())

    def upload(self, gait: Gait | Text, *, period: float = 30.0) -> Result:
        """Forecasts a gait on this robot and sends it; it becomes the active one.

        Parameters
        ----------
        gait : Gait, str or path
            A gait, ``circle:70deg``, or a gait file.
        period : float, optional
            Duration of a cycle for the forecast [s].

        Returns
        -------
        Result
            ``knots``, ``crc32``, ``min_period_s``, ``seconds`` of the upload, and ``preflight``, the forecast.

        Raises
        ------
        BadInput
            If the gait cannot be read.
        Failed
            If the gait is another swimmer's, if it must not be played, or if the robot refuses it.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     robot.upload("circle:70deg").knots
        512
        """
        gait = gait if isinstance(gait, Gait) else Gait.load(gait)
        return self._result(self._link.upload(gait, period))

    def play(
        self,
        gait: Gait | Text | None = None,
        *,
        cycles: int | None = 1,
        period: float = 30.0,
        wait: bool = True,
    ) -> Result:
        """Plays a gait: powers the servos, starts softly, and waits for the end of the last cycle.

        Parameters
        ----------
        gait : Gait, str or path, optional
            Gait that is uploaded first. Without it, the robot plays the gait that it holds.
        cycles : int or None, optional
            Number of cycles; None for a play without end, which `stop` or Ctrl-C ends.
        period : float, optional
            Duration of a cycle [s].
        wait : bool, optional
            With False, returns once the play has begun. Iterate over `telemetry` or `poses` then, which keeps the link alive.

        Returns
        -------
        Result
            ``state``, ``cause``, ``cycles``, ``period_s``; with ``wait=False`` the `status`.

        Raises
        ------
        BadInput
            If the gait, the period or the number of cycles cannot be used.
        Failed
            If the robot refuses, or the play ends for another reason than its last cycle. The robot is stopped.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     robot.play("circle:70deg", cycles=1, period=6).state
        'stopped'
        """
        if gait is not None:
            self.upload(gait, period=period)
        _, notes = self._link.play(cycles, period)
        warn(notes, stacklevel=3)
        return self.wait() if wait else self.status()

    def wait(self) -> Result:
        """Waits until the last cycle has ended and the pulses are off.

        Returns
        -------
        Result
            ``state``, ``cause``, ``cycles``, ``period_s``.

        Raises
        ------
        Failed
            If the play ended for another reason than its last cycle.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     playing = robot.play("circle:70deg", cycles=1, period=6, wait=False)
        ...     robot.wait().cause
        'finished'
        """
        return self._result(self._link.wait())

    def stop(self) -> Result:
        """Ramps to neutral and switches the pulses off, from every state and every thread.

        A call of another thread that waits for the robot raises `Failed`.

        Returns
        -------
        Result
            The state of the robot, as `status`.

        Raises
        ------
        Failed
            If the link is lost; the robot then stops by itself.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     playing = robot.play("circle:70deg", cycles=None, wait=False)
        ...     robot.stop().state
        'stopped'
        """
        return self._result(self._link.stop())

    def telemetry(self, seconds: float | None = None) -> Iterator[Telemetry]:
        """Iterates over the reports of the robot, and keeps the link alive.

        Parameters
        ----------
        seconds : float, optional
            Duration on the clock of the port. Without it, the iterator ends with the play under way.

        Returns
        -------
        iterator of Telemetry
            Reports as they arrive.

        Raises
        ------
        BadInput
            If the robot is at rest and `seconds` is missing.
        Failed
            If the link is lost; the robot then stops by itself.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     playing = robot.play("circle:70deg", cycles=1, period=6, wait=False)
        ...     reports = list(robot.telemetry())
        >>> len(reports) > 20 and max(report.cycles for report in reports) > 0.9
        True
        """
        return self._reports(self._end(seconds))

    def poses(self, seconds: float | None = None) -> Iterator[Pose]:
        """Iterates over the poses of the middle link by the cameras, and keeps the link alive.

        Parameters
        ----------
        seconds : float, optional
            Duration on the clock of the port. Without it, the iterator ends with the play under way.

        Returns
        -------
        iterator of Pose
            Filtered poses, one for each frame that shows the robot.

        Raises
        ------
        BadInput
            If the robot has no cameras, or if it is at rest and `seconds` is missing.
        Failed
            If the cameras do not show the robot at first, or the link is lost.

        Examples
        --------
        >>> import swimmer as sw
        >>> with sw.Robot("twin") as robot:
        ...     poses = list(robot.poses(seconds=0.5))
        >>> all(pose.sigma_position < 1e-3 for pose in poses)
        True
        """
        return self._poses(self._end(seconds))

    def close(self) -> None:
        """Stops the robot if it moves, and closes the port.

        Raises
        ------
        Failed
            If the link is lost before the robot has stopped, which it then does by itself; or if the log cannot be written.

        Examples
        --------
        >>> import swimmer as sw
        >>> robot = sw.Robot("twin")
        >>> robot.close()
        """
        warn(self._link.close(), stacklevel=3)

    def _end(self, seconds: float | None) -> float | None:
        if seconds is None:
            if not self.is_moving:
                raise BadInput("the robot is at rest: give the duration, as seconds=10, or begin with play(..., wait=False)")
            return None
        if not 0.0 < seconds < float("inf"):
            raise BadInput(f"seconds = {seconds!r} is no duration: give a number above 0")
        return self._link.now() + seconds

    def _goes_on(self, end: float | None) -> bool:
        return self._link.is_moving() if end is None else self._link.now() < end

    def _reports(self, end: float | None) -> Iterator[Telemetry]:
        while self._goes_on(end):
            report, notes = self._link.next_telemetry()
            warn(notes, stacklevel=3)
            if report is not None:
                yield Telemetry(
                    report["time_s"],
                    report["robot_time_s"],
                    report["state"],
                    report["cycles"],
                    tuple(report["phi"]),
                    tuple(report["pose"]),
                    report["battery_v"],
                )

    def _poses(self, end: float | None) -> Iterator[Pose]:
        while self._goes_on(end):
            poses, notes = self._link.next_poses()
            warn(notes, stacklevel=3)
            for pose in poses:
                yield Pose(*pose)

    @staticmethod
    def _result(reply: tuple[Any, list[str]]) -> Result:
        document, notes = reply
        warn(notes, stacklevel=4)
        return Result(document)
