"""Framing: marks of others, checked and cut so that a canvas can draw them, wherever they lie and however large they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from pinjoint.components.camera import Viewport
from pinjoint.components.language import listed, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.wording import printable
from pinjoint.systems.render.clip import clip_polygon, clip_segments
from pinjoint.systems.render.marks import (
    Bars,
    Discs,
    Fills,
    Mark,
    Owners,
    Panel,
    Points,
    Stamps,
    Strokes,
    Text,
    owners,
)
from pinjoint.systems.render.symbols import SUPPORT_DEPTH, SYMBOLS, arc, circle, icons, turned_parts
from pinjoint.systems.render.theme import Colour
from pinjoint.systems.render.typography import WEIGHTS

_MARGIN = 4.0  # pixels around the viewport within which cuts are not seen
_LARGEST_STAMP = 64.0  # points, greatest radius of a circle drawn as a stamp
_FAR = 1e7  # pixels; what is larger looks the same
_FARTHEST = 1e9  # pixels; places beyond it are moved there
_SHAPES: dict[type, dict[str, tuple[int | None, ...]]] = {  # of a mark's arrays; None: any number
    Strokes: {"start": (None, 2), "end": (None, 2)},
    Fills: {"corners": (None, None, 2)},
    Bars: {"start": (None, 2), "end": (None, 2), "rise": (None, 2)},
    Stamps: {"at": (None, 2)},
    Discs: {"at": (None, 2), "radius": (None,)},
}
_SIZES = {"width", "height", "radius", "size", "unit"}  # what cannot be negative
_COLOURS = {"colour", "ink", "hollow", "fill", "outline"}
_WORDS = {"weight": tuple(WEIGHTS), "anchor": ("left", "centre", "right")}


def framed(mark: Mark, viewport: Viewport, unit: float) -> Iterator[Mark]:
    """What is seen of a mark in a viewport, as marks that are not much larger. unit: pixels per point.

    Raises ValueError if its arrays have other shapes than they should, or a number, colour or symbol is none.
    """
    _check_mark(mark)
    low, high = viewport.corners
    match mark:
        case Strokes():
            width = min(mark.width, 4.0 * float(np.hypot(*(high - low))))
            reach = width + _MARGIN
            start, end, seen = clip_segments(_within(mark.start), _within(mark.end), low - reach, high + reach)
            yield replace(mark, start=start, end=end, width=width, of=owners(mark.of, seen))
        case Fills():
            yield from _fills(_within(mark.corners), mark.colour, viewport, mark.of)
        case Bars():
            mark = replace(mark, start=_within(mark.start), end=_within(mark.end), rise=_within(mark.rise))
            yield from _fills(mark.corners, mark.colour, viewport, mark.of)
        case Stamps():
            yield from _stamps(mark, viewport)
        case Discs():
            yield from cut_discs(mark, viewport, unit)
        case Panel():
            yield from _panel(mark, low, high)
        case Text():
            yield from _text(mark, viewport)


# --- checks ------------------------------------------------------------------------------------------------


def _check_mark(mark: Mark) -> None:
    """Raise ValueError, naming the part, if a mark of the right types cannot be drawn."""
    kind, arrays = type(mark), [*_SHAPES.get(type(mark), {})]
    names = getattr(mark, "_fields", None) or [*vars(mark)]
    for name in [name for name in names if name != "of"]:
        problem = _problem(name, getattr(mark, name), _SHAPES.get(kind, {}).get(name))
        if problem:
            raise ValueError(f"{kind.__name__}.{name} {problem}")
    counts = {len(getattr(mark, name)) for name in arrays}
    if arrays and (of := getattr(mark, "of", None)) is not None:
        arrays.append("of")
        counts.add(len(of[1]))
    if len(counts) > 1:
        raise WrongValue(
            "{mark}: {parts} have different numbers of rows", mark=kind.__name__, parts=listed(arrays)
        )


def _problem(name: str, value: Any, shape: tuple[int | None, ...] | None) -> str:
    """What is wrong with a part of a mark, "" if nothing is."""
    if shape is not None:
        fits = len(value.shape) == len(shape) and all(
            n in (None, m) for n, m in zip(shape, value.shape, strict=True)
        )
        if not fits and value.size:
            wanted = ", ".join("n" if n is None else str(n) for n in shape)
            return tr("has the shape {shape}; it must be ({wanted})", shape=value.shape, wanted=wanted)
    if name in _COLOURS:
        wrong = value is not None and not all(0 <= part <= 255 for part in value)
        told = tr("is {value}; red, green, blue and opacity go from 0 to 255", value=value)
        return told if wrong else ""
    if name == "symbol":
        return (
            ""
            if value in SYMBOLS or value in icons()
            else tr("is '{value}'; there is no such symbol", value=value)
        )
    if name in _WORDS:
        known = ", ".join(_WORDS[name])
        return (
            "" if value in _WORDS[name] else tr("is '{value}'; choose one of {known}", value=value, known=known)
        )
    if isinstance(value, str):
        return ""
    value = np.asarray(value, dtype=np.float64)  # whole numbers of any length, too
    bad = ~np.isfinite(value) | ((value < 0.0) if name in _SIZES else False)
    if np.any(bad):
        wrong = value[bad].flat[0]
        if name in _SIZES:
            return tr("contains {value}; it must be 0 or more, in pixels", value=wrong)
        return tr("contains {value}; it must be finite, in pixels", value=wrong)
    return ""


# --- cutting -------------------------------------------------------------------------------------------------


def _fills(corners: Points, colour: Colour, viewport: Viewport, of: Owners | None) -> Iterator[Fills]:
    """Polygons, those that stick out of the viewport cut to it."""
    if not corners.size:
        return
    low, high = viewport.corners
    low, high = low - _MARGIN, high + _MARGIN
    inside = np.asarray(((corners >= low) & (corners <= high)).all(axis=(1, 2)))
    if inside.any():
        yield Fills(corners[inside], colour, owners(of, inside))
    away = ((corners < low).all(axis=1) | (corners > high).all(axis=1)).any(axis=-1)
    for index in np.flatnonzero(~inside & ~away).tolist():
        cut = clip_polygon(corners[index], low, high)
        if len(cut) > 2:
            yield Fills(cut[None], colour, owners(of, slice(index, index + 1)))


def _within(places: Points) -> Points:
    """Places at distances with which one can compute."""
    return np.clip(places, -_FARTHEST, _FARTHEST)


def _near(at: Points, reach: float, viewport: Viewport) -> Any:
    """Which of some places (n, 2) lie within a reach of the viewport."""
    low, high = viewport.corners
    inside = (at >= low - reach) & (at <= high + reach)
    return inside[:, 0] & inside[:, 1]  # in a tenth of the time of all()


def _stamps(mark: Stamps, viewport: Viewport) -> Iterator[Mark]:
    """Stamps near the viewport; large ones as polygons."""
    mark = replace(mark, at=_within(mark.at), size=min(mark.size, _FAR), unit=min(mark.unit, _FAR))
    largest = mark.size if mark.symbol in SYMBOLS else 20.0 * mark.size  # of an icon: of a unit of its square
    reach = largest + 2.0 * SUPPORT_DEPTH * mark.unit
    near = _near(mark.at, reach, viewport)
    mark = replace(mark, at=mark.at[near], of=owners(mark.of, near))
    if not len(mark.at) or not mark.size or not mark.unit:
        return
    if reach <= 4.0 * _LARGEST_STAMP:
        yield mark
        return
    for role, corners in turned_parts(mark):
        colour = mark.ink if role == "ink" else mark.hollow
        yield from _fills(mark.at[:, None] + corners, colour, viewport, mark.of)


def cut_discs(mark: Discs, viewport: Viewport, unit: float) -> Iterator[Mark]:
    """Discs near the viewport; large ones as polygons, of whose rims that part which may be seen."""
    large = mark.radius > _LARGEST_STAMP * unit
    small = ~large & _near(mark.at, _LARGEST_STAMP * unit, viewport)
    rim = min(mark.rim, _LARGEST_STAMP * unit)
    if small.any():
        yield replace(mark, at=mark.at[small], radius=mark.radius[small], rim=rim, of=owners(mark.of, small))
    low, high = viewport.corners
    for index in np.flatnonzero(large).tolist():
        place, radius, of = mark.at[index], float(mark.radius[index]), owners(mark.of, slice(index, index + 1))
        inner = radius - rim / 2
        inside = _within(place) + circle(min(inner, _FAR))
        yield from _fills(inside[None], mark.hollow if rim else mark.ink, viewport, of)
        line = arc(place, inner, (low + high) / 2, float(np.hypot(*(high - low))))
        if rim and len(line):
            step = line[1:] - line[:-1]
            overlap = 0.5 * step / np.hypot(*step.T)[:, None]  # pixel, so that joints close
            start, end, _ = clip_segments(line[:-1] - overlap, line[1:] + overlap, low - rim, high + rim)
            yield Strokes(start, end, rim, mark.ink, of and (of[0], np.repeat(of[1], len(start))))


def _panel(mark: Panel, low: Points, high: Points) -> Iterator[Panel]:
    """A panel, cut where its round corners are not seen."""
    radius = min(mark.radius, mark.width / 2, mark.height / 2, float((high - low).max()))
    reach = 2.0 * radius + _MARGIN
    first, size = _within(np.array(mark[:2])), np.minimum(mark[2:4], 4.0 * _FARTHEST)
    (left, top), (right, bottom) = np.maximum(first, low - reach), np.minimum(first + size, high + reach)
    if right - left >= 1.0 and bottom - top >= 1.0:
        yield Panel(float(left), float(top), float(right - left), float(bottom - top), radius, *mark[5:])


def _text(mark: Text, viewport: Viewport) -> Iterator[Text]:
    """A text as much of which as fits into three viewports, without characters that do not print."""
    size = int(min(mark.size, viewport.height))
    text = printable(mark.text[: 3 * viewport.width // max(size // 4, 1) + 1])
    reach = size * (len(text) + 1.0)
    if size > 0 and text and _near(np.array([[mark.x, mark.y]]), reach, viewport)[0]:
        yield mark._replace(text=text, size=size)
