"""Scenes of discs that the tests of collisions share: racks, gases, boxes, piles.

Each returns what `pinjoint.systems.collision.free.discs.Discs` takes, as keyword arguments. Units: m, s, kg.
"""

import numpy as np

GRAVITY = 9.81
Scene = dict[str, np.ndarray]


def line(places: list[float], speeds: list[float], masses: list[float], radius: float = 0.05) -> Scene:
    """Return discs on the x axis; a mass of 0 stands for one that is held."""
    inverse = [1 / mass if mass else 0.0 for mass in masses]
    return {
        "position": np.column_stack([places, np.zeros(len(places))]),
        "velocity": np.column_stack([speeds, np.zeros(len(places))]),
        "radius": np.full(len(places), radius),
        "inverse_mass": np.column_stack([inverse, inverse]),
    }


def break_shot(rows: int, speed: float = 5.0, gap: float = 0.0, radius: float = 0.05) -> Scene:
    """Return a cue ball that comes along the axis of a triangle of balls; gap 0: they touch."""
    pitch = 2 * radius + gap
    rack = [
        (0.5 * np.sqrt(3) * row * pitch, (c - row / 2) * pitch) for row in range(rows) for c in range(row + 1)
    ]
    position = np.array([(-1.0, 0.0), *rack])
    velocity = np.zeros_like(position)
    velocity[0, 0] = speed
    return {
        "position": position,
        "velocity": velocity,
        "radius": np.full(len(position), radius),
        "inverse_mass": np.ones_like(position),
    }


def frame(width: float, height: float, radius: float = 0.05) -> np.ndarray:
    """Return the centres of held discs, close together, around the rectangle from (0, 0) to (width, height)."""
    spacing = 2 * radius * 0.99
    along = np.arange(-radius, width + 2 * radius, spacing)
    up = np.arange(-radius, height + 2 * radius, spacing)
    sides = [np.column_stack([along, np.full(len(along), y)]) for y in (-radius, height + radius)]
    sides += [np.column_stack([np.full(len(up), x), up]) for x in (-radius, width + radius)]
    return np.concatenate(sides)


def with_held(scene: Scene, places: np.ndarray, radius: float = 0.05) -> Scene:
    """Return the scene with held discs added behind the others."""
    count = len(places)
    return {
        "position": np.concatenate([scene["position"], places]),
        "velocity": np.concatenate([scene["velocity"], np.zeros((count, 2))]),
        "radius": np.concatenate([scene["radius"], np.full(count, radius)]),
        "inverse_mass": np.concatenate([scene["inverse_mass"], np.zeros((count, 2))]),
    }


def gas(count: int, filled: float, seed: int = 0, radius: float = 0.05) -> Scene:
    """Return a gas in a box: discs of 1 kg that cover that share of its area, all at 1 m/s, first in the arrays."""
    rng = np.random.default_rng(seed)
    pitch, side = np.sqrt(np.pi / filled) * radius, int(np.ceil(np.sqrt(count)))
    cells = np.array([(k % side, k // side) for k in range(count)], dtype=float)
    shift = rng.uniform(-0.9, 0.9, (count, 2)) * (0.5 * pitch - radius)
    angle = rng.uniform(0, 2 * np.pi, count)
    scene = {
        "position": (cells + 0.5) * pitch + shift,
        "velocity": np.column_stack([np.cos(angle), np.sin(angle)]),
        "radius": np.full(count, radius),
        "inverse_mass": np.ones((count, 2)),
    }
    return with_held(scene, frame(side * pitch, side * pitch, radius), radius)


def lattice(side: int, pitch: float = 0.3, seed: int = 0, radius: float = 0.05) -> Scene:
    """Return discs of 1 kg on a square lattice, without walls, at random velocities: a gas that expands."""
    cells = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
    return {
        "position": cells * pitch,
        "velocity": np.random.default_rng(seed).normal(size=cells.shape),
        "radius": np.full(len(cells), radius),
        "inverse_mass": np.ones(cells.shape),
    }


def stacked(count: int, columns: int, seed: int = 0, spread: float = 0.2, radius: float = 0.05) -> Scene:
    """Return discs of various radii above one another in a box, about to fall."""
    rng = np.random.default_rng(seed)
    radii = radius * (1 + spread * rng.uniform(-1, 1, count))
    pitch = 2 * radius * 1.25 * (1 + spread)
    cells = np.array([(k % columns, k // columns) for k in range(count)], dtype=float)
    scene = {
        "position": (cells + 0.5) * pitch + rng.uniform(-0.2, 0.2, (count, 2)) * radius,
        "velocity": np.zeros((count, 2)),
        "radius": radii,
        "inverse_mass": np.repeat((radius / radii)[:, None] ** 2, 2, axis=1),
    }
    return with_held(scene, frame(columns * pitch, (count // columns + 1) * pitch, radius), radius)


def packed(columns: int, rows: int, radius: float = 0.05) -> Scene:
    """Return a hexagonal pile at rest in a trough, everything touching: rows of `columns` and one less in turns."""
    pitch = 2 * radius
    places = [
        ((c + 0.5 * (row % 2)) * pitch, (row + 1) * np.sqrt(3) * radius)
        for row in range(rows)
        for c in range(columns - row % 2)
    ]
    scene = {
        "position": np.array(places),
        "velocity": np.zeros((len(places), 2)),
        "radius": np.full(len(places), radius),
        "inverse_mass": np.ones((len(places), 2)),
    }
    floor = [((c - 0.5) * pitch, 0.0) for c in range(columns + 1)]
    walls = [(x, row * np.sqrt(3) * radius) for row in range(1, rows + 2, 2) for x in (-pitch, columns * pitch)]
    return with_held(scene, np.array(floor + walls))


def deepest(place: np.ndarray, radius: np.ndarray, movable: np.ndarray) -> float:
    """Return by how much discs sink into each other at most (m); negative: nothing touches."""
    gap = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1)) - (radius[:, None] + radius[None])
    gap[~(movable[:, None] | movable[None])] = np.inf
    np.fill_diagonal(gap, np.inf)
    return float(-gap.min())
