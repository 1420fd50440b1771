"""Overlap removal: discs that overlap where a run begins are moved apart."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.language import joined, plural
from pinjoint.components.model import Model
from pinjoint.components.obstacles import NO_OBSTACLES, Obstacles, obstacles
from pinjoint.components.rod import nodes
from pinjoint.systems.broad_phase import SEARCH_MARGIN, Rows, gaps, near_pairs
from pinjoint.systems.collision.free.discs import WORK_AT_ONCE
from pinjoint.systems.program.compiler import LONGEST_WORK, GeneratedModule, entries_to

SLACK = 1e-13  # of the reach of two discs: a smaller overlap is round-off
AROUND = 1.5  # radii: the neighbours of a disc within it are moved apart at a time
_MOST_ROUNDS = 100  # in each of which neighbours are found anew
MOST_SWEEPS = 400  # over the same pairs; overlaps that these leave stay
_JOINT_WORK = 32  # operations in a joint impact, for each of the pairs and each disc of the row that passes it on (measured)
_UNSEEN_OVERLAP = 1e-3  # of a radius: too small to see, as steps of piles leave them, and not worth a message

Among = Callable[[Rows], NDArray[np.bool_]]


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    from pinjoint.systems.collision.kernels import overlap

    return entries_to({"part": overlap.separate})


def _warm_up() -> None:
    vectors, rows = np.zeros((2, 2)), np.zeros(0, dtype=np.int64)
    PARTING.form.part(rows, rows, vectors, vectors, np.ones(2), vectors, vectors, SLACK, 0, 0)


PARTING = GeneratedModule("parting", _contents, _warm_up)  # of its own: compiled within a second


def overlaps(place: Array, radius: Array, others: Obstacles = NO_OBSTACLES) -> Rows:
    """Pairs of discs, and of discs and obstacles, that overlap, shape (k, 2)."""
    pairs = near_pairs(place, radius, others)
    reach = np.concatenate([radius, others.radius])[pairs].sum(axis=1)
    return pairs[gaps(place, radius, pairs, others)[0] < -SLACK * reach]


def part(
    position: Array,
    displacement: Array,
    radius: Array,
    inverse_mass: Array,
    among: Among,
    others: Obstacles = NO_OBSTACLES,
) -> Generator[None, None, int]:
    """Move overlapping discs apart, in portions, changing `displacement`; returns the number of pairs that still overlap.

    among: selects the pairs that are to be parted.
    """
    count, still = len(position), np.zeros((len(others), 2))
    places, moved = np.concatenate([position, others.start]), np.concatenate([displacement, still])
    span = np.concatenate([np.zeros_like(position), others.span])
    radii, inverse = np.concatenate([radius, others.radius]), np.concatenate([inverse_mass, still])
    for _ in range(_MOST_ROUNDS):
        near = near_pairs(position + moved[:count], AROUND * radius, others)
        near = near[among(near)]
        first, second = np.ascontiguousarray(near[:, 0]), np.ascontiguousarray(near[:, 1])
        sweep = last = 0
        while sweep == last < MOST_SWEEPS:
            yield
            most = (WORK_AT_ONCE if PARTING.is_loaded else LONGEST_WORK) // max(len(near), 1)
            last = min(sweep + max(most, 1), MOST_SWEEPS)
            sweep = PARTING.form.part(first, second, places, moved, radii, inverse, span, SLACK, sweep, last)
        if sweep == 0:
            break
    displacement[...] = moved[:count]
    left = overlaps(position + displacement, radius, others)
    return int(among(left).sum())


def _colliding(model: Model) -> Among:
    """Selects the pairs that collide: not nodes of structures with each other, nor what is held."""
    particles, others = model.particles, obstacles(model)
    node: NDArray[np.bool_] = np.ones(particles.count + len(others), dtype=bool)  # obstacles count as nodes
    held = node.copy()
    held[: particles.count] = (particles.mobility == 0.0).all(axis=1)
    node[: particles.count] = nodes(model)

    def among(pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
        left_alone: NDArray[np.bool_] = np.logical_or(node[pairs].all(axis=1), held[pairs].all(axis=1))
        return np.logical_not(left_alone)

    return among


def work_ahead(model: Model) -> tuple[int, int]:
    """Operations, counted at most, of parting what overlaps, and of an impact that all that touches takes part in.

    Of what is pulled, large groups take steps as piles, which are short.
    """
    particles, others = model.particles, obstacles(model)
    place = particles.position + particles.displacement
    pairs, among = near_pairs(place, SEARCH_MARGIN * particles.radius, others), _colliding(model)
    if not len(pairs := pairs[among(pairs)]):
        return 0, 0
    overlapping = int(among(overlaps(place, particles.radius, others)).sum())
    touching = place[pairs[:, 0]]
    row = float(np.ptp(touching, axis=0).max() / (2.0 * particles.radius[pairs[:, 0]].min())) + 1.0
    together = 0 if particles.constant_force.any() else len(pairs) - overlapping
    return MOST_SWEEPS * overlapping, int(_JOINT_WORK * together * row)


def part_overlaps(model: Model) -> Generator[None, None, str]:
    """Move overlapping particles apart, except nodes of structures from each other, in portions; returns a message, or "".

    There is no message about overlaps that are too small to see.
    """
    particles, others, among = model.particles, obstacles(model), _colliding(model)
    displacement = particles.displacement.copy()
    overlapping = overlaps(particles.position + displacement, particles.radius, others)
    overlapping = overlapping[among(overlapping)]
    count = len(overlapping)
    if count == 0:
        return ""
    columns = particles.position, displacement, particles.radius, particles.mobility
    left = yield from part(*columns, among, others)
    farthest = float(np.abs(displacement - particles.displacement).max())
    model.writable("particles.displacement")[...] = displacement
    if farthest <= _UNSEEN_OVERLAP * float(particles.radius.min()) and not left:
        return ""
    if (overlapping[:, 1] >= particles.count).any():
        note = plural(
            "1 particle overlapped an obstacle: it was moved away.",
            "{count} overlaps of particles with others or with obstacles: the particles were moved apart.",
            count,
        )
    else:
        note = plural(
            "1 pair of particles overlapped and was moved apart along the line of centres.",
            "{count} pairs of particles overlapped and were moved apart along their lines of centres.",
            count,
        )
    still = plural(
        "1 pair still overlaps: move one of the two, or free a direction.",
        "{count} pairs still overlap: move them, or free a direction.",
        left,
    )
    return joined([note, still if left else ""])
