"""The robot on the twin: uploads, plays, stops, telemetry and poses, against the command and against the model."""

import contextlib
import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import swimmer as sw


def test_an_upload_is_that_of_the_command(robot: sw.Swimmer) -> None:
    gait = sw.optimize.displacement(robot, max_angle=1.2, playable=True).gait
    for one, word in ((sw.Gait.circle(1.2), "circle:1.2"), (gait, None)):
        with sw.Robot("twin") as twin:
            uploaded = twin.upload(one, period=6.0)
            assert twin.status().gait.crc32 == uploaded.crc32
        if word is None:
            continue
        words = [sys.executable, "-m", "swimmer", "robot", "upload", word, "--port=twin", "--period=6", "--json"]
        command = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
        assert (uploaded.crc32, uploaded.knots) == (command["crc32"], command["knots"])
        assert uploaded.to_dict()["preflight"]["displacement_m"] == command["preflight"]["displacement_m"]


def swum_in_two_cycles(poses: list[sw.Pose], period: float) -> float:
    """Mean distance between poses two cycles apart, at which the shape is the same, over the last half cycle before rest."""
    t = np.array([pose.time for pose in poses])
    ends = np.linspace(t[-1] - 1.0 - period / 2, t[-1] - 1.0, 61)
    moved = []
    for axis in "xy":
        at = np.array([getattr(pose, axis) for pose in poses])
        moved.append(np.mean(np.interp(ends, t, at) - np.interp(ends - 2 * period, t, at)))
    return math.hypot(*moved)


def test_the_tracked_path_is_that_of_the_model(robot: sw.Swimmer) -> None:
    gait = sw.Gait.circle(1.2)
    with sw.Robot("twin", seed=3) as twin:
        twin.play(gait, cycles=3, period=6, wait=False)
        assert twin.is_moving
        poses = list(twin.poses())
        played = twin.wait()
    assert (played.cycles, played.state, played.cause) == (3, "stopped", "finished")
    assert np.all(np.diff([pose.time for pose in poses]) > 0) and len(poses) > 1500
    expected = 2 * abs(sw.simulate(robot, gait, played=True, period=6).played.displacement_m)
    assert swum_in_two_cycles(poses, 6.0) == pytest.approx(expected, rel=0.02)


def test_telemetry_follows_the_gait() -> None:
    gait = sw.Gait.circle(1.2)
    with sw.Robot("twin") as twin:
        twin.play(gait, cycles=2, period=6, wait=False)
        reports = list(twin.telemetry())
        assert not twin.is_moving
    playing = [report for report in reports if report.state == "playing"]
    assert len(playing) > 40
    for report in playing:
        u = report.cycles % 1.0
        np.testing.assert_allclose(report.phi, gait.at(u), atol=0.03)
    assert playing[-1].cycles > 1.9 and playing[-1].pose[0] != 0.0


def test_a_block_that_fails_stops_the_robot() -> None:
    with pytest.raises(RuntimeError, match="of mine"):
        with sw.Robot("twin") as twin:
            twin.play("circle:60deg", cycles=None, wait=False)
            raise RuntimeError("of mine")
    with pytest.raises(sw.BadInput, match="closed"):
        twin.status()
    twin.close()


def test_a_stop_ends_the_wait_of_another_thread() -> None:
    with sw.Robot("twin") as twin:
        twin.upload("circle:60deg")
        raised: list[Exception] = []

        def play() -> None:
            try:
                twin.play(cycles=None)
            except sw.Failed as error:
                raised.append(error)

        thread = threading.Thread(target=play)
        thread.start()
        while not twin.is_moving and thread.is_alive():
            time.sleep(0.01)
        assert twin.stop().state == "stopped"
        thread.join(timeout=30)
        assert not thread.is_alive() and len(raised) == 1
        # It plays again afterwards.
        assert twin.play(cycles=1, period=6).cause == "finished"


@pytest.mark.skipif(sys.platform == "win32", reason="os.kill sends no Ctrl-C there")
def test_ctrl_c_stops_the_robot_first(tmp_path: Path) -> None:
    log = tmp_path / "link.mcap"
    program = f"""
import os, signal, threading, time
import swimmer as sw
signal.signal(signal.SIGINT, signal.default_int_handler)
robot = sw.Robot("twin", log={str(log)!r})
def interrupt():
    while not robot.is_moving:
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
try:
    robot.play("circle:60deg", cycles=None)
except KeyboardInterrupt:
    status = robot.status()
    print(status.state, status.cause, status.cycles)
robot.close()
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert ended.stdout.split() == ["stopped", "requested", "None"], ended


def test_ctrl_c_between_reports_leaves_the_block(tmp_path: Path) -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with pytest.raises(KeyboardInterrupt):
        with sw.Robot("twin") as twin:
            twin.play("circle:60deg", cycles=None, wait=False)
            for _ in twin.telemetry():
                os.kill(os.getpid(), signal.SIGINT)


def test_mistakes_are_named_in_terms_of_python() -> None:
    with sw.Robot("twin") as twin:
        with pytest.raises(sw.BadInput, match="give the duration, as seconds=10"):
            twin.telemetry()
        with pytest.raises(sw.BadInput, match="seconds = -1 is no duration"):
            twin.poses(seconds=-1)
        with pytest.raises(sw.BadInput, match="at least one cycle"):
            twin.play("circle:60deg", cycles=0)
        with pytest.raises(sw.BadInput, match="period"):
            twin.play("circle:60deg", period=-3.0)
        with pytest.raises(sw.Failed, match="made for `purcell`"):
            purcell = sw.Swimmer.preset("purcell")
            twin.play(sw.optimize.turning(purcell, max_angle=1.0).gait)
        assert twin.status().state == "stopped"
    with sw.Robot("twin") as twin, pytest.raises(sw.Failed, match="holds no gait: .*"):
        twin.play()
    with pytest.raises(sw.Failed, match="no such port"):
        sw.Robot("/dev/no-such-port")
    with pytest.raises(sw.BadInput, match="tcp:HOST:PORT"):
        sw.Robot("twin", track="tcp:nowhere")


def test_a_robot_of_ones_own_swims_in_the_tank(robot: sw.Swimmer) -> None:
    slow = robot.replace(chi=2.6, name="slow")
    gait = sw.Gait.circle(1.2)
    expected = 2 * abs(sw.simulate(slow, gait, played=True, period=6).played.displacement_m)
    assert expected < 0.8 * 2 * abs(sw.simulate(robot, gait, played=True, period=6).played.displacement_m)
    with sw.Robot("twin", swimmer=slow) as twin:
        twin.play(gait, cycles=3, period=6, wait=False)
        poses = list(twin.poses())
    assert swum_in_two_cycles(poses, 6.0) == pytest.approx(expected, rel=0.02)


def test_a_robot_behind_a_terminal(tmp_path: Path) -> None:
    """A twin of another process in real time, over a pseudo-terminal as over a serial port."""
    if sys.platform == "win32":
        pytest.skip("no pseudo-terminals there")
    link = tmp_path / "robot"
    words = [sys.executable, "-m", "swimmer", "twin", f"--pty={link}"]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as other:
        try:
            began = time.monotonic()
            while not link.exists() and time.monotonic() < began + 30:
                time.sleep(0.05)
            with sw.Robot(str(link)) as twin:
                twin.upload("circle:60deg")
                twin.play(cycles=None, period=30, wait=False)
                assert [report.state for report in twin.telemetry(seconds=1.0)]
                # No call renews the lease: the robot stops by itself, and the next call greets it again.
                time.sleep(4.0)
                status = twin.status()
                assert (status.state, status.cause) == ("stopped", "link lost")
                with pytest.raises(sw.BadInput, match="no cameras see this robot"):
                    next(twin.poses(seconds=1.0))
            # A script that sees pixels, with y downwards: 0.4 mm each.
            with camera_script({"Front": [750.0, 411.25], "Back": [750.0, 588.75]}) as port:
                with sw.Robot(str(link), track=f"tcp:127.0.0.1:{port}", axes="x,-y", scale=0.0004) as twin:
                    *_, pose = twin.poses(seconds=1.0)
            assert (pose.x, pose.y, pose.heading) == pytest.approx((0.3, -0.2, math.pi / 2), abs=1e-6)
        finally:
            other.terminate()


@contextlib.contextmanager
def camera_script(points: dict[str, list[float]]) -> Iterator[int]:
    """A script that sends the same points a hundred times a second; yields its port."""
    ended = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as server:

        def stream() -> None:
            connection, _ = server.accept()
            with connection, contextlib.suppress(OSError):
                while not ended.wait(0.01):
                    frame = {"t": time.monotonic(), "points": points}
                    connection.sendall(json.dumps(frame).encode() + b"\n")

        sender = threading.Thread(target=stream)
        sender.start()
        yield server.getsockname()[1]
        ended.set()
        sender.join()
