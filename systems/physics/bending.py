"""Bending: what is computed of all rods that bend at once, outside steps, in the present state of a model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from components.derived import chord_rotation
from components.model import Model

Array = NDArray[np.float64]


def slopes(model: Model) -> Array:
    """Slopes of the rigid ends of every rod to its chord (rad), 0 at others; shape (rods, 2)."""
    rods = model.rods
    rotation = model.particles.rotation[rods.between]
    found: Array = np.where(rods.turning_shares > 0.0, rotation - chord_rotation(model)[:, None], 0.0)
    return found


def bending_energy(model: Model) -> Array:
    """½ (φ − φ⁰)ᵀ K (φ − φ⁰) of every rod (kN·m)."""
    start, end = (slopes(model) - model.rods.initial_slopes).T
    of_start, mixed, of_end = model.rods.end_stiffness.T
    energy: Array = 0.5 * (of_start * start**2 + of_end * end**2) + mixed * start * end
    return energy


def bowing_work(model: Model) -> Array:
    """What its distributed force does on every rod by the slopes of its ends (kN·m)."""
    rods = model.rods
    first, second = rods.between.astype(np.intp).T
    present = rods.difference + model.particles.displacement[second] - model.particles.displacement[first]
    length = np.hypot(present[:, 0], present[:, 1])
    x, y = (present / np.where(length > 0.0, length, 1.0)[:, None]).T
    transverse = rods.distributed_force[:, 1] * x - rods.distributed_force[:, 0] * y
    work: Array = transverse * (rods.load_shares * slopes(model)).sum(axis=1)
    return work


def levers(model: Model) -> Array:
    """1/the shortest rod at each particle (1/m), by which moments compare with forces; 0 without rods."""
    rods = model.rods
    found = np.zeros(model.particles.count)
    for ends in rods.between.T:
        np.maximum.at(found, ends, 1.0 / rods.rest_length)
    return found
