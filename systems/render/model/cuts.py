"""Cuts: rods cut through, or hinged at an end, with the pair of unit forces or moments that acts there."""

from __future__ import annotations

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.view import Cut
from pinjoint.systems.broad_phase import distance_to_segments
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.marks import Points, Strokes
from pinjoint.systems.render.model.arrows import draw_arrows
from pinjoint.systems.render.model.members import draw_arcs
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.model.values import FIRST, half_sizes, off, write
from pinjoint.systems.render.symbols import dashed
from pinjoint.systems.render.theme import faded

_DASH = 5.0  # points, of the lines that are left of a rod
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
    u, ink = sheet.unit, faded(sheet.theme.ink, 0.6)
    first, last = sheet.centres[joints]
    shares = np.array(_SHARES)[:, None]
    away = distance_to_segments((first + shares * (last - first))[:, None], sheet.start, sheet.end)
    free = away.min(axis=1, initial=np.inf) >= _CLEAR * u
    middle = first + _SHARES[int(np.argmax(free)) if free.any() else 1] * (last - first)
    half = (_PAIR if cut.label else _OPEN) * u
    faces = np.stack([middle - half * along, middle + half * along])
    start, end, _ = dashed(sheet.centres[joints], faces, _DASH * u)
    sheet.marks.append(Strokes(start, end, 1.25 * u, ink))
    sheet.occupancy.line(sheet.centres[joints], faces, STRONG, (_KEY, np.full(2, number)))
    across = np.array([-along[1], along[0]]) * _FACE * u
    sheet.marks.append(Strokes(faces - across, faces + across, 1.25 * u, ink))
    if not cut.label:
        return
    towards = np.stack([along, -along])
    length = np.full(2, half - 2.0 * u)
    draw_arrows(sheet, ("particles", joints), faces, towards, length, sheet.theme.load, (_KEY, joints), 1.75)
    _label(sheet, number, cut.label, middle, np.stack([across, -across]) / (_FACE * u), 6.0 * u)


def _pair_of_moments(sheet: Sheet, number: int, cut: Cut, end: int, joints: Rows) -> None:
    """Around a hinge: one moment on the rod, the other on the joint, if that is not held by a support."""
    colour, radius = sheet.theme.load, np.array([_RADIUS * sheet.unit])
    joint = int(joints[end])
    at, of = sheet.centres[[joint]], ("particles", np.array([joint]))
    way = sheet.centres[joints[1 - end]] - at[0]
    on_rod = np.array([-1.0, 1.0])[[end]]  # counter-clockwise
    angle = float(np.arctan2(-way[1], way[0]))
    if cut.held:
        draw_arcs(sheet, of, at, radius, on_rod, colour, _KEY)
    else:
        for turn, middle in ((on_rod, angle), (-on_rod, angle + np.pi)):
            draw_arcs(sheet, of, at, radius, turn, colour, _KEY, middle, _SWEEP)
    sheet.arcs[joint] = max(float(sheet.arcs[joint]), float(radius[0]))
    angles = np.radians([45.0, 135.0, -45.0, -135.0, 90.0, 0.0, 180.0, -90.0])
    ways = np.stack([np.cos(angles), -np.sin(angles)], axis=1)
    _label(sheet, number, cut.label, at[0], ways, float(radius[0]))


def _label(sheet: Sheet, number: int, text: str, at: Points, ways: Points, gap: float) -> None:
    gaps = np.repeat(gap + np.array([0.0, 8.0, 16.0]) * sheet.unit, len(ways))
    places, key = off(at, np.tile(ways, (3, 1)), gaps, half_sizes(sheet, [text])), (_KEY, number)
    anchors = at + gap * ways[:4]
    write(sheet, text, places, sheet.theme.load, key, None, rank=2.0 * FIRST, leads=(anchors, ways[0]))
