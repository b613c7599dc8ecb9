"""Swimmers and gaits as objects: from arrays, from files, and back."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import swimmer as sw


def circle(samples: int, amplitude: float = 1.0) -> np.ndarray:
    angle = np.pi / 4 + 2 * np.pi * np.arange(samples) / samples
    return amplitude * np.column_stack([np.cos(angle), np.sin(angle)])


def test_samples_of_a_circle_swim_as_the_circle(purcell: sw.Swimmer) -> None:
    drawn = sw.simulate(purcell, sw.Gait(circle(400)))
    exact = sw.simulate(purcell, sw.Gait.circle(1.0))
    assert drawn.displacement_m == pytest.approx(exact.displacement_m, abs=1e-9)


def test_a_closed_array_and_an_open_one_are_one_gait() -> None:
    opened = circle(40)
    closed = np.vstack([opened, opened[:1]])
    assert sw.Gait(opened) == sw.Gait(closed)
    assert sw.Gait(opened).phi.shape == (41, 2) and sw.Gait(opened).u[-1] == 1.0
    assert np.array_equal(sw.Gait(opened).phi, closed)


def test_fractions_and_corners() -> None:
    corners = np.array([[1.0, 1], [-1, 1], [-1, -1], [1, -1]])
    u = np.arange(28) / 28
    edge = np.minimum((u * 4).astype(int), 3)
    phi = corners[edge] + (corners[(edge + 1) % 4] - corners[edge]) * (u * 4 - edge)[:, None]
    square = sw.Gait(phi, u=u, corners=list(u[[0, 7, 14, 21]]))
    where = np.linspace(-0.5, 1.5, 301)
    np.testing.assert_allclose(square.at(where), sw.Gait.square(1.0).at(where), atol=1e-12)
    assert square.at(0.3).shape == (2,) and square.at(np.zeros((2, 3))).shape == (2, 3, 2)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"phi": np.zeros((5, 2))}, "needs at least 9"),
        ({"phi": np.zeros((2, 9))}, r"\(n, 2\)"),
        ({"phi": np.zeros((3, 9, 2))}, r"\(n, 2\)"),
        ({"phi": np.full((9, 2), np.nan)}, "not a finite number"),
        ({"phi": circle(9) * 60}, "radians"),
        ({"phi": circle(9), "u": [0.0, 0.5]}, "one for each"),
        ({"phi": circle(9), "u": np.arange(9)[::-1] / 9}, "must be 0"),
        ({"phi": circle(9), "u": np.linspace(0, 1, 9)}, "does not close"),
        ({"phi": circle(9), "corners": [0.01]}, "no sample has the u"),
    ],
)
def test_what_is_no_gait(arguments: dict[str, Any], sentence: str) -> None:
    with pytest.raises(sw.BadInput, match=sentence):
        sw.Gait(**arguments)


def test_gaits_make_the_round_trip(tmp_path: Path) -> None:
    path = tmp_path / "drawn.gait"
    drawn = sw.Gait(circle(40))
    drawn.save(path)
    for again in (sw.Gait.load(path), sw.Gait.from_text(drawn.to_text()), pickle.loads(pickle.dumps(drawn))):
        assert again == drawn and hash(again) == hash(drawn)
    for closed in (sw.Gait.circle(1.2), sw.Gait.square(0.7, clockwise=True)):
        assert pickle.loads(pickle.dumps(closed)) == closed
        assert sw.Gait.load(str(closed.closed_form)) == closed


def test_reversed_runs_back(purcell: sw.Swimmer) -> None:
    for gait in (sw.Gait.circle(1.0), sw.Gait.square(1.0, clockwise=True), sw.Gait(circle(60))):
        back = gait.reversed()
        np.testing.assert_allclose(back.at(0.3), gait.at(0.7), atol=1e-12)
        np.testing.assert_allclose(back.reversed().phi, gait.phi, atol=0)
        forwards, backwards = sw.simulate(purcell, gait), sw.simulate(purcell, back)
        assert forwards.displacement_m * backwards.displacement_m < 0


def test_swimmers_make_the_round_trip(tmp_path: Path, robot: sw.Swimmer) -> None:
    path = tmp_path / "robot.toml"
    other = robot.replace(chi=3.1, name="mine", kinematic_viscosity=0.06, density=976.0)
    other.save(path)
    for again in (sw.Swimmer.load(path), sw.Swimmer.from_toml(other.to_toml()), pickle.loads(pickle.dumps(other))):
        assert again == other and hash(again) == hash(other)
    assert other != robot and other.hash != robot.hash
    assert (other.chi, other.name, other.sphere_radius) == (3.1, "mine", robot.sphere_radius)
    assert other.c_t == {"log_aspect": 4.543}
    assert other.length == pytest.approx(0.071 + 2 * 0.137)


def test_a_swimmer_from_its_numbers(purcell: sw.Swimmer) -> None:
    assert sw.__version__.count(".") == 2
    made = sw.Swimmer(middle=1.0, side=1.0, name="purcell")
    assert made == purcell
    other = sw.Swimmer(middle=0.071, front=0.137, back=0.12, chi=3.6, sphere_radius=0.0692, log_aspect=4.543)
    assert (other.front, other.back, other.chi, other.sphere_radius) == (0.137, 0.12, 3.6, 0.0692)
    assert (other.c_t, other.name) == ({"log_aspect": 4.543}, "swimmer")
    with pytest.raises(sw.BadInput, match="two side links"):
        sw.Swimmer(middle=1.0, front=1.0)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"chi": -1.0}, "cannot swim"),
        ({"side": 0.0}, "above 0"),
        ({"sphere_radius": float("nan")}, "sphere radius"),
        ({"log_aspect": 1.0, "over_viscosity": 1.0}, "one form"),
        ({"density": 976.0}, "give both"),
        ({"density": 976.0, "kinematic_viscosity": -1.0}, "positive number"),
    ],
)
def test_what_is_no_swimmer(purcell: sw.Swimmer, change: dict[str, float], sentence: str) -> None:
    with pytest.raises(sw.BadInput, match=sentence):
        purcell.replace(**change)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        purcell.replace(mass=1.0)  # type: ignore[call-arg]
