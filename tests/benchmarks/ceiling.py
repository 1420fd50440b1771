"""What this machine can do at most: memory bandwidth, and rods as fast as numbers can be streamed through."""

import math
import time
from collections.abc import Callable

import numpy as np
from numba import njit

SMALL = 1_000  # rods, whose arrays stay in the nearest cache

# Bytes that elastic Verlet must at least move: ends, difference, three lengths and stiffness of a rod; displacement,
# velocity and force (read and written), mobility and constant force of a particle.
BYTES_PER_ROD = 2 * 4 + 2 * 8 + 3 * 8
BYTES_PER_PARTICLE = 16 * (2 + 2 + 2 + 1 + 1)


@njit(error_model="numpy")
def triad(a, b, c, times):
    """a = b + 3 c, as the STREAM benchmark has it."""
    for _ in range(times):
        for i in range(a.shape[0]):
            a[i] = b[i] + 3.0 * c[i]


@njit(error_model="numpy")
def axial_forces(dx, dy, sx, sy, original, rest, stiffness, force, times):
    """Elastic forces of rods whose ends' displacements lie ready side by side: nothing gathered or scattered."""
    for _ in range(times):
        for r in range(force.shape[0]):
            x, y = dx[r] + sx[r], dy[r] + sy[r]
            length = math.sqrt(x * x + y * y)
            stretch = ((dx[r] + x) * sx[r] + (dy[r] + y) * sy[r]) / (length + original[r])
            force[r] = stiffness[r] * (stretch + original[r] - rest[r]) / rest[r] / length


def bandwidth(size: float) -> float:
    """Bytes per second that one core reads and writes, again and again, in arrays of so many bytes together."""
    arrays = [np.ones(max(int(size / 24), 1)) for _ in range(3)]
    times = max(int(2e7 / size), 1)
    return 24 * len(arrays[0]) * times / _shortest(lambda: triad(*arrays, times))  # type: ignore[call-arg]


def seconds_per_rod() -> float:
    """Seconds that the arithmetic of an elastic rod takes, vectorised, in the nearest cache."""
    rng = np.random.default_rng(0)
    columns = [rng.uniform(1.0, 2.0, SMALL) for _ in range(8)]
    times = 300
    return _shortest(lambda: axial_forces(*columns, times)) / times / SMALL  # type: ignore[call-arg]


def _shortest(run: Callable[[], object], rounds: int = 9) -> float:
    run()
    best = math.inf
    for _ in range(rounds):
        started = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - started)
    return best
