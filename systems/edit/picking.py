"""Picking: which element lies under a pixel, and which elements lie in a box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinjoint.components.additions import outlines
from pinjoint.components.bent import FLAT, curved_lines
from pinjoint.components.field import Vector
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.view import View, drawn_positions
from pinjoint.systems.broad_phase import distance_to_segments

PARTICLE_REACH = 8.0  # points from the centre, at least its radius
_ROD_REACH = 10.0  # points
END_REACH, END_SHARE = 48.0, 0.4  # points, and share of a rod: what belongs to an end of it
RING = 16.0  # points from a joint, where hinges of one rod are


@dataclass(frozen=True)
class Grip:
    """A point by which an element can be dragged. point: the name of the Field."""

    element: Handle
    point: str

    @property
    def place(self) -> Vector:
        """The place of the point (m)."""
        return getattr(self.element, self.point)


def pick_end(model: Model, view: View, pixel: Vector) -> tuple[Rod, int] | None:
    """The rod under a pixel and that end of it, 0 or 1, which is near; None if none is, and under the toolbar."""
    rod = None if view.covers(pixel) else pick_rod(model, view, pixel)
    if rod is None:
        return None
    x, y = (view.camera.to_pixels(drawn_positions(model)[list(rod.between)]) - pixel).T
    away = np.hypot(x, y)
    number = int(np.argmin(away))
    reach = min(END_REACH * view.pixel_ratio, END_SHARE * float(np.hypot(x[1] - x[0], y[1] - y[0])))
    return (rod, number) if away[number] <= reach else None


def ring_of(model: Model, view: View, rod: Rod, end: int) -> Vector:
    """Where a hinge at an end of a rod is drawn (m)."""
    rows = list(rod.between)
    at, other = drawn_positions(model)[rows if end == 0 else rows[::-1]]
    length = float(np.hypot(*(other - at)))
    share = min(RING * view.pixel_ratio / view.camera.scale / length, 0.25) if length > 0.0 else 0.0
    x, y = (at + share * (other - at)).tolist()
    return x, y


def pick(model: Model, view: View, pixel: Vector) -> Handle | None:
    """The particle, else the rod or the element of a mod under a pixel; None if there is nothing."""
    if view.covers(pixel):
        return None
    return pick_particle(model, view, pixel) or pick_line(model, view, pixel)


def pick_line(model: Model, view: View, pixel: Vector, reach: float = _ROD_REACH) -> Handle | None:
    """The rod, else the element of a mod's kind with points, within reach (points) of a pixel."""
    return pick_rod(model, view, pixel, reach) or _outlined_at(model, view, pixel, reach)


def pick_particle(model: Model, view: View, pixel: Vector) -> Particle | None:
    """The particle within reach of a pixel, the nearest relative to its reach; None under the toolbar."""
    if model.particles.count == 0 or view.covers(pixel):
        return None
    x, y = (view.camera.to_pixels(drawn_positions(model)) - pixel).T
    reach = np.maximum(model.particles.radius * view.camera.scale, PARTICLE_REACH * view.pixel_ratio)
    beyond = np.hypot(x, y) - reach
    nearest = int(np.argmin(beyond))
    return model.particles[nearest] if beyond[nearest] <= 0.0 else None


def pick_rod(model: Model, view: View, pixel: Vector, reach: float = _ROD_REACH) -> Rod | None:
    """The nearest rod within reach (points) of a pixel, bent ones along their curves."""
    if model.rods.count == 0:
        return None
    places, at = view.camera.to_pixels(drawn_positions(model)), np.array(pixel)
    first, last = model.rods.between.astype(np.intp).T
    distance = distance_to_segments(at, places.take(first, axis=0), places.take(last, axis=0))
    if (curved := curved_lines(model, FLAT / view.camera.scale)) is not None:
        ends = (view.camera.to_pixels(points) for points in (curved.start, curved.end))
        distance[curved.rods] = np.inf
        np.minimum.at(distance, curved.rods, distance_to_segments(at, *ends))
    nearest = int(np.argmin(distance))
    return model.rods[nearest] if distance[nearest] <= reach * view.pixel_ratio else None


def _outlined_at(model: Model, view: View, pixel: Vector, reach: float) -> Handle | None:
    """The nearest element, within reach, of a mod's kind with points, seen as the lines through them."""
    best, found = reach * view.pixel_ratio, None
    for table, points in outlines(model):
        places, lines = view.camera.to_pixels(points), max(points.shape[1] - 1, 1)
        ends = places[:, :lines], np.roll(places, -1, axis=1)[:, :lines]
        distance = distance_to_segments(np.array(pixel), *ends).min(axis=1)
        nearest = int(np.argmin(distance))
        if distance[nearest] <= best:
            best, found = float(distance[nearest]), table[nearest]
    return found


def pick_point(model: Model, view: View, pixel: Vector, besides: Handle | None = None) -> Grip | None:
    """The nearest point of an element of a mod's kind within reach of a pixel; None if there is none."""
    best, found = PARTICLE_REACH * view.pixel_ratio, None
    for table, points in outlines(model):
        away = np.hypot(*np.moveaxis(view.camera.to_pixels(points) - pixel, -1, 0))
        if besides is not None and besides.table == table.name:
            away[besides.row] = np.inf
        row, k = np.unravel_index(int(np.argmin(away)), away.shape)
        if away[row, k] <= best:
            best, found = float(away[row, k]), Grip(table[int(row)], table.kind.points[int(k)])
    return found


def pick_grid(model: Model, view: View, pixel: Vector) -> Grid | None:
    """The shown grid, if one of its lines is within reach of a pixel."""
    reach = 5.0 * view.pixel_ratio
    if view.strip.contains(pixel):
        return None
    for row in np.flatnonzero(model.grids.shown).tolist():
        grid = model.grids[row]
        point = view.camera.to_model(pixel)
        for value, spacing in zip(point, grid.spacing, strict=True):
            offset = abs(value - round(value / spacing) * spacing) * view.camera.scale
            if spacing * view.camera.scale > 2 * reach and offset <= reach:
                return grid
    return None


def inside(model: Model, corner: Vector, opposite: Vector) -> list[Handle]:
    """Particles drawn inside the box between two points (m), and elements with all ends or points inside."""
    low, high = np.minimum(corner, opposite), np.maximum(corner, opposite)
    drawn = drawn_positions(model)
    within = np.asarray(((drawn >= low) & (drawn <= high)).all(axis=1))
    rods = within[model.rods.between].all(axis=1)
    return [
        *(model.particles[row] for row in np.flatnonzero(within).tolist()),
        *(model.rods[row] for row in np.flatnonzero(rods).tolist()),
        *(
            table[row]
            for table, points in outlines(model)
            for row in np.flatnonzero(((points >= low) & (points <= high)).all(axis=(1, 2))).tolist()
        ),
    ]


def everything(model: Model) -> list[Handle]:
    """All particles and rods, and the elements of mods that have a place."""
    return [*model.particles, *model.rods, *(handle for table, _ in outlines(model) for handle in table)]
