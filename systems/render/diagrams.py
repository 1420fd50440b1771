"""Force diagrams: rectangles on rods, arrows at particles, and their values."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.bent import distributed_shares
from pinjoint.components.language import tr
from pinjoint.components.load import CONSTANT
from pinjoint.components.model import Model
from pinjoint.components.tags import DiagramShown, Selected
from pinjoint.components.view import View
from pinjoint.systems.render.arrows import FORCES, arrows, full_load, head_length, lengths, whose
from pinjoint.systems.render.clip import bounds, clip_segments
from pinjoint.systems.render.labels import Key, Label, half_size
from pinjoint.systems.render.leaders import ANCHORS
from pinjoint.systems.render.marks import Bars, Owner, Points, Strokes
from pinjoint.systems.render.occupancy import FAINT
from pinjoint.systems.render.sheet import DIRECTIONS, Rows, Sheet, typical_length
from pinjoint.systems.render.supports import NO_SUPPORT, crowding
from pinjoint.systems.render.symbols import SUPPORT_DEPTH
from pinjoint.systems.render.theme import Colour, faded

SMALLEST_FORCE = 1e-4  # kN; smaller forces are drawn as none
FEW_VALUES = 24  # up to which each carries its unit and keeps clear of rods
_STEPS = (8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0)
_TOO_FLAT, _ENLARGED = 0.05, 0.3  # of the room: loads (one point per kN) below which, up to which, to enlarge
SHORTEST_WITH_DIAGRAM = 6.0  # points
SHORTEST_WITH_VALUE = 24.0  # points; the values of shorter rods would only hide the structure
_MANY_ARROWS = 200  # of a kind, up to which all are drawn, though they may lie over each other
_SQUARE = 20.0  # points, the side of squares of which each shows one of more arrows
_TOLD = 1.5  # factor by which a new value must be larger to replace one of the last picture
_ROD_VALUE = "rods.axial_force"  # keys by which labels keep places
_ARROW_VALUES = {"load": "particles.applied_force", "reaction": "particles.reaction"}
_MOST_COVERED = 0.15  # of a picture, by values
_SLIDES = np.array([0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9])  # of how far a label can go along a rod
_OFF_ARCS = 6.0  # points between the arrow of a moment and that of a force
GAP = 1.0  # points between a rod or an arrow and a value beside it
BACKING = 0.86  # opacity behind a value


def scale_step(largest: float, scale: float, room: float) -> float:
    """The largest of …, 2, 1.5, 1, 0.8, 0.6, 0.5, 0.4, 0.3, 0.2, 0.15, … with `largest` × `scale` × it ≤ `room`.

    Changing all diagrams alike keeps them comparable; steps keep their scale steady while forces change.
    """
    decade = 10.0 ** math.floor(math.log10(room / (largest * scale)))
    enough = room * (1.0 + 1e-9)  # so that round-off in the logarithm leaves a step
    return next(decade * step for step in _STEPS if largest * scale * decade * step <= enough)


def diagram_factor(largest: float, loads: float, scale: float, room: float) -> float:
    """The factor of all diagrams, so that they can be seen and leave the structure readable.

    largest: the largest axial force, kN; loads: the sum of what acts on the model, kN; scale: points per kN as
    the person chose; room: points. 1 where that is readable. The loads decide whether to enlarge, since they
    stay while the forces that they cause vibrate.
    """
    factor = 1.0
    if SMALLEST_FORCE < loads < _TOO_FLAT * room:
        factor = scale_step(loads, 1.0, _ENLARGED * room)
    if largest * scale * factor > room:
        factor = scale_step(largest, scale, room)
    return factor


def draw_rod_diagrams(sheet: Sheet) -> None:
    """A rectangle on each rod that shows its diagram, |N| × diagram scale high, and the value of N.

    Where rods are too short for rectangles, they themselves take the colour of tension or compression.
    """
    force, rows, start, end = _shown_rods(sheet)
    if not len(rows):
        return
    if typical_length(start, end) < SHORTEST_WITH_DIAGRAM * sheet.unit:
        sheet.pulled = rows[force[rows] > SMALLEST_FORCE]
        sheet.pushed = rows[force[rows] < -SMALLEST_FORCE]
        sheet.notes.append(tr("zoom in to see force diagrams"))
        return
    room = room_for(sheet, start, end) / sheet.unit
    largest = float(np.abs(force).max())
    factor = diagram_factor(largest, _loads(sheet.model), sheet.model.settings.diagram_scale, room)
    if factor != 1.0:
        sheet.notes.append(tr("diagrams ×{factor:g}", factor=factor))
    height = np.abs(force[rows]) * (sheet.model.settings.diagram_scale * factor * sheet.unit)
    normal = _outward_normals(sheet, rows, start, end)
    values = force[rows]
    rise = normal * height[:, None]
    pulled, pushed = values > SMALLEST_FORCE, values < -SMALLEST_FORCE
    nothing = ~(pulled | pushed | sheet.model.rods.tension_only[rows])  # a slack cable stays dashed
    for name, mask in (("tension", pulled), ("compression", pushed), ("zero", nothing)):
        if mask.any():
            _draw_rectangles(sheet, name, rows[mask], start[mask], end[mask], rise[mask])
    _label_rods(sheet, rows, values, start, end, normal, height)


def _shown_rods(sheet: Sheet) -> tuple[NDArray[np.float64], Rows, Points, Points]:
    """Axial forces of all rods; rows and visible ends of those whose diagram is drawn."""
    shown: NDArray[np.bool_] | slice = slice(None if sheet.view.forces_known else 0)
    if sheet.view.forces_known and not sheet.view.all_diagrams:
        shown = sheet.chosen(sheet.tagged(DiagramShown, "rods"), sheet.rods)
    rows = sheet.rods[shown]
    force = np.nan_to_num(sheet.model.rods.axial_force) if len(rows) else np.empty(0)
    return force, rows, sheet.start[shown], sheet.end[shown]


def _loads(model: Model) -> float:
    """The sum of all external forces (kN), of varying ones the largest that they reach."""
    constant, loads = model.particles.constant_force, model.loads
    varying = [row for row, history in enumerate(loads.history) if history["kind"] != CONSTANT["kind"]]
    return float(np.hypot(*constant.T).sum() + np.hypot(*loads.force[varying].T).sum())


def room_for(sheet: Sheet, start: Points, end: Points) -> float:
    """The greatest height (pixels) of a diagram that leaves the structure readable."""
    window = min(sheet.viewport.width, sheet.viewport.height)
    return max(min(0.15 * window, 0.6 * typical_length(start, end)), 10.0 * sheet.unit)


def _outward_normals(sheet: Sheet, rows: Rows, start: Points, end: Points) -> Points:
    """Unit normals (pixels) away from the middle of the original structure; upwards or left if through it.

    Judged in the original geometry, so that a diagram does not change sides while the rod moves.
    """
    rods = sheet.model.rods
    x, y = sheet.model.particles.position.T
    first, last = sheet.ends[:, 0], sheet.ends[:, 1]
    middle_x, middle_y = 0.5 * (x[first] + x[last]), 0.5 * (y[first] + y[last])
    extent = max(np.ptp(middle_x), np.ptp(middle_y)) + 1e-300
    outward_x, outward_y = middle_x[rows] - middle_x.mean(), middle_y[rows] - middle_y.mean()
    difference_x, difference_y = rods.difference[rows].T
    length = rods.original_length[rows]
    side = outward_y * difference_x - outward_x * difference_y
    upwards = np.where(np.abs(difference_x) > 1e-9 * length, difference_x, -difference_y)
    side = np.where(np.abs(side) < 1e-6 * extent * length, upwards, side)
    along_x, along_y = (end - start).T
    scale = np.where(side < 0.0, -1.0, 1.0) / np.maximum(np.hypot(along_x, along_y), 1e-9)
    return np.stack([along_y * scale, -along_x * scale], axis=1)


def _draw_rectangles(sheet: Sheet, name: str, rows: Rows, start: Points, end: Points, rise: Points) -> None:
    colour: Colour = getattr(sheet.theme, name)
    outlined = sheet.rod_length > 16.0 * sheet.unit
    bars = Bars(start, end, rise, faded(colour, 0.16 if outlined else 0.5), ("rods", rows))
    sheet.marks.append(bars)
    sheet.occupancy.parts.diagrams(("rods", rows), start, end, rise)
    if outlined:
        corners = bars.corners
        first, last = corners[:, :-1].reshape(-1, 2), corners[:, 1:].reshape(-1, 2)
        sheet.occupancy.line(first, last, FAINT)
        sheet.marks.append(
            Strokes(first, last, 1.25 * sheet.unit, faded(colour, 0.9), ("rods", np.repeat(rows, 3)))
        )
    if name != "zero":
        sheet.explain(name, np.concatenate([start, start + rise]), np.concatenate([end, end + rise]))


def _label_rods(
    sheet: Sheet,
    rows: Rows,
    values: NDArray[np.float64],
    start: Points,
    end: Points,
    normal: Points,
    height: NDArray[np.float64],
) -> None:
    """The values of the rods, along those parts of them that are seen."""
    start, end, seen = clip_segments(start, end, *bounds(sheet.viewport))
    rows, values, normal, height = rows[seen], values[seen], normal[seen], height[seen]
    sheet.values[_ROD_VALUE] = len(rows)
    selected = sheet.chosen(sheet.tagged(Selected, "rods"), rows)
    is_short = sheet.rod_length < SHORTEST_WITH_VALUE * sheet.unit
    candidates = np.flatnonzero(selected) if is_short else np.arange(len(rows))
    worth = worth_of(sheet, _ROD_VALUE, rows, values) + 1e6 * selected
    shown = most_important(sheet, worth, candidates)
    few = len(values) <= FEW_VALUES
    numbers = values[shown].tolist()
    texts, size, half = _value_texts(sheet, numbers, few)
    places = _places_by_rods(start[shown], end[shown], normal[shown], height[shown], half, sheet.unit)
    signs = ("zero" if abs(n) <= SMALLEST_FORCE else "tension" if n > 0.0 else "compression" for n in numbers)
    colours = [getattr(sheet.theme, sign) for sign in signs]
    keys = [(_ROD_VALUE, row) for row in rows[shown].tolist()]
    of = [("rods", row) for row in rows[shown].tolist()]
    edge = start[shown] + (normal * height[:, None])[shown]
    anchors = edge[:, None] + ANCHORS[:, None] * (end - start)[shown, None]
    ranks = (-worth[shown]).tolist()
    values_of = zip(texts, places, colours, ranks, keys, of, of, anchors, normal[shown], strict=True)
    add_values(sheet, values_of, size, "spare" if few else "cover")


def worth_of(sheet: Sheet, field: str, rows: Rows, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The importance of each value: its size to two digits, so that tiny changes do not reorder labels.

    Values of the last picture count more, so that labels do not come and go while forces vibrate.
    """
    size = np.maximum(np.abs(values), 1e-300)
    decade = 10.0 ** np.floor(np.log10(size))
    told = np.array([row for name, row in sheet.placed if name == field], dtype=np.intp)
    worth: NDArray[np.float64] = np.round(size / decade, 1) * decade
    return worth * np.where(sheet.chosen(told, rows), _TOLD, 1.0)


def most_important(sheet: Sheet, worth: NDArray[np.float64], candidates: Rows) -> Rows:
    """Of the candidates those worth most, as many as there may be room for beside them."""
    area = sheet.viewport.width * sheet.viewport.height / sheet.unit**2
    most = int(_MOST_COVERED * area / (46.0 * 18.0))
    return np.sort(candidates[np.lexsort((candidates, -worth[candidates]))][:most])


def _value_texts(sheet: Sheet, forces: Iterable[float], few: bool) -> tuple[list[str], int, Points]:
    """Forces (kN) as they are written among few or many, their font size, and half the size of each label, (n, 2)."""
    write = written.force if few else written.number
    texts = [write(force, nothing=SMALLEST_FORCE) for force in forces]
    size = sheet.font(12.0 if few else 11.0)
    half = [half_size(text, size, "semibold", sheet.unit) for text in texts]
    return texts, size, np.array(half).reshape(-1, 2)


def add_values(
    sheet: Sheet,
    values: Iterable[tuple[str, Points, Colour, float, Key, Owner, Owner, Points, Points]],
    size: int,
    lines: Literal["spare", "cover"],
) -> None:
    """Labels of values: text, places, colour, rank, key, owner, own part, anchors and direction of each."""
    backing = faded(sheet.theme.background, BACKING)
    sheet.labels += [
        Label(text, places, size, colour, rank, "semibold", backing, lines, key, of, own, anchors, out)
        for text, places, colour, rank, key, of, own, anchors, out in values
    ]


def _places_by_rods(
    start: Points, end: Points, normal: Points, height: NDArray[np.float64], half: Points, u: float
) -> Points:
    """Where the value of each rod may stand, (n, k, 2): in its diagram if it fits, beyond, behind the rod, on it.

    reach: half the extent of a label along the normal of its rod. slide: how far it can move along the rod.
    """
    normal_x, normal_y = np.abs(normal).T
    reach, extent = normal_x * half[:, 0] + normal_y * half[:, 1], normal_y * half[:, 0] + normal_x * half[:, 1]
    beside, fits = reach + GAP * u, height > 2.0 * reach
    beyond, nothing = height + beside, np.zeros(len(height))
    across = [np.where(fits, 0.5 * height, beyond), beyond, np.where(fits, beside, -beside), -beside, nothing]
    slide = np.maximum(np.hypot(*(end - start).T) / 2 - extent, 0.0)[:, None] * _SLIDES
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    offset = np.stack(across, axis=1)[:, :, None, None] * normal[:, None, None, :]
    places = (start + end)[:, None, None, :] / 2 + offset + slide[:, None, :, None] * along[:, None, None, :]
    found: Points = places.reshape(len(start), len(across) * len(_SLIDES), 2)
    return found


def draw_particle_diagrams(sheet: Sheet, sides: NDArray[np.int64]) -> None:
    """Arrows of the horizontal and vertical load and reaction on each particle that shows its diagram."""
    shown = sheet.particles if sheet.view.forces_known else sheet.particles[:0]
    if not sheet.view.all_diagrams:
        shown = shown[sheet.chosen(sheet.tagged(DiagramShown, "particles"), shown)]
    if not len(shown):
        return
    particles = sheet.model.particles
    largest = max(largest_force(sheet.model, sheet.view), sheet.view.largest_force)
    taken = np.full((len(sheet.centres), 2), NO_SUPPORT)  # by reactions: a side of each particle, by axis
    applied = (particles.applied_force - distributed_shares(sheet.model))[
        shown
    ]  # rows of arrows show the others
    for name, force in (("reaction", particles.reaction[shown]), ("load", applied)):
        index, axis = _thinned(sheet, shown, force, *np.nonzero(np.abs(force) > SMALLEST_FORCE))
        if len(index):
            _draw_forces(sheet, name, shown[index], axis, force[index, axis], largest, sides, taken)


def largest_force(model: Model, view: View) -> float:
    """The largest force (kN) that an arrow may show: of loads at full size, and in diagrams of their parts and reactions."""
    particles = model.particles
    largest = float(np.hypot(*full_load(model).T).max(initial=SMALLEST_FORCE))
    if view.forces_known and (view.all_diagrams or model.any_tagged(DiagramShown)):
        for forces in (particles.applied_force, particles.reaction):
            largest = max(largest, float(np.abs(forces).max(initial=0.0)))
    return largest


def _draw_forces(
    sheet: Sheet,
    name: str,
    rows: Rows,
    axis: Rows,
    value: NDArray[np.float64],
    largest: float,
    sides: NDArray[np.int64],
    taken: NDArray[np.int64],
) -> None:
    """Arrows of forces of one kind along an axis each, with their values."""
    # Model y is up, pixels' y is down: a positive vertical force points in direction 3.
    direction = np.where(axis == 0, np.where(value > 0, 0, 2), np.where(value > 0, 3, 1))
    length = lengths(sheet, FORCES, np.abs(value), largest)
    tail, outer = _arrow_places(sheet, rows, direction, length, sides, taken[rows, axis])
    taken[rows, axis] = outer
    along, parts = DIRECTIONS[direction], (_ARROW_VALUES[name], 2 * rows + axis)
    middle = tail + along * length[:, None] / 2
    sheet.explain(name, tail, tail + along * length[:, None])
    sheet.marks += arrows(sheet, _of(sheet, name, rows), tail, along, length, getattr(sheet.theme, name), parts)
    sheet.occupancy.block_squares(middle, np.minimum(0.2 * length, 3.0 * sheet.unit))
    _label_arrows(sheet, name, 2 * rows + axis, value, middle, length, outer, outer == direction)


def _of(sheet: Sheet, name: str, rows: Rows) -> list[Owner]:
    """Whose the arrows of forces of one kind on particles are."""
    return whose(sheet.model, rows) if name == "load" else [("particles", row) for row in rows.tolist()]


def _thinned(
    sheet: Sheet, rows: Rows, force: NDArray[np.float64], index: Rows, axis: Rows
) -> tuple[Rows, Rows]:
    """Of many arrows, the largest in each square, so that they can be told apart.

    Squares divide the original geometry, so that arrows neither come nor go while a structure moves.
    """
    if len(index) <= _MANY_ARROWS:
        return index, axis
    side = _SQUARE * sheet.unit / sheet.view.camera.scale
    x, y = np.floor(sheet.model.particles.position[rows[index]] / side).T
    order = np.lexsort((index, -np.abs(force[index, axis]), axis, y, x))
    x, y, along = x[order], y[order], axis[order]
    first = np.ones(len(order), dtype=bool)
    first[1:] = (np.diff(x) != 0) | (np.diff(y) != 0) | (np.diff(along) != 0)
    kept = np.sort(order[first])
    if len(kept) < len(order):
        sheet.notes.append(tr("zoom in to see all loads and reactions"))
    return index[kept], axis[kept]


def _arrow_places(
    sheet: Sheet,
    rows: Rows,
    direction: NDArray[np.int64],
    length: NDArray[np.float64],
    sides: NDArray[np.int64],
    taken: NDArray[np.int64],
) -> tuple[Points, NDArray[np.int64]]:
    """Tails of the arrows, and on which side of its particle each stands.

    An arrow starts at the rim, or ends at it where the side that it comes from is freer; there it stands beyond
    the support, if there is one, and beyond the arrow of a moment. taken: the side of another arrow along the
    same axis, or NO_SUPPORT.
    """
    u = sheet.unit
    opposite, crowd = (direction + 2) % 4, crowding(sheet, rows)
    supported = sides[rows] != NO_SUPPORT
    busy_ahead = crowd[rows, direction] + 0.8 * (supported & (sides[rows] == direction))
    busy_behind = crowd[rows, opposite] + 0.8 * (supported & (sides[rows] == opposite))
    pushes = ((busy_behind < busy_ahead - 0.1) & (taken != opposite)) | (taken == direction)
    side = np.where(pushes, opposite, direction)
    gap = sheet.radii[rows] + 2.0 * u + np.where(supported & (sides[rows] == side), SUPPORT_DEPTH * u, 0.0)
    around = np.where(DIRECTIONS[side, 1] > 0.0, 0.0, sheet.arcs[rows])  # they are open below
    gap = np.maximum(gap, around + np.where(around > 0.0, _OFF_ARCS * u, 0.0))
    outward = DIRECTIONS[side]
    start = sheet.centres[rows] + outward * gap[:, None]
    return start + outward * np.where(pushes, length, 0.0)[:, None], side


def _label_arrows(
    sheet: Sheet,
    name: str,
    which: Rows,
    value: NDArray[np.float64],
    middle: Points,
    length: NDArray[np.float64],
    side: NDArray[np.int64],
    pulls: NDArray[np.bool_],
) -> None:
    """The size of the force at each arrow; which: twice the particle's row, one more if it is vertical."""
    few, field = len(value) <= FEW_VALUES, _ARROW_VALUES[name]
    worth = worth_of(sheet, field, which, value)
    seen = np.flatnonzero(sheet.sees(middle))
    sheet.values[field] = len(seen)
    shown = most_important(sheet, worth, seen)
    sizes = np.abs(value[shown]).tolist()
    texts, font, half = _value_texts(sheet, sizes, few)
    outward = DIRECTIONS[side[shown]]
    places = _places_by_arrows(middle[shown], length[shown], outward, pulls[shown], half, sheet.unit)
    # Arrows are few and say little without their value: before the rods.
    ranks, keys = (-worth[shown] - 1e9).tolist(), [(field, number) for number in which[shown].tolist()]
    colours = [getattr(sheet.theme, name)] * len(texts)
    of = _of(sheet, name, which[shown] // 2)
    anchors = (middle[shown] + outward * length[shown, None] / 2)[:, None]
    values_of = zip(texts, places, colours, ranks, keys, of, keys, anchors, outward, strict=True)
    add_values(sheet, values_of, font, "spare")


def _places_by_arrows(
    middle: Points,
    length: NDArray[np.float64],
    outward: Points,
    pulls: NDArray[np.bool_],
    half: Points,
    u: float,
) -> Points:
    """Where the value of each arrow may stand, (n, k, 2): beyond its outer end, beside its head, it, that end.

    pulls: whether the head is at the outer end.
    """
    level = outward[:, 0] != 0.0
    deep, width = np.where(level, half.T, half.T[::-1])
    outer, nothing, wing = length / 2, np.zeros(len(middle)), head_length(length, u) / 2
    beyond, beside = outer + deep + GAP * u, wing + width + GAP * u
    along, across = [beyond], [nothing]
    for place in ((outer - 2.0 * wing) * np.where(pulls, 1.0, -1.0), nothing, deep - outer, outer, beyond):
        along += [place, place]
        across += [beside, -beside]
    along += [nothing, nothing]
    across += [beside + width, -beside - width]
    x, y = np.stack(along, axis=1), np.stack(across, axis=1)
    dx, dy = outward.T[:, :, None]
    places: Points = middle[:, None, :] + np.stack([dx * x + dy * y, dy * x + dx * y], axis=2)
    return places
