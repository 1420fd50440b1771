"""The model itself: grid, the shape that it had or gets, rods, particles, names, and a shape over all."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.bent import FLAT, Axes, Parts, drawn_scale
from pinjoint.components.rod import rigid_joints
from pinjoint.components.round_numbers import round_up
from pinjoint.components.spans import Curves
from pinjoint.components.tags import Hovered, Selected
from pinjoint.components.view import Shape
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.framing import cut_discs
from pinjoint.systems.render.labels.nearness import LINE
from pinjoint.systems.render.labels.occupancy import FAINT, STRONG
from pinjoint.systems.render.labels.placing import Label, half_size
from pinjoint.systems.render.marks import Discs, Panel, Points, Strokes, Truths, Values
from pinjoint.systems.render.model.sheet import DIRECTIONS, FEW, MANY, Sheet
from pinjoint.systems.render.model.values import BACKING, FIRST, by_arrows, half_sizes, reach, write
from pinjoint.systems.render.symbols import RIM, dashed
from pinjoint.systems.render.theme import Colour, faded

_CORNERS, _SIDES = np.array([(x, y) for y in (-1.0, 1.0) for x in (-1.0, 1.0)]), DIRECTIONS[[3, 2, 0, 1]]
_DASH = 5.0  # points
_GHOST_FROM = 4.0  # points of displacement
_SHAPE_WIDTH, _SHAPE_RADIUS, _SHAPE_FROM = 1.5, 2.5, 0.5  # points; drawn from so large a displacement on
_SHAPE_OPACITY = 0.75
HALO_OPACITY = 0.4
_THINNEST, _THICKEST, _DEPTHS = 0.5, 1.3, 8.0  # widths of rods by their bending stiffness, in steps of 1/8
_DOT = 4.0  # points, radius of the dot of a rigid joint
_HALO = 0.12  # of the length of rods, by which halos stand out, within limits


def draw_grid(sheet: Sheet) -> None:
    """The lines of the shown grid; only every 2nd, 5th, 10th, … where they would be too close."""
    selected = sheet.tagged(Selected, "grids")
    grids = sheet.model.grids
    camera, viewport = sheet.view.camera, sheet.viewport
    left, top = camera.to_model((viewport.left, viewport.top))
    right, bottom = camera.to_model((viewport.left + viewport.width, viewport.top + viewport.height))
    for row in np.flatnonzero(grids.shown).tolist():
        colour = sheet.theme.selected if row in selected else sheet.theme.grid
        spacing = grids.spacing[row]
        across = _grid_lines(left, right, float(spacing[0]), sheet)
        up = _grid_lines(bottom, top, float(spacing[1]), sheet)
        x = np.round(camera.to_pixels(np.stack([across, 0.0 * across], axis=1))[:, 0])
        y = np.round(camera.to_pixels(np.stack([0.0 * up, up], axis=1))[:, 1])
        thick = max(round(sheet.unit), 1)
        sheet.marks += [
            Panel(at - thick // 2, viewport.top, thick, viewport.height, 0.0, colour) for at in x.tolist()
        ]
        sheet.marks += [
            Panel(viewport.left, at - thick // 2, viewport.width, thick, 0.0, colour) for at in y.tolist()
        ]


def _grid_lines(low: float, high: float, spacing: float, sheet: Sheet) -> Values:
    pixels = spacing * sheet.view.camera.scale
    step = spacing * max(round_up(8.0 * sheet.unit / pixels), 1.0)
    first, last = math.ceil(low / step), math.floor(high / step)
    return step * (first + np.arange(last - first + 1, dtype=np.float64))


def draw_ghost(sheet: Sheet) -> None:
    """The undeformed rods, faint and dashed, where rods have visibly moved."""
    if not 0 < sheet.ends.shape[0] <= MANY:
        return
    original = sheet.view.camera.to_pixels(sheet.model.particles.position)
    moved = np.hypot(*(sheet.centres - original).T)
    far = (moved[sheet.ends] > _GHOST_FROM * sheet.unit).any(axis=1)
    far[_sagging(sheet)] = True
    rows = np.flatnonzero(far)
    first, last = sheet.ends[rows].T
    start, end, seen = clip_segments(original[first], original[last], *sheet.viewport.corners)
    if len(start):
        sheet.occupancy.line(start, end, FAINT)
        sheet.explain("ghost", start, end)
        start, end, of = dashed(start, end, _DASH * sheet.unit)
        sheet.marks.append(Strokes(start, end, sheet.unit, sheet.theme.ghost, ("rods", rows[seen][of])))


def draw_deflected(sheet: Sheet) -> None:
    """The deflected shape as a thin line, where the structure is drawn undeformed and the eye can tell them apart."""
    model, scale = sheet.model, float(sheet.model.settings.displacement_scale)
    if drawn_scale(model) == scale or sheet.view.shape is not None or len(sheet.ends) > MANY:
        return
    rows, shares = np.arange(len(sheet.ends)), np.array([0.0, 0.5, 1.0])
    axes = Axes.of(model, rows, scale)
    least = _SHAPE_WIDTH * sheet.unit / sheet.view.camera.scale
    seen = np.abs(axes.start - model.particles.position[sheet.ends[:, 0]]).max(initial=0.0) > least
    if seen or (np.abs(axes.points(shares) - Axes.of(model, rows).points(shares)) > least).any():
        start, end = _lines(sheet, axes, rows)
        sheet.occupancy.line(start, end, FAINT)
        sheet.explain("deflected", start, end)
        colour = faded(sheet.colour_of("sketch"), _SHAPE_OPACITY)
        sheet.marks.append(Strokes(start, end, _SHAPE_WIDTH * sheet.unit, colour))


def _sagging(sheet: Sheet) -> Rows:
    """Rows of visible rods whose axes have visibly left the straight lines between their ends."""
    if sheet.curved is None:
        return sheet.rods[:0]
    start = sheet.start[sheet.curved.rods]
    along = sheet.end[sheet.curved.rods] - start
    away, length = sheet.curved.start - start, np.maximum(np.hypot(*along.T), 1e-9)
    aside = np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]) / length
    return sheet.rods[sheet.curved.rods[aside > _GHOST_FROM * sheet.unit]]


def draw_halos(sheet: Sheet) -> None:
    """Neutral halos around selected elements and, lighter, the one that a click would hit; forces keep their colours."""
    theme, u = sheet.theme, sheet.unit
    around = float(np.clip(_HALO * sheet.rod_length, 1.5 * u, 5.0 * u))
    for tag, colour in ((Hovered, theme.hover), (Selected, theme.selected)):
        glow = faded(colour, HALO_OPACITY)
        rods = sheet.chosen(sheet.tagged(tag, "rods"), sheet.rods)
        if rods.any():
            start, end, of = sheet.lines(rods)
            sheet.marks.append(Strokes(start, end, 2.0 * around + _rod_width(sheet), glow, ("rods", of)))
        chosen = sheet.chosen(sheet.tagged(tag, "particles"), sheet.particles)
        _draw_circles(sheet, sheet.particles[chosen], glow, glow, 0.0, around)
    if near := sheet.view.near_buckling:
        start, end, of = sheet.lines(sheet.chosen(np.array(near), sheet.rods))
        glow = faded(theme.compression, HALO_OPACITY * (1.0 + sheet.view.swing) / 2.0)
        sheet.marks.append(Strokes(start, end, 4.0 * around + _rod_width(sheet), glow, ("rods", of)))
        sheet.explain("near buckling", start, end)


def draw_rods(sheet: Sheet) -> None:
    """A line between the drawn positions of the ends, magenta while yielding.

    Cables are thin, and dashed while they are slack.
    """
    rods, theme = sheet.model.rods, sheet.theme
    yielding, limited = sheet.rods[:0], np.isfinite(rods.tension_limit) | np.isfinite(rods.compression_limit)
    if sheet.view.forces_known and limited.any():
        yielding = np.flatnonzero(rods.yielding)
    width = _rod_width(sheet)
    by_force = {"compression": sheet.pushed, "tension": sheet.pulled}
    layers = [(wanted, getattr(theme, name)) for name, wanted in by_force.items()]
    layers += [*sheet.shades, (yielding, theme.yielding)]
    colours, number = [theme.ink], np.zeros(len(sheet.rods), dtype=np.intp)  # later layers win
    for wanted, colour in layers:
        number[sheet.chosen(wanted, sheet.rods)] = len(colours)
        colours.append(colour)
    for index, colour in enumerate(colours):
        if (mask := number == index).any():
            wider = 2.0 if sheet.shades else 1.35 if colour == theme.yielding else 1.0
            _draw_lines(sheet, slice(None) if mask.all() else mask, width * wider, colour)
    for name, wanted in (*by_force.items(), ("yielding", yielding)):
        sheet.explain(name, *sheet.lines(sheet.chosen(wanted, sheet.rods))[:2])
    start, end, rows = sheet.lines()
    sheet.occupancy.line(start, end, STRONG, ("rods", rows))
    sheet.occupancy.parts.add(("rods", rows), start, end, width / 2, kind=LINE)


def _rod_width(sheet: Sheet) -> float:
    """Pixels; less where rods are short."""
    return float(np.clip(0.12 * sheet.rod_length / sheet.unit, 0.5, 2.5)) * sheet.unit


def _draw_lines(sheet: Sheet, mask: Truths | slice, width: float, colour: Colour) -> None:
    """The lines of some rods, of one colour; where some bend, those that bend less are thicker."""
    rods, (start, end, rows) = sheet.model.rods, sheet.lines(mask)
    cables = rods.tension_only[rows]
    if not cables.any():
        for factor, which in _depths(sheet, rows):
            some = ("rods", rows[which])
            sheet.marks.append(Strokes(start[which], end[which], factor * width, colour, some))
        return
    thin, slack = 0.5 * width, np.zeros_like(cables)
    if sheet.view.forces_known:
        slack = cables & (rods.axial_force[rows] <= 0.0)
    if slack.any():
        first, last, of = dashed(start[slack], end[slack], _DASH * sheet.unit)
        sheet.marks.append(Strokes(first, last, thin, colour, ("rods", rows[slack][of])))
        sheet.explain("slack", first, last)
    for kind, thick in ((~cables, width), (cables & ~slack, thin)):
        if kind.any():
            sheet.marks.append(Strokes(start[kind], end[kind], thick, colour, ("rods", rows[kind])))


def _depths(sheet: Sheet, rows: Rows) -> list[tuple[float, Truths | slice]]:
    """Widths of the lines of rods, as the depths of sections with their bending stiffness, in steps; which have each."""
    if not sheet.is_frame:
        return [(1.0, slice(None))]
    stiffness = sheet.model.rods.bending_stiffness
    largest = float(stiffness.max())
    depth = np.maximum((stiffness[rows] / largest) ** 0.25, _THINNEST)
    level = np.round(_THICKEST * depth * _DEPTHS) / _DEPTHS
    return [(factor, level == factor) for factor in np.unique(level).tolist()]


def draw_particles(sheet: Sheet) -> None:
    """Open circles of their own radius, hinges of all that they join. Very small ones and rigid joints are filled."""
    theme, rows = sheet.theme, sheet.particles
    small = sheet.radii[rows] < 3.0 * sheet.unit
    dots = rows[:0]
    if sheet.is_frame:
        rigid = rigid_joints(sheet.model)[rows]
        small |= rigid & (sheet.radii[rows] <= _DOT * sheet.unit)
        dots = rows[rigid & ~small]
    open_ones = np.setdiff1d(rows[~small], dots)
    for chosen, ink, rim in (
        (rows[small], theme.ink, 0.0),
        (open_ones, theme.ink, RIM * sheet.unit),
        (dots, theme.ghost, sheet.unit),
    ):
        if len(chosen):
            _draw_circles(sheet, chosen, ink, theme.hollow, rim, 0.0)
    if len(dots):  # the circles around them are the bodies that collide
        size = np.full(len(dots), _DOT * sheet.unit)
        sheet.marks.append(Discs(sheet.centres[dots], size, theme.ink, theme.ink, 0.0, ("particles", dots)))
    at, radii = sheet.centres[rows], sheet.radii[rows]
    sheet.occupancy.parts.add(("particles", rows), at, at, radii)
    if len(sheet.particles) <= MANY:
        sheet.occupancy.block_squares(at, 0.8 * radii)


def _draw_circles(sheet: Sheet, rows: Rows, ink: Colour, hollow: Colour, rim: float, extra: float) -> None:
    """Circles of the particles' radius and `extra` pixels, as far as they are seen."""
    discs = Discs(sheet.centres[rows], sheet.radii[rows] + extra, ink, hollow, rim, ("particles", rows))
    sheet.marks += cut_discs(discs, sheet.viewport, sheet.unit)


def draw_shape(sheet: Sheet) -> None:
    """The moving part of the structure, displaced by the shape from the state that the shape is about."""
    shape = sheet.view.shape
    if shape is None:
        return
    parts = shape.parts or Parts.of(sheet.model)
    position, joints = parts.position, sheet.model.particles.count
    if shape.displacement.shape != position.shape or len(position) < joints:
        return
    if shape.about is not None:
        position = position + shape.about * drawn_scale(sheet.model)
    colour, swing = faded(sheet.theme.sketch, _SHAPE_OPACITY), sheet.view.swing
    pixels = np.hypot(*shape.displacement.T) * sheet.view.camera.scale
    moving = pixels > _SHAPE_FROM * sheet.unit
    if shape.rotation is not None:
        moving |= shape.rotation != 0.0
    parts = replace(
        parts, between=parts.between[(drawn := moving[parts.between].any(axis=1))], fixity=parts.fixity[drawn]
    )
    start, end = farthest = _lines_of_shape(sheet, shape, position, parts, 1.0)
    if swing != 1.0:
        start, end = _lines_of_shape(sheet, shape, position, parts, swing)
    sheet.occupancy.line(*farthest, FAINT)  # so that labels stay where they are while it swings
    if len(start):
        sheet.marks.append(Strokes(start, end, _SHAPE_WIDTH * sheet.unit, colour))
    places = sheet.view.camera.to_pixels(position + swing * shape.displacement)
    dots = places[:joints][(moving & sheet.sees(places))[:joints]]
    if len(dots):
        sheet.marks.append(Discs(dots, np.full(len(dots), _SHAPE_RADIUS * sheet.unit), colour, colour))
    for number, (text, place, away) in enumerate(shape.values):
        first, last = sheet.view.camera.to_pixels(np.array([place, place + away]))
        if sheet.sees(last[None])[0]:
            near = by_arrows(half_sizes(sheet, [text])[0], first, last, 3.0 * sheet.unit)
            write(
                sheet, text, near, sheet.theme.text, ("shape.value", number), None, rank=FIRST - np.hypot(*away)
            )


def _lines_of_shape(
    sheet: Sheet, shape: Shape, position: Points, parts: Parts, swing: float
) -> tuple[Points, Points]:
    """Visible pieces of rods in pixels, displaced from these positions by so much of a shape."""
    rows, displacement = np.arange(len(parts.between)), swing * shape.displacement
    moved, straight = position + displacement, np.zeros((len(rows), 2))
    start, end = moved[parts.between.T]
    axes = Axes(start, end, straight, Curves.plain(straight))
    if shape.rotation is not None:
        axes = Axes.moved(parts, moved, displacement, swing * shape.rotation)
    return _lines(sheet, axes, rows)


def _lines(sheet: Sheet, axes: Axes, rows: Rows) -> tuple[Points, Points]:
    """Visible pieces, in pixels, of the axes of some rods."""
    to_pixels = sheet.view.camera.to_pixels
    start, end = to_pixels(axes.start), to_pixels(axes.end)
    if (lines := axes.pieces(rows, FLAT / sheet.view.camera.scale)) is not None:
        straight = ~sheet.chosen(lines.rods, rows)
        start = np.concatenate([start[straight], to_pixels(lines.start)])
        end = np.concatenate([end[straight], to_pixels(lines.end)])
    return clip_segments(start, end, *sheet.viewport.corners)[:2]


def label_names(sheet: Sheet) -> None:
    """Names of selected elements, of all where there are few, and of the one that a click would hit."""
    most = MANY if sheet.view.names else FEW
    all_of_them = sheet.model.particles.count + sheet.model.rods.count <= most
    backing = faded(sheet.theme.background, BACKING)
    for table, rows in (("particles", sheet.particles), ("rods", sheet.rods)):
        selected = sheet.tagged(Selected, table)
        marked = np.append(selected if len(selected) <= FEW else [], sheet.tagged(Hovered, table)).astype(int)
        wanted = np.arange(len(rows)) if all_of_them else np.flatnonzero(sheet.chosen(marked, rows))
        for index in wanted[:most].tolist():
            row = int(rows[index])
            handle, is_marked = sheet.model.tables[table].handles[row], row in marked
            name = handle.said
            size, weight = (sheet.font(12.0), "semibold") if is_marked else (sheet.font(11.0), "regular")
            half, key = np.array(half_size(name, size, weight, sheet.unit)), (f"{table}.name", row)
            of_particle = table == "particles"
            at = _places_by_particle(sheet, row, half) if of_particle else places_by_rod(sheet, index, half)
            if is_marked:
                label = Label(name, at, size, sheet.theme.text, 1e11, weight, backing, key=key)
            else:
                label = Label(name, at, size, sheet.theme.muted, 1e12, weight, lines="avoid", key=key)
            own = None if is_marked else (table, row)  # what is marked is not taken for another
            close = len(at) if of_particle else 0
            sheet.labels.append(label._replace(of=(table, row), own=own, close=close))


def _places_by_particle(sheet: Sheet, row: int, half: Points) -> Points:
    """Where a label may stand around a rim: first at the corners, then at the sides, then further away."""
    radius, places = float(sheet.radii[row]), []
    for gap in (0.0, 6.0 * sheet.unit, 14.0 * sheet.unit):
        corner, side = half + 0.8 * radius + 3.0 * sheet.unit + gap, half + radius + gap
        places += [corner * _CORNERS, side * _SIDES]
    return sheet.centres[row] + np.concatenate(places)


def places_by_rod(sheet: Sheet, index: int, half: Points) -> Points:
    """Where a label may stand by a rod: beside its middle, on either side, then further along and further away."""
    places = []
    for share in (0.5, 0.35, 0.65):
        at, (x, y) = sheet.line_at(index, share)
        across = np.array([y, -x])
        away = reach(across, half) + 1.0 * sheet.unit
        places += [at + side * away * across for side in (-1.0, 1.0, -1.8, 1.8)]
    return np.array(places)
