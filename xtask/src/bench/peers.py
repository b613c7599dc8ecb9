"""Times the Python peers on what the Rust benches time, one thread, and prints one JSON object of seconds.

Called in a copy of the peers' folder, whose modules `model` and `gaits` it imports. What a peer lacks is null.
"""
import json
import sys
import time

import numpy as np

from gaits import circle, integrate_path
from model import connection_power, purcell

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
        "displacement_over_length": 4 * float(integrate_path(path, swimmer, breaks)["dx"]),
    }))


main()
