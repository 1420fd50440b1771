"""Envelopes along rods: the most and the least of N, V or M in all combinations, filled between, with their extremes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinjoint.components.bent import AXIAL, MOMENT
from pinjoint.systems.render.labels.occupancy import FAINT
from pinjoint.systems.render.marks import Fills, Strokes
from pinjoint.systems.render.model.diagrams import EXPLAINED, UNITS, baseline, crowding, diagram_room, stations
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.model.values import FIRST, SMALLEST, by_arrows, half_sizes, off, said, write
from pinjoint.systems.render.theme import faded

_NOTHING = 1e-3  # of the largest value: what is not told
_MANY = 300  # rods, above which nothing is filled


def draw_envelope(sheet: Sheet, envelope: Any, taken: float) -> None:
    """The envelope of the quantity that diagrams show; taken: pixels at the top, off which it keeps."""
    quantity, every = sheet.view.quantity if sheet.is_frame else AXIAL, np.arange(sheet.model.rods.count)
    least, most = envelope.forces[quantity].values
    largest = max(float(np.abs(least).max(initial=0.0)), float(np.abs(most).max(initial=0.0)))
    if len(least) != len(every) or largest <= SMALLEST:
        return
    side = np.full(len(every), -1.0 if quantity == MOMENT else 1.0)
    axes = baseline(sheet, every)
    points, normals = stations(axes, envelope.shares[quantity], side)
    room = diagram_room(sheet.viewport, sheet.unit, sheet.rod_length)
    per_pixel = max(crowding(sheet, points, normals, values, taken) for values in (least, most))
    scale = sheet.model.settings.diagram_scale / max(largest / room, per_pixel)
    low, high = (points + scale * values[..., None] * normals for values in (least, most))
    u, colour, of = sheet.unit, sheet.theme.ink, ("rods", np.repeat(every, points.shape[1] - 1))
    if len(every) <= _MANY:
        corners = np.concatenate([low, high[:, ::-1]], axis=1)
        sheet.marks.append(Fills(corners, faded(colour, 0.13), ("rods", every)))
    for edge in (low, high):
        line = edge[:, :-1].reshape(-1, 2), edge[:, 1:].reshape(-1, 2)
        sheet.marks.append(Strokes(*line, 1.4 * u, faded(colour, 0.9), of))
        sheet.occupancy.line(*line, FAINT)
    ends = low[:, [0, -1]].reshape(-1, 2), high[:, [0, -1]].reshape(-1, 2)
    sheet.marks.append(Strokes(*ends, 0.8 * u, faded(colour, 0.4), ("rods", np.repeat(every, 2))))
    sheet.explain(EXPLAINED[quantity][0], *ends)
    told, nothing = set[tuple[int, int, int]](), max(_NOTHING * largest, SMALLEST)
    for row in every.tolist():
        for which, (value, distance, name) in enumerate(envelope.extremes(quantity, row)):
            share = np.array([[distance / max(float(envelope.length[row]), 1e-300)]])
            base, normal = (at[0, 0] for at in stations(axes.some(np.array([row])), share, side[[row]]))
            place = round(float(base[0])), round(float(base[1])), round(value / largest * 1e3)
            if abs(value) <= nothing or place in told:  # of another rod at the same joint
                continue
            told.add(place)
            text = _told(said(sheet, abs(value) if quantity == MOMENT else value, UNITS[quantity]), name)
            edge, way = base + scale * value * normal, np.copysign(1.0, value) * normal
            near = by_arrows(half_sizes(sheet, [text])[0], edge - 12.0 * u * way, edge, 3.0 * u)
            key = (f"envelope.{quantity}", 2 * row + which)
            owner = ("rods", row)
            leads = (np.array([edge]), way)
            colour = sheet.colour_of("text")
            write(sheet, text, near, colour, key, owner, rank=FIRST - abs(value), own=owner, leads=leads)


def draw_enveloped_reactions(sheet: Sheet, envelope: Any) -> None:
    """The least and the most of each reaction, beside its support."""
    least, most = envelope.reaction.values
    largest = max(float(np.abs(envelope.reaction.values).max(initial=0.0)), SMALLEST)
    nothing, u = _NOTHING * largest, sheet.unit
    for row, axis in np.argwhere(np.maximum(np.abs(least), np.abs(most)) > nothing).tolist():
        sides = (1, 0) if most[row, axis] - least[row, axis] > nothing else (1,)
        values = envelope.reaction.values[:, row, axis].tolist()
        numbers = [said(sheet, values[side], "kN·m" if axis == 2 else "kN") for side in sides]
        names = (envelope.named(envelope.reaction.governing[side, row, axis]) for side in sides)
        told = [_told(number, name) for number, name in zip(numbers, names, strict=True)]
        text, short = (f"{'xyM'[axis]}: {' … '.join(parts)}" for parts in (told, numbers))
        at, half = sheet.centres[row], half_sizes(sheet, [text])[0]
        ways = np.array([(0.0, 1.0), (-1.0, 0.0), (1.0, 0.0), (0.0, -1.0)])
        far = np.array([34.0, 52.0, 12.0])[:, None, None] * u
        places = off(at + far * ways, ways, 2.0 * u, half).reshape(-1, 2)
        owner = ("particles", row)
        key = ("envelope.reaction", 3 * row + axis)
        colour = sheet.colour_of("reaction")
        write(sheet, text, places, colour, key, owner, own=owner, short=short, leads=(at[None], ways[0]))
        sheet.explain("reaction", at[None], at[None])


def _told(number: str, name: str) -> str:
    """A value, and which combination governs it, if one does."""
    return f"{number} ({name})" if name else number
