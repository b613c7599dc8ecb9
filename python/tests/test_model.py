"""The model over arrays, against the equations of motion derived anew."""

import threading
import time

import numpy as np
import pytest
import swimmer as sw

from physics import Robot

Pair = tuple[sw.Swimmer, Robot]


def test_the_connection_is_the_one_derived_here(pair: Pair, shapes: np.ndarray) -> None:
    made, derived = pair
    np.testing.assert_allclose(made.A(shapes), [derived.connection(phi) for phi in shapes], rtol=0, atol=1e-13)


def test_the_power_is_the_one_derived_here(pair: Pair, shapes: np.ndarray) -> None:
    made, derived = pair
    np.testing.assert_allclose(made.W(shapes), [derived.power(phi) for phi in shapes], rtol=1e-12, atol=0)


def test_printed_values(purcell: sw.Swimmer) -> None:
    expected = [[0.092985, 0.077454], [-0.149731, -0.151491], [-0.259598, 0.268328]]
    np.testing.assert_allclose(purcell.A([0.5, -0.3]), expected, atol=5e-7)


@pytest.mark.parametrize("joint", [0, 1])
def test_derivatives_are_those_of_the_values(pair: Pair, shapes: np.ndarray, joint: int) -> None:
    made, _ = pair
    step = np.zeros(2)
    step[joint] = h = 1e-3

    def central(of: str, h: float) -> np.ndarray:
        value = getattr(made, of)
        return np.asarray((value(shapes + step * h / 1e-3) - value(shapes - step * h / 1e-3)) / (2 * h))

    for value, derivative in (("A", made.dA), ("W", made.dW)):
        # Richardson: error h⁴.
        slope = (4 * central(value, h / 2) - central(value, h)) / 3
        np.testing.assert_allclose(derivative(shapes)[..., joint], slope, rtol=0, atol=2e-9)


def test_the_curvature_is_what_a_small_loop_brings(pair: Pair) -> None:
    made, _ = pair
    centre, radius = np.array([0.7, -0.4]), 1e-3
    angle = np.linspace(0, 2 * np.pi, 65)[:-1]
    loop = centre + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    swum = sw.simulate(made, sw.Gait(loop)).trajectory.pose[-1]
    area = np.pi * radius**2
    # From the pose at the loop's first sample to that at its centre is a turn of order radius.
    np.testing.assert_allclose(swum / area, made.F(centre), rtol=0, atol=5e-3 * np.abs(made.F(centre)).max())


def test_shapes_and_types(purcell: sw.Swimmer) -> None:
    many = np.zeros((7, 2))
    for value, trailing in ((purcell.A, (3, 2)), (purcell.W, (2, 2)), (purcell.dA, (3, 2, 2)), (purcell.dW, (2, 2, 2)), (purcell.F, (3,))):
        assert value(many).shape == (7, *trailing)
        assert value(many[0]).shape == trailing
        assert value(np.zeros((4, 5, 2))).shape == (4, 5, *trailing)
        assert value(np.zeros((0, 2))).shape == (0, *trailing)
        answer = value(many)
        assert answer.dtype == np.float64 and answer.flags.c_contiguous and answer.flags.owndata is not None


def test_any_layout_is_the_same_array(purcell: sw.Swimmer, shapes: np.ndarray) -> None:
    expected = purcell.A(shapes)
    column_major = np.asfortranarray(shapes)
    strided = np.repeat(shapes, 2, axis=0)[::2]
    backwards = shapes[::-1]
    swapped = shapes.astype(">f8")
    assert not column_major.flags.c_contiguous and not strided.flags.c_contiguous
    for same in (column_major, strided, shapes.tolist(), swapped):
        assert np.array_equal(purcell.A(same), expected)
    assert np.array_equal(purcell.A(backwards)[::-1], expected)
    single = shapes.astype(np.float32)
    assert np.array_equal(purcell.A(single), purcell.A(single.astype(np.float64)))
    assert np.array_equal(purcell.A([[1, 2]]), purcell.A([[1.0, 2.0]]))


@pytest.mark.parametrize("wrong", [np.zeros(3), np.zeros((2, 3)), 1.0, np.zeros((2, 0))])
def test_other_shapes_are_refused(purcell: sw.Swimmer, wrong: object) -> None:
    with pytest.raises(sw.BadInput, match=r"shape \(2,\) or \(n, 2\)"):
        purcell.A(wrong)  # type: ignore[arg-type]


def test_the_argument_stays(purcell: sw.Swimmer, shapes: np.ndarray) -> None:
    before = shapes.copy()
    purcell.dA(shapes)[...] = 0
    assert np.array_equal(shapes, before)


def test_the_interpreter_is_free_meanwhile(purcell: sw.Swimmer) -> None:
    """Another thread of Python goes on while a long array is computed: held, it would stand still all the while."""
    many = np.zeros((3_000_000, 2))
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(1e-3)

    ticking = threading.Thread(target=tick)
    ticking.start()
    began = time.perf_counter()
    purcell.dA(many)
    ended = time.perf_counter()
    done.set()
    ticking.join()
    # The copies in and out hold the interpreter for a part of it.
    during = [at for at in ticks if began < at < ended]
    longest = max(np.diff([began, *during, ended]))
    assert longest < 0.6 * (ended - began), f"{longest} of {ended - began} s"
