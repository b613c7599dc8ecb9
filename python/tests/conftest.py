from pathlib import Path

import numpy as np
import pytest
import swimmer as sw

from physics import Robot


@pytest.fixture(scope="session")
def purcell() -> sw.Swimmer:
    return sw.Swimmer.preset("purcell")


@pytest.fixture(scope="session")
def robot() -> sw.Swimmer:
    return sw.Swimmer.preset("robot")


@pytest.fixture(params=["purcell", "robot", "odd"])
def pair(request: pytest.FixtureRequest) -> tuple[sw.Swimmer, Robot]:
    """A swimmer of the wheel and the same one derived here."""
    if request.param == "purcell":
        return sw.Swimmer.preset("purcell"), Robot((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), 2.0, 0.0)
    if request.param == "robot":
        c_t = 2 * np.pi / 4.543
        return sw.Swimmer.preset("robot"), Robot((0.071, 0.137, 0.137), (c_t, c_t, c_t), 3.598, 0.0692)
    links, a = (0.5, 0.8, 1.3), 0.01
    made = sw.Swimmer.preset("purcell").replace(
        middle=links[0], front=links[1], back=links[2], chi=1.7, sphere_radius=0.2, half_thickness=a
    )
    drag = tuple(2 * np.pi / np.log(link / a) for link in links)
    return made, Robot(links, (drag[0], drag[1], drag[2]), 1.7, 0.2)


@pytest.fixture(scope="session")
def shapes() -> np.ndarray:
    return np.random.default_rng(1).uniform(-2.8, 2.8, (200, 2))


@pytest.fixture(scope="session")
def straight() -> Path:
    """Gaits that join at the straight shape, to drive the robot with."""
    return Path(__file__).parents[2] / "experiment" / "tests" / "straight"
