"""Arrows of loads, reactions and velocities: each kind on one scale, so that they grow with what they show."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.model import Model
from pinjoint.components.rod import nodes
from pinjoint.components.tags import DiagramShown
from pinjoint.systems.render.clip import bounds, clip_segments
from pinjoint.systems.render.marks import Fills, Mark, Owner, Owners, Points, Strokes
from pinjoint.systems.render.occupancy import STRONG
from pinjoint.systems.render.sheet import DIRECTIONS, Rows, Sheet
from pinjoint.systems.render.supports import crowding
from pinjoint.systems.render.theme import Colour

MOST = 100  # particles, above which arrows would hide one another
LONGEST, SHORTEST = 46.0, 13.0  # points: of the largest of its kind, and of any that is drawn
HEAD = 9.0  # points, or of short arrows a share of them
GAP = 3.0  # points between an arrow and its particle
NOTHING = 1e-6  # of the usual speed in a run: a slower motion counts as none
SLOW = 0.02  # of it, below which motion has no arrow while time passes, since it would flicker in piles
FORCES, VELOCITIES = ("arrows.force", 0), ("arrows.velocity", 0)  # keys by which scales are kept

_STEPS = 6.0  # of a scale in a power of ten
_KEPT = 3  # steps by which a scale may be coarser than needed, so that it is steady while forces change
_SHORT_HEAD = 0.65

Values = NDArray[np.float64]


def full_load(model: Model) -> Values:
    """The force (kN) on each particle, its loads at full size included, (n, 2)."""
    force: Values = model.particles.force.copy()
    for axis in (0, 1):
        force[:, axis] += np.bincount(model.loads.on, model.loads.force[:, axis], len(force))
    return force


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
    found: Values = np.clip(LONGEST * sizes / steady(sheet, key, largest), SHORTEST, LONGEST) * sheet.unit
    return found


def steady(sheet: Sheet, key: tuple[str, int], largest: float) -> float:
    """A value of at least `largest`, in steps, which is that of the last picture while it fits."""
    needed = math.ceil(_STEPS * math.log10(largest) - 1e-9)
    step = sheet.placed.get(key, needed)
    step = step if needed <= step <= needed + _KEPT else needed
    sheet.scales[key] = step
    return float(10.0 ** (step / _STEPS))


def draw_loads(sheet: Sheet) -> Iterator[Mark]:
    """The force on each particle, its loads at full size included, where no diagram shows it."""
    model = sheet.model
    force = full_load(model)
    loaded = (force[:, 0] != 0.0) | (force[:, 1] != 0.0)
    loaded[sheet.tagged(DiagramShown, "particles")] = False
    rows = sheet.particles[loaded[sheet.particles]]
    if sheet.view.all_diagrams or not 0 < len(rows) <= MOST:
        return
    along, size = _directions(force[rows]), np.hypot(*force[rows].T)
    length = lengths(sheet, FORCES, size, max(float(np.hypot(*force.T).max()), sheet.view.largest_force))
    ahead = np.argmax(along @ DIRECTIONS.T, axis=1)
    crowd = crowding(sheet, rows)
    pushes = crowd[rows, (ahead + 2) % 4] <= crowd[rows, ahead] + 0.1  # towards the particle, if there is room
    of = whose(model, rows, loads_only=True)
    yield from _at_rims(sheet, rows, along, length, sheet.theme.load, "load", pushes, of)


def draw_velocities(sheet: Sheet) -> Iterator[Mark]:
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
    yield from _at_rims(sheet, rows, _directions(velocity[rows]), length, sheet.theme.ink, "velocity")


def _directions(vectors: Values) -> Values:
    """Unit vectors in pixels, y down."""
    scaled = vectors / np.abs(vectors).max(axis=1)[:, None]  # squares of tiny components would underflow
    directions: Values = scaled / np.hypot(scaled[:, 0], scaled[:, 1])[:, None] * [1.0, -1.0]
    return directions


def _at_rims(
    sheet: Sheet,
    rows: Rows,
    along: Values,
    length: Values,
    colour: Colour,
    name: str,
    pushes: NDArray[np.bool_] | bool = False,
    of: Sequence[Owner] = (),
) -> list[Mark]:
    """Arrows from the rims of particles outwards, or (pushes) ending there."""
    reach = (sheet.radii[rows] + GAP * sheet.unit)[:, None] * along
    back = -reach - length[:, None] * along
    tail = sheet.centres[rows] + np.where(np.reshape(pushes, (-1, 1)), back, reach)
    sheet.explain(name, tail, tail + length[:, None] * along)
    of = of or [("particles", row) for row in rows.tolist()]
    return arrows(sheet, of, tail, along, length, colour, (f"particles.{name}", rows))


def head_length(length: Values, unit: float) -> Values:
    """Length and width in pixels of the heads of arrows."""
    return np.minimum(HEAD * unit, _SHORT_HEAD * length)


def arrows(
    sheet: Sheet,
    of: Sequence[Owner],
    tail: Points,
    along: Points,
    length: Values,
    colour: Colour,
    part: Owners,
    width: float = 2.0,
) -> list[Mark]:
    """Arrows of elements from `tail` (n, 2) along unit vectors (n, 2), of so many pixels (n,).

    part: the key of each among the parts of the picture. width: points, of their shafts.
    """
    u, (kind, which) = sheet.unit, part
    tip, across = tail + length[:, None] * along, along[:, ::-1] * [-1.0, 1.0]
    head = head_length(length, u)[:, None]
    neck = tip - head * along
    low, high = bounds(sheet.viewport)
    _, _, seen = clip_segments(tail, tip, low - HEAD * u, high + HEAD * u)  # rims may be beyond all pixels
    tail, tip, across, neck, head = tail[seen], tip[seen], across[seen], neck[seen], head[seen]
    sheet.occupancy.line(tail, tip, STRONG, (kind, which[seen]))
    barb = 0.5 * head * across
    for ends in ((tail, tip), (neck - barb, neck + barb)):
        sheet.occupancy.parts.symbols((kind, which[seen]), *ends, u)
    points = np.stack([tip, neck + barb, neck - barb], axis=1)
    marks: list[Mark] = []
    for table in dict.fromkeys(of[index][0] for index in seen.tolist()):
        chosen = np.array([of[index][0] == table for index in seen.tolist()])
        rows = table, np.array([of[index][1] for index in seen.tolist()])[chosen]
        marks += [
            Strokes(tail[chosen], neck[chosen], width * u, colour, rows),
            Fills(points[chosen], colour, rows),
        ]
    return marks
