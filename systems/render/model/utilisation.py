"""Utilisation: rods in the colour of the share of their strength that they bear, and which came to it first."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from pinjoint.components import written
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.rod import bends_unchecked, has_strength, utilisation
from pinjoint.systems.render.labels.placing import ANCHORS
from pinjoint.systems.render.marks import Mark, Panel, Strokes, Values
from pinjoint.systems.render.model.sheet import FEW, Sheet
from pinjoint.systems.render.model.structure import HALO_OPACITY, places_by_rod
from pinjoint.systems.render.model.values import half_sizes, write
from pinjoint.systems.render.theme import Colour, Theme, faded

LEVELS = 10  # colours of the scale
_HALO = 13.0  # points


def first_at_limit(model: Model, share: Values) -> int:
    """The row of the rod that came to its strength first; if none has yet, of that which is nearest to it."""
    at = model.rods.column("yielded_at")
    return int(np.nanargmin(at)) if np.isfinite(at).any() else int(np.nanargmax(share))


def shade(theme: Theme, share: float) -> Colour:
    """The colour of a share between 0 and 1: lightness changes steadily, so that everybody can read it."""
    three = [theme.scale_low, theme.scale_middle, theme.scale_high]
    red, green, blue = (
        round(float(np.interp(share, [0.0, 0.5, 1.0], [c[part] for c in three]))) for part in range(3)
    )
    return red, green, blue, 255


def shade_rods(sheet: Sheet) -> None:
    """Let rods take the colours of their utilisation, where a person wants to see it."""
    if not (sheet.view.utilisation and sheet.view.forces_known and has_strength(sheet.model)):
        return
    share = utilisation(sheet.model)
    limited = np.isfinite(share)
    level = np.minimum(np.where(limited, share, 0.0) * LEVELS, LEVELS - 1).astype(np.intp)
    sheet.shades.append((np.flatnonzero(~limited), sheet.theme.ghost))
    for step in np.unique(level[limited]).tolist():
        colour = shade(sheet.theme, step / (LEVELS - 1))
        sheet.shades.append((np.flatnonzero(limited & (level == step)), colour))
    whole = not bends_unchecked(sheet.model)[limited].any()
    sheet.explain("utilisation" if whole else "axial utilisation", sheet.start, sheet.end)
    _mark_first(sheet, share)
    _label(sheet, share)


def _mark_first(sheet: Sheet, share: Values) -> None:
    """A halo around the rod that came to its strength first."""
    if not np.isfinite(sheet.model.rods.column("yielded_at")).any():
        return
    here = sheet.rods == first_at_limit(sheet.model, share)
    colour = faded(sheet.theme.yielding, HALO_OPACITY)
    start, end, rows = sheet.lines(here)
    sheet.marks.append(Strokes(start, end, _HALO * sheet.unit, colour, ("rods", rows)))
    sheet.explain("first", start, end)


def _label(sheet: Sheet, share: Values) -> None:
    """The shares of few rods, unless they show their forces; of many that of the first at its strength."""
    first, few = first_at_limit(sheet.model, share), len(share) <= FEW and not sheet.view.all_diagrams
    for index, row in enumerate(sheet.rods.tolist()):
        if row != first and not (few and share[row] >= 0.005):
            continue
        text = _said(sheet.model, row, float(share[row])) if row == first else written.share(share[row])
        places = places_by_rod(sheet, index, half_sizes(sheet, [text])[0])
        nearest = places.reshape(-1, 4, 2)[:, :2].reshape(-1, 2)
        along = sheet.end[index] - sheet.start[index]
        across = along[::-1] * [1.0, -1.0] / max(float(np.hypot(*along)), 1e-9)
        rank, key, of = (-1e11 if row == first else -share[row]), ("rods.utilisation", row), ("rods", row)
        anchors, text_colour = sheet.start[index] + ANCHORS[:, None] * along, sheet.theme.text
        write(sheet, text, nearest, text_colour, key, of, rank=rank, own=of, leads=(anchors, across))


def _said(model: Model, row: int, share: float) -> str:
    """What is said of the first rod at its strength, or of that which is nearest to it."""
    rod = model.rods[row]
    used = {"rod": rod.name, "share": written.share(share)}
    if rod.yielded_at is not None:
        return tr("{rod} {share}: yielded first, at {time}", **used, time=written.time(rod.yielded_at))
    if bends_unchecked(model)[row]:
        return tr("{rod} {share}: closest to yielding by axial force", **used)
    return tr("{rod} {share}: closest to yielding", **used)


def scale_bar(theme: Theme, x: float, y: float, width: float, unit: float) -> list[Mark]:
    """The colours from 0 to 100 %."""
    edges = np.round(np.linspace(x, x + width, LEVELS + 1)).astype(int).tolist()
    top, height = round(y - 5.0 * unit), round(10.0 * unit)
    return [
        Panel(left, top, right - left, height, 0.0, shade(theme, step / (LEVELS - 1)))
        for step, (left, right) in enumerate(pairwise(edges))
    ]
