"""Pointed: the numbers of the element under the pointer, beside it."""

from __future__ import annotations

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.handle import Handle
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.tags import Hovered
from pinjoint.systems.render.clip import bounds, clip_segments
from pinjoint.systems.render.layout import Column, Paper, Plate, Row, Text
from pinjoint.systems.render.marks import Mark, Points
from pinjoint.systems.render.occupancy import STRONG
from pinjoint.systems.render.sheet import Sheet
from pinjoint.systems.render.symbols import SUPPORT_DEPTH
from pinjoint.systems.render.theme import faded

_PAD, _GAP, _NEAR = 8.0, 14.0, 16.0  # points: inside the box, between columns, to the pointer
_ROWS = (8, 2, 1)  # how many are told, where that many find room
_STEP = 8.0  # points between places that are tried where those beside the pointer are taken
_AROUND = [(1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (0, -1), (1, 0), (-1, 0)]

Box = tuple[float, float, float, float]  # left, top, width, height


def draw_pointed(sheet: Sheet) -> list[Mark]:
    """A box with the results of the element under the pointer, near that, where it covers neither it nor much else."""
    pointed, handle = sheet.view.pointed, _hovered(sheet)
    if pointed is None or handle is None or sheet.view.preview is not None or sheet.view.help:
        return []
    theme = sheet.theme
    title = Text(pointed.title, 12.0, theme.text, "semibold")
    for count in _ROWS:  # fewer where more would cover values
        rows = [
            Row((Text(name, 12.0, theme.muted, grow=1.0), Text(value, 12.0, theme.text, "semibold")), _GAP)
            for name, value in pointed.rows[:count]
        ]
        inside = Column([title, *rows], around=(_PAD, _PAD / 2, _PAD / 2))
        box = Plate(inside, faded(theme.panel, 0.96), theme.line)
        width = box.width(sheet.unit)
        size = width, box.height(sheet.unit, width)
        if (place := _beside(sheet, handle, *size) or _farther(sheet, handle, *size)) is not None:
            paper = Paper(sheet.unit)
            paper.put(box, Rectangle(*place))
            return paper.marks
    return []


def _hovered(sheet: Sheet) -> Handle | None:
    for name, table in sheet.model.tables.items():
        for row in sheet.tagged(Hovered, name).tolist():
            handle: Handle = table[row]
            return handle
    return None


def _beside(sheet: Sheet, handle: Handle, width: float, height: float) -> Box | None:
    """The box beside the pointer that covers least, no value and not the element; None where there is no such place."""
    (low, high), pointer = bounds(sheet.viewport), sheet.view.pointer or sheet.view.camera.middle
    best: tuple[float, Box] | None = None
    for rank, (reach, (across, down)) in enumerate((r, way) for r in (1.0, 2.0, 4.0, 7.0) for way in _AROUND):
        gap = reach * _NEAR * sheet.unit
        left = pointer[0] + across * (gap + width / 2) - width / 2
        top = pointer[1] + down * (gap + height / 2) - height / 2
        if left < low[0] or top < low[1] or left + width > high[0] or top + height > high[1]:
            continue
        if _covers(sheet, handle, (left, top, width, height)):
            continue
        hidden = sheet.occupancy.crossed(left, top, width, height) + 4.0 * rank
        free = not sheet.occupancy.is_taken(left, top, width, height)
        if free and (best is None or hidden < best[0]):
            best = hidden, (left, top, width, height)
    return best[1] if best is not None else None


def _farther(sheet: Sheet, handle: Handle, width: float, height: float) -> Box | None:
    """The place nearest to the pointer, anywhere in the picture, where a box covers no value, name or panel."""
    (low, high), pointer = bounds(sheet.viewport), sheet.view.pointer or sheet.view.camera.middle
    step, size = _STEP * sheet.unit, np.array([width, height])
    x, y = (np.arange(low[axis], high[axis] - size[axis], step) for axis in (0, 1))
    corners = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    sizes = np.broadcast_to(size, corners.shape)
    corners = corners[sheet.occupancy.are_free(sheet.occupancy.cells_of(corners, sizes), STRONG)]
    for corner in corners[np.argsort(np.hypot(*(corners + size / 2 - pointer).T), kind="stable")]:
        box = float(corner[0]), float(corner[1]), width, height
        beside = not (box[0] <= pointer[0] <= box[0] + width and box[1] <= pointer[1] <= box[1] + height)
        if beside and not _covers(sheet, handle, box):
            return box
    return None


def _covers(sheet: Sheet, handle: Handle, box: Box) -> bool:
    """Whether a box lies over any of the lines or the disc of an element."""
    start, end, reach = _outline(sheet, handle)
    corner, size = np.array(box[:2]), np.array(box[2:])
    covered = clip_segments(start, end, corner - reach, corner + size + reach)[2]
    return len(covered) > 0


def _outline(sheet: Sheet, handle: Handle) -> tuple[Points, Points, float]:
    """The lines of an element in pixels, from and to, and how far it reaches from them."""
    u = sheet.unit
    if isinstance(handle, Particle):
        at = sheet.centres[[handle.row]]
        return at, at, float(sheet.radii[handle.row]) + (SUPPORT_DEPTH * u if any(handle.fixed) else 2.0 * u)
    if isinstance(handle, Rod):
        return *sheet.lines(sheet.rods == handle.row)[:2], 4.0 * u
    table = sheet.model.tables[handle.table]
    points = [getattr(table, point)[handle.row] for point in handle.points]
    places = sheet.view.camera.to_pixels(np.array(points))
    return places, np.roll(places, -1, axis=0), 4.0 * u
