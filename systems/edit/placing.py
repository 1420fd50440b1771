"""Placing: where new elements lie and others are moved to, on the grid if near it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.table import Table
from pinjoint.components.view import View, drawn_at, drawn_positions
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import PARTICLE_REACH, pick_particle, pick_point

SNAP_REACH = 5.0  # points from a grid line
SAME = 1e-9  # m between places that are one

Points = NDArray[np.float64]


def snapped(model: Model, view: View, point: Vector, start: Vector = (math.inf, math.inf)) -> Vector:
    """A point (m) moved onto the lines of the shown grid within reach, else level with or above a start, by axis.

    Other points are rounded to a power of ten of at most a pixel, so that numbers stay short.
    """
    shown = np.flatnonzero(model.grids.shown)
    spacing = model.grids.spacing[shown[-1]].tolist() if len(shown) else (math.inf, math.inf)
    found = []
    for value, step, from_there in zip(point, spacing, start, strict=True):
        # 3 × 0.1 is 0.3
        line = float(f"{round(value / step) * step:.12g}") if math.isfinite(step) else math.inf
        lines = (line, from_there)
        near = [at for at in lines if abs(at - value) * view.camera.scale <= SNAP_REACH * view.pixel_ratio]
        found.append((near[0] if near else round(value, _digits(view))) + 0.0)  # no −0
    return found[0], found[1]


def snapped_to_points(
    model: Model, view: View, pixel: Vector, kind: type[Handle], besides: Handle | None = None
) -> Vector:
    """The point (m) under a pixel for an element of a mod's kind: a particle, unless they collide with that kind, else a
    point of another such element, within reach, else on the grid if near it."""
    particle = None if kind in EXTENSIONS.obstacles else pick_particle(model, view, pixel)
    if particle is not None:
        return drawn_at(model, particle)
    grip = pick_point(model, view, pixel, besides)
    return snapped(model, view, view.camera.to_model(pixel)) if grip is None else grip.place


def _digits(view: View) -> int:
    """Of a power of ten (m), that which is nearest below a pixel."""
    return math.ceil(math.log10(view.camera.scale) - 1e-9)


def place(model: Model, view: View, point: Vector) -> Particle:
    """A new particle at a point (m). Raises Refusal if one is there already."""
    check_free(model, view, point)
    return model.create(Particle, position=[point])[0]


def particle_at(model: Model, point: Vector) -> Particle | None:
    """The particle that is drawn at a point (m), whatever else is near it."""
    if model.particles.count == 0:
        return None
    away = np.hypot(*(drawn_positions(model) - point).T)
    nearest = int(np.argmin(away))
    return model.particles[nearest] if away[nearest] <= SAME else None


def check_free(model: Model, view: View, point: Vector, besides: list[Particle] | None = None) -> None:
    """Raise Refusal if a particle other than those in `besides` is drawn at a point (m)."""
    if model.particles.count == 0:
        return
    distance = np.hypot(*(drawn_positions(model) - point).T) * view.camera.scale
    distance[model.row_of_entity[[particle.entity for particle in besides or []]]] = math.inf
    nearest = int(np.argmin(distance))
    if distance[nearest] <= PARTICLE_REACH * view.pixel_ratio:
        name = model.describe(model.particles[nearest])
        raise Refusal("{particle} is here already; choose another place, or zoom in.", particle=begun(name))


# --- moving: original positions change, displacements stay as they are ------------------------------------


def moving_rows(model: Model, rows: Mapping[str, NDArray[np.intp]]) -> NDArray[np.intp]:
    """Rows of the particles that move with elements in these rows, by table: those and the ends of rods, ascending."""
    moves = np.zeros(model.particles.count, dtype=bool)
    moves[rows["particles"]] = True
    moves[model.rods.between[rows["rods"]]] = True
    return np.flatnonzero(moves)


class Movable:
    """The movable parts of elements: particles by original positions, other elements by their points."""

    def __init__(self, model: Model, handles: Iterable[Handle]) -> None:
        chosen = list(handles)
        self._model = model
        self.particles = [model.particles[row] for row in moving_rows(model, model.rows_of(chosen)).tolist()]
        self.others = [handle for handle in chosen if handle.points]
        self._groups: list[tuple[Table[Any], Sequence[Handle], str]] = [
            (model.particles, self.particles, "position")
        ]
        for kind in dict.fromkeys(type(handle) for handle in self.others):
            those = [handle for handle in self.others if type(handle) is kind]
            self._groups += [(model.tables[kind.table], those, point) for point in kind.points]

    def __len__(self) -> int:
        return len(self.particles) + len(self.others)

    @property
    def positions(self) -> Points:
        """Original positions of the particles and then the points (m), shape (n, 2)."""
        return np.concatenate(
            [table.column(point)[rows_of(self._model, handles)] for table, handles, point in self._groups]
        )

    def index(self, handle: Handle) -> int:
        """The row of an element (of its first point) in `positions`; 0 for elements that move with others."""
        row = 0
        for _, handles, _ in self._groups:
            if handle in handles:
                return row + handles.index(handle)
            row += len(handles)
        return 0

    def place(self, positions: ArrayLike) -> None:
        """Give all of them new positions (m), in the order of `positions`.

        Raises FieldError, such as for a rod that would lose its length; then nothing has moved.
        """
        wanted = np.asarray(positions, dtype=np.float64)
        with self._model.transaction("move"):
            row = 0
            for _, handles, point in self._groups:
                self._model.assign(handles, point, wanted[row : row + len(handles)])
                row += len(handles)


def rows_of(model: Model, handles: Sequence[Handle]) -> NDArray[np.int64]:
    """Rows of existing elements of one kind, each in its table."""
    return model.row_of_entity[[handle.entity for handle in handles]]


def nudged(model: Model, view: View, positions: ArrayLike, direction: Vector, *, far: bool) -> Points:
    """Positions (m), shape (n, 2), moved by about a pixel, or (far) by a spacing of the shown grid.

    direction: such as (1, 0). Without a grid, far is ten times as far.
    """
    step = np.full(2, 10.0 ** -_digits(view))
    if far:
        shown = np.flatnonzero(model.grids.shown)
        step = model.grids.spacing[shown[-1]] if len(shown) else 10.0 * step
    moved = np.asarray(positions) + np.multiply(direction, step)
    return np.array([float(f"{value:.12g}") for value in moved.ravel()]).reshape(moved.shape)
