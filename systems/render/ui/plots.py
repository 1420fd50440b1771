"""Plots: curves over axes with round ticks, and the values under the pointer."""

from __future__ import annotations

import itertools
import math

import numpy as np

from pinjoint.components import written
from pinjoint.components.camera import Rectangle
from pinjoint.components.field import Vector
from pinjoint.components.language import several
from pinjoint.components.round_numbers import round_up
from pinjoint.components.view import Plot
from pinjoint.systems.render.marks import Mark, Panel, Points, Stamps, Strokes, Text, Truths, Values
from pinjoint.systems.render.theme import Colour, Theme
from pinjoint.systems.render.typography import font_size, text_width

_TEXT = 10.0  # points
_REACH = 30.0  # points from a curve, within which the pointer reads it
_STEP = 2.0  # points along a curve between drawn samples
_TICKS = 4  # on each axis, about


def draw_plot(plot: Plot, box: Rectangle, theme: Theme, unit: float, pointer: Vector | None) -> list[Mark]:
    """A plot within a box, as marks in pixels."""
    return _Drawing(plot, box, theme, unit).marks(pointer)


class _Drawing:
    """Places one plot in a box: the axes' titles and ticks outside, the curves inside."""

    def __init__(self, plot: Plot, box: Rectangle, theme: Theme, unit: float) -> None:
        self.plot, self.theme, self.unit = plot, theme, unit
        self.size = font_size(_TEXT, unit)
        self.x_range = _range([x for _, x, _ in plot.curves])
        low, high = _range([y for _, _, y in plot.curves])
        self.y_range = low - 0.06 * (high - low), high + 0.06 * (high - low)
        self.x_ticks, self.y_ticks = round_ticks(self.x_range), round_ticks(self.y_range)
        labels = max((text_width(text, self.size) for _, text in self.y_ticks), default=0.0)
        self.left, self.right = box.left + labels + 6.0 * unit, box.right - 4.0 * unit
        self.top, self.bottom = box.top + 16.0 * unit, box.bottom - 30.0 * unit
        colours = theme.curve_1, theme.curve_2, theme.curve_3, theme.curve_4
        self.coloured = list(zip(plot.curves, itertools.cycle(colours), strict=False))

    def pixels(self, x: Values, y: Values) -> Points:
        """Points of a curve in pixels, shape (n, 2)."""
        across = (x - self.x_range[0]) / (self.x_range[1] - self.x_range[0])
        up = (y - self.y_range[0]) / (self.y_range[1] - self.y_range[0])
        at_x = self.left + (self.right - self.left) * across
        return np.stack([at_x, self.bottom - (self.bottom - self.top) * up], axis=1)

    def marks(self, pointer: Vector | None) -> list[Mark]:
        """All marks of the plot, in painter's order."""
        marks = [*self._axes(), *self._titles()]
        for (_, x, y), colour in self.coloured:
            marks += self._curve(self.pixels(x, y), colour)
        if self.plot.dots is not None and len(self.plot.dots):
            places, ink = self.pixels(*self.plot.dots.T), self.theme.curve_2
            marks.append(Stamps("disc", places, 3.5 * self.unit, self.unit, ink, ink))
        return marks + (self._reading(pointer) if pointer is not None else [])

    def _axes(self) -> list[Mark]:
        marks: list[Mark] = []
        thin = max(self.unit, 1.0)
        for value, text in self.x_ticks:
            x = float(self.pixels(np.array([value]), np.array([self.y_range[0]]))[0, 0])
            ends = np.array([[x, self.top]]), np.array([[x, self.bottom]])
            marks.append(Strokes(*ends, thin, self.theme.line))
            y = self.bottom + 9.0 * self.unit
            marks.append(Text(text, x, y, self.size, self.theme.muted, anchor="centre"))
        for value, text in self.y_ticks:
            y = float(self.pixels(np.array([self.x_range[0]]), np.array([value]))[0, 1])
            ends = np.array([[self.left, y]]), np.array([[self.right, y]])
            marks.append(Strokes(*ends, thin, self.theme.muted if value == 0.0 else self.theme.line))
            x = self.left - 5.0 * self.unit
            marks.append(Text(text, x, y, self.size, self.theme.muted, anchor="right"))
        return marks

    def _titles(self) -> list[Mark]:
        """The titles of the axes; with several curves, their names in their colours."""
        y, middle = self.top - 8.0 * self.unit, (self.left + self.right) / 2
        below = self.bottom + 22.0 * self.unit
        marks: list[Mark] = [
            Text(self.plot.x_title, middle, below, self.size, self.theme.muted, anchor="centre"),
            Text(self.plot.y_title, self.left, y, self.size, self.theme.muted),
        ]
        x = self.right
        for (name, _, _), colour in reversed(self.coloured if len(self.coloured) > 1 else []):
            marks.append(Text(name, x, y, self.size, colour, "semibold", "right"))
            x -= text_width(name, self.size, "semibold") + 8.0 * self.unit
        return marks

    def _curve(self, points: Points, colour: Colour) -> list[Mark]:
        points = _thinned(points, _STEP * self.unit)
        finite: Truths = np.asarray(np.isfinite(points).all(axis=1))
        whole = finite[1:] & finite[:-1]
        start, end = points[:-1][whole], points[1:][whole]
        length = np.maximum(np.hypot(*(end - start).T), 1e-9)[:, None]
        overlap = (end - start) / length * (0.5 * self.unit)  # else the joints would show
        return [Strokes(start, end + overlap, 1.5 * self.unit, colour)] if len(start) else []

    def _reading(self, pointer: Vector) -> list[Mark]:
        """The point of a curve nearest to the pointer, with its values."""
        found = self._nearest(pointer)
        if found is None:
            return []
        (x, y), text, colour = found
        u, width = self.unit, text_width(text, self.size) + 8.0 * self.unit
        left = min(max(x - width / 2, self.left), self.right - width)
        top = max(y - 20.0 * u, self.top)
        return [
            Stamps("disc", np.array([[x, y]]), 3.0 * u, u, colour, colour),
            Panel(left, top, width, 15.0 * u, 3.0 * u, self.theme.background, self.theme.line),
            Text(text, left + 4.0 * u, top + 7.5 * u, self.size, self.theme.text),
        ]

    def _nearest(self, pointer: Vector) -> tuple[Vector, str, Colour] | None:
        """The pixel nearest to the pointer on a curve, the values there, and the curve's colour."""
        if not (self.left <= pointer[0] <= self.right and self.top <= pointer[1] <= self.bottom):
            return None
        found, reach = None, _REACH * self.unit
        for (_, x, y), colour in self.coloured:
            points = self.pixels(x, y)
            distance = np.nan_to_num(np.hypot(*(points - pointer).T), nan=math.inf)
            if len(points) and distance.min() <= reach:
                at, reach = int(distance.argmin()), float(distance.min())
                pixel = float(points[at, 0]), float(points[at, 1])
                found = pixel, several((written.given(x[at], 4), written.given(y[at], 4))), colour
        return found


def _thinned(points: Points, step: float) -> Points:
    """Those points of a curve that are at least a step along it from the one before, gaps, and the last."""
    if len(points) < 2:
        return points
    along = np.cumsum(np.nan_to_num(np.hypot(*np.diff(points, axis=0, prepend=points[:1]).T)))
    kept: Truths = np.diff(np.floor(along / step), prepend=-1.0) > 0.0
    kept[-1] = True
    return points[kept | ~np.isfinite(points).all(axis=1)]


def _range(columns: list[Values]) -> Vector:
    """The least and the largest finite value, widened if equal."""
    values = np.concatenate([*columns, np.empty(0)])
    values = values[np.isfinite(values)]
    if not len(values):
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    if high - low > 1e-9 * max(abs(low), abs(high)):
        return low, high
    room = 0.5 * abs(high) or 0.5
    return low - room, high + room


def round_ticks(values: Vector) -> list[tuple[float, str]]:
    """Round values within a range, 1, 2 or 5 times a power of ten apart, and how they are written."""
    step = round_up(values[1] / _TICKS - values[0] / _TICKS)
    first, last = math.ceil(values[0] / step), math.floor(values[1] / step)
    return [(n * step, written.given(n * step, 4)) for n in range(first, last + 1)]
