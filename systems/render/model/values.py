"""Values: what is written beside rods, arrows and diagrams, which of many comes first, and where each may stand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Rows
from pinjoint.systems.render.labels.placing import NO_LINE, Key, Label, half_size
from pinjoint.systems.render.marks import Owner, Points, Values
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.theme import Colour, faded

SMALLEST = 1e-4  # kN or kN·m; smaller forces and moments are drawn as none
FEW_VALUES = 24  # values up to which each carries its unit and keeps clear of rods
BACKING = 0.86  # opacity behind a value
FIRST = -1e9  # rank of values of arrows, which are few and say little without them: before those of rods
_KEPT = 1.5  # factor by which a new value must be larger to replace one of the last picture


def half_sizes(sheet: Sheet, texts: Iterable[str], size: int = 0) -> Points:
    """Half the width and height of each text as a label of that font size, else the usual one, (n, 2)."""
    size = size or sheet.font(12.0)
    return np.array([half_size(text, size, "semibold", sheet.unit) for text in texts]).reshape(-1, 2)


def said(sheet: Sheet, value: float, usual: str, nothing: float = SMALLEST, *, bare: bool = False) -> str:
    """A computed value in a usual unit, with that on screen unless it is bare; as short as it is where a view wants none."""
    if not sheet.view.has_units:
        return written.given(value if abs(value) > nothing else 0.0, written.DIGITS)
    return written.amount(value, usual, nothing=nothing, bare=bare)


def stated(sheet: Sheet, value: float, usual: str, *, bare: bool = False) -> str:
    """A value that a person gave, likewise, without zeros at its end."""
    if not sheet.view.has_units:
        return written.given(value, written.DIGITS)
    text = written.stated(value, usual, written.DIGITS)
    return text.partition(" ")[0] if bare else text


def reach(way: Points, half: Points) -> Values:
    """How far labels of `half` the size (…, 2) extend along unit vectors (…, 2), or points to all sides of them."""
    found: Values = np.abs(way) * half
    return found[..., 0] + found[..., 1]


def off(at: Points, way: Points, gap: Values | float, half: Points) -> Points:
    """Middles of labels that stand off points (…, 2) by a gap (…), in the direction of unit vectors (…, 2)."""
    return at + way * (gap + reach(way, half))[..., None]


def beside(
    half: Points, start: Points, end: Points, gap: float, shares: Sequence[float] = (0.5, 0.75, 0.3, 1.0)
) -> Points:
    """Where values may stand beside lines (…, 2), so far off, at shares of them: right as drawn, then left, (…, k, 2)."""
    way = end - start
    right = np.stack([-way[..., 1], way[..., 0]], axis=-1) / np.maximum(np.hypot(*way.T).T, 1e-9)[..., None]
    at = start[..., None, :] + np.repeat(shares, 2)[:, None] * way[..., None, :]
    return off(at, np.stack([right, -right] * len(shares), axis=-2), gap, half[..., None, :])


def by_arrows(half: Points, start: Points, end: Points, gap: float) -> Points:
    """Where the values of arrows may stand: beyond their outer `end`, or beside them, (…, k, 2)."""
    way = end - start
    out = way / np.maximum(np.hypot(*way.T).T, 1e-9)[..., None]
    return np.concatenate([off(end, out, gap, half)[..., None, :], beside(half, start, end, gap)], axis=-2)


def most_important(
    sheet: Sheet, field: str, rows: Rows, values: Values, seen: Rows, more: Values | float = 0.0
) -> tuple[Rows, Values]:
    """Of the values of a field that are seen those worth most, as many as there may be room for; and how much they are.

    That is their size to two digits, so that tiny changes do not reorder labels. Values of the last picture count more,
    so that labels do not come and go while forces vibrate; while a hand drags, of more than there is room for they alone
    count. more: what is added to it.
    """
    size = np.maximum(np.abs(values), 1e-300)
    decade = 10.0 ** np.floor(np.log10(size))
    kept = np.array([row for name, row in sheet.placed if name == field], dtype=np.intp)
    before, room = sheet.chosen(kept, rows), room_for_values(sheet)
    worth: Values = np.round(size / decade, 1) * decade * np.where(before, _KEPT, 1.0) + more
    some = seen[before[seen]] if sheet.view.steady and len(seen) > room else seen
    shown = np.sort(some[np.lexsort((some, -worth[some]))][:room])
    sheet.values[field] += len(seen) - len(shown)
    return shown, worth[shown]


def room_for_values(sheet: Sheet) -> int:
    """How many values there may be room for in a picture."""
    area = sheet.viewport.width * sheet.viewport.height / sheet.unit**2
    return max(int(0.15 * area / (46.0 * 18.0)), 60)  # so much of a picture, but always some


def write(
    sheet: Sheet,
    text: str,
    places: Points,
    colour: Colour,
    key: Key,
    of: Owner | None,
    *,
    rank: float = FIRST,
    own: Owner | None = None,
    leads: tuple[Points, Points] = NO_LINE,
    size: int = 0,
    lines: Literal["cover", "spare", "avoid"] = "spare",
    short: str = "",
) -> None:
    """Add a value to the labels of a picture, see there. leads: its anchors, and which way it had best stand from them."""
    font, backing = size or sheet.font(12.0), faded(sheet.theme.background, BACKING)
    sheet.labels.append(
        Label(text, places, font, colour, rank, "semibold", backing, lines, key, of, own, *leads, short=short)
    )
    sheet.values[key[0]] += 1


def write_spring(
    sheet: Sheet, at: Points, radius: float, stiffness: float, unit: str, key: tuple[str, int], of: Owner
) -> None:
    """Write the stiffness of a spring beside its symbol."""
    write_beside(sheet, at, radius, f"k = {stated(sheet, stiffness, unit)}", key, of)


def write_beside(sheet: Sheet, at: Points, radius: float, text: str, key: tuple[str, int], of: Owner) -> None:
    """Write what is given of a symbol beside it."""
    angle = np.radians([60.0, 120.0, -60.0, -120.0, 90.0, 0.0, 180.0, -90.0])
    out = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    write_around(sheet, at, radius, out, text, sheet.theme.ink, (key, of, of), 0.0, text)


def write_around(
    sheet: Sheet,
    at: Points,
    radius: float,
    out: Points,
    text: str,
    colour: Colour,
    whose: tuple[Owner, Owner, Owner],
    worth: float,
    short: str,
) -> None:
    """Write a value outside a circle, at one of some directions (k, 2) from it. whose: key, of and own of the label."""
    near = off(at, out, radius + 2.0 * sheet.unit, half_sizes(sheet, [text]))
    places, rank = np.concatenate([near, near + 8.0 * sheet.unit * out]), FIRST - worth
    (key, of, own), leads = whose, (at + radius * out[:5], out[0])
    write(sheet, text, places, colour, key, of, rank=rank, own=own, leads=leads, short=short)
