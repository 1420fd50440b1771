"""Rods: joining particles, and deleting elements so that masses follow."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np

from components.handle import Handle
from components.model import Model
from components.particle import Particle
from components.rod import Rod, spawn_rods
from systems.edit import Refusal
from systems.edit.moving import rows_of


def distance(first: Particle, second: Particle) -> float:
    """Present distance (m) between two particles."""
    ends = [np.add(end.position, end.displacement) for end in (first, second)]
    return math.hypot(*(ends[1] - ends[0]))


def check_ends(model: Model, first: Particle, second: Particle) -> None:
    """Raise Refusal if two particles cannot be joined by a new rod."""
    if first is second:
        raise Refusal("A rod needs two different particles; point at another one.")
    ends = model.rods.between
    for row in np.flatnonzero(((ends == first.row) | (ends == second.row)).all(axis=1))[:1].tolist():
        raise Refusal(
            f"{first.name} and {second.name} are joined already, by {model.describe(model.rods[row])}."
        )
    if distance(first, second) == 0.0:
        raise Refusal(f"{first.name} and {second.name} are at the same place; move one of them first.")


def join(model: Model, first: Particle, second: Particle) -> Rod:
    """A new rod, without force as the particles are now; their masses follow from the rods again.

    Raises Refusal if it cannot be.
    """
    check_ends(model, first, second)
    moved = first.displacement != second.displacement
    with model.transaction("new rod"):
        [rod] = spawn_rods(
            model,
            [(first.row, second.row)],
            prescribed_rest_length=[distance(first, second) if moved else None],
        )
        masses_from_rods(model, [first, second])
    return rod


def delete(model: Model, handles: Iterable[Handle]) -> None:
    """Delete elements with all that refer to them; masses of the remaining particles follow from the rods again."""
    doomed = list(handles)
    rows = model.rows_of(doomed)
    rods = np.zeros(model.rods.count, dtype=bool)
    rods[rows["rods"]] = True
    particles = np.zeros(model.particles.count, dtype=bool)
    particles[rows["particles"]] = True
    rods |= particles[model.rods.between].any(axis=1)
    ends = np.zeros(model.particles.count, dtype=bool)
    ends[model.rods.between[rods]] = True
    remaining = [model.particles[row] for row in np.flatnonzero(ends & ~particles).tolist()]
    with model.transaction("delete"):
        masses_from_rods(model, remaining)
        model.delete(doomed)


def masses_from_rods(model: Model, particles: Sequence[Particle]) -> None:
    """Forget the masses that were prescribed for these particles."""
    given = ~np.isnan(model.particles.prescribed_mass[rows_of(model, particles)])
    model.assign(list(itertools.compress(particles, given.tolist())), "prescribed_mass", None)
