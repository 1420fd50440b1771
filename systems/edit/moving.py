"""Moving: dragging and nudging change original positions, the design; displacements stay as they are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from components.field import Vector
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.view import View
from components.world import Handle
from systems.edit.placing import resolution

Points = NDArray[np.float64]


def movable(model: Model, handles: Iterable[Handle]) -> list[Particle]:
    """The particles that move with some elements: themselves, and the ends of rods; in row order."""
    chosen = list(handles)
    moves = np.zeros(model.particles.count, dtype=bool)
    moves[rows_of(model, [handle for handle in chosen if isinstance(handle, Particle)])] = True
    moves[model.rods.between[rows_of(model, [handle for handle in chosen if isinstance(handle, Rod)])]] = True
    return [model.particles[row] for row in np.flatnonzero(moves).tolist()]


def rows_of(model: Model, handles: Sequence[Handle]) -> NDArray[np.int64]:
    """Rows of existing elements of one kind, each in its table."""
    rows: NDArray[np.int64] = model.row_of_entity[[handle.entity for handle in handles]]
    return rows


def move(model: Model, particles: list[Particle], positions: ArrayLike) -> None:
    """Give particles new original positions (m), shape (n, 2). Raises FieldError if a rod lost its length."""
    model.assign(particles, "position", np.asarray(positions, dtype=np.float64))


def nudged(model: Model, view: View, positions: ArrayLike, direction: Vector, *, far: bool) -> Points:
    """Positions (m), shape (n, 2), moved by about a pixel, or (far) by a spacing of the shown grid.

    direction: such as (1, 0). Without a grid, far is ten times as far.
    """
    step = np.full(2, resolution(view))
    if far:
        shown = np.flatnonzero(model.grids.shown)
        step = model.grids.spacing[shown[-1]] if len(shown) else 10.0 * step
    moved = np.asarray(positions) + np.multiply(direction, step)
    tidy: Points = np.array([float(f"{value:.12g}") for value in moved.ravel()]).reshape(moved.shape)
    return tidy
