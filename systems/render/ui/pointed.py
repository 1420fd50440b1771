"""Pointed: the numbers of the element under the pointer, beside it, and those of a place that are to stay."""

from __future__ import annotations

import numpy as np

from pinjoint.components.bent import Axes
from pinjoint.components.camera import Rectangle
from pinjoint.components.handle import Handle
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.tags import Hovered
from pinjoint.components.view import Readout
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.labels.placing import Placed
from pinjoint.systems.render.marks import Discs, Mark, Points
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.symbols import RIM, SUPPORT_DEPTH
from pinjoint.systems.render.theme import faded
from pinjoint.systems.render.ui.layout import Column, Paper, Plate, Row, Text

_PAD, _GAP, _NEAR = 8.0, 14.0, 16.0  # points: inside the box, between columns, to the pointer
# rows, and points of type, of which the first with room is taken
_FORMS = (8, 12.0), (8, 9.0), (3, 12.0), (3, 9.0), (1, 12.0)
_STEP, _BESIDE = 8.0, 90.0  # points between places that are tried; within which they are to cover no lines
# Keys by which the form and the place from the pointer are kept.
_KEPT = [("pointed", number) for number in range(3)]


def draw_pointed(sheet: Sheet, former: Placed) -> list[Mark]:
    """Boxes with the results of the pinned place, which is marked, and of the element under the pointer.

    former: where that was in the last picture. While a hand drags it keeps its place by the pointer if that is free: 0.5 ms
    in place of 3.
    """
    view, marks = sheet.view, list[Mark]()
    if view.help:
        return marks
    if (pin := view.pin) is not None and pin.told is not None:
        row = np.array([pin.rod.row])
        share = min(pin.distance / float(sheet.model.rods.length[row[0]]), 1.0)
        at = view.camera.to_pixels(Axes.of(sheet.model, row).points(np.array([share]))[0])
        size, ink = np.array([4.0 * sheet.unit]), sheet.theme.focus  # points
        marks += [
            Discs(at, size, ink, sheet.theme.hollow, RIM * sheet.unit),
            *_box(sheet, pin.told, pin.rod, at[0]),
        ]
    tagged = ((t, sheet.tagged(Hovered, name)) for name, t in sheet.model.tables.items())
    handle = next((table[int(rows[0])] for table, rows in tagged if len(rows)), None)
    told_already = pin is not None and pin.told == view.pointed
    if view.pointed is not None and handle is not None and view.preview is None and not told_already:
        at = np.array(view.pointer or view.camera.middle)
        marks += _box(sheet, view.pointed, handle, at, former if view.steady else {})
    return marks


def _box(
    sheet: Sheet, pointed: Readout, handle: Handle, at: Points, former: Placed | None = None
) -> list[Mark]:
    """A box with the results of an element near a pixel, where it covers neither that nor what is said.

    former: where it was, if that is to be kept; None: it is not.
    """
    theme, held = sheet.theme, [former.get(key, -1) for key in _KEPT] if former else [-1]
    for form in sorted(range(len(_FORMS)), key=lambda form: form != held[0]):
        count, points = _FORMS[form]
        title = Text(pointed.title, points, theme.text, "semibold")
        rows = [
            Row((Text(name, points, theme.muted, grow=1.0), Text(value, points, theme.text, "semibold")), _GAP)
            for name, value in pointed.rows[:count]
        ]
        inside = Column([title, *rows], around=(_PAD, _PAD / 2, _PAD / 2))
        box = Plate(inside, faded(theme.panel, 0.96), theme.line)
        width = box.width(sheet.unit)
        size, place = np.array([width, box.height(sheet.unit, width)]), None
        if form == held[0]:
            place = _if_free(sheet, handle, size, at + held[1:])
        place = place or _free_place(sheet, handle, size, at)
        if place is not None:
            paper = Paper(sheet.unit)
            paper.put(box, place)
            sheet.occupancy.block(*place.box)
            if former is not None:
                kept = form, *np.round([place.left, place.top] - at).astype(int).tolist()
                sheet.scales |= zip(_KEPT, kept, strict=True)
            return paper.marks
    return []


def _if_free(sheet: Sheet, handle: Handle, size: Points, corner: Points) -> Rectangle | None:
    """A place for a box, if that covers there neither a value, name or panel nor its element."""
    (low, high), (start, end, reach) = sheet.viewport.corners, _outline(sheet, handle)
    inside = (corner >= low).all() and (corner + size <= high).all()
    if not inside or sheet.occupancy.is_taken(*corner, *size):
        return None
    meets = len(clip_segments(start, end, corner - reach, corner + size + reach)[2])
    return None if meets else Rectangle(*corner.tolist(), *size.tolist())


def _free_place(sheet: Sheet, handle: Handle, size: Points, pointer: Points) -> Rectangle | None:
    """The place nearest to a pixel where a box covers no value, name or panel; near by one where it covers no line."""
    (low, high), u = sheet.viewport.corners, sheet.unit
    sides = [(np.arange(low[k], high[k] - size[k], _STEP * u), pointer[k], size[k]) for k in (0, 1)]
    for covered, farthest in ((0, _BESIDE * u), (STRONG, np.inf)):
        x, y = (side[(side >= at - wide - farthest) & (side <= at + farthest)] for side, at, wide in sides)
        corners = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        distance = np.hypot(*np.maximum(np.maximum(corners - pointer, pointer - corners - size), 0.0).T)
        near = np.flatnonzero((distance >= _NEAR * u) & (distance <= farthest))
        cells = sheet.occupancy.cells_of(corners[near], np.broadcast_to(size, (len(near), 2)))
        free = near[sheet.occupancy.are_free(cells, covered)]
        for index in free[np.argsort(distance[free], kind="stable")].tolist():
            if (place := _if_free(sheet, handle, size, corners[index])) is not None:
                return place
    return None


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
