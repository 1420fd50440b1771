"""Free bodies: joints and rods drawn apart, with the forces on each as arrows with their values."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.bent import axes
from pinjoint.components.free_body import Apart, Force, apart, on_joint
from pinjoint.components.language import tr
from pinjoint.systems.render.arrows import FORCES, GAP, arrows, lengths
from pinjoint.systems.render.diagrams import SMALLEST_FORCE
from pinjoint.systems.render.labels import Label, half_size
from pinjoint.systems.render.marks import Owner, Points, Strokes
from pinjoint.systems.render.members import arc_marks, gaps, label_moment
from pinjoint.systems.render.occupancy import STRONG
from pinjoint.systems.render.sheet import Sheet
from pinjoint.systems.render.theme import Colour, faded

MOST = 150  # rods that are taken apart: of more, arrows would hide one another
SHORTEST = 74.0  # points: shorter rods stay whole, since there is no room for arrows
_CLEAR = math.cos(math.radians(24.0))  # of the angle between an arrow and the rods that leaves both readable
_ASIDE = 10.0  # points by which an arrow stands beside a rod where all is taken
_PIECES, _ARC = 16, 9.0  # of a bent rod; points, radius of the arrow of a moment at its end
_SMALLEST_SHARE = 1e-3  # of the largest force: a smaller one of inertia is told, not drawn


def draw_free_bodies(sheet: Sheet) -> None:
    """Rods with gaps at their joints; in each the two opposite forces; and what else acts on every joint."""
    known = apart(sheet.model)
    force = known.pull
    long = np.hypot(*(sheet.end - sheet.start).T) >= SHORTEST * sheet.unit
    if len(sheet.rods) > MOST or not long.any():
        sheet.notes.append(tr("zoom in to see free bodies"))
        sheet.marks.append(
            Strokes(sheet.start, sheet.end, 2.0 * sheet.unit, sheet.theme.ink, ("rods", sheet.rods))
        )
        return
    if not long.all():
        sheet.notes.append(tr("zoom in to see short rods as free bodies, too"))
    largest = _largest(sheet, force)
    _draw_rods(sheet, known, long, largest)
    inertia = np.hypot(*known.left_over.T) > _SMALLEST_SHARE * largest
    inertia |= np.abs(known.left_over_moment) > _SMALLEST_SHARE * np.abs(known.on_ends[..., 2]).max(initial=0.0)
    for row in sheet.particles.tolist():
        others = [f for f in on_joint(sheet.model, row, known) if f.kind != "rod"]
        others = [f for f in others if f.kind != "inertia" or inertia[row]]
        _draw_others(sheet, row, others, largest)


def _largest(sheet: Sheet, force: NDArray[np.float64]) -> float:
    particles = sheet.model.particles
    acting = [particles.applied_force, particles.reaction, force]
    return max(SMALLEST_FORCE, *(float(np.abs(values).max(initial=0.0)) for values in acting))


def _draw_rods(sheet: Sheet, known: Apart, long: NDArray[np.bool_], largest: float) -> None:
    """The rods, shortened where they are long enough, and the pairs of forces in the gaps."""
    u, rods, force = sheet.unit, sheet.rods, known.pull
    way = sheet.end - sheet.start
    length = np.hypot(*way.T)
    along = way / np.maximum(length, 1e-9)[:, None]
    bearing = long & (np.abs(known.on_ends[rods]) > SMALLEST_FORCE).any(axis=(1, 2))
    gap = np.where(bearing, gaps(length, u), 0.0)
    start, end = sheet.start + gap[:, None] * along, sheet.end - gap[:, None] * along
    _draw_bodies(sheet, start, end, gap / np.maximum(length, 1e-9))
    _draw_bending(sheet, known, bearing, (start, end), along, largest)
    for index in np.flatnonzero(long & ~bearing).tolist():
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


def _draw_bodies(sheet: Sheet, start: Points, end: Points, gap: NDArray[np.float64]) -> None:
    """Rods between points (n, 2), bent ones along their axes; gap: what is left out at both ends, of their length."""
    u, rods = sheet.unit, sheet.rods
    bent = np.zeros(len(rods), dtype=bool)
    if sheet.curved is not None:
        bent[sheet.curved.rods] = True
        shares = gap[bent, None] + np.linspace(0.0, 1.0, _PIECES + 1) * (1.0 - 2.0 * gap[bent, None])
        points = sheet.view.camera.to_pixels(axes(sheet.model, rods[bent]).points(shares).reshape(-1, 2))
        points = points.reshape(-1, _PIECES + 1, 2)
        overlap = 0.1 * (points[:, 1:] - points[:, :-1])  # so that pieces close
        start = np.concatenate([start[~bent], (points[:, :-1] - overlap).reshape(-1, 2)])
        end = np.concatenate([end[~bent], (points[:, 1:] + overlap).reshape(-1, 2)])
        rods = np.concatenate([rods[~bent], np.repeat(rods[bent], _PIECES)])
    sheet.marks.append(Strokes(start, end, 2.5 * u, sheet.theme.ink, ("rods", rods)))
    sheet.occupancy.line(start, end, STRONG)


def _draw_bending(
    sheet: Sheet,
    known: Apart,
    bearing: NDArray[np.bool_],
    rod_ends: tuple[Points, Points],
    along: Points,
    largest: float,
) -> None:
    """Shears and moments of members in the gaps: those on the ends of rods, and the opposite ones on their joints."""
    if not sheet.is_frame:
        return
    u, colour = sheet.unit, sheet.theme.ink
    across = along[:, ::-1] * [1.0, -1.0]  # to the left as drawn, y down
    true = known.along[sheet.rods][:, ::-1] * [-1.0, 1.0]  # and as it is
    for side, joint, out in ((0, sheet.start, along), (1, sheet.end, -along)):
        force = known.on_ends[sheet.rods, side]
        shear = (force[:, :2] * true).sum(axis=1)
        rim = joint + (sheet.radii[sheet.ends[sheet.rods, side]] + 3.0 * GAP * u)[:, None] * out
        which = np.flatnonzero(bearing & (np.abs(shear) > SMALLEST_FORCE))
        if len(which):
            way = across[which] * np.sign(shear[which])[:, None]
            size = lengths(sheet, FORCES, np.abs(shear[which]), largest)
            rows = sheet.rods[which]
            whose: list[Owner] = [("rods", row) for row in rows.tolist()]
            key = ("rods.shear", 2 * rows + side)
            sheet.marks += arrows(sheet, whose, rod_ends[side][which], way, size, colour, key)
            sheet.marks += arrows(sheet, whose, rim[which], -way, size, colour, key)
            for index, row, tail, direction, long in zip(
                which.tolist(), rows.tolist(), rod_ends[side][which], way, size.tolist(), strict=True
            ):
                own = [tail, tail + long * direction]
                text = written.force(abs(float(shear[index])))
                places = [_beyond(sheet, text, own[1], direction), *_beside(sheet, text, *own)]
                _label(sheet, text, places, colour, ("rods.shear", 2 * row + side), ("rods", row), own)
            sheet.legend.append("shear")
        moment = force[:, 2]
        which = np.flatnonzero(bearing & (np.abs(moment) > SMALLEST_FORCE))
        for at, turn in ((rod_ends[side], moment), (rim, -moment)):
            radius = np.full(len(which), _ARC * u)
            arcs = ("rods", sheet.rods[which])
            sheet.marks += arc_marks(sheet, arcs, at[which], radius, turn[which], colour, "rods.bending_moment")
        for index in which.tolist():
            text, row, at = (
                written.moment(abs(float(moment[index]))),
                int(sheet.rods[index]),
                rod_ends[side][index],
            )
            down = np.array([0.0, _ARC * u])
            ends = [at - down, at + down]
            places = [_beyond(sheet, text, end, (end - at) / (_ARC * u)) for end in ends]
            places += [
                _beyond(sheet, text, at + sign * _ARC * u * across[index], sign * across[index])
                for sign in (1, -1)
            ]
            _label(sheet, text, places, colour, ("rods.bending_moment", 2 * row + side), ("rods", row), ends)


def _beyond(sheet: Sheet, text: str, end: Points, way: Points) -> Points:
    """Where a value may stand beyond the end of a line that goes that way."""
    half = half_size(text, sheet.font(12.0), "semibold", sheet.unit)
    found: Points = end + (abs(way[0]) * half[0] + abs(way[1]) * half[1] + 4.0 * sheet.unit) * way
    return found


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
        if abs(force.moment) > SMALLEST_FORCE:
            colour: Colour = sheet.theme.ink if force.kind == "inertia" else getattr(sheet.theme, force.kind)
            key, around = f"particles.{force.name}.moment", np.array([radius + 2.0 * _ARC * u])
            at, rows = centre[None], np.array([row])
            sheet.marks += arc_marks(
                sheet, ("particles", rows), at, around, np.array([force.moment]), colour, key
            )
            sheet.legend.append(f"{force.kind} moment")
            label_moment(sheet, centre, float(around[0]), force.moment, colour, (key, row))
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
        colour = sheet.theme.ink if force.kind == "inertia" else getattr(sheet.theme, force.kind)
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
