"""Free bodies: joints and rods drawn apart, with the forces on each as arrows with their values."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pinjoint.components import written
from pinjoint.components.bent import Axes
from pinjoint.components.free_body import Apart, Force, on_joint
from pinjoint.components.language import tr
from pinjoint.systems.broad_phase import distance_to_segments
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.labels.placing import Key
from pinjoint.systems.render.marks import Owner, Points, Strokes, Truths, Values
from pinjoint.systems.render.model.arrows import FORCES, OFF, draw_arrows, lengths
from pinjoint.systems.render.model.members import draw_arcs, gaps, write_moment
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.model.values import SMALLEST, beside, by_arrows, half_sizes, off, stated, write
from pinjoint.systems.render.theme import Colour

MOST = 150  # rods that are taken apart: of more, arrows would hide one another
SHORTEST = 74.0  # points: shorter rods stay whole, since there is no room for arrows
_CLEAR = math.cos(math.radians(24.0))  # of the angle between an arrow and the rods that leaves both readable
# Of a bent rod; points: radius of the arrow of a moment at its end, to a value.
_PIECES, _ARC, _APART = 16, 9.0, 4.0
_SMALLEST_SHARE = 1e-3  # of the largest force: a smaller one of inertia is told, not drawn


def draw_free_bodies(sheet: Sheet) -> None:
    """Rods with gaps at their joints; in each the two opposite forces; and what else acts on every joint."""
    known = Apart.of(sheet.model)
    force = known.pull
    long = np.hypot(*(sheet.end - sheet.start).T) >= SHORTEST * sheet.unit
    if len(sheet.rods) > MOST or not long.any():
        sheet.advise(tr("zoom in to see free bodies"))
        sheet.marks.append(
            Strokes(sheet.start, sheet.end, 2.0 * sheet.unit, sheet.theme.ink, ("rods", sheet.rods))
        )
        return
    if not long.all():
        sheet.advise(tr("zoom in to see short rods as free bodies, too"))
    acting = sheet.model.particles.applied_force, sheet.model.particles.reaction, force
    largest = max(SMALLEST, *(float(np.abs(values).max(initial=0.0)) for values in acting))
    _draw_rods(sheet, known, long, largest)
    inertia = np.hypot(*known.left_over.T) > _SMALLEST_SHARE * largest
    inertia |= np.abs(known.left_over_moment) > _SMALLEST_SHARE * np.abs(known.on_ends[..., 2]).max(initial=0.0)
    for row in sheet.particles.tolist():
        others = [f for f in on_joint(sheet.model, row, known) if f.kind != "rod"]
        others = [f for f in others if f.kind != "inertia" or inertia[row]]
        _draw_others(sheet, row, others, largest)


def _draw_rods(sheet: Sheet, known: Apart, long: Truths, largest: float) -> None:
    """The rods, shortened where they are long enough, and the pairs of forces in the gaps."""
    u, rods, force = sheet.unit, sheet.rods, known.pull
    way = sheet.end - sheet.start
    length = np.hypot(*way.T)
    along = way / np.maximum(length, 1e-9)[:, None]
    bearing = long & (np.abs(known.on_ends[rods]) > SMALLEST).any(axis=(1, 2))
    gap = np.where(bearing, gaps(length, u), 0.0)
    start, end = sheet.start + gap[:, None] * along, sheet.end - gap[:, None] * along
    _draw_bodies(sheet, start, end, gap / np.maximum(length, 1e-9))
    _draw_bending(sheet, known, bearing, (start, end), along, largest)
    for index in np.flatnonzero(long & ~bearing).tolist():
        row, own = int(rods[index]), (start[index], end[index])
        _write(sheet, written.force(0.0), beside, sheet.theme.zero, ("rods.end0", row), ("rods", row), own)
    for pulled, name in ((True, "tension"), (False, "compression")):
        bears = long & ((force[rods] > SMALLEST) if pulled else (force[rods] < -SMALLEST))
        which = np.flatnonzero(bears)
        if not len(which):
            continue
        sheet.legend.append(name)
        colour: Colour = getattr(sheet.theme, name)
        for joint, out, rod_end, side in ((sheet.start, along, start, 0), (sheet.end, -along, end, 1)):
            radius = sheet.radii[sheet.ends[rods[which], side]]
            room = gap[which] - radius - OFF * u
            size = np.minimum(lengths(sheet, FORCES, np.abs(force[rods[which]]), largest), 0.5 * room - OFF * u)
            rim = joint[which] + (radius + OFF * u)[:, None] * out[which]
            of = "rods", rods[which]  # in tension a rod pulls both: the arrows point at each other
            for at, way in ((rim, out[which]), (rod_end[which], -out[which])):
                tail = at if pulled else at + size[:, None] * way
                draw_arrows(sheet, of, tail, way if pulled else -way, size, colour, ("rods.end", of[1]))
            for row, *line in zip(rods[which].tolist(), rim, rod_end[which], strict=True):
                text, key = written.force(abs(float(force[row]))), (f"rods.end{side}", row)
                own = line[0], line[1]
                _write(sheet, text, beside, colour, key, ("rods", row), own)


def _draw_bodies(sheet: Sheet, start: Points, end: Points, gap: Values) -> None:
    """Rods between points (n, 2), bent ones along their axes; gap: what is left out at both ends, of their length."""
    u, rods = sheet.unit, sheet.rods
    bent = np.zeros(len(rods), dtype=bool)
    if sheet.curved is not None:
        bent[sheet.curved.rods] = True
        shares = gap[bent, None] + np.linspace(0.0, 1.0, _PIECES + 1) * (1.0 - 2.0 * gap[bent, None])
        points = sheet.view.camera.to_pixels(Axes.of(sheet.model, rods[bent]).points(shares).reshape(-1, 2))
        points = points.reshape(-1, _PIECES + 1, 2)
        overlap = 0.1 * (points[:, 1:] - points[:, :-1])  # so that pieces close
        start = np.concatenate([start[~bent], (points[:, :-1] - overlap).reshape(-1, 2)])
        end = np.concatenate([end[~bent], (points[:, 1:] + overlap).reshape(-1, 2)])
        rods = np.concatenate([rods[~bent], np.repeat(rods[bent], _PIECES)])
        low, high = sheet.viewport.corners
        start, end, seen = clip_segments(start, end, low - 10.0 * u, high + 10.0 * u)
        rods = rods[seen]
    sheet.marks.append(Strokes(start, end, 2.5 * u, sheet.theme.ink, ("rods", rods)))
    sheet.occupancy.line(start, end, STRONG)


def _draw_bending(
    sheet: Sheet, known: Apart, bearing: Truths, rod_ends: tuple[Points, Points], along: Points, largest: float
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
        rim = joint + (sheet.radii[sheet.ends[sheet.rods, side]] + 3.0 * OFF * u)[:, None] * out
        which = np.flatnonzero(bearing & (np.abs(shear) > SMALLEST))
        if len(which):
            way = across[which] * np.sign(shear[which])[:, None]
            size = lengths(sheet, FORCES, np.abs(shear[which]), largest)
            rows, key = sheet.rods[which], ("rods.shear", 2 * sheet.rods[which] + side)
            for at, forwards in ((rod_ends[side], way), (rim, -way)):
                draw_arrows(sheet, ("rods", rows), at[which], forwards, size, colour, key)
            tips = rod_ends[side][which] + size[:, None] * way
            for k, (index, row) in enumerate(zip(which.tolist(), rows.tolist(), strict=True)):
                own, text = (rod_ends[side][index], tips[k]), written.force(abs(float(shear[index])))
                _write(sheet, text, by_arrows, colour, ("rods.shear", 2 * row + side), ("rods", row), own)
            sheet.legend.append("shear")
        moment = force[:, 2]
        which = np.flatnonzero(bearing & (np.abs(moment) > SMALLEST))
        for at, turn in ((rod_ends[side], moment), (rim, -moment)):
            radius = np.full(len(which), _ARC * u)
            arcs = ("rods", sheet.rods[which])
            draw_arcs(sheet, arcs, at[which], radius, turn[which], colour, "rods.bending_moment")
        for index in which.tolist():
            text = written.moment(abs(float(moment[index])))
            row = int(sheet.rods[index])
            at = rod_ends[side][index]
            ways = np.array([[0.0, -1.0], [0.0, 1.0], across[index], -across[index]])
            places = off(at, ways, (_ARC + _APART) * u, half_sizes(sheet, [text]))
            first, last = at + _ARC * u * ways[:2]
            key_of_value = "rods.bending_moment", 2 * row + side
            _write(sheet, text, places, colour, key_of_value, ("rods", row), (first, last))


def _draw_others(sheet: Sheet, row: int, forces: list[Force], largest: float) -> None:
    """Loads, reactions and inertia of a joint, each on the side where rods and other arrows leave most room."""
    taken = _directions_of_rods(sheet, row)
    u, centre, radius = sheet.unit, sheet.centres[row], float(sheet.radii[row])
    for force in forces:
        if abs(force.moment) > SMALLEST:
            colour: Colour = sheet.theme.ink if force.kind == "inertia" else sheet.colour_of(force.kind)
            key, around = f"particles.{force.name}.moment", np.array([radius + 2.0 * _ARC * u])
            at, rows = centre[None], np.array([row])
            draw_arcs(sheet, ("particles", rows), at, around, np.array([force.moment]), colour, key)
            sheet.legend.append(f"{force.kind} moment")
            write_moment(sheet, centre, float(around[0]), force.moment, colour, (key, row))
        size = math.hypot(force.x, force.y)
        if size <= SMALLEST:
            continue
        out = np.array([force.x, -force.y]) / size
        crowd = [max((float(side @ other) for other in taken), default=-1.0) for side in (out, -out)]
        pushes = crowd[1] <= crowd[0]  # towards the joint, if there is as much room
        side = -out if pushes else out
        # beside it where all is taken
        aside = np.array([-side[1], side[0]]) * (10.0 * u if min(crowd) > _CLEAR else 0.0)
        taken.append(side)
        length = float(lengths(sheet, FORCES, np.array([size]), largest)[0])
        rim = centre + (radius + OFF * u) * side + aside
        tail = rim + length * side if pushes else rim
        colour = sheet.theme.ink if force.kind == "inertia" else sheet.colour_of(force.kind)
        of = ("loads", force.load) if force.load >= 0 else ("particles", row)
        part = f"particles.{force.name}", np.array([row])
        draw_arrows(sheet, [of], tail[None], out[None], np.array([length]), colour, part)
        sheet.legend.append(force.kind)
        key = f"particles.{force.name}"
        text = stated(sheet, size, "kN") if force.kind == "load" else written.force(size)
        _write(sheet, text, by_arrows, colour, (key, row), of, (rim, rim + length * side))


def _directions_of_rods(sheet: Sheet, row: int) -> list[Points]:
    """Unit vectors in pixels along the rods that leave a joint."""
    found = []
    for end, sign in ((0, 1.0), (1, -1.0)):
        for index in np.flatnonzero(sheet.ends[sheet.rods, end] == row).tolist():
            way = sign * (sheet.end[index] - sheet.start[index])
            found.append(way / max(float(np.hypot(*way)), 1e-9))
    return found


def _write(
    sheet: Sheet,
    text: str,
    places: Points | Callable[[Points, Points, Points, float], Points],
    colour: Colour,
    key: Key,
    of: Owner,
    own: tuple[Points, Points],
) -> None:
    """A value at one of the places in sight that are nearer to its own arrows, a line from and to, than to other rods, else
    at the end of a line that leads there.

    places: or what finds them from half the size of the value, the line and the gap.
    """
    if callable(places):
        places = places(half_sizes(sheet, [text])[0], *own, _APART * sheet.unit)
    at = places[sheet.sees(places)]
    others = sheet.rods != (of[1] if of[0] == "rods" else -1)
    away = distance_to_segments(at[:, None], sheet.start[others], sheet.end[others]).min(axis=1, initial=np.inf)
    nearest = at[distance_to_segments(at, *own) < away]
    way = own[1] - own[0]
    out = np.array([way[1], -way[0]]) / max(float(np.hypot(*way)), 1e-9)
    along, off_it = np.repeat([0.5, 0.8, 0.2], 2)[:, None] * way, np.tile([1.0, -1.0], 3)[:, None] * out
    leads = own[0] + along + _APART * sheet.unit * off_it, out
    if len(at):
        write(sheet, text, nearest, colour, key, of, leads=leads, lines="avoid", short=text)
