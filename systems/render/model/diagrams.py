"""Diagrams along rods: N, M on the side in tension, or V, with values, extremes and zero points.

Where no rod of a model bends, N is drawn as rectangles that stand outside of the structure.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.bent import AXIAL, FLAT, MOMENT, SHEAR, Axes, inner_forces
from pinjoint.components.camera import Viewport
from pinjoint.components.language import marked, tr
from pinjoint.components.load import varying
from pinjoint.components.model import Model
from pinjoint.components.spans import Curves, zeros
from pinjoint.components.tags import DiagramShown, Selected
from pinjoint.components.view import MARGIN
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.nearness import DIAGRAM, ranges
from pinjoint.systems.render.labels.occupancy import FAINT
from pinjoint.systems.render.labels.placing import ANCHORS
from pinjoint.systems.render.marks import Bars, Discs, Fills, Points, Strokes, Truths, Values
from pinjoint.systems.render.model.arrows import steady
from pinjoint.systems.render.model.sheet import Sheet, typical_length
from pinjoint.systems.render.model.values import (
    FEW_VALUES,
    SMALLEST,
    half_sizes,
    most_important,
    reach,
    room_for_values,
    said,
    write,
)
from pinjoint.systems.render.symbols import dashed
from pinjoint.systems.render.theme import Colour, faded

NAMES = {AXIAL: marked("axial force N"), MOMENT: marked("bending moment M"), SHEAR: marked("shear force V")}
UNITS = {AXIAL: "kN", MOMENT: "kN·m", SHEAR: "kN"}
_BESIDE = ("load", "load per length", "load moment", "reaction", "reaction moment", "ghost")
EXPLAINED = {  # in the legend, at most: what they show, then what stands beside them
    AXIAL: ("tension", "compression", *_BESIDE),
    MOMENT: ("moment", *_BESIDE),
    SHEAR: ("shear", *_BESIDE),
}
_LEAST = 24.0  # points that diagrams have towards the legend and the rim, where there is less room
_LARGEST, _FAR = 1e100, 1e6  # kN or kN·m, pixels: what is beyond is left out
_STEPS = (8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0)
_TOO_FLAT, _ENLARGED = 0.05, 0.3  # of the room: loads (one point per kN) below which, up to which, to enlarge
# Points, of rods with a diagram; values of others would only hide them.
_SHORTEST, _SHORTEST_WITH_VALUE = 6.0, 24.0
_MANY = 300  # rods, above which diagrams of those that bend are outlines
_PIECES, _PIECE = 1_440, 5.0  # of all diagrams of rods that bend, at most; points, or longer
_ROOM, _SHARE = 1.25, 0.3  # of the room of force diagrams; of the largest shear, the least that fills it with N
_DASH = 4.0  # points, of the outlines of what is no equilibrium
_NOTHING = 1e-3  # of the largest value: what is not told
_ALIKE = 5e-3  # of the largest value: what counts as the same
_IN_LINE = 1e-3  # sine of an angle between rods that nobody sees
_INSIDE = 0.02  # share of a rod, from which on a zero point or an extreme is not at its end
_ALONG = np.array([0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9])  # of how far the value of a rectangle can go along it
# Between ends, and at one.
_SLIDES = ((0.0, 0.0), (0.5, 0.5), (-0.5, 1.0), (1.0, 2.0), (-1.0, -1.0), (1.5, 4.0))
_GAP = 1.0  # points between a rod and a value beside it
_NEAR = 42.0  # points along a rod, or a step: so far from its end stands a value without a line
# Points from an end, and along from a value between, of places where its line may end.
_INSETS = ((0.0, 0.0), (6.0, 6.0), (12.0, -6.0), (18.0, 12.0), (25.0, -12.0), (33.0, 18.0))
# Shares, where the lines may end, too.
_ON_RODS = np.array([0.5, 0.35, 0.65, 0.2, 0.8, 0.28, 0.72, 0.12, 0.88, 0.43, 0.57])
_PLACES = 6  # of values of a rod: start, end, and between


@dataclass(frozen=True)
class _Diagram:
    """The diagram of some rods: rows (n,), their axes in pixels, values along them, constant of rectangles, pixels per kN or
    kN·m, largest value in the model.

    side: 1 where positive values stand to the left, as drawn, else −1, (n,). points, normals, heights: at shares (n, k),
    with unit normals to where positive values stand;
    of rectangles one for both ends.
    """

    quantity: str
    rows: Rows
    base: Axes
    curves: Curves
    scale: float
    largest: float
    side: Values
    points: Points
    normals: Points
    heights: Values

    @property
    def is_straight(self) -> bool:
        """Whether it consists of rectangles."""
        return bool(self.curves.polynomials.shape[1] == 1)

    def some(self, which: Truths | Rows) -> _Diagram:
        """The diagram of some of the rods."""
        names = "rows", "side", "points", "normals", "heights"
        columns = {name: getattr(self, name)[which] for name in names}
        return replace(self, base=self.base.some(which), curves=self.curves.some(which), **columns)

    def at(self, which: Rows, shares: Values) -> tuple[Points, Points]:
        """Points at shares (k,) of some of its rods, and unit normals to where positive values stand."""
        points, normals = stations(self.base.some(which), shares[:, None], self.side[which])
        return points[:, 0], normals[:, 0]


def draw_diagrams(sheet: Sheet, taken: float = 0.0) -> None:
    """The diagrams of rods; where they are too short, they themselves take the colour of tension or compression.

    taken: pixels at the top, of heading and legend, off which those of rods that bend keep.
    """
    shown = np.full(len(sheet.rods), sheet.view.forces_known)
    if sheet.view.forces_known and not sheet.view.all_diagrams:
        shown = sheet.chosen(sheet.tagged(DiagramShown, "rods"), sheet.rods)
    if not shown.any():
        return
    rows, start, end = sheet.rods[shown], sheet.start[shown], sheet.end[shown]
    quantity = sheet.view.quantity if sheet.is_frame else AXIAL
    force = np.nan_to_num(sheet.model.rods.axial_force)
    length = sheet.rod_length if shown.all() else typical_length(start, end)
    if length < _SHORTEST * sheet.unit and len(rows) > _MANY:
        if quantity == AXIAL:
            sheet.pulled, sheet.pushed = rows[force[rows] > SMALLEST], rows[force[rows] < -SMALLEST]
        sheet.advise(tr("zoom in to see force diagrams"))
        return
    room = diagram_room(sheet.viewport, sheet.unit, length)
    diagram = (
        _curves(sheet, rows, quantity, min(_ROOM * room, MARGIN * sheet.unit), taken)
        if sheet.is_frame
        else (_rectangles(sheet, rows, force, start, end, room))
    )
    if diagram is not None:
        _draw(sheet, diagram)
        _mark_zeros(sheet, diagram)
        _write(sheet, diagram)


def diagram_room(window: Viewport, unit: float, length: float = math.inf) -> float:
    """How high (pixels) diagrams of rods of such a length leave the structure readable."""
    return max(min(0.15 * min(window.width, window.height), 0.6 * length), 10.0 * unit)


# --- rectangles, where none bends --------------------------------------------------------------------


def _rectangles(sheet: Sheet, rows: Rows, force: Values, start: Points, end: Points, room: float) -> _Diagram:
    """The diagram of bars of which these parts are seen, |N| × diagram scale high."""
    largest, scale = float(np.abs(force).max()), sheet.model.settings.diagram_scale
    factor = diagram_factor(largest, _loads(sheet.model), scale, room / sheet.unit)
    if factor != 1.0:
        sheet.notes.append(tr("diagrams ×{factor:g}", factor=factor))
    value, scale = force[rows, None], scale * factor * sheet.unit
    way = end - start
    left = np.stack([way[:, 1], -way[:, 0]], axis=1) / np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    side = _outward(sheet, rows) * np.where(value[:, 0] < 0.0, -1.0, 1.0)
    base = Axes(start, end, left, Curves.plain(np.zeros((len(rows), 1))))
    points, normals = np.stack([start, end], axis=1), (left * side[:, None])[:, None]
    curves = Curves.plain(value)
    return _Diagram(AXIAL, rows, base, curves, scale, largest, side, points, normals, scale * value)


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
    if SMALLEST < loads < _TOO_FLAT * room:
        factor = scale_step(loads, 1.0, _ENLARGED * room)
    if largest * scale * factor > room:
        factor = scale_step(largest, scale, room)
    return factor


def _loads(model: Model) -> float:
    """The sum of all external forces (kN), of varying ones the largest that they reach."""
    constant, loads = model.particles.constant_force, model.loads
    return float(np.hypot(*constant.T).sum() + np.hypot(*loads.force[varying(loads)].T).sum())


def _outward(sheet: Sheet, rows: Rows) -> Values:
    """1 for rods whose left side, as drawn, is away from the middle of the original structure, else −1; if they go through
    it, upwards or to the left.

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
    return np.where(side < 0.0, -1.0, 1.0)


# --- curves ------------------------------------------------------------------------------------------


def _curves(sheet: Sheet, rows: Rows, quantity: str, room: float, taken: float) -> _Diagram | None:
    """The diagram of some rods, on the scale of all; None where there is nothing to be drawn."""
    model = sheet.model
    every = inner_forces(model, np.arange(model.rods.count), quantity)
    every.polynomials[~(np.abs(every.polynomials) < _LARGEST).all(axis=1)] = 0.0
    few = every.with_kinks(np.linspace(0.0, 1.0, 5))
    largest = float(np.abs(sampled := every.at(few)).max(initial=0.0))
    if quantity == AXIAL:  # small ones, as bending shortens rods, look small
        shear = np.abs(model.rods.shear)
        largest = max(largest, _SHARE * float(shear[shear < _LARGEST].max(initial=0.0)))
    if largest <= SMALLEST:
        return None
    side = np.full(len(every), -1.0 if quantity == MOMENT else 1.0)
    whole = baseline(sheet, np.arange(len(every)))
    fitting = max(largest, room * crowding(sheet, *stations(whole, few, side), sampled, taken))
    scale = room * model.settings.diagram_scale / steady(sheet, (f"diagrams.{quantity}", 0), fitting)
    scale = min(scale, _FAR / largest)
    base, curves, side = whole.some(rows), every.some(rows), side[rows]
    most = np.clip(_PIECES // len(rows), 4, 24)  # more where rods are few and long
    tall = math.sqrt(scale * largest / FLAT)  # so many chords of a parabola so high are that flat
    pieces = int(np.clip(max(sheet.rod_length / (_PIECE * sheet.unit), tall), 8, most))
    shares = np.linspace(0.0, 1.0, pieces + 1)
    shares = curves.with_kinks(shares)
    points, normals = stations(base, shares, side)
    heights = scale * curves.at(shares)
    found = _Diagram(quantity, rows, base, curves, scale, largest, side, points, normals, heights)
    near = (np.abs(points) < _FAR) & np.isfinite(normals)
    return found.some(np.asarray(near.all(axis=(1, 2))))


def crowding(sheet: Sheet, points: Points, normals: Points, values: Values, taken: float) -> float:
    """The value per pixel up to which diagrams keep off the legend and the rim; 0 where the view is closer."""
    view = sheet.view
    if not view.shows(sheet.model):
        return 0.0
    low, high = view.room.corners
    low[1] += taken
    above = normals * values[..., None]
    free = np.maximum(np.where(above < 0.0, points - low, high - points), _LEAST * sheet.unit)
    return float(np.nan_to_num(np.abs(above) / free).max(initial=0.0))


def baseline(sheet: Sheet, rows: Rows) -> Axes:
    """The axes of rods in pixels as drawn."""
    camera, found = sheet.view.camera, Axes.of(sheet.model, rows)
    # Pixels' y is down, and what is ahead of a left side behind it.
    left = found.left * [camera.scale, -camera.scale]
    drift = None if found.drift is None else found.drift.times(-1.0)
    return Axes(camera.to_pixels(found.start), camera.to_pixels(found.end), left, found.bow, drift)


def stations(base: Axes, shares: Values, side: Values) -> tuple[Points, Points]:
    """Points of baselines in pixels, and unit normals to the left as drawn, or where `side` is −1 to the right."""
    way = base.tangents(shares)
    length = np.maximum(np.hypot(way[..., 0], way[..., 1]), 1e-300)[..., None]
    return base.points(shares), way[..., ::-1] * [1.0, -1.0] / length * side[:, None, None]


# --- areas -------------------------------------------------------------------------------------------


def _draw(sheet: Sheet, diagram: _Diagram) -> None:
    """Areas with an outline; axial forces in the colours of tension and compression, and of bars without force."""
    if diagram.quantity != AXIAL:
        everywhere = np.ones(len(diagram.rows), dtype=bool)
        _draw_areas(sheet, EXPLAINED[diagram.quantity][0], diagram, diagram.heights, everywhere)
        return
    nothing = diagram.is_straight & ~sheet.model.rods.tension_only[diagram.rows]  # a slack cable stays dashed
    pulled, pushed = np.maximum(diagram.heights, 0.0), np.minimum(diagram.heights, 0.0)
    for name, heights in (("tension", pulled), ("compression", pushed)):
        drawn = np.abs(heights).max(axis=1) > SMALLEST * diagram.scale
        _draw_areas(sheet, name, diagram, heights, drawn)
        nothing &= ~drawn
    _draw_areas(sheet, "zero", diagram, diagram.heights, nothing)


def _draw_areas(sheet: Sheet, name: str, diagram: _Diagram, heights: Values, drawn: Truths) -> None:
    """One colour of a diagram; what is curved is hatched but for moments."""
    if not drawn.any():
        return
    rows, points, heights = diagram.rows[drawn], diagram.points[drawn], heights[drawn]
    rise = heights[..., None] * diagram.normals[drawn]
    colour, edge, u = sheet.colour_of("ink" if name in ("moment", "shear") else name), points + rise, sheet.unit
    is_outlined, of = not diagram.is_straight or sheet.rod_length > 16.0 * u, ("rods", rows)
    if diagram.is_straight:
        area = faded(colour, 0.16 if is_outlined else 0.5)
        sheet.marks.append(Bars(points[:, 0], points[:, 1], rise[:, 0], area, of))
    elif len(rows) <= _MANY:
        corners = np.concatenate([points, edge[:, ::-1]], axis=1)
        sheet.marks.append(Fills(corners, faded(colour, 0.13), of))
        if name != "moment":
            _hatch(sheet, diagram, drawn, colour, name)
    if is_outlined:
        outline = np.concatenate([points[:, :1], edge, points[:, -1:]], axis=1)
        first, last = outline[:, :-1].reshape(-1, 2), outline[:, 1:].reshape(-1, 2)
        each, width = np.repeat(rows, outline.shape[1] - 1), 1.25 if diagram.is_straight else 1.4
        start, end, of_line = first, last, each
        if sheet.view.provisional:
            start, end, dash = dashed(first, last, _DASH * u)
            of_line = each[dash]
        sheet.marks.append(Strokes(start, end, width * u, faded(colour, 0.9), ("rods", of_line)))
        sheet.occupancy.line(first, last, FAINT)
    if name != "zero":
        shown = (np.concatenate([points[:, end], edge[:, end]]) for end in (0, -1))
        sheet.explain(name, *shown)
    if not diagram.is_straight:
        higher = np.abs(heights[:, :-1]) > np.abs(heights[:, 1:])
        rise = np.where(higher[..., None], rise[:, :-1], rise[:, 1:])
    pieces = points[:, :-1].reshape(-1, 2), points[:, 1:].reshape(-1, 2), rise.reshape(-1, 2)
    of = "rods", np.repeat(rows, points.shape[1] - 1)
    sheet.occupancy.parts.add(of, *pieces[:2], rise=pieces[2], kind=DIAGRAM)


def _hatch(sheet: Sheet, diagram: _Diagram, drawn: Truths, colour: Colour, name: str) -> None:
    """Lines across, at equal distances along each rod."""
    some = np.flatnonzero(drawn)
    length = np.hypot(*(diagram.points[some, -1] - diagram.points[some, 0]).T)
    count = np.clip(length / (7.0 * sheet.unit), 1, 200).astype(np.intp)  # points between lines across
    of = np.repeat(some, count)
    shares = (ranges(np.zeros_like(count), count) + 0.5) / np.repeat(count, count)
    start, normals = diagram.at(of, shares)
    height = diagram.curves.some(of).at(shares[:, None])[:, 0]
    if name in ("tension", "compression"):
        height = np.maximum(height, 0.0) if name == "tension" else np.minimum(height, 0.0)
    end = start + (diagram.scale * height)[:, None] * normals
    sheet.marks.append(Strokes(start, end, 0.8 * sheet.unit, faded(colour, 0.4), ("rods", diagram.rows[of])))


def _mark_zeros(sheet: Sheet, diagram: _Diagram) -> None:
    """Small open circles where a curve changes sign between the ends of a rod."""
    if len(diagram.rows) > _MANY or diagram.is_straight:
        return
    which, shares = zeros(diagram.curves.stretches)
    large = np.abs(diagram.heights).max(axis=1) > 2.0 * sheet.unit
    kept = (shares > _INSIDE) & (shares < 1.0 - _INSIDE) & large[which]
    which, shares = which[kept], shares[kept]
    if not len(which):
        return
    at, radius = diagram.at(which, shares)[0], np.full(len(which), 2.5 * sheet.unit)  # points
    colour, of = faded(sheet.theme.ink, 0.9), ("rods", diagram.rows[which])
    sheet.above.append(Discs(at, radius, colour, sheet.theme.background, 1.25 * sheet.unit, of))


# --- values ------------------------------------------------------------------------------------------


def _write(sheet: Sheet, diagram: _Diagram) -> None:
    """Values: of rectangles in the middle of what is seen of the rod, else at the ends and at the extreme between, where
    they are not told by a neighbour already."""
    quantity, field = diagram.quantity, f"rods.{diagram.quantity}"
    if diagram.is_straight:
        start, end, seen = clip_segments(diagram.base.start, diagram.base.end, *sheet.viewport.corners)
        diagram = diagram.some(seen)
        diagram = replace(diagram, base=replace(diagram.base, start=start, end=end))
    selected = sheet.chosen(sheet.tagged(Selected, "rods"), diagram.rows)
    if sheet.rod_length < _SHORTEST_WITH_VALUE * sheet.unit and len(diagram.rows) > room_for_values(sheet):
        sheet.values[field] += int((~selected).sum())
        diagram, selected = diagram.some(selected), selected[selected]
    which, number, shares, value = _told(sheet, diagram)
    keys, selected = _PLACES * diagram.rows[which] + number, selected[which]
    seen, (at, normal) = np.arange(len(which)), diagram.at(which, shares)
    if not diagram.is_straight:
        seen = seen[sheet.sees(at)]
    shown, worth = most_important(sheet, field, keys, value, seen, np.where(selected, 1e6, 0.0))
    if not len(shown):
        return
    few, told = len(seen) <= FEW_VALUES, len(seen) == len(shown)
    size, which, number, value = sheet.font(12.0 if few else 11.0), which[shown], number[shown], value[shown]
    nothing = SMALLEST if diagram.is_straight else max(_NOTHING * diagram.largest, SMALLEST)
    texts = [_written(sheet, quantity, each, nothing, few) for each in value.tolist()]
    lines: Literal["cover", "spare"] = "spare" if few else "cover"
    half, height = half_sizes(sheet, texts, size), diagram.scale * np.abs(value)
    at, normal = at[shown], normal[shown]
    along = normal[:, ::-1] * [-1.0, 1.0] * diagram.side[which, None]
    normal = normal * np.where(value < 0.0, -1.0, 1.0)[:, None]
    edge = at + normal * height[:, None]
    if diagram.is_straight:
        way = (diagram.base.end - diagram.base.start)[which]
        places = _places_by_rectangles(at, normal, height, half, np.hypot(*way.T), sheet.unit)
        edges = edge[:, None] + (ANCHORS[:, None] - 0.5) * way[:, None]
        anchors = np.concatenate([edges, at[:, None] + (_ON_RODS[:, None] - 0.5) * way[:, None]], axis=1)
    else:
        inward = np.array([1.0, -1.0, 0.0])[np.minimum(number, 2)]
        places = _places_by_curves(at, normal, along, height, inward, half, sheet.unit)
        anchors = _ends_of_lines(sheet, diagram, which, shares[shown], number)
        worth = worth + np.where(np.abs(value) > 0.5 * diagram.largest, 2e9, 0.0)  # before arrows
    columns = (column.tolist() for column in (diagram.rows[which], keys[shown], worth, value))
    for k, (row, number_of, most, force) in enumerate(zip(*columns, strict=True)):
        of, key, rank = ("rods", row), (field, number_of), -most
        sign = "zero" if abs(force) <= SMALLEST else "tension" if force > 0.0 else "compression"
        colour = sheet.colour_of(sign if quantity == AXIAL else "text")
        short = texts[k] if not few else _written(sheet, quantity, force, nothing, few=False)
        write(
            sheet,
            texts[k],
            places[k],
            colour,
            key,
            of,
            rank=rank,
            own=of,
            leads=(anchors[k], normal[k]),
            size=size,
            lines=lines,
            short=short if told else "",
        )


def _written(sheet: Sheet, quantity: str, value: float, nothing: float, few: bool) -> str:
    """A value as it is told: moments without sign, since their side says it; shear with both."""
    size = abs(value) if quantity == MOMENT else value
    sign = "+" if quantity == SHEAR and value > nothing else ""
    return f"{sign}{said(sheet, size, UNITS[quantity], nothing, bare=not few)}"


def _told(sheet: Sheet, diagram: _Diagram) -> tuple[Rows, Rows, Values, Values]:
    """Which values are told: of which rod of the diagram, at which of its places, the share there, and the value."""
    count, curves, quantity = len(diagram.rows), diagram.curves, diagram.quantity
    every = np.arange(count)
    if diagram.is_straight:
        return every, np.full(count, 2), np.full(count, 0.5), curves.polynomials[:, 0]
    ends = curves.at(np.array([0.0, 1.0]))
    largest = diagram.largest
    least = max(_NOTHING * largest, SMALLEST)
    told = np.abs(ends) > least
    which, shares = zeros(curves.derivative.stretches)
    which, shares = np.append(which, curves.row), np.append(shares, curves.place)
    which, shares = np.append(which, curves.row), np.append(shares, np.nextafter(curves.place, 0.0))
    between = curves.some(which).at(shares[:, None])[:, 0]
    kept = (shares > _INSIDE) & (shares < 1.0 - _INSIDE) & (np.abs(between) > least)
    kept &= (np.abs(between[:, None] - ends[which]) > _ALIKE * largest).all(axis=1)
    which, shares, between = which[kept], shares[kept], between[kept]
    order = np.lexsort((-np.abs(between), which))  # of several in a rod the largest
    number = np.where(np.diff(which[order], prepend=-1) != 0, 0, _PLACES)
    for row in np.unique(curves.row).tolist():  # where loads act inside, all that differ
        told_here: list[float] = []
        for at in range(*np.searchsorted(which[order], [row, row + 1]).tolist()):
            value = float(between[order[at]])
            known = any(abs(value - other) <= _ALIKE * largest for other in told_here)
            number[at] = _PLACES if known else len(told_here)
            told_here += [] if known else [value]
    order, number = order[number < _PLACES - 2], number[number < _PLACES - 2]
    which, shares, between = which[order], shares[order], between[order]
    same = np.abs(ends[:, 0] - ends[:, 1]) <= _ALIKE * largest
    same[which] = False
    middle = np.flatnonzero(same & (told.any(axis=1) | (quantity == AXIAL)))
    constant = ends[middle, 0] if quantity == AXIAL else np.abs(ends[middle, 0])
    middle = middle[~_continued(sheet, diagram.rows[middle], constant, largest)]
    told[same] = False
    if quantity != AXIAL:
        told &= ~_repeated(sheet, diagram, ends)
    rod, end = np.nonzero(told)
    return (
        np.concatenate([rod, which, every[middle]]),
        np.concatenate([end, 2 + number, np.full(len(middle), 2)]),
        np.concatenate([end.astype(np.float64), shares, np.full(len(middle), 0.5)]),
        np.concatenate([ends[rod, end], between, curves.some(middle).at(np.array([0.5]))[:, 0]]),
    )


def _continued(sheet: Sheet, rows: Rows, constant: Values, largest: float) -> Truths:
    """Which rods with constant values go on in a line from another one with the same, by a joint of these two only."""
    start, end = sheet.ends[rows].T
    before, rods = np.full((len(sheet.centres), 3), np.nan), sheet.model.rods
    way = rods.difference[rows] / np.maximum(rods.original_length[rows], 1e-300)[:, None]
    before[end] = np.column_stack([constant, way])
    turned = np.abs(before[start, 1] * way[:, 1] - before[start, 2] * way[:, 0])
    alike = np.abs(before[start, 0] - constant) <= _ALIKE * largest
    joined = np.bincount(sheet.ends.ravel(), minlength=len(sheet.centres)) == 2
    return joined[start] & alike & (turned <= _IN_LINE)


def _repeated(sheet: Sheet, diagram: _Diagram, ends: Values) -> Truths:
    """Ends of rods whose moment another end at the same joint tells, or that are no extreme of a member, (n, 2); likewise
    ends from which a member goes straight on with the same shear force."""
    rows, repeated = diagram.rows, np.zeros(ends.shape, dtype=bool)
    joints = sheet.ends[rows]
    counted = sheet.ends[sheet.model.rods.turning_shares > 0.0] if diagram.quantity == MOMENT else sheet.ends
    at = np.bincount(counted.ravel(), minlength=len(sheet.centres))
    slope = diagram.curves.derivative.at(np.array([0.0, 1.0])) * [1.0, -1.0]  # away from the end
    slope = slope / np.maximum(sheet.model.rods.rest_length[rows], 1e-300)[:, None] * np.sign(ends)
    way = (diagram.points[:, -1] - diagram.points[:, 0])[:, None] * np.array([[1.0], [-1.0]])
    way = way / np.maximum(np.hypot(way[..., 0], way[..., 1]), 1e-9)[..., None]
    shared = np.flatnonzero(at[joints].ravel() == 2)
    shared = shared[np.argsort(joints.ravel()[shared], kind="stable")]
    pairs = np.flatnonzero(np.diff(joints.ravel()[shared]) == 0)
    one, other = shared[pairs], shared[pairs + 1]
    first, second = (
        np.abs(ends.ravel()[which]) if diagram.quantity == MOMENT else ends.ravel()[which]
        for which in (one, other)
    )
    same = np.abs(first - second) <= 1e-3 * np.maximum(np.abs(first), np.abs(second))  # told once
    one, other = one[same], other[same]
    way, slope = way.reshape(-1, 2), slope.ravel()
    straight = (way[one] * way[other]).sum(axis=1) < -0.9  # cosine of the turn
    if diagram.quantity == SHEAR:
        repeated.ravel()[other[straight]] = True
        return repeated
    repeated.ravel()[other] = True
    repeated.ravel()[one[straight & (slope[one] * slope[other] < 0.0)]] = True  # the moment passes through
    return repeated


def _ends_of_lines(sheet: Sheet, diagram: _Diagram, which: Rows, shares: Values, ends: Rows) -> Points:
    """Where lines from values may end, (n, k, 2): on the edge of the diagram, in it, on the rod, then the same further along
    it, off the joint, where others begin, too."""
    length = np.hypot(*(diagram.base.end - diagram.base.start)[which].T)[:, None]
    insets = np.array([(from_end, -from_end, between) for from_end, between in _INSETS])[
        :, np.minimum(ends, 2)
    ].T
    along = shares[:, None] + np.clip(insets * sheet.unit / np.maximum(length, 1e-9), -0.4, 0.4)
    along = np.clip(along, 0.0, 1.0)
    at, normal = stations(diagram.base.some(which), along, diagram.side[which])
    value = diagram.curves.some(which).at(along)
    height = diagram.scale * np.where(np.abs(value) > SMALLEST, value, 0.0)  # smaller ones are drawn as none
    up = np.array([1.0, 0.0, 0.5]) * height[..., None]
    return (at[:, :, None] + up[..., None] * normal[:, :, None]).reshape(len(which), -1, 2)


def _places_by_rectangles(
    at: Points, normal: Points, height: Values, half: Points, length: Values, u: float
) -> Points:
    """Where each value may stand, (n, k, 2): in its rectangle if it fits, beyond, behind the rod, on it.

    at: middles of what is seen of the rods, which is so long.
    """
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    across, beside = reach(normal, half), reach(normal, half) + _GAP * u
    fits, beyond = height > 2.0 * across, height + beside
    rows = [
        np.where(fits, 0.5 * height, beyond),
        beyond,
        np.where(fits, beside, -beside),
        -beside,
        0.0 * height,
    ]
    slides = np.maximum(length / 2 - reach(along, half), 0.0)[:, None] * _ALONG
    return _in_rows(at, normal, rows, along, slides).reshape(len(at), -1, 2)


def _places_by_curves(
    at: Points, normal: Points, along: Points, height: Values, inward: Values, half: Points, u: float
) -> Points:
    """Where each value may stand, (n, k, 2): beyond the edge of its diagram, in it if it fits, behind the rod.

    inward: +1, −1: at the start, the end of a rod, whose values stand along it; 0: between.
    """
    across, beside = reach(normal, half), reach(normal, half) + _GAP * u
    fits, beyond = height > 2.0 * across, height + beside
    rows = [beyond, np.where(fits, 0.5 * height, beyond), -beside, beyond + 10.0 * u]
    rows.append(np.where(fits, beside, -beside))
    step = reach(along, half) + 3.0 * u
    near = np.maximum(_NEAR * u, step)
    slides = [
        np.where(inward == 0.0, share * step, inward * np.minimum(other * step, near))
        for share, other in _SLIDES
    ]
    slides = slides if len(at) <= FEW_VALUES else slides[:3]
    places = _in_rows(at, normal, rows, along, np.stack(slides, axis=1))
    parts = [part.reshape(len(at), -1, 2) for part in (places[:, :, :5], places[:, :, 5:])]  # far ones last
    return np.concatenate(parts, axis=1)


def _in_rows(at: Points, way: Points, across: Sequence[Values], along: Points, slides: Values) -> Points:
    """Places of values by points (n, 2): at distances (n,) each along unit vectors `way` (n, 2), and in each of these
    rows shifted by `slides` (n, k) along others, (n, rows, k, 2)."""
    offset = np.stack(across, axis=1)[:, :, None, None] * way[:, None, None, :]
    return at[:, None, None, :] + offset + slides[:, None, :, None] * along[:, None, None, :]
