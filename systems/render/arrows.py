"""Arrows of one length for the directions of loads and velocities; force diagrams show sizes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from components.rod import nodes
from components.tags import DiagramShown
from systems.render.clip import bounds, clip_segments
from systems.render.labels import STRONG
from systems.render.marks import Fills, Mark, Strokes
from systems.render.sheet import DIRECTIONS, Rows, Sheet
from systems.render.supports import crowding
from systems.render.theme import Colour

MOST = 100  # particles, above which arrows would hide one another
LENGTH, HEAD = 32.0, 10.0  # points
GAP = 3.0  # points between an arrow and its particle


def draw_loads(sheet: Sheet) -> Iterator[Mark]:
    """The direction of the force on each particle, its loads at full size included, where no diagram shows it."""
    model = sheet.model
    force, count = model.particles.force.copy(), model.particles.count
    for axis in (0, 1):
        force[:, axis] += np.bincount(model.loads.on, model.loads.force[:, axis], count)
    loaded = (force[:, 0] != 0.0) | (force[:, 1] != 0.0)
    loaded[sheet.tagged(DiagramShown, "particles")] = False
    rows = sheet.particles[loaded[sheet.particles]]
    if sheet.view.all_diagrams or not 0 < len(rows) <= MOST:
        return
    sheet.legend.append("load")
    along = _directions(force[rows])
    ahead = np.argmax(along @ DIRECTIONS.T, axis=1)
    crowd = crowding(sheet, rows)
    pushes = crowd[rows, (ahead + 2) % 4] <= crowd[rows, ahead] + 0.1  # towards the particle, if there is room
    yield from _arrows(sheet, rows, along, sheet.theme.force, pushes)


def draw_velocities(sheet: Sheet) -> Iterator[Mark]:
    """The direction of velocity of free particles, and of nodes before their first step, while time stands still."""
    model = sheet.model
    velocity = model.particles.velocity
    moving = (velocity[:, 0] != 0.0) | (velocity[:, 1] != 0.0)
    if model.clock.steps:
        moving &= ~nodes(model)
    rows = sheet.particles[moving[sheet.particles]]
    if sheet.view.status.speed or not 0 < len(rows) <= MOST:
        return
    sheet.legend.append("velocity")
    yield from _arrows(sheet, rows, _directions(velocity[rows]), sheet.theme.ink)


def _directions(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors in pixels, y down."""
    scaled = vectors / np.abs(vectors).max(axis=1)[:, None]  # squares of tiny components would underflow
    directions: NDArray[np.float64] = scaled / np.hypot(scaled[:, 0], scaled[:, 1])[:, None] * [1.0, -1.0]
    return directions


def _arrows(
    sheet: Sheet,
    rows: Rows,
    along: NDArray[np.float64],
    colour: Colour,
    pushes: NDArray[np.bool_] | bool = False,
) -> Iterator[Mark]:
    """From the rims of particles outwards, or (pushes) ending there."""
    u = sheet.unit
    reach = (sheet.radii[rows] + GAP * u)[:, None] * along
    length = LENGTH * u * along
    tail = sheet.centres[rows] + np.where(np.reshape(pushes, (-1, 1)), -reach - length, reach)
    tip, across = tail + length, along[:, ::-1] * [-1.0, 1.0]
    neck = tip - HEAD * u * along
    low, high = bounds(sheet.viewport)
    _, _, seen = clip_segments(tail, tip, low - HEAD * u, high + HEAD * u)  # rims may be beyond all pixels
    tail, tip, across, neck, of = tail[seen], tip[seen], across[seen], neck[seen], ("particles", rows[seen])
    sheet.occupancy.line(tail, tip, STRONG)
    yield Strokes(tail, neck, 2.0 * u, colour, of)
    head = np.stack([tip, neck + 0.5 * HEAD * u * across, neck - 0.5 * HEAD * u * across], axis=1)
    yield Fills(head, colour, of)
