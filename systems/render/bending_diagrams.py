"""Diagrams along rods where some bend: N, M on the side in tension, or V, with values, extremes and zero points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.bent import (
    AXIAL,
    MOMENT,
    SHEAR,
    Axes,
    axes,
    derivative,
    inner_forces,
    values,
    zeros,
)
from pinjoint.components.language import marked, tr
from pinjoint.components.tags import DiagramShown, Selected
from pinjoint.components.view import MARGIN
from pinjoint.systems.render.arrows import steady
from pinjoint.systems.render.clip import bounds
from pinjoint.systems.render.diagrams import (
    FEW_VALUES,
    GAP,
    SHORTEST_WITH_DIAGRAM,
    SHORTEST_WITH_VALUE,
    SMALLEST_FORCE,
    add_values,
    draw_rod_diagrams,
    most_important,
    room_for,
    worth_of,
)
from pinjoint.systems.render.labels import half_size
from pinjoint.systems.render.marks import Discs, Fills, Points, Strokes
from pinjoint.systems.render.nearness import ranges
from pinjoint.systems.render.occupancy import FAINT
from pinjoint.systems.render.overlays import heading_height
from pinjoint.systems.render.sheet import Rows, Sheet, typical_length
from pinjoint.systems.render.theme import Colour, faded

NAMES = {
    AXIAL: marked("axial force N"),
    MOMENT: marked("bending moment M"),
    SHEAR: marked("shear force V"),
}
UNITS = {AXIAL: "kN", MOMENT: "kN·m", SHEAR: "kN"}
_MEANT = {AXIAL: ("tension", "compression"), MOMENT: ("moment",), SHEAR: ("shear",)}  # in the legend
_BESIDE = (
    "load",
    "load per length",
    "load moment",
    "reaction",
    "reaction moment",
    "ghost",
)  # in the legend, at most
_LEAST = 24.0  # points that diagrams have towards the legend and the rim, where there is less room
_LARGEST, _FAR = 1e100, 1e6  # kN or kN·m, pixels: what is beyond is left out
_MANY = 300  # rods, above which diagrams are outlines
_PIECES = ((24, 24), (120, 12), (_MANY, 8), (np.inf, 4))  # of a diagram, by how many rods have one at most
_PIECE = 5.0  # points, or longer
_ROOM, _SHARE = 1.25, 0.3  # of the room of force diagrams; of the largest shear, the least that fills it with N
_HATCH = 7.0  # points between lines across
_NOTHING = 1e-3  # of the largest value: what is not told
_ALIKE = 5e-3  # of the largest value: what counts as the same
_GREAT = 0.5  # of the largest value: what is told before all else
_ZERO = 2.5  # points, radius of the mark of a zero point
_INSIDE = 0.02  # share of a rod, from which on a zero point or an extreme is not at its end
_STRAIGHT = 0.9  # cosine of the turn at a joint up to which two rods are one member
_SLIDES = (
    (0.0, 0.0),
    (0.5, 0.5),
    (-0.5, 1.0),
    (1.0, 2.0),
    (-1.0, -1.0),
    (1.5, 4.0),
)  # of a value: between ends, and at one
_NEAR = 42.0  # points along a rod, or two steps: so far from its end stands a value, but for the last place
_PLACES = 3  # of values of a rod: start, end, between

Values = NDArray[np.float64]


@dataclass(frozen=True)
class _Diagram:
    """The diagram of some rods: rows (n,), their baselines, values as polynomials, pixels per kN or kN·m, largest
    value in the model.

    points, normals, heights: at shares (n, k), with unit normals to where positive values are drawn.
    """

    rows: Rows
    base: Axes
    polynomials: Values
    scale: float
    largest: float
    points: Points
    normals: Points
    heights: Values

    def some(self, which: NDArray[np.bool_]) -> _Diagram:
        """The diagram of some of the rods."""
        columns = self.polynomials, self.points, self.normals, self.heights
        polynomials, points, normals, heights = (column[which] for column in columns)
        base = self.base.some(which)
        return _Diagram(self.rows[which], base, polynomials, self.scale, self.largest, points, normals, heights)


def draw_diagrams(sheet: Sheet) -> None:
    """The diagrams of rods: where none bends, rectangles of their axial forces."""
    if not sheet.is_frame:
        draw_rod_diagrams(sheet)
        return
    shown = np.full(len(sheet.rods), sheet.view.forces_known)
    if sheet.view.forces_known and not sheet.view.all_diagrams:
        shown = sheet.chosen(sheet.tagged(DiagramShown, "rods"), sheet.rods)
    if not shown.any():
        return
    start, end, rows = sheet.start[shown], sheet.end[shown], sheet.rods[shown]
    quantity = sheet.view.quantity
    if typical_length(start, end) < SHORTEST_WITH_DIAGRAM * sheet.unit:
        if quantity == AXIAL:
            force = np.nan_to_num(sheet.model.rods.axial_force)
            sheet.pulled, sheet.pushed = rows[force[rows] > SMALLEST_FORCE], rows[force[rows] < -SMALLEST_FORCE]
        sheet.notes.append(tr("zoom in to see force diagrams"))
        return
    room = min(_ROOM * room_for(sheet, start, end), MARGIN * sheet.unit)
    diagram = _measured(sheet, rows, quantity, room)
    if diagram is not None:
        _draw(sheet, quantity, diagram)
        _mark_zeros(sheet, quantity, diagram)
        _label(sheet, quantity, diagram)


def _measured(sheet: Sheet, rows: Rows, quantity: str, room: float) -> _Diagram | None:
    """The diagram of some rods, on the scale of all; None where there is nothing to be drawn."""
    model = sheet.model
    every = inner_forces(model, np.arange(model.rods.count), quantity)
    every[~(np.abs(every) < _LARGEST).all(axis=1)] = 0.0
    largest = float(np.abs(values(every, np.linspace(0.0, 1.0, 5))).max(initial=0.0))
    if quantity == AXIAL:  # small ones, as bending shortens rods, look small
        shear = np.abs(model.rods.shear)
        largest = max(largest, _SHARE * float(shear[shear < _LARGEST].max(initial=0.0)))
    if largest <= SMALLEST_FORCE:
        return None
    fitting = max(largest, room * _crowding(sheet, every, quantity))
    scale = room * model.settings.diagram_scale / steady(sheet, (f"diagrams.{quantity}", 0), fitting)
    base, polynomials = _baseline(sheet, rows), every[rows]
    shares = np.linspace(0.0, 1.0, _pieces(sheet, rows) + 1)
    points, normals = _stations(sheet, base, shares, quantity)
    heights = scale * values(polynomials, shares)
    found = _Diagram(rows, base, polynomials, scale, largest, points, normals, heights)
    near = (np.abs(points) < _FAR) & np.isfinite(normals)
    return found.some(np.asarray(near.all(axis=(1, 2))))


def _crowding(sheet: Sheet, every: Values, quantity: str) -> float:
    """The value per pixel up to which diagrams of all rods keep off the legend and the rim; 0 if somebody looks closer."""
    view = sheet.view
    if not view.shows(sheet.model):
        return 0.0
    shares, names = np.linspace(0.0, 1.0, 5), _MEANT[quantity]
    points, normals = _stations(sheet, _baseline(sheet, np.arange(len(every))), shares, quantity)
    explained = (*names, *_BESIDE) if view.legend else ()
    low, high = bounds(view.room)
    low[1] += heading_height(view.heading, sheet.viewport.width, sheet.unit, sheet.theme, explained)
    reach = normals * values(every, shares)[..., None]
    free = np.maximum(np.where(reach < 0.0, points - low, high - points), _LEAST * sheet.unit)
    return float(np.nan_to_num(np.abs(reach) / free).max(initial=0.0))


def _pieces(sheet: Sheet, rows: Rows) -> int:
    """Into how many pieces diagrams are cut, more where rods are few and long."""
    most = next(pieces for count, pieces in _PIECES if len(rows) <= count)
    return int(np.clip(sheet.rod_length / (_PIECE * sheet.unit), 2, most))


def _baseline(sheet: Sheet, rows: Rows) -> Axes:
    """The axes of rods as drawn, or where they were originally, as a person wants it."""
    model = sheet.model
    if not model.settings.original_diagrams:
        return axes(model, rows)
    ends = model.particles.position[sheet.ends[rows]]
    x, y = (ends[:, 1] - ends[:, 0]).T
    left = np.stack([-y, x], axis=1) / np.maximum(np.hypot(x, y), 1e-300)[:, None]
    return Axes(ends[:, 0], ends[:, 1], left, np.zeros((len(rows), 5)))


def _stations(sheet: Sheet, base: Axes, shares: Values, quantity: str) -> tuple[Points, Points]:
    """Points of baselines in pixels, and unit normals to the side of positive values: left, of moments right."""
    x, y = np.moveaxis(base.tangents(shares), -1, 0)
    left = np.stack([-y, -x], axis=-1) / np.maximum(np.hypot(x, y), 1e-300)[..., None]  # pixels' y is down
    points = sheet.view.camera.to_pixels(base.points(shares).reshape(-1, 2)).reshape(left.shape)
    return points, -left if quantity == MOMENT else left


# --- areas -------------------------------------------------------------------------------------------


def _draw(sheet: Sheet, quantity: str, diagram: _Diagram) -> None:
    """Areas with an outline, hatched but for moments; axial forces in the colours of tension and compression."""
    if quantity != AXIAL:
        _draw_areas(sheet, quantity, diagram, diagram.heights, np.ones(len(diagram.rows), dtype=bool))
        sheet.explain(_MEANT[quantity][0], diagram.points[:, 0], diagram.points[:, -1])
        return
    for name, heights in (
        ("tension", np.maximum(diagram.heights, 0.0)),
        ("compression", np.minimum(diagram.heights, 0.0)),
    ):
        drawn = np.abs(heights).max(axis=1) > SMALLEST_FORCE * diagram.scale
        _draw_areas(sheet, name, diagram, heights, drawn)
        sheet.explain(name, diagram.points[drawn, 0], diagram.points[drawn, -1])


def _colour(sheet: Sheet, name: str) -> Colour:
    found: Colour = sheet.theme.ink if name in (MOMENT, SHEAR) else getattr(sheet.theme, name)
    return found


def _draw_areas(sheet: Sheet, name: str, diagram: _Diagram, heights: Values, drawn: NDArray[np.bool_]) -> None:
    rows, points, normals = diagram.rows[drawn], diagram.points[drawn], diagram.normals[drawn]
    colour, u = _colour(sheet, name), sheet.unit
    if not len(rows):
        return
    edge = points + heights[drawn][..., None] * normals
    if len(rows) <= _MANY:
        corners = np.concatenate([points, edge[:, ::-1]], axis=1)
        sheet.marks.append(Fills(corners, faded(colour, 0.13), ("rods", rows)))
        if name != MOMENT:
            _hatch(sheet, diagram, drawn, colour, name)
    outline = np.concatenate([points[:, :1], edge, points[:, -1:]], axis=1)
    first, last = outline[:, :-1].reshape(-1, 2), outline[:, 1:].reshape(-1, 2)
    of = ("rods", np.repeat(rows, outline.shape[1] - 1))
    sheet.marks.append(Strokes(first, last, 1.4 * u, faded(colour, 0.9), of))
    sheet.occupancy.line(first, last, FAINT)
    _note_areas(sheet, rows, points, normals, heights[drawn])


def _note_areas(sheet: Sheet, rows: Rows, points: Points, normals: Points, heights: Values) -> None:
    """Let labels know where the areas are, piece by piece."""
    start, end = points[:, :-1].reshape(-1, 2), points[:, 1:].reshape(-1, 2)
    way = end - start
    across = np.stack([way[:, 1], -way[:, 0]], axis=1) / np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    side = np.sign((across * normals[:, :-1].reshape(-1, 2)).sum(axis=1))
    first, last = heights[:, :-1].ravel(), heights[:, 1:].ravel()
    most = np.where(np.abs(first) > np.abs(last), first, last)
    of = ("rods", np.repeat(rows, heights.shape[1] - 1))
    sheet.occupancy.parts.diagrams(of, start, end, across * (side * most)[:, None])


def _hatch(sheet: Sheet, diagram: _Diagram, drawn: NDArray[np.bool_], colour: Colour, name: str) -> None:
    """Lines across, at equal distances along each rod."""
    some = np.flatnonzero(drawn)
    length = np.hypot(*(diagram.points[some, -1] - diagram.points[some, 0]).T)
    count = np.clip(length / (_HATCH * sheet.unit), 1, 200).astype(np.intp)
    of = np.repeat(some, count)
    shares = (ranges(np.zeros_like(count), count) + 0.5) / np.repeat(count, count)
    points, normals = _stations(sheet, diagram.base.some(of), shares[:, None], sheet.view.quantity)
    height = diagram.scale * values(diagram.polynomials[of], shares[:, None])
    if name in ("tension", "compression"):
        height = np.maximum(height, 0.0) if name == "tension" else np.minimum(height, 0.0)
    start, end = points[:, 0], (points + height[..., None] * normals)[:, 0]
    sheet.marks.append(Strokes(start, end, 0.8 * sheet.unit, faded(colour, 0.4), ("rods", diagram.rows[of])))


def _mark_zeros(sheet: Sheet, quantity: str, diagram: _Diagram) -> None:
    """Small open circles where a diagram changes sign between the ends of a rod."""
    if len(diagram.rows) > _MANY:
        return
    which, shares = zeros(diagram.polynomials)
    large = np.abs(diagram.heights).max(axis=1) > 2.0 * sheet.unit
    kept = (shares > _INSIDE) & (shares < 1.0 - _INSIDE) & large[which]
    which, shares = which[kept], shares[kept]
    if not len(which):
        return
    base = diagram.base.some(which)
    at = _stations(sheet, base, shares[:, None], quantity)[0][:, 0]
    radius, of = np.full(len(at), _ZERO * sheet.unit), ("rods", diagram.rows[which])
    colour = sheet.theme.ink
    sheet.above.append(Discs(at, radius, faded(colour, 0.9), sheet.theme.background, 1.25 * sheet.unit, of))


# --- values ------------------------------------------------------------------------------------------


def _label(sheet: Sheet, quantity: str, diagram: _Diagram) -> None:
    """Values at the ends and at the extreme between, where they are not told by a neighbour already."""
    field = f"rods.{quantity}"
    selected = sheet.chosen(sheet.tagged(Selected, "rods"), diagram.rows)
    if sheet.rod_length < SHORTEST_WITH_VALUE * sheet.unit:
        sheet.values[field] = int((~selected).sum())
        diagram = diagram.some(selected)
    which, number, shares, value = _told(sheet, quantity, diagram)
    base = diagram.base.some(which)
    points, normals = _stations(sheet, base, shares[:, None], quantity)
    points, normals = points[:, 0], normals[:, 0]
    seen = np.flatnonzero(sheet.sees(points))
    sheet.values[field] += len(seen)
    rows = diagram.rows[which]
    keys = _PLACES * rows + number
    worth = worth_of(sheet, field, keys, value) + 1e6 * sheet.chosen(sheet.tagged(Selected, "rods"), rows)
    shown = most_important(sheet, worth, seen)
    if not len(shown):
        return
    few = len(seen) <= FEW_VALUES
    size = sheet.font(12.0 if few else 11.0)
    numbers = value[shown].tolist()
    nothing = max(_NOTHING * diagram.largest, SMALLEST_FORCE)
    texts = [_written(quantity, number, nothing, few) for number in numbers]
    half = np.array([half_size(text, size, "semibold", sheet.unit) for text in texts]).reshape(-1, 2)
    at, normal = points[shown], normals[shown] * np.where(value[shown] < 0.0, -1.0, 1.0)[:, None]
    height, inward = diagram.scale * np.abs(value[shown]), np.array([1.0, -1.0, 0.0])[number[shown]]
    along = normals[shown][:, ::-1] * ([1.0, -1.0] if quantity == MOMENT else [-1.0, 1.0])
    places = _places(at, normal, along, height, inward, half, sheet.unit)
    colours = [_colour_of(sheet, quantity, number) for number in numbers]
    great = np.abs(value[shown]) > _GREAT * diagram.largest  # before arrows
    ranks = (-worth[shown] - np.where(great, 2e9, 0.0)).tolist()
    of = [("rods", row) for row in rows[shown].tolist()]
    anchors = np.stack([at + normal * height[:, None], at + normal * (0.5 * height)[:, None], at], axis=1)
    labels = [(field, key) for key in keys[shown].tolist()]
    found = zip(texts, places, colours, ranks, labels, of, of, anchors, normal, strict=True)
    add_values(sheet, found, size, "spare" if few else "cover")


def _colour_of(sheet: Sheet, quantity: str, value: float) -> Colour:
    if quantity != AXIAL:
        return sheet.theme.text
    sign = "zero" if abs(value) <= SMALLEST_FORCE else "tension" if value > 0.0 else "compression"
    return _colour(sheet, sign)


def _written(quantity: str, value: float, nothing: float, few: bool) -> str:
    """A value as it is told: moments without sign, since their side says it; shear with both."""
    text = written.number(abs(value) if quantity == MOMENT else value, nothing=nothing)
    sign = "+" if quantity == SHEAR and value > 0.0 and text != "0" else ""
    return f"{sign}{text}{f' {UNITS[quantity]}' if few else ''}"


def _told(sheet: Sheet, quantity: str, diagram: _Diagram) -> tuple[Rows, Rows, Values, Values]:
    """Which values are told: of which rod of the diagram, at which of its places, the share there, and the value."""
    count, polynomials = len(diagram.rows), diagram.polynomials
    ends = values(polynomials, np.array([0.0, 1.0]))
    largest = diagram.largest
    least = max(_NOTHING * largest, SMALLEST_FORCE)
    told = np.abs(ends) > least
    which, shares = zeros(derivative(polynomials))
    between = values(polynomials[which], shares[:, None])[:, 0]
    kept = (shares > _INSIDE) & (shares < 1.0 - _INSIDE) & (np.abs(between) > least)
    kept &= (np.abs(between[:, None] - ends[which]) > _ALIKE * largest).all(axis=1)
    which, shares, between = which[kept], shares[kept], between[kept]
    order = np.lexsort((-np.abs(between), which))  # of several in a rod the largest
    first = order[np.unique(which[order], return_index=True)[1]]
    which, shares, between = which[first], shares[first], between[first]
    same = np.abs(ends[:, 0] - ends[:, 1]) <= _ALIKE * largest
    same[which] = False
    middle = np.flatnonzero(same & (told.any(axis=1) | (quantity == AXIAL)))
    middle = middle[~_continued(sheet, diagram.rows[middle], ends[middle, 0], largest)]
    told[same] = False
    if quantity == MOMENT:
        told &= ~_repeated(sheet, diagram, ends, largest)
    rod, end = np.nonzero(told)
    every = np.arange(count)
    return (
        np.concatenate([rod, which, every[middle]]),
        np.concatenate([end, np.full(len(which) + len(middle), 2)]),
        np.concatenate([end.astype(np.float64), shares, np.full(len(middle), 0.5)]),
        np.concatenate([ends[rod, end], between, values(polynomials[middle], np.array([0.5]))[:, 0]]),
    )


def _continued(sheet: Sheet, rows: Rows, constant: Values, largest: float) -> NDArray[np.bool_]:
    """Which rods with constant values go on from another one with the same, by a joint of these two only."""
    start, end = sheet.ends[rows].T
    before = np.full(len(sheet.centres), np.nan)
    before[end] = np.abs(constant)
    joined = np.bincount(sheet.ends.ravel(), minlength=len(sheet.centres)) == 2
    same: NDArray[np.bool_] = joined[start] & (np.abs(before[start] - np.abs(constant)) <= _ALIKE * largest)
    return same


def _repeated(sheet: Sheet, diagram: _Diagram, ends: Values, largest: float) -> NDArray[np.bool_]:
    """Ends of rods whose moment another end at the same joint tells, or that are no extreme of a member, (n, 2)."""
    rows, repeated = diagram.rows, np.zeros(ends.shape, dtype=bool)
    joints = sheet.ends[rows]
    at = np.bincount(sheet.ends[sheet.model.rods.turning_shares > 0.0], minlength=len(sheet.centres))
    slope = values(derivative(diagram.polynomials), np.array([0.0, 1.0])) * [1.0, -1.0]  # away from the end
    slope = slope / np.maximum(sheet.model.rods.rest_length[rows], 1e-300)[:, None] * np.sign(ends)
    way = (diagram.points[:, -1] - diagram.points[:, 0])[:, None] * np.array([[1.0], [-1.0]])
    way = way / np.maximum(np.hypot(way[..., 0], way[..., 1]), 1e-9)[..., None]
    shared = np.flatnonzero(at[joints].ravel() == 2)
    shared = shared[np.argsort(joints.ravel()[shared], kind="stable")]
    pairs = np.flatnonzero(np.diff(joints.ravel()[shared]) == 0)
    one, other = shared[pairs], shared[pairs + 1]
    same = np.abs(np.abs(ends.ravel()[one]) - np.abs(ends.ravel()[other])) <= _ALIKE * largest
    one, other = one[same], other[same]
    way, slope = way.reshape(-1, 2), slope.ravel()
    straight = (way[one] * way[other]).sum(axis=1) < -_STRAIGHT
    repeated.ravel()[other] = True
    repeated.ravel()[one[straight & (slope[one] * slope[other] < 0.0)]] = True  # the moment passes through
    return repeated


def _places(
    at: Points, normal: Points, along: Points, height: Values, inward: Values, half: Points, u: float
) -> Points:
    """Where each value may stand, (n, k, 2): beyond the edge of its diagram, in it if it fits, behind the rod.

    inward: +1, −1: at the start, the end of a rod, whose values stand along it; 0: between.
    """
    normal_x, normal_y = np.abs(normal).T
    reach, extent = normal_x * half[:, 0] + normal_y * half[:, 1], normal_y * half[:, 0] + normal_x * half[:, 1]
    beside, fits = reach + GAP * u, height > 2.0 * reach
    beyond = height + beside
    across = [
        beyond,
        np.where(fits, 0.5 * height, beyond),
        -beside,
        beyond + 10.0 * u,
        np.where(fits, beside, -beside),
    ]
    step = extent + 3.0 * u
    near = np.maximum(_NEAR * u, 2.0 * step)
    slides = [
        np.where(inward == 0.0, share * step, inward * np.minimum(other * step, near))
        for share, other in _SLIDES
    ]
    slides.append(inward * 3.0 * step)
    slides = slides if len(at) <= FEW_VALUES else slides[:3]
    offset = np.stack(across, axis=1)[:, :, None, None] * normal[:, None, None, :]
    slide = np.stack(slides, axis=1)[:, None, :, None] * along[:, None, None, :]
    places = at[:, None, None, :] + offset + slide
    parts = [part.reshape(len(at), -1, 2) for part in (places[:, :, :5], places[:, :, 5:])]  # far ones last
    return np.concatenate(parts, axis=1)
