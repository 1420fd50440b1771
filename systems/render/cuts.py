"""Cuts: rods cut through, or hinged at an end, with the pair of unit forces or moments that acts there."""

from __future__ import annotations

import numpy as np

from pinjoint.components.view import Cut
from pinjoint.systems.render.arrows import arrows
from pinjoint.systems.render.labels import Label, half_size
from pinjoint.systems.render.marks import Points, Strokes
from pinjoint.systems.render.members import arc_marks
from pinjoint.systems.render.occupancy import STRONG
from pinjoint.systems.render.sheet import Rows, Sheet
from pinjoint.systems.render.theme import faded

_DASH, _BETWEEN = 5.0, 3.5  # points, of the lines that are left of a rod
_OPEN, _PAIR = 5.0, 17.0  # points, half of a cut: without and with arrows in it
_FACE = 4.5  # points, half of the line across it
_SHARES = (0.5, 0.35, 0.65, 0.28, 0.72)  # along a rod: where it may be cut
_CLEAR = 18.0  # points from there to other rods
_RADIUS, _SWEEP = 13.0, np.radians(120.0)  # points, of the arrows of a pair of moments
_KEY = "cuts"


def draw_cuts(sheet: Sheet) -> None:
    """What is left of cut rods, and the pairs of unit forces and moments."""
    particles = sheet.model.particles
    for number, cut in enumerate(sheet.view.cuts):
        joints = np.array([particles[name].row for name in cut.between])
        ends = sheet.centres[joints]
        length = float(np.hypot(*(ends[1] - ends[0])))
        if cut.end is None and length > 4.0 * _PAIR * sheet.unit:
            _cut_through(sheet, number, cut, joints, (ends[1] - ends[0]) / length)
        elif cut.end is not None and cut.label:
            _pair_of_moments(sheet, number, cut, cut.end, joints)


def _cut_through(sheet: Sheet, number: int, cut: Cut, joints: Rows, along: Points) -> None:
    u, ink, of = sheet.unit, faded(sheet.theme.ink, 0.6), np.array([number])
    first, last = sheet.centres[joints]
    shares = np.array(_SHARES)[:, None]
    free = _clearance(sheet, first + shares * (last - first)) >= _CLEAR * u
    middle = first + _SHARES[int(np.argmax(free)) if free.any() else 1] * (last - first)
    half = (_PAIR if cut.label else _OPEN) * u
    faces = np.stack([middle - half * along, middle + half * along])
    for joint, face in zip((first, last), faces, strict=True):
        way = face - joint
        count = max(int(np.hypot(*way) / ((_DASH + _BETWEEN) * u)), 1)
        at = joint + np.arange(count)[:, None] / count * way
        sheet.marks.append(Strokes(at, at + _DASH * u * way / np.hypot(*way), 1.25 * u, ink))
        sheet.occupancy.line(joint[None], face[None], STRONG, (_KEY, of))
    across = np.array([-along[1], along[0]]) * _FACE * u
    sheet.marks.append(Strokes(faces - across, faces + across, 1.25 * u, ink))
    if not cut.label:
        return
    towards = np.stack([along, -along])
    owners = [("particles", int(joint)) for joint in joints]
    length = np.full(2, half - 2.0 * u)
    sheet.marks += arrows(sheet, owners, faces, towards, length, sheet.theme.load, (_KEY, joints), 1.75)
    _label(sheet, number, cut.label, middle, np.stack([across, -across]) / (_FACE * u), 6.0 * u)


def _clearance(sheet: Sheet, points: Points) -> Points:
    """The distance in pixels of each point (k, 2) from the nearest rod and joint."""
    start, way = sheet.start, sheet.end - sheet.start
    square = np.maximum((way**2).sum(axis=1), 1e-12)
    apart = points[:, None] - start
    share = np.clip((apart * way).sum(axis=2) / square, 0.0, 1.0)
    found: Points = np.hypot(*np.moveaxis(apart - share[..., None] * way, 2, 0)).min(axis=1, initial=np.inf)
    return found


def _pair_of_moments(sheet: Sheet, number: int, cut: Cut, end: int, joints: Rows) -> None:
    """Around a hinge: one moment on the rod, the other on the joint, if that is not held by a support."""
    colour, radius = sheet.theme.load, np.array([_RADIUS * sheet.unit])
    joint = int(joints[end])
    at, of = sheet.centres[[joint]], ("particles", np.array([joint]))
    way = sheet.centres[joints[1 - end]] - at[0]
    on_rod = np.array([-1.0, 1.0])[[end]]  # counter-clockwise
    angle = float(np.arctan2(-way[1], way[0]))
    if cut.held:
        sheet.marks += arc_marks(sheet, of, at, radius, on_rod, colour, _KEY)
    else:
        for turn, middle in ((on_rod, angle), (-on_rod, angle + np.pi)):
            sheet.marks += arc_marks(sheet, of, at, radius, turn, colour, _KEY, middle, _SWEEP)
    sheet.arcs[joint] = max(float(sheet.arcs[joint]), float(radius[0]))
    angles = np.radians([45.0, 135.0, -45.0, -135.0, 90.0, 0.0, 180.0, -90.0])
    _label(
        sheet, number, cut.label, at[0], np.stack([np.cos(angles), -np.sin(angles)], axis=1), float(radius[0])
    )


def _label(sheet: Sheet, number: int, text: str, at: Points, out: Points, off: float) -> None:
    font, u = sheet.font(12.0), sheet.unit
    half = np.array(half_size(text, font, "semibold", u))
    reach = off + np.abs(out) @ half
    places = np.concatenate([at + out * (reach + more * u)[:, None] for more in (0.0, 8.0, 16.0)])
    backing = faded(sheet.theme.background, 0.86)
    label = Label(text, places, font, sheet.theme.load, -2e9, "semibold", backing, "spare", (_KEY, number))
    sheet.labels.append(label._replace(anchors=at + off * out[:4], outward=out[0]))
