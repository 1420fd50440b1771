"""Arrows of loads, reactions and velocities with their values: each kind on one scale, so that they grow with what they
show."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Rows
from pinjoint.components.bent import borne_between
from pinjoint.components.cases import case_told, factor_of_each, permanent
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.rod import nodes
from pinjoint.components.tags import DiagramShown
from pinjoint.components.view import View
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.marks import Fills, Owner, Owners, Points, Strokes, Truths, Values
from pinjoint.systems.render.model.sheet import DIRECTIONS, Sheet
from pinjoint.systems.render.model.supports import NO_SUPPORT, crowding
from pinjoint.systems.render.model.values import (
    FEW_VALUES,
    FIRST,
    SMALLEST,
    by_arrows,
    half_sizes,
    most_important,
    said,
    stated,
    write,
)
from pinjoint.systems.render.symbols import SUPPORT_DEPTH
from pinjoint.systems.render.theme import Colour

MOST = 100  # particles, above which arrows would hide one another
LONGEST, SHORTEST = 46.0, 13.0  # points: of the largest of its kind, and of any that is drawn
HEAD = 9.0  # points, or of short arrows a share of them
OFF = 3.0  # points between an arrow and its particle
NOTHING = 1e-6  # of the usual speed in a run: a slower motion counts as none
SLOW = 0.02  # of it, below which motion has no arrow while time passes, since it would flicker in piles
FORCES, VELOCITIES = ("arrows.force", 0), ("arrows.velocity", 0)  # keys by which scales are kept

_STEPS = 6.0  # of a scale in a power of ten
_KEPT = 3  # steps by which a scale may be coarser than needed, so that it is steady while forces change
_FIELDS = {"load": "particles.applied_force", "reaction": "particles.reaction"}  # what arrows along axes show
_MANY = 200  # such arrows of a kind, up to which all are drawn, though they may lie over each other
_SQUARE = 20.0  # points, the side of squares of which each shows one of more arrows


def full_load(model: Model) -> Values:
    """The force (kN) and the moment (kN·m) on each particle, its loads at full size included, (n, 3)."""
    found: Values = permanent(model) * np.column_stack([model.particles.force, model.particles.moment])
    loads = np.column_stack([model.loads.force, model.loads.moment])
    np.add.at(found, model.loads.on, factor_of_each(model, "loads")[:, None] * loads)
    return found


def whose(model: Model, rows: Rows, *, loads_only: bool = False) -> list[Owner]:
    """Whose each arrow of what acts on particles is: the load's that is all of it, else the particle's.

    loads_only: the arrow shows forces and loads, no weight.
    """
    particles, environment = model.particles, model.environment
    others = particles.force + environment.force
    if not loads_only:
        others = others + particles.mass[:, None] * (particles.acceleration + environment.acceleration)
    count = np.bincount(model.loads.on, minlength=particles.count)
    alone = (count == 1) & ~others.any(axis=1)
    load = np.zeros(particles.count, dtype=np.intp)
    load[model.loads.on] = np.arange(model.loads.count)
    return [("loads", int(load[row])) if alone[row] else ("particles", row) for row in rows.tolist()]


def lengths(sheet: Sheet, key: tuple[str, int], sizes: Values, largest: float) -> Values:
    """Lengths in pixels of arrows for sizes (n,), on the scale of all of a kind, of which `largest` is the largest.

    Scales come in steps, and stay while they fit, so that an arrow grows and shrinks with its own size only.
    """
    return np.clip(LONGEST * sizes / steady(sheet, key, largest), SHORTEST, LONGEST) * sheet.unit


def steady(sheet: Sheet, key: tuple[str, int], largest: float) -> float:
    """A value of at least `largest`, in steps, which is that of the last picture while it fits."""
    needed = math.ceil(_STEPS * math.log10(largest) - 1e-9)
    step = sheet.placed.get(key, needed)
    step = step if needed <= step <= needed + _KEPT else needed
    sheet.scales[key] = step
    return float(10.0 ** (step / _STEPS))


def draw_loads(sheet: Sheet) -> None:
    """The force on each particle, its loads at full size included, where no diagram shows it; in statics its size, too."""
    model = sheet.model
    force = full_load(model)[:, :2]
    loaded = (force[:, 0] != 0.0) | (force[:, 1] != 0.0)
    loaded[sheet.tagged(DiagramShown, "particles")] = False
    rows = sheet.particles[loaded[sheet.particles]]
    if not 0 < len(rows) <= MOST:
        return
    along, size = _directions(force[rows]), np.hypot(*force[rows].T)
    length = lengths(sheet, FORCES, size, max(float(np.hypot(*force.T).max()), sheet.view.largest_force))
    ahead = np.argmax(along @ DIRECTIONS.T, axis=1)
    crowd = crowding(sheet, rows)
    pushes = crowd[rows, (ahead + 2) % 4] <= crowd[rows, ahead] + 0.1  # towards the particle, if there is room
    of = whose(model, rows, loads_only=True)
    ends = _draw_at_rims(sheet, of, rows, along, length, sheet.theme.load, "load", pushes)
    if model.solution is not None and len(rows) <= FEW_VALUES:
        _write_forces(sheet, "load", of, ("particles.load", rows), size, *ends)


def draw_velocities(sheet: Sheet) -> None:
    """The velocity of free particles, and of nodes before their first step.

    At rest there is none: what is left in the state is below what counts as motion.
    """
    model = sheet.model
    velocity, clock = model.particles.velocity, model.clock
    moving = (velocity[:, 0] != 0.0) | (velocity[:, 1] != 0.0)
    if clock.steps:
        moving &= ~nodes(model)
    rows = sheet.particles[moving[sheet.particles]]
    if (clock.at_rest and clock.steps) or not 0 < len(rows) <= MOST:
        return
    speed = np.hypot(*velocity[rows].T)
    usual = math.sqrt(2.0 * clock.energy_scale / model.particles.mass[rows].sum()) if clock.steps else 0.0
    seen = speed > (SLOW if sheet.view.status.speed else NOTHING) * usual
    rows, speed = rows[seen], speed[seen]
    if not len(rows):
        return
    length = lengths(sheet, VELOCITIES, speed, max(speed.max(), usual))
    along = _directions(velocity[rows])
    _draw_at_rims(sheet, ("particles", rows), rows, along, length, sheet.theme.ink, "velocity")


def _directions(vectors: Values) -> Values:
    """Unit vectors in pixels, y down."""
    scaled = vectors / np.abs(vectors).max(axis=1)[:, None]  # squares of tiny components would underflow
    return scaled / np.hypot(scaled[:, 0], scaled[:, 1])[:, None] * [1.0, -1.0]


def _draw_at_rims(
    sheet: Sheet,
    of: Owners | list[Owner],
    rows: Rows,
    along: Values,
    length: Values,
    colour: Colour,
    name: str,
    pushes: Truths | bool = False,
) -> tuple[Points, Points]:
    """Arrows from the rims of particles outwards, or (pushes) ending there; returns their ends at the rims and outside."""
    outward = along * np.where(np.reshape(pushes, (-1, 1)), -1.0, 1.0)
    rim = sheet.centres[rows] + (sheet.radii[rows] + OFF * sheet.unit)[:, None] * outward
    end = rim + length[:, None] * outward
    sheet.explain(name, rim, end)
    tail = np.where(np.reshape(pushes, (-1, 1)), end, rim)
    draw_arrows(sheet, of, tail, along, length, colour, (f"particles.{name}", rows))
    return rim, end


def head_length(length: Values, unit: float) -> Values:
    """Length and width in pixels of the heads of arrows."""
    return np.minimum(HEAD * unit, 0.65 * length)  # of short arrows


def draw_arrows(
    sheet: Sheet,
    of: Owners | list[Owner],
    tail: Points,
    along: Points,
    length: Values,
    colour: Colour,
    part: Owners,
    width: float = 2.0,
) -> None:
    """Arrows of elements from `tail` (n, 2) along unit vectors (n, 2), of so many pixels (n,).

    part: the key of each among the parts of the picture. width: points, of their shafts.
    """
    u, (kind, which) = sheet.unit, part
    tip, across = tail + length[:, None] * along, along[:, ::-1] * [-1.0, 1.0]
    head = head_length(length, u)[:, None]
    neck = tip - head * along
    low, high = sheet.viewport.corners
    _, _, seen = clip_segments(tail, tip, low - HEAD * u, high + HEAD * u)  # rims may be beyond all pixels
    tail, tip, across, neck, head = tail[seen], tip[seen], across[seen], neck[seen], head[seen]
    sheet.occupancy.line(tail, tip, STRONG, (kind, which[seen]))
    barb = 0.5 * head * across
    for ends in ((tail, tip), (neck - barb, neck + barb)):
        sheet.occupancy.parts.add((kind, which[seen]), *ends, u)
    points = np.stack([tip, neck + barb, neck - barb], axis=1)
    owned = zip(*of, strict=True) if isinstance(of, list) else (np.full(len(of[1]), of[0]), of[1])
    tables, rows = (np.array(column)[seen] for column in owned)
    for table in dict.fromkeys(tables.tolist()):
        own = tables == table
        whose = table, rows[own]
        sheet.marks.append(Strokes(tail[own], neck[own], width * u, colour, whose))
        sheet.marks.append(Fills(points[own], colour, whose))


# --- diagrams of particles ----------------------------------------------------------------------------


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
    along_rods = borne_between(sheet.model)  # rows of arrows show these
    applied = particles.applied_force - along_rods
    if sheet.model.first_order and (left_out := ~nodes(sheet.model)).any():
        applied[left_out] = full_load(sheet.model)[left_out, :2]
    for name, force in (("reaction", particles.reaction[shown]), ("load", applied[shown])):
        index, axis = _thinned(sheet, shown, force, *np.nonzero(np.abs(force) > SMALLEST))
        if len(index):
            value, rows = force[index, axis], shown[index]
            pressed = value * along_rods[rows, axis] < 0.0
            _draw_forces(sheet, name, rows, axis, value, largest, sides, taken, pressed)


def largest_force(model: Model, view: View) -> float:
    """The largest force (kN) that an arrow may show: of loads at full size, and in diagrams of their parts and reactions."""
    particles = model.particles
    largest = float(np.hypot(*full_load(model)[:, :2].T).max(initial=SMALLEST))
    largest = max(largest, float(np.hypot(*model.span_loads.force.T).max(initial=0.0)))
    if view.forces_known and (view.all_diagrams or model.any_tagged(DiagramShown)):
        for forces in (particles.applied_force, particles.reaction):
            largest = max(largest, float(np.abs(forces).max(initial=0.0)))
    return largest


def _draw_forces(
    sheet: Sheet,
    name: str,
    rows: Rows,
    axis: Rows,
    value: Values,
    largest: float,
    sides: NDArray[np.int64],
    taken: NDArray[np.int64],
    pressed: Truths,
) -> None:
    """Arrows of forces of one kind along an axis each, with their values; pressed: rows of arrows stand before them."""
    # Model y is up, pixels' y is down: a positive vertical force points in direction 3.
    direction = np.where(axis == 0, np.where(value > 0, 0, 2), np.where(value > 0, 3, 1))
    length = lengths(sheet, FORCES, np.abs(value), largest)
    tail, outer = _arrow_places(sheet, rows, direction, length, sides, taken[rows, axis], pressed)
    taken[rows, axis] = outer
    along, parts = DIRECTIONS[direction], (_FIELDS[name], 2 * rows + axis)
    tip, of = tail + along * length[:, None], [("particles", row) for row in rows.tolist()]
    of = whose(sheet.model, rows) if name == "load" else of
    sheet.explain(name, tail, tip)
    draw_arrows(sheet, of, tail, along, length, sheet.colour_of(name), parts)
    sheet.occupancy.block_squares(0.5 * (tail + tip), np.minimum(0.2 * length, 3.0 * sheet.unit))
    pulls = (outer == direction)[:, None]  # the head is at the outer end
    _write_forces(sheet, name, of, parts, value, np.where(pulls, tail, tip), np.where(pulls, tip, tail))


def _thinned(sheet: Sheet, rows: Rows, force: Values, index: Rows, axis: Rows) -> tuple[Rows, Rows]:
    """Of many arrows, the largest in each square, so that they can be told apart.

    Squares divide the original geometry, so that arrows neither come nor go while a structure moves.
    """
    if len(index) <= _MANY:
        return index, axis
    side = _SQUARE * sheet.unit / sheet.view.camera.scale
    x, y = np.floor(sheet.model.particles.position[rows[index]] / side).T
    order = np.lexsort((index, -np.abs(force[index, axis]), axis, y, x))
    x, y, along = x[order], y[order], axis[order]
    first = np.ones(len(order), dtype=bool)
    first[1:] = (np.diff(x) != 0) | (np.diff(y) != 0) | (np.diff(along) != 0)
    kept = np.sort(order[first])
    if len(kept) < len(order):
        sheet.advise(tr("zoom in to see all loads and reactions"))
    return index[kept], axis[kept]


def _arrow_places(
    sheet: Sheet,
    rows: Rows,
    direction: NDArray[np.int64],
    length: Values,
    sides: NDArray[np.int64],
    taken: NDArray[np.int64],
    pressed: Truths,
) -> tuple[Points, NDArray[np.int64]]:
    """Tails of the arrows, and on which side of its particle each stands.

    An arrow starts at the rim, or ends at it where the side that it comes from is freer; there it stands beyond
    the support, if there is one, and beyond the arrow of a moment. pressed: loads along rods stand ahead. taken: the
    side of another arrow along the same axis, or NO_SUPPORT.
    """
    u = sheet.unit
    opposite, crowd = (direction + 2) % 4, crowding(sheet, rows)
    supported = sides[rows] != NO_SUPPORT
    busy_ahead = crowd[rows, direction] + 0.8 * (supported & (sides[rows] == direction)) + pressed
    busy_behind = crowd[rows, opposite] + 0.8 * (supported & (sides[rows] == opposite))
    pushes = ((busy_behind < busy_ahead - 0.1) & (taken != opposite)) | (taken == direction)
    side = np.where(pushes, opposite, direction)
    gap = sheet.radii[rows] + 2.0 * u + np.where(supported & (sides[rows] == side), SUPPORT_DEPTH * u, 0.0)
    around = np.where(DIRECTIONS[side, 1] > 0.0, 0.0, sheet.arcs[rows])  # they are open below
    gap = np.maximum(gap, around + np.where(around > 0.0, 6.0 * u, 0.0))  # points off a moment's arrow
    outward = DIRECTIONS[side]
    start = sheet.centres[rows] + outward * gap[:, None]
    return start + outward * np.where(pushes, length, 0.0)[:, None], side


def _write_forces(
    sheet: Sheet, name: str, of: list[Owner], parts: Owners, value: Values, start: Points, end: Points
) -> None:
    """The size of the force at each arrow, of which `parts` are the keys, between points of which `end` is outside."""
    field, which = parts
    few = len(value) <= FEW_VALUES
    seen = np.flatnonzero(sheet.sees(0.5 * (start + end)))
    shown, worth = most_important(sheet, field, which, value, seen)
    cases = [case_told(sheet.model, *of[index]) for index in shown.tolist()]
    sizes, told = np.abs(value[shown]).tolist(), stated if name == "load" else said
    texts = [f"{told(sheet, size, 'kN', bare=not few)}{case}" for size, case in zip(sizes, cases, strict=True)]
    font = sheet.font(12.0 if few else 11.0)
    half, start, end = half_sizes(sheet, texts, font), start[shown], end[shown]
    places = by_arrows(half, start, end, 5.5 * sheet.unit)  # points
    out = (end - start) / np.hypot(*(end - start).T)[:, None]
    lines = np.stack([end, 0.5 * (start + end), start], axis=1)
    colour, ranks = sheet.colour_of(name), (FIRST - worth).tolist()
    for k, index in enumerate(shown.tolist()):
        key, leads = (field, int(which[index])), (lines[k], out[k])
        write(
            sheet,
            texts[k],
            places[k],
            colour,
            key,
            of[index],
            rank=ranks[k],
            own=key,
            leads=leads,
            size=font,
            short=told(sheet, sizes[k], "kN", bare=True) if few else "",
        )
