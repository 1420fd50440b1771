"""Discs in persistent contact: the slow, obvious physics that piles are compared with.

In each short step the velocities change as little as they can (Gauss's principle) so that no gap is negative at its
end, to first order: min |v − v₀ − h g|² in mass, under gap + h n·Δv ≥ 0. Nothing bounces. The least is found by
non-negative least squares (Lawson, Hanson, Solving Least Squares Problems, chapter 23). The error is of first order.
"""

from itertools import combinations

import numpy as np
from scipy.optimize import nnls

from tests.reference.scenes_of_discs import Scene

FASTEST = 10.0  # m/s at which gaps are expected to close, at most


def lines_of(
    scene: Scene, place: np.ndarray, within: float
) -> tuple[list[tuple[int, int]], np.ndarray, np.ndarray]:
    """Pairs whose rims are nearer than that (m), how their gaps follow motion, shape (c, 2n), and the gaps, m."""
    radius, movable = scene["radius"], (scene["inverse_mass"] > 0).any(axis=1)
    pairs, lines, gaps = [], [], []
    for i, j in combinations(range(len(place)), 2):
        line = place[j] - place[i]
        gap = np.hypot(*line) - radius[i] - radius[j]
        if gap < within and (movable[i] or movable[j]):
            row = np.zeros((len(place), 2))
            row[i], row[j] = -line / np.hypot(*line), line / np.hypot(*line)
            pairs.append((i, j))
            lines.append(row.ravel())
            gaps.append(gap)
    return pairs, np.array(lines).reshape(len(pairs), 2 * len(place)), np.array(gaps)


def moved(scene: Scene, acceleration: np.ndarray, until: float, steps: int) -> np.ndarray:
    """Centres at a time (s), shape (n, 2), m."""
    place, velocity, h = scene["position"].copy(), scene["velocity"].copy(), until / steps
    root = np.sqrt(scene["inverse_mass"].ravel())
    for _ in range(steps):
        free = velocity + h * acceleration * (scene["inverse_mass"] > 0)
        _, lines, gaps = lines_of(scene, place, FASTEST * h)
        if len(gaps) == 0:
            place, velocity = place + h * free, free
            continue
        given = lines * root
        wanted = -(lines @ free.ravel() + gaps / h)
        matrix = np.vstack([given.T, wanted])
        target = np.zeros(len(matrix))
        target[-1] = 1.0
        share, _ = nnls(matrix, target)
        rest = matrix @ share - target
        velocity = free + (root * (-rest[:-1] / rest[-1])).reshape(-1, 2)
        place = place + h * velocity
    return place


def forces_at_rest(scene: Scene, place: np.ndarray, acceleration: np.ndarray) -> dict[tuple[int, int], float]:
    """The pushes (N ≥ 0) of contacts that hold the weight of all at rest; raises AssertionError if none do."""
    pairs, lines, _ = lines_of(scene, place, 1e-9 * scene["radius"].max())
    free = (scene["inverse_mass"] > 0).ravel()
    weight = np.zeros(len(free))
    weight[free] = (
        (np.broadcast_to(acceleration, scene["inverse_mass"].shape).ravel()[free])
        / scene["inverse_mass"].ravel()[free]
    )
    forces, left = nnls(lines[:, free].T, -weight[free])
    assert left <= 1e-8 * np.abs(weight).max()
    return dict(zip(pairs, forces.tolist(), strict=True))
