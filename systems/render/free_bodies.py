"""Free bodies: joints and rods drawn apart, with the forces on each as arrows with their values."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from components import written
from components.free_body import Force, apart, on_joint
from systems.render.arrows import FORCES, GAP, arrows, lengths
from systems.render.diagrams import SMALLEST_FORCE
from systems.render.labels import Label, half_size
from systems.render.marks import Owner, Points, Strokes
from systems.render.occupancy import STRONG
from systems.render.sheet import Sheet
from systems.render.theme import Colour, faded

MOST = 150  # rods that are taken apart: of more, arrows would hide one another
SHORTEST = 74.0  # points: shorter rods stay whole, since there is no room for arrows
_WIDEST, _SHARE = 84.0, 0.36  # of the gap between a joint and its rod: points, and of the rod
_CLEAR = math.cos(math.radians(24.0))  # of the angle between an arrow and the rods that leaves both readable
_ASIDE = 10.0  # points by which an arrow stands beside a rod where all is taken
_SMALLEST_SHARE = 1e-3  # of the largest force: a smaller one of inertia is told, not drawn


def draw_free_bodies(sheet: Sheet) -> None:
    """Rods with gaps at their joints; in each the two opposite forces; and what else acts on every joint."""
    known = apart(sheet.model)
    force = known.pull
    long = np.hypot(*(sheet.end - sheet.start).T) >= SHORTEST * sheet.unit
    if len(sheet.rods) > MOST or not long.any():
        sheet.notes.append("zoom in to take rods and joints apart")
        sheet.marks.append(
            Strokes(sheet.start, sheet.end, 2.0 * sheet.unit, sheet.theme.ink, ("rods", sheet.rods))
        )
        return
    if not long.all():
        sheet.notes.append("zoom in to take short rods apart, too")
    largest = _largest(sheet, force)
    _draw_rods(sheet, force, long, largest)
    inertia = np.hypot(*known.left_over.T) > _SMALLEST_SHARE * largest
    for row in sheet.particles.tolist():
        others = [f for f in on_joint(sheet.model, row, known) if f.kind != "rod"]
        others = [f for f in others if f.kind != "inertia" or inertia[row]]
        _draw_others(sheet, row, others, largest)


def _largest(sheet: Sheet, force: NDArray[np.float64]) -> float:
    particles = sheet.model.particles
    acting = [particles.applied_force, particles.reaction, force]
    return max(SMALLEST_FORCE, *(float(np.abs(values).max(initial=0.0)) for values in acting))


def _draw_rods(sheet: Sheet, force: NDArray[np.float64], long: NDArray[np.bool_], largest: float) -> None:
    """The rods, shortened where they are long enough, and the pairs of forces in the gaps."""
    u, rods = sheet.unit, sheet.rods
    way = sheet.end - sheet.start
    length = np.hypot(*way.T)
    along = way / np.maximum(length, 1e-9)[:, None]
    bearing = long & (np.abs(force[rods]) > SMALLEST_FORCE)
    gap = np.where(bearing, np.minimum(_SHARE * length, _WIDEST * u), 0.0)
    start, end = sheet.start + gap[:, None] * along, sheet.end - gap[:, None] * along
    sheet.marks.append(Strokes(start, end, 2.5 * u, sheet.theme.ink, ("rods", rods)))
    sheet.occupancy.line(start, end, STRONG)
    for index in np.flatnonzero(long & (np.abs(force[rods]) <= SMALLEST_FORCE)).tolist():
        row, own = int(rods[index]), [start[index], end[index]]
        places = _beside(sheet, "0 kN", *own)
        _label(sheet, "0 kN", places, sheet.theme.zero, ("rods.end0", row), ("rods", row), own)
    for pulled, name in ((True, "tension"), (False, "compression")):
        bears = long & ((force[rods] > SMALLEST_FORCE) if pulled else (force[rods] < -SMALLEST_FORCE))
        which = np.flatnonzero(bears)
        if not len(which):
            continue
        sheet.legend.append(name)
        colour: Colour = getattr(sheet.theme, name)
        for joint, out, rod_end, side in ((sheet.start, along, start, 0), (sheet.end, -along, end, 1)):
            radius = sheet.radii[sheet.ends[rods[which], side]]
            room = gap[which] - radius - GAP * u
            size = np.minimum(lengths(sheet, FORCES, np.abs(force[rods[which]]), largest), 0.5 * room - GAP * u)
            rim = joint[which] + (radius + GAP * u)[:, None] * out[which]
            _draw_pair(sheet, rods[which], rim, rod_end[which], out[which], size, colour, pulled=pulled)
            for row, *own in zip(rods[which].tolist(), rim, rod_end[which], strict=True):
                text, key = written.force(abs(float(force[row]))), (f"rods.end{side}", row)
                _label(sheet, text, _beside(sheet, text, *own), colour, key, ("rods", row), own)


def _draw_pair(
    sheet: Sheet,
    rows: NDArray[np.intp],
    rim: Points,
    rod_end: Points,
    out: Points,
    size: NDArray[np.float64],
    colour: Colour,
    *,
    pulled: bool,
) -> None:
    """The force of a rod on its joint and the opposite one on the rod, in the gap between them.

    A rod in tension pulls both: the arrows point at each other. In compression they point apart.
    """
    step = size[:, None] * out
    whose = [("rods", row) for row in rows.tolist()]
    if pulled:
        sheet.marks += arrows(sheet, whose, rim, out, size, colour, ("rods.end", rows))
        sheet.marks += arrows(sheet, whose, rod_end, -out, size, colour, ("rods.end", rows))
    else:
        sheet.marks += arrows(sheet, whose, rim + step, -out, size, colour, ("rods.end", rows))
        sheet.marks += arrows(sheet, whose, rod_end - step, out, size, colour, ("rods.end", rows))


def _draw_others(sheet: Sheet, row: int, forces: list[Force], largest: float) -> None:
    """Loads, reactions and inertia of a joint, each on the side where rods and other arrows leave most room."""
    taken = _directions_of_rods(sheet, row)
    u, centre, radius = sheet.unit, sheet.centres[row], float(sheet.radii[row])
    for force in forces:
        size = math.hypot(force.x, force.y)
        if size <= SMALLEST_FORCE:
            continue
        out = np.array([force.x, -force.y]) / size
        crowd = [max((float(side @ other) for other in taken), default=-1.0) for side in (out, -out)]
        pushes = crowd[1] <= crowd[0]  # towards the joint, if there is as much room
        side = -out if pushes else out
        aside = np.array([-side[1], side[0]]) * (_ASIDE * u if min(crowd) > _CLEAR else 0.0)
        taken.append(side)
        length = float(lengths(sheet, FORCES, np.array([size]), largest)[0])
        rim = centre + (radius + GAP * u) * side + aside
        tail = rim + length * side if pushes else rim
        colour: Colour = sheet.theme.ink if force.kind == "inertia" else getattr(sheet.theme, force.kind)
        of = ("loads", force.load) if force.load >= 0 else ("particles", row)
        part = f"particles.{force.name}", np.array([row])
        sheet.marks += arrows(sheet, [of], tail[None], out[None], np.array([length]), colour, part)
        sheet.legend.append(force.kind)
        text = written.force(size)
        half = half_size(text, sheet.font(12.0), "semibold", u)
        far = rim + (length + 4.0 * u + abs(side[0]) * half[0] + abs(side[1]) * half[1]) * side
        own = [rim, rim + length * side]
        places = [far, *_beside(sheet, text, *own)]
        _label(sheet, text, places, colour, (f"particles.{force.name}", row), of, own)


def _directions_of_rods(sheet: Sheet, row: int) -> list[Points]:
    """Unit vectors in pixels along the rods that leave a joint."""
    found = []
    for end, sign in ((0, 1.0), (1, -1.0)):
        for index in np.flatnonzero(sheet.ends[sheet.rods, end] == row).tolist():
            way = sign * (sheet.end[index] - sheet.start[index])
            found.append(way / max(float(np.hypot(*way)), 1e-9))
    return found


def _beside(sheet: Sheet, text: str, start: Points, end: Points) -> list[Points]:
    """Where a value may stand beside a line: on either side of its middle, then nearer to its ends."""
    half = half_size(text, sheet.font(12.0), "semibold", sheet.unit)
    way = end - start
    across = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9)
    reach = abs(across[0]) * half[0] + abs(across[1]) * half[1] + 4.0 * sheet.unit
    shares = (0.5, 0.75, 0.3, 1.0)
    return [start + share * way + side * reach * across for share in shares for side in (1.0, -1.0)]


def _label(
    sheet: Sheet,
    text: str,
    places: list[Points],
    colour: Colour,
    key: tuple[str, int],
    of: Owner,
    own: list[Points],
) -> None:
    """A value at one of the places in sight that are nearer to its own arrows, a line from and to, than to other rods."""
    at = np.array(places)
    at = at[sheet.sees(at)]
    if not len(at):
        return
    sheet.values[key[0]] += 1
    others = sheet.rods != (of[1] if of[0] == "rods" else -1)
    distance = _distances(at, sheet.start[others], sheet.end[others]).min(axis=1, initial=np.inf)
    nearest = at[_distances(at, own[0][None], own[1][None])[:, 0] < distance]
    if len(nearest):
        backing = faded(sheet.theme.background, 0.86)
        label = Label(text, nearest, sheet.font(12.0), colour, -1e9, "semibold", backing, "avoid", key, of)
        sheet.labels.append(label)


def _distances(points: Points, start: Points, end: Points) -> NDArray[np.float64]:
    """From each of points (n, 2) to each of lines (m, 2), shape (n, m)."""
    way, to = end - start, points[:, None] - start
    share = (to * way).sum(axis=2) / np.maximum((way * way).sum(axis=1), 1e-12)
    away = to - np.clip(share, 0.0, 1.0)[:, :, None] * way
    found: NDArray[np.float64] = np.hypot(away[..., 0], away[..., 1])
    return found
