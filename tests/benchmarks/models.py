"""Models that benchmarks share: made by size, without a file."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod


def truss(**rods: Any) -> Model:
    """The thesis' isostatic triangle: three rods."""
    model = Model()
    model.create(
        Particle,
        3,
        name=["A", "B", "C"],
        position=[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)],
        fixed=[(False, True), (False, False), (True, True)],
        force=[(0.0, 0.0), (120.0, -160.0), (0.0, 0.0)],
    )
    model.create(Rod, 3, between=[(0, 1), (1, 2), (2, 0)], name=["AB", "BC", "CA"], **rods)
    return model


def lattice(rods: int, *, at_random: bool = False, **columns: Any) -> Model:
    """A square lattice with both diagonals and about so many rods, its left edge held, pulled to the right.

    at_random: its particles and rods are numbered in no order.
    """
    side = max(round((rods / 4.0) ** 0.5), 2)
    return _held_at_the_left(side, side, _with_diagonals(side), columns, at_random)


def islands(count: int, rods: int, **columns: Any) -> Model:
    """So many lattices of about so many rods each, of which only the first is pulled."""
    one = lattice(rods)
    particles, moved = one.particles, np.zeros((one.particles.count, 2))
    moved[:, 0] = 2.0 * particles.position[:, 0].max()
    several, ends = range(count), one.rods.between.astype(np.intp)
    model = Model()
    model.create(
        Particle,
        count * particles.count,
        position=np.concatenate([particles.position + k * moved for k in several]),
        fixed=np.tile(particles.fixed, (count, 1)),
        force=np.concatenate([particles.force * (k == 0) for k in several]),
    )
    between = np.concatenate([ends + k * particles.count for k in several])
    model.create(Rod, len(between), between=between, **columns)
    return model


def overlapping(count: int) -> Model:
    """So many discs in 1 m², most of which overlap."""
    model = Model()
    model.create(Particle, count, position=np.random.default_rng(3).uniform(0.0, 1.0, (count, 2)))
    return model


def touching(columns: int, rows: int) -> Model:
    """Discs in a grid that touch, the first of which sets out to the right."""
    model = Model()
    position = [(0.1 * (k % columns), 0.1 * (k // columns)) for k in range(columns * rows)]
    model.create(
        Particle, len(position), position=position, velocity=[(1.0, 0.0)] + [(0.0, 0.0)] * (len(position) - 1)
    )
    return model


# Whose first steps have calls that would take long interpreted.
CROWDS: dict[str, Callable[[], Model]] = {
    "290 overlapping": partial(overlapping, 290),
    "2000 overlapping": partial(overlapping, 2000),
    "400 touching": partial(touching, 20, 20),
    "290 in a row": partial(touching, 290, 1),
}


def mesh(rods: int, **columns: Any) -> Model:
    """Like a lattice, without diagonals, and wider than high: half as many particles as rods."""
    height = max(round((rods / 3.2) ** 0.5), 2)
    width = round(1.6 * height)
    return _held_at_the_left(width, height, _across_and_up(width, height), columns)


def storeys(bays: int, floors: int) -> Model:
    """A steel frame, clamped below, with a distributed force on every beam: bays × floors beams and a column more each."""
    model, columns = Model(), bays + 1
    place = np.arange(columns * (floors + 1)).reshape(floors + 1, columns)
    x, y = np.meshgrid(4.0 * np.arange(columns), 3.0 * np.arange(floors + 1))
    foot = y.ravel() == 0.0
    model.create(
        Particle,
        place.size,
        position=np.column_stack([x.ravel(), y.ravel()]),
        fixed=np.column_stack([foot, foot]),
        fixed_rotation=foot,
    )
    up = np.column_stack([place[:-1].ravel(), place[1:].ravel()])
    across = np.column_stack([place[1:, :-1].ravel(), place[1:, 1:].ravel()])
    model.create(Rod, len(up), between=up, section="HEB 200")
    model.create(Rod, len(across), between=across, section="IPE 300", distributed_force=(0.0, -20.0))
    return model


def _held_at_the_left(
    width: int, height: int, ends: np.ndarray, columns: dict[str, Any], at_random: bool = False
) -> Model:
    x, y = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    position = np.stack([x.ravel(), y.ravel()], axis=1)
    if at_random:
        rng = np.random.default_rng(0)
        number = rng.permutation(len(position))
        position, ends = position[np.argsort(number)], rng.permutation(number[ends])
    left, right = position[:, 0] == 0.0, position[:, 0] == width - 1.0
    force = np.zeros_like(position)
    force[right, 0] = 100.0
    model = Model()
    model.create(Particle, len(position), position=position, fixed=np.stack([left, left], axis=1), force=force)
    model.create(Rod, len(ends), between=ends, **columns)
    return model


def _across_and_up(width: int, height: int) -> np.ndarray:
    index = np.arange(width * height).reshape(height, width)
    across = np.stack([index[:, :-1].ravel(), index[:, 1:].ravel()], axis=1)
    up = np.stack([index[:-1].ravel(), index[1:].ravel()], axis=1)
    return np.concatenate([across, up])


def _with_diagonals(side: int) -> np.ndarray:
    index = np.arange(side * side).reshape(side, side)
    rising = np.stack([index[:-1, :-1].ravel(), index[1:, 1:].ravel()], axis=1)
    falling = np.stack([index[:-1, 1:].ravel(), index[1:, :-1].ravel()], axis=1)
    pairs = np.concatenate([_across_and_up(side, side), rising, falling])
    return pairs[np.argsort(pairs.min(axis=1), kind="stable")]
