"""Optimal gaits: the paper's numbers, and SciPy's integration of them."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import swimmer as sw
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from physics import Robot


@pytest.fixture(scope="module")
def farthest(purcell: sw.Swimmer) -> sw.OptimalGait:
    return sw.optimize.displacement(purcell)


def test_the_papers_displacement(farthest: sw.OptimalGait) -> None:
    assert farthest.displacement_over_length == pytest.approx(0.1035322400, abs=5e-11)
    assert farthest.start_angle_rad == pytest.approx(1.41172371, abs=5e-9)
    assert farthest.certificate.pass_ and farthest.certificate["pass"]
    assert {arc.kind for arc in farthest.arcs} == {"singular"}


def test_the_papers_efficiency(purcell: sw.Swimmer) -> None:
    small = sw.optimize.efficiency(purcell)
    assert small.efficiency == pytest.approx(0.012364154624, abs=5e-13)
    assert small.start_angle_rad == pytest.approx(1.04425742, abs=5e-9)
    large = sw.optimize.efficiency(purcell, gait="large")
    assert large.efficiency == pytest.approx(0.018102560473, abs=1e-11)


def swum_by_scipy(derived: Robot, gait: sw.Gait) -> np.ndarray:
    """x, y, θ after one cycle: the equations derived here, and SciPy's splines and integration over the gait's samples alone."""
    pose = np.zeros(3)
    ends = sorted({0.0, *gait.corners, 1.0})
    for start, end in zip(ends, ends[1:]):
        piece = (gait.u >= start) & (gait.u <= end)
        spline = CubicSpline(gait.u[piece], gait.phi[piece])
        slope = spline.derivative()

        def rates(u: float, pose: np.ndarray) -> np.ndarray:
            body = derived.connection(spline(u)) @ slope(u)
            cos, sin = np.cos(pose[2]), np.sin(pose[2])
            return np.array([cos * body[0] - sin * body[1], sin * body[0] + cos * body[1], body[2]])

        # Tight: the steps cross the spline's knots, where its third derivative jumps, and their error is not foretold there.
        pose = solve_ivp(rates, (start, end), pose, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return pose


def test_scipy_swims_as_far(farthest: sw.OptimalGait) -> None:
    derived = Robot((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), 2.0, 0.0)
    x, y, theta = swum_by_scipy(derived, farthest.gait)
    assert x / 3 == pytest.approx(farthest.displacement_over_length, abs=1e-8)
    assert abs(y) < 1e-7 and abs(theta) < 1e-7


def test_scipy_swims_a_circle_as_far(pair: tuple[sw.Swimmer, Robot]) -> None:
    made, derived = pair
    circle = sw.Gait.circle(1.1, clockwise=True)
    swum = sw.simulate(made, circle)

    def rates(u: float, pose: np.ndarray) -> np.ndarray:
        angle = np.pi / 4 - 2 * np.pi * u
        phi = 1.1 * np.array([np.cos(angle), np.sin(angle)])
        rate = 1.1 * 2 * np.pi * np.array([np.sin(angle), -np.cos(angle)])
        body = derived.connection(phi) @ rate
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        return np.array([cos * body[0] - sin * body[1], sin * body[0] + cos * body[1], body[2]])

    pose = solve_ivp(rates, (0, 1), np.zeros(3), method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    have = [swum.displacement_m, swum.lateral_over_length * made.length, swum.rotation_rad]
    np.testing.assert_allclose(have, pose, rtol=0, atol=1e-11)


@pytest.mark.parametrize("words", [["turning", "--max-angle=1.2"], ["sideways", "--max-angle=1.2"], ["displacement", "--max-angle=1.2"]])
def test_answers_are_those_of_the_command(purcell: sw.Swimmer, words: list[str]) -> None:
    command = [sys.executable, "-m", "swimmer", "optimize", *words, "--swimmer=purcell", "--json"]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    have = getattr(sw.optimize, words[0])(purcell, max_angle=float(words[1].split("=")[1])).to_dict()
    assert {key: value for key, value in have.items() if key != "seconds"} == {
        key: value for key, value in told.items() if key != "seconds"
    }


def test_without_a_sign_the_farthest_gait_swims_forwards(purcell: sw.Swimmer) -> None:
    senses = {sign: sw.optimize.displacement(purcell, max_angle=2.8, sign=sign) for sign in ("+", "-")}
    farthest = sw.optimize.displacement(purcell, max_angle=2.8)
    assert farthest.displacement_over_length == -senses["-"].displacement_over_length > senses["+"].displacement_over_length > 0.1
    assert farthest.to_dict()["clockwise"] is True and senses["-"].to_dict()["clockwise"] is False
    assert farthest.arcs == senses["-"].arcs
    swum = sw.simulate(purcell, farthest.gait)
    assert swum.displacement_over_length == pytest.approx(farthest.displacement_over_length, rel=1e-9)


def test_the_gait_file_is_the_commands(farthest: sw.OptimalGait, tmp_path: Path) -> None:
    path, other = tmp_path / "best.gait", tmp_path / "other.gait"
    farthest.to_gait_file(path)
    words = ["optimize", "displacement", "--swimmer=purcell", "-o", str(other)]
    subprocess.run([sys.executable, "-m", "swimmer", *words], check=True, capture_output=True)
    assert path.read_bytes() == other.read_bytes()
    assert sw.Gait.load(path) == farthest.gait
    with pytest.raises(sw.BadInput, match="exists"):
        farthest.to_gait_file(path)
    farthest.to_gait_file(path, overwrite=True)


def test_a_gait_of_ones_own_is_certified_or_not(farthest: sw.OptimalGait, purcell: sw.Swimmer) -> None:
    assert sw.certify(purcell, farthest.gait).pass_
    with pytest.warns(sw.Doubt):
        failed = sw.certify(purcell, sw.Gait.circle(1.0), objective="displacement")
    assert failed.pass_ is False and failed.verdict == "fail"
    assert all(isinstance(check.value, float) for check in failed.checks)


def test_speed_takes_one_rate_or_two(robot: sw.Swimmer) -> None:
    one = sw.optimize.speed(robot, max_rate="200deg", max_angle="60deg", no_overlap=True)
    two = sw.optimize.speed(robot, max_rate=(np.radians(200), np.radians(200)), max_angle=np.float64(np.pi / 3), no_overlap=True)
    assert one.certificate.pass_
    assert one.speed_over_length_per_s == pytest.approx(two.speed_over_length_per_s, rel=1e-9)
