"""Times the Python peers on what the Rust benches time, one thread, and prints one JSON object of seconds.

Called in a copy of the peers' folder, whose modules `model` and `gaits` it imports. What a peer lacks is null.
"""
import json
import math
import sys
import time

import numpy as np

from gaits import circle, integrate_path
from model import connection_power, purcell, robot

BEST_CIRCLE = 1.6331625
SHAPE = (0.9, -0.4)
POINTS = 10_000


def seconds(task, least=0.5):
    """Least time of one call over repetitions that take `least` seconds together."""
    task()
    best, until = float("inf"), time.perf_counter() + least
    while time.perf_counter() < until:
        start = time.perf_counter()
        task()
        best = min(best, time.perf_counter() - start)
    return best


def casadi_times(swimmer):
    """One shape a call and a batch of shapes a call, CasADi's own expression graph of A and W."""
    try:
        import casadi as ca
        from model import casadi_model_fast
    except ImportError as missing:
        print(f"CasADi is not here: {missing}", file=sys.stderr)
        return None, None
    g, w = casadi_model_fast(swimmer)
    phi = ca.SX.sym("phi", 2)
    both = ca.Function("both", [phi], [g(phi, 0), w(phi)])
    shape = ca.DM(SHAPE)
    batch = both.map(POINTS)
    shapes = ca.DM(np.random.default_rng(1).uniform(-2, 2, (2, POINTS)))
    return seconds(lambda: both(shape)), seconds(lambda: batch(shapes)) / POINTS


def best_of(task, times=3):
    """Least time of a task that takes long."""
    best = float("inf")
    for _ in range(times):
        start = time.perf_counter()
        task()
        best = min(best, time.perf_counter() - start)
    return best


def fourier_chain(swimmer, radius, sign):
    """Fourier series of one, two and three terms from a circle; the coefficients of the last."""
    from fourier import optimise
    coefficients = np.array([radius, radius])
    for order in (1, 2, 3):
        start, have = np.zeros(2 * order), len(coefficients) // 2
        start[:have], start[order:order + have] = coefficients[:have], coefficients[have:]
        coefficients, *_ = optimise(start, swimmer, sign, gtol=1e-8)
    return coefficients


def lighthill_times():
    """Each Lighthill gait by CasADi's collocation 20 x 5 (building, then solving from a Fourier start), by the Fourier chain,
    and by SciPy's shooting from a guess that is right to 1e-4. Seconds and efficiencies by name."""
    try:
        from collocation import Colloc
        from scipy.optimize import root
        from shooting import Shoot
    except ImportError as missing:
        print(f"CasADi or SciPy is not here: {missing}", file=sys.stderr)
        return {}
    found = {}
    # One c_t for all links, ln(l/a) = 4.543: the preset.
    for name, swimmer in (("purcell", purcell()), ("robot", robot(logmode=2 * math.pi / 4.543))):
        for gait, radius, sign in (("small", 1.3, 1), ("large", 3.3, -1)):
            key = f"{name} {gait}"
            start = fourier_chain(swimmer, radius, sign)
            found[f"fourier {key}"] = best_of(lambda: fourier_chain(swimmer, radius, sign), 2)
            built = best_of(lambda: Colloc(swimmer, 20, 5, phimax=5.0), 2)
            problem = Colloc(swimmer, 20, 5, phimax=5.0)
            guess = problem.guess_fourier(start)
            solution = problem.solve(guess)
            solved = best_of(lambda: problem.solve(guess))
            if not solution["ok"]:
                print(f"CasADi does not solve {key}: {solution['status']}", file=sys.stderr)
                continue
            found[f"casadi {key}"] = built + solved
            found[f"casadi warm {key}"] = solved
            found[f"xi {key}"] = solution["xi"]
            shoot = Shoot(swimmer)
            end = np.array([solution[part] for part in ("phi1f", "xf", "thf", "E")]) * (1 + 1e-4)

            def shot():
                return root(lambda k: shoot.residual(k, jac=False, rtol=1e-9, atol=1e-11), end, method="hybr",
                            options={"xtol": 1e-10, "maxfev": 200})
            found[f"shooting {key}"] = best_of(shot, 1)
    return found


def wide_text(frames=20_000, markers=10):
    """The file of calibrate's bench, to the byte."""
    axes = range(3 * markers)

    def row(cell):
        return "".join("," + cell(i) for i in axes)
    lines = ["Format Version,1.23,Export Frame Rate,100,Length Units,Meters,Coordinate Space,Global", "",
             ",Type" + row(lambda i: "Marker"), ",Name" + row(lambda i: f"Marker {i // 3}"),
             "," + row(lambda i: "Position"), "Frame,Time (Seconds)" + row(lambda i: "XYZ"[i % 3])]
    lines += [f"{frame},{frame / 100:.6f}" + row(lambda i: f"{(frame * 7919 + i * 104729) % 4000000 / 1e6 - 2:.6f}")
              for frame in range(frames)]
    return "\n".join(lines) + "\n"


def reading_times():
    """A wide Motive file from text to arrays of positions: the csv module, and pandas."""
    import csv
    import io
    text = wide_text()

    def by_csv():
        rows = csv.reader(io.StringIO(text))
        for _ in range(6):
            next(rows)
        return np.array([[float(cell) for cell in row] for row in rows])
    found = {"reading bytes": len(text), "reading csv": best_of(by_csv)}
    try:
        import pandas
    except ImportError as missing:
        print(f"pandas is not here: {missing}", file=sys.stderr)
        return found
    found["reading pandas"] = best_of(lambda: pandas.read_csv(io.StringIO(text), skiprows=6, header=None).to_numpy())
    return found


def main():
    swimmer = purcell()
    phi1, phi2 = np.random.default_rng(1).uniform(-2, 2, (2, POINTS))
    path, breaks = circle(BEST_CIRCLE)
    casadi_one, casadi_batch = casadi_times(swimmer)
    print(json.dumps({
        "numpy_one": seconds(lambda: connection_power(*SHAPE, swimmer)),
        "numpy_batch": seconds(lambda: connection_power(phi1, phi2, swimmer)) / POINTS,
        "casadi_one": casadi_one,
        "casadi_batch": casadi_batch,
        "quarter_cycle": seconds(lambda: integrate_path(path, swimmer, breaks)),
        **lighthill_times(),
        **reading_times(),
        "displacement_over_length": 4 * float(integrate_path(path, swimmer, breaks)["dx"]),
    }))


main()
