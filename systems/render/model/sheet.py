"""Sheet: a model in the pixels of one viewport with the marks made on it so far; and the layers that mods draw."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.bent import FLAT, Lines, curved_lines, drawn_scale, is_frame, largest_sag
from pinjoint.components.camera import Viewport
from pinjoint.components.form import Form
from pinjoint.components.model import Model
from pinjoint.components.rod import rigid_joints
from pinjoint.components.tags import Hovered
from pinjoint.components.toolbar import Toolbar
from pinjoint.components.view import Listing, View, drawn_positions
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.occupancy import Occupancy
from pinjoint.systems.render.labels.placing import Label, Placed
from pinjoint.systems.render.marks import Mark, Points, Truths, Values
from pinjoint.systems.render.theme import Colour, Theme, pale
from pinjoint.systems.render.typography import font_size

Shown = Model | Form | Toolbar | Listing
Stage = tuple[Shown, View]  # what is shown, and how

FEW = 30  # elements, up to which each shows its name
MANY = 2000  # rods, above which details of single elements are left out

# Directions by quarter turns clockwise, in pixels: right, down, left, up.
DIRECTIONS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])

# Points, radius: of particles where more would hide short rods, and that can be seen and hit.
_SMALLEST = (0.6, 5.0)


@dataclass
class Sheet:
    """The data that the drawing functions share.

    unit: pixels per point. centres: particles in pixels, shape (n, 2). radii: drawn radii in pixels (n,).
    ends: rows of the particles at the rods' ends (m, 2). rods: rows of the rods that can be seen; start,
    end: their visible parts in pixels, aligned with `rods`. is_frame: some rod bends. curved: visible pieces in
    pixels of those that look bent, by their place among `rods`; None: none does. particles: rows of those that can be seen.
    pulled, pushed: rows of the rods that are coloured by their axial force, since they have no room for more.
    shades: rows of rods and the colours that show a quantity of theirs. above: marks to be drawn over rods and particles.
    placed: where labels were in the last picture. rod_length: the typical one of rods in pixels, as far as they are seen.
    legend: names of the colours that occur and mean something.
    notes: scales to be shown. scales: those of arrows and the place of the scale, to be kept in `placed`. values: how many
    there are to show, by field, if there were room for all.
    """

    model: Model
    view: View
    theme: Theme
    unit: float
    centres: Points
    radii: Values
    ends: Rows
    rods: Rows
    start: Points
    end: Points
    particles: Rows
    occupancy: Occupancy
    placed: Placed
    rod_length: float
    is_frame: bool = False
    curved: Lines | None = None
    pulled: Rows = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    pushed: Rows = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    marks: list[Mark] = field(default_factory=list)
    above: list[Mark] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    legend: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    shades: list[tuple[Rows, Colour]] = field(default_factory=list)
    scales: Placed = field(default_factory=dict)
    values: Counter[str] = field(default_factory=Counter)

    @cached_property
    def arcs(self) -> Values:
        """The radius in pixels of the arrow of a moment around each particle, where one is drawn; else 0."""
        return np.zeros(len(self.centres))

    @property
    def session(self) -> Any:
        """The running program that shows it; None where there is none, as in pictures beside a form."""
        return None if self.view.session is None else self.view.session()

    def colour_of(self, name: str) -> Colour:
        """The colour of loads and results: of these, pale where what is shown is no equilibrium."""
        found: Colour = getattr(self.theme, name)
        return found if name == "load" or not self.view.provisional else pale(found, self.theme.background)

    @property
    def viewport(self) -> Viewport:
        return self.occupancy.viewport

    def lines(self, some: Truths | slice = slice(None)) -> tuple[Points, Points, Rows]:
        """Straight lines along some of the visible rods, bent ones in pieces: from, to, and the row of each."""
        if self.curved is None:
            return self.start[some], self.end[some], self.rods[some]
        wanted = np.zeros(len(self.rods), dtype=bool)
        wanted[some] = True
        pieces = wanted[self.curved.rods]
        wanted[self.curved.rods] = False
        straight, bent = np.flatnonzero(wanted), self.curved.rods[pieces]
        start = np.concatenate([self.start[straight], self.curved.start[pieces]])
        end = np.concatenate([self.end[straight], self.curved.end[pieces]])
        return start, end, self.rods[np.concatenate([straight, bent])]

    def line_at(self, index: int, share: float) -> tuple[Points, Points]:
        """A point on a visible rod in pixels at a share of its length, and its unit direction there, (2,) each."""
        start, end = self.start[index], self.end[index]
        pieces = np.empty(0) if self.curved is None else np.flatnonzero(self.curved.rods == index)
        if self.curved is not None and len(pieces):
            number = min(int(share * len(pieces)), len(pieces) - 1)
            piece, share = pieces[number], share * len(pieces) - number
            start, end = self.curved.start[piece], self.curved.end[piece]
        way = end - start
        return start + share * way, way / max(float(np.hypot(*way)), 1e-9)

    def font(self, points: float) -> int:
        """A font size in whole pixels."""
        return font_size(points, self.unit)

    def sees(self, points: Points) -> Truths:
        """For each of `points` (n, 2), whether it lies in the viewport."""
        low, high = self.viewport.corners
        inside: Truths = (points >= low) & (points <= high)
        return inside[:, 0] & inside[:, 1]

    def explain(self, name: str, start: Points, end: Points) -> None:
        """Let the legend say what a colour means if any of the lines from `start` to `end`, each (n, 2), can be seen."""
        if name not in self.legend and len(start):
            seen = self.sees(start).any() or self.sees(end).any()
            if seen or len(clip_segments(start, end, *self.viewport.corners)[2]):
                self.legend.append(name)

    def advise(self, said: str) -> None:
        """Add a note about what to do, which no picture in a file has."""
        if self.view.advises:
            self.notes.append(said)

    def tagged(self, tag: type, table: str) -> Rows:
        """Rows of the entities of one table that carry a tag; nothing is pointed at in a picture without a pointer."""
        if tag is Hovered and self.view.pointer is None:
            return np.empty(0, dtype=np.intp)
        return self.model.rows_tagged(tag)[table]

    def chosen(self, wanted: Rows, rows: Rows) -> Truths:
        """For each of `rows`, whether it is among `wanted`."""
        if not len(wanted):
            return np.zeros(len(rows), dtype=bool)
        marked = np.zeros(1 + max(rows.max(initial=-1), wanted.max(initial=-1)), dtype=bool)
        marked[wanted] = True
        return marked[rows]


def measure(model: Model, view: View, theme: Theme, placed: Placed | None = None) -> Sheet:
    """The model in pixels. Elements at places that are not finite numbers are left out."""
    camera, unit = view.camera, view.pixel_ratio
    centres = camera.to_pixels(drawn_positions(model))
    ends = model.rods.between.astype(np.intp)
    viewport = view.canvas
    low, high = viewport.corners
    margin = 150.0 * unit  # so that the ends of a rod that leaves the viewport, and their labels, are not seen
    frame, reach, lines = is_frame(model), margin, None
    if frame:
        sag = largest_sag(model) * drawn_scale(model) * camera.scale
        reach += min(2.0 * sag, float((high - low).max()))
    first, last = (centres.take(side, axis=0) for side in ends.T)  # a tenth of the time of centres[ends.T]
    start, end, rods = clip_segments(first, last, low - reach, high + reach)
    if frame:
        lines = curved_lines(model, FLAT / camera.scale, rods)
    curved = _visible(lines, rods, view, (low - margin, high + margin)) if lines is not None else None
    rod_length = typical_length(start, end)
    smallest = min(max(0.18 * rod_length, _SMALLEST[0] * unit), _SMALLEST[1] * unit)
    radii: Values = np.maximum(model.particles.radius * camera.scale, smallest)
    if frame:
        radii[rigid_joints(model) & (radii == smallest)] = 0.7 * smallest
    around = radii[:, None] + 40.0 * unit
    seen = (centres > low - around) & (centres < high + around)
    particles, occupancy = np.flatnonzero(seen[:, 0] & seen[:, 1]), Occupancy(viewport, unit)
    placed = {} if placed is None else placed
    seen_of = rods, start, end, particles
    found = Sheet(model, view, theme, unit, centres, radii, ends, *seen_of, occupancy, placed, rod_length)
    found.is_frame, found.curved = frame, curved
    return found


def _visible(lines: Lines, rods: Rows, view: View, within: tuple[Points, Points]) -> Lines:
    """The pieces of rods that can be seen, in pixels, by the place of their rod among `rods`, which are in order."""
    start, end = view.camera.to_pixels(lines.start), view.camera.to_pixels(lines.end)
    start, end, kept = clip_segments(start, end, *within)
    way = end - start
    overlap = 0.5 * way / np.maximum(np.hypot(*way.T), 1e-9)[:, None]  # pixel, so that pieces close
    return Lines(start - overlap, end + overlap, np.searchsorted(rods, lines.rods[kept]))


def typical_length(start: Points, end: Points) -> float:
    """Median length in pixels of segments, of many that of a sample; infinite if there are none."""
    sample = slice(None, None, len(start) // MANY + 1)
    return float(np.median(np.hypot(*(end[sample] - start[sample]).T))) if len(start) else np.inf


Layer = Callable[[Sheet], Iterable[Mark]]  # draws marks with every picture of a model
