"""Bending: what is computed of all rods that bend at once, outside steps, in the present state of a model."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.derived import chord_rotation, on_axis, rigid_slopes
from pinjoint.components.model import Model
from pinjoint.components.particle import spring_stiffness
from pinjoint.components.rod import bends


def slopes(model: Model) -> Array:
    """Slopes of the rigid ends of every rod to its chord (rad), 0 at others; shape (rods, 2)."""
    rotation = model.particles.rotation[model.rods.between]
    return rigid_slopes(model.rods, rotation, chord_rotation(model))


def bending_energy(model: Model) -> Array:
    """½ (φ − φ⁰)ᵀ K (φ − φ⁰) of every rod (kN·m)."""
    start, end = (slopes(model) - model.rods.initial_slopes).T
    of_start, mixed, of_end = model.rods.end_stiffness.T
    return 0.5 * (of_start * start**2 + of_end * end**2) + mixed * start * end


def bowing_work(model: Model) -> Array:
    """Work of what acts between the ends of every rod, by their slopes, of couples by the turning chord (kN·m)."""
    rods = model.rods
    first, second = rods.between.astype(np.intp).T
    present = rods.difference + model.particles.displacement[second] - model.particles.displacement[first]
    length = np.hypot(present[:, 0], present[:, 1])
    across = on_axis(rods.span_load, present / np.where(length > 0.0, length, 1.0)[:, None])[1]
    return (across * slopes(model)).sum(axis=1) + rods.span_load[:, 6] * chord_rotation(model)


def levers(model: Model) -> Array:
    """1/the shortest rod at each particle (1/m), by which moments compare with forces; 0 without rods."""
    rods = model.rods
    found = np.zeros(model.particles.count)
    for ends in rods.between.T:
        np.maximum.at(found, ends, 1.0 / rods.rest_length)
    return found


def arm_of(model: Model) -> float:
    """The length ℓ (m) by which rotations θ count as displacements ℓθ: a power of two, at most the longest rod."""
    return math.ldexp(0.5, math.frexp(float(model.rods.rest_length.max()))[1])


def free_coordinates(model: Model) -> NDArray[np.bool_]:
    """Which coordinates of each particle can move, shape (n, 2), or with rotations (n, 3) in models that bend."""
    free = model.particles.mobility > 0.0
    if not bends(model):
        return np.asarray(free)
    return np.column_stack([free, model.particles.turning > 0.0])


def deformations(model: Model) -> tuple[Array, NDArray[np.intp], NDArray[np.intp], Array, Array]:
    """How rods deform by small displacements and rotations from the original geometry: entries, rows and columns.

    Elongations, what springs of supports hold and, in models that bend, two combinations of the slopes of each rod, by
    which K = Σ k d dᵀ and likewise C: K₁₁ (φ_a + K₁₂/K₁₁ φ_b)² + (K₂₂ − K₁₂²/K₁₁) φ_b². Also the stiffness and the
    damping of every row.
    """
    rods = model.rods
    ends = rods.between.astype(np.intp)
    length = np.where(rods.original_length > 0.0, rods.original_length, 1.0)
    axis = rods.difference / length[:, None]
    count, width = len(ends), 3 if bends(model) else 2
    places = np.stack(
        [width * ends[:, 0], width * ends[:, 0] + 1, width * ends[:, 1], width * ends[:, 1] + 1], axis=1
    )
    rows = [np.repeat(np.arange(count), 4)]
    columns, entries = [places.ravel()], [np.concatenate([-axis, axis], axis=1).ravel()]
    stiffness, damping = [rods.stiffness / rods.rest_length], [rods.damping]
    if width == 3:
        left = np.stack([-axis[:, 1], axis[:, 0]], axis=1) / length[:, None]
        leaning = np.concatenate([left, -left], axis=1)  # of both slopes
        start, mixed, end = rods.end_stiffness.T
        share = np.divide(mixed, start, out=np.zeros(count), where=start > 0.0)
        turns = np.stack([3 * ends[:, 0] + 2, 3 * ends[:, 1] + 2], axis=1)
        for place, of_start, of_end in ((1, 1.0, share), (2, 0.0, 1.0)):
            own = np.stack([np.broadcast_to(of_start, count), np.broadcast_to(of_end, count)], axis=1)
            rows.append(np.repeat(place * count + np.arange(count), 6))
            columns.append(np.concatenate([places, turns], axis=1).ravel())
            entries.append(np.concatenate([leaning * own.sum(axis=1)[:, None], own], axis=1).ravel())
        stiffness += [start, end - share * mixed]
        damping += [rods.end_damping[:, 0], rods.end_damping[:, 2] - share * rods.end_damping[:, 1]]
    springs = spring_stiffness(model)[:, :width].ravel()
    held = np.flatnonzero(springs)
    rows.append(sum(map(len, stiffness)) + np.arange(len(held)))
    columns, entries = [*columns, held], [*entries, np.ones(len(held))]
    stiffness, damping = [*stiffness, springs[held]], [*damping, np.zeros(len(held))]
    found = map(np.concatenate, (entries, rows, columns, stiffness, damping))
    return tuple(found)  # type: ignore[return-value]


def stiffness_matrix(model: Model, *, by_mass: bool = False) -> tuple[Array, float]:
    """K of the free coordinates in the original geometry, or M^-½ K M^-½, and the largest stiffness in it."""
    entries, rows, columns, stiffness, _ = deformations(model)
    free = free_coordinates(model)
    deformed = np.zeros((len(stiffness), free.size))
    deformed[rows, columns] = entries
    if by_mass:
        mobility = np.column_stack([model.particles.mobility, model.particles.turning])
        deformed *= np.sqrt(mobility[:, : free.shape[1]]).ravel()
    deformed = deformed[:, free.ravel()]
    return deformed.T @ (deformed * stiffness[:, None]), float(stiffness.max())
