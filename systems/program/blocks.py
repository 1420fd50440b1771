"""Layouts: a large model in blocks that fit a cache and can be computed in parallel.

A space-filling curve through the original positions of the particles is cut into pieces with about the same number of
rod ends each. Within a block, particles are numbered by row and column of the picture, and rods by their ends:
neighbours lie near each other in memory. Rods within blocks come first, block after block, then the rods between
blocks. Blocks are computed independently, the rods between them afterwards. The order of every particle's sum thus
depends on the model alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.model import Model

BLOCK = 8192  # rods in a block at most, about: their particles stay in the cache of one core
SHARES = 8  # the number of blocks is a multiple of this: 2, 4 or 8 cores get equal shares

Numbers = NDArray[np.intp]


@dataclass(frozen=True)
class Layout:
    """Which particles and rods of a model a program holds in which of its rows.

    particles, rods: the particle or rod in each row. row: of each particle, -1 if it is left out. ends: rows of the
    particles at the ends of each row's rod. first_particle, first_rod: the first row of each block, then of the
    rods between blocks, and the number of rows.
    """

    particles: Numbers
    rods: Numbers
    row: Numbers
    ends: NDArray[np.uint32]
    first_particle: Numbers
    first_rod: Numbers

    @classmethod
    def in_order(cls, model: Model) -> Layout:
        """All of a model in one block, in its own order."""
        rows, rods = np.arange(model.particles.count), np.arange(model.rods.count)
        limits = (np.array([0, count, count], dtype=np.intp) for count in (len(rows), len(rods)))
        return cls(rows, rods, rows, model.rods.between, *limits)

    @classmethod
    def of(cls, model: Model) -> Layout:
        """The layout of a model in blocks of up to BLOCK rods or so."""
        position, between = model.particles.position, model.rods.between.astype(np.intp)
        count, blocks = len(position), SHARES * max(math.ceil(len(between) / (SHARES * BLOCK)), 1)
        curve = np.argsort(_along_curve(position), kind="stable")
        crowd = np.cumsum(np.bincount(between.ravel(), minlength=count)[curve])
        limits = np.searchsorted(crowd, crowd[-1:] * np.arange(1, blocks) / blocks)
        first_particle = np.concatenate([[0], limits, [count, count]]).astype(np.intp)
        block = np.repeat(np.arange(blocks + 1), np.diff(first_particle))
        particles = curve[np.lexsort((*position[curve].T, block))]
        row = np.empty_like(particles)
        row[particles] = np.arange(count)
        ends = row[between]
        home = block[ends]
        block_of = np.where(home[:, 0] == home[:, 1], home[:, 0], blocks)
        rods = np.lexsort((ends.max(axis=1), ends.min(axis=1), block_of))
        first_rod = np.searchsorted(block_of[rods], np.arange(blocks + 2))
        return cls(particles, rods, row, ends[rods].astype(np.uint32), first_particle, first_rod)

    def part(self, moving: NDArray[np.bool_]) -> Layout:
        """The layout of the rods that hold moving particles, and of the particles at their ends, in the same order.

        moving: which particles move, shape (n,).
        """
        here = moving[self.particles]
        rods = np.asarray(here[self.ends].any(axis=1))
        here[self.ends[rods]] = True
        particles = self.particles[here]
        row = np.full_like(self.row, -1)
        row[particles] = np.arange(len(particles))
        return Layout(
            particles,
            self.rods[rods],
            row,
            row[self.particles[self.ends[rods]]].astype(np.uint32),
            _remaining(self.first_particle, here),
            _remaining(self.first_rod, rods),
        )


def _remaining(first: Numbers, stays: NDArray[np.bool_]) -> Numbers:
    """The first row of each block once only some rows stay."""
    before = np.concatenate([[0], np.cumsum(stays)]).astype(np.intp)
    return before[first]


def _along_curve(position: NDArray[np.float64]) -> NDArray[np.uint64]:
    """The place of each position along Morton's curve, which visits squares within squares."""
    low, high = position.min(axis=0, initial=np.inf), position.max(axis=0, initial=-np.inf)
    size = max(float((high - low).max(initial=0.0)), np.finfo(float).tiny)
    return _spread(position[:, 0], low[0], size) | (_spread(position[:, 1], low[1], size) << np.uint64(1))


def _spread(along: NDArray[np.float64], low: float, size: float) -> NDArray[np.uint64]:
    """The first 16 binary digits of each place in [low, low + size], every second digit a zero."""
    bits = ((along - low) / size * 65535.0).astype(np.uint64)
    for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
    return bits
