"""Layout: trees of texts, rows, columns and plates, measured and placed; what can be pressed is noted as it is placed.

A tree is plain data in points that a function makes anew for every picture; it knows no window and no colours of its own.
`Paper.put` places it in a rectangle of pixels, as marks and hits. Parts get the room that they need; what is left of a row
or column, or lacks, is shared by those that `grow`: texts are shortened or wrapped there, and a `Scroll` leaves rows out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.field import Vector
from pinjoint.components.view import Hit
from pinjoint.systems.render import marks
from pinjoint.systems.render.marks import Mark, Panel, Stamps
from pinjoint.systems.render.theme import Colour
from pinjoint.systems.render.typography import font_size, line_height, shortened, text_width, wrapped


@dataclass
class Paper:
    """What trees are placed on: pixels per point and where the pointer is; marks and hits so far, the topmost last.

    scrolled: of the part that scrolls, the number of its first row in sight, of those in sight, and of all. draws: False
    where only hits are wanted.
    """

    unit: float
    pointer: Vector | None = None
    marks: list[Mark] = field(default_factory=list)
    hits: list[Hit] = field(default_factory=list)
    scrolled: tuple[int, int, int] = (0, 0, 0)
    draws: bool = True

    def put(self, part: Part, place: Rectangle) -> None:
        """Place a tree in a rectangle."""
        part.put(self, place)

    def is_under_pointer(self, place: Rectangle) -> bool:
        """True if the pointer is over a rectangle."""
        return self.pointer is not None and place.contains(self.pointer)


class Part:
    """A part of a tree, of so many points. grow: the share that it takes of what its row or column has left, or lacks."""

    wide: float = 0.0
    high: float = 0.0
    grow: float = 0.0

    def width(self, u: float) -> float:
        """The pixels that it needs, with u pixels per point."""
        return self.wide * u

    def height(self, u: float, width: float) -> float:
        """The pixels that it needs where it is so wide."""
        return self.high * u

    def put(self, paper: Paper, place: Rectangle) -> None:
        """Make its marks and hits in a rectangle."""


@dataclass(frozen=True)
class Gap(Part):
    """Room in points, or all that is left."""

    wide: float = 0.0
    high: float = 0.0
    grow: float = 0.0


@dataclass(frozen=True)
class Text(Part):
    """A text in the middle of the height of its place, in at most so many lines, the last of them shortened.

    points: the size of its type; of several the first in which it is whole in one line. apart: points from line to line.
    wide: points across; 0: as many as it needs.
    """

    text: str
    points: float | tuple[float, ...]
    colour: Colour
    weight: str = "regular"
    anchor: str = "left"
    lines: int = 1
    grow: float = 0.0
    apart: float = 0.0
    wide: float = 0.0

    def size(self, u: float, width: float = math.inf) -> int:
        """The size of its type in pixels."""
        if not isinstance(self.points, tuple):
            return font_size(self.points, u)
        sizes = [font_size(p, u) for p in self.points]
        return next((size for size in sizes if text_width(self.text, size, self.weight) <= width), sizes[-1])

    def width(self, u: float) -> float:
        return self.wide * u or text_width(self.text, self.size(u), self.weight)

    def height(self, u: float, width: float) -> float:
        lines = 1 if self.lines == 1 else len(self._lines(self.size(u, width), width))
        return lines * self._apart(u)

    def put(self, paper: Paper, place: Rectangle) -> None:
        u, size = paper.unit, self.size(paper.unit, place.width)
        lines = self._lines(size, place.width)
        apart = self._apart(u) if len(lines) > 1 else 0.0
        x = place.left + {"left": 0.0, "centre": 0.5, "right": 1.0}[self.anchor] * place.width
        y = place.middle[1] - (len(lines) - 1) * apart / 2
        for number, line in enumerate(lines):
            if line:
                at = x, y + number * apart
                paper.marks.append(marks.Text(line, *at, size, self.colour, self.weight, self.anchor))

    def _apart(self, u: float) -> float:
        return self.apart * u or line_height(self.size(u))

    def _lines(self, size: int, width: float) -> Sequence[str]:
        width += 0.01  # pixels: what is as wide as its place is whole, whatever sums of widths were rounded to
        if self.lines == 1:
            return [shortened(self.text, width, size, self.weight)]
        return wrapped(self.text, width, size, self.weight, self.lines)


@dataclass(frozen=True)
class Drawn(Part):
    """Whatever a function of its place and the pixels per point draws, in so many points."""

    draw: Callable[[Rectangle, float], Iterable[Mark]]
    wide: float = 0.0
    high: float = 0.0
    grow: float = 0.0

    def put(self, paper: Paper, place: Rectangle) -> None:
        if paper.draws:
            paper.marks += self.draw(place, paper.unit)


def icon(symbol: str, size: float, colour: Colour, wide: float) -> Drawn:
    """A symbol of that size in the middle of so many points."""
    return Drawn(lambda at, u: [Stamps(symbol, np.array([at.middle]), size * u, u, colour, colour)], wide)


def rule(colour: Colour, high: float) -> Drawn:
    """A hairline in the middle of so many points of height."""
    return Drawn(
        lambda at, u: [
            Panel(round(at.left), round(at.middle[1]), round(at.width), max(round(u), 1), 0.0, colour)
        ],
        high=high,
        grow=1.0,
    )


@dataclass(frozen=True)
class Group(Part):
    """Parts with a gap between them, and room around them (points): at the sides, above, and below.

    wide, high: points that it takes at least. even: all parts get the same room. top: parts of a row begin at its top.
    """

    parts: Sequence[Part]
    gap: float = 0.0
    around: tuple[float, float, float] = (0.0, 0.0, 0.0)
    grow: float = 0.0
    wide: float = 0.0
    high: float = 0.0
    even: bool = False
    top: bool = False
    down: ClassVar[bool] = False

    def width(self, u: float) -> float:
        each = self._each(u)
        wide = max(each, default=0.0) if self.down else self._whole(each, u)
        return max(wide + 2 * self.around[0] * u, self.wide * u)

    def height(self, u: float, width: float) -> float:
        each = self._each(u, width - 2 * self.around[0] * u)
        high = self._whole(each, u) if self.down else max(each, default=0.0)
        return max(high + (self.around[1] + self.around[2]) * u, self.high * u)

    def put(self, paper: Paper, place: Rectangle) -> None:
        u = paper.unit
        sides, above, below = (points * u for points in self.around)
        left, top = place.left + sides, place.top + above
        width, height = place.width - 2 * sides, place.height - above - below
        if self.down:
            for part, high in zip(self.parts, self._shared(self._each(u, width), height, u), strict=True):
                part.put(paper, Rectangle(left, top, width, high))
                top += high + self.gap * u
            return
        for part, wide in zip(self.parts, self._shared(self._each(u), width, u), strict=True):
            part.put(paper, Rectangle(left, top, wide, part.height(u, wide) if self.top else height))
            left += wide + self.gap * u

    def _whole(self, each: list[float], u: float) -> float:
        taken = len(each) * max(each, default=0.0) if self.even else sum(each)
        return taken + max(len(each) - 1, 0) * self.gap * u

    def _each(self, u: float, width: float | None = None) -> list[float]:
        """The pixels that each part needs across, or down in such a width, for which those around ask again and again."""
        known: dict[tuple[float, float | None], list[float]] = vars(self).setdefault("_known", {})
        if (found := known.get((u, width))) is None:
            if width is None:
                found = [part.width(u) for part in self.parts]
            else:
                widths = [width] * len(self.parts) if self.down else self._shared(self._each(u), width, u)
                found = [part.height(u, wide) for part, wide in zip(self.parts, widths, strict=True)]
            known[u, width] = found
        return found

    def _shared(self, needed: list[float], room: float, u: float) -> list[float]:
        """What each part gets of the room in the direction of the group."""
        room -= max(len(needed) - 1, 0) * self.gap * u
        if self.even:
            return [room / max(len(needed), 1)] * len(needed)
        left, shares = room - sum(needed), [part.grow for part in self.parts]
        if not any(shares):
            return needed
        if left < 0.0:  # who needs more gives more
            shares = [share * n for share, n in zip(shares, needed, strict=True)]
        total = sum(shares) or 1.0
        return [max(n + left * share / total, 0.0) for n, share in zip(needed, shares, strict=True)]


class Row(Group):
    """Parts side by side, each as high as the row."""


class Column(Group):
    """Parts one below the other, each as wide as the column."""

    down = True


@dataclass(frozen=True)
class Scroll(Column):
    """A column of which only whole parts are shown, from the one with number `first` on, with a bar if there are more.

    from_end: `first` counts from where the last part is in sight. bar: its colour. beside: points to it from the right edge.
    """

    first: int = 0
    from_end: bool = False
    bar: Colour = (0, 0, 0, 0)
    beside: float = 0.0

    def put(self, paper: Paper, place: Rectangle) -> None:
        u, gap = paper.unit, self.gap * paper.unit
        each = self._each(u, place.width)
        last = _last_first(each, gap, place.height)
        first = min(max(self.first + (last if self.from_end else 0), 0), last)
        shown, taken = 0, -gap
        for high in each[first:]:
            if shown and taken + gap + high > place.height + 0.5:
                break
            taken += gap + high
            shown += 1
        paper.scrolled = first, shown, len(each)
        visible = Column(self.parts[first : first + shown], self.gap)
        visible.put(paper, Rectangle(place.left, place.top, place.width, taken))
        if shown < len(each):
            width, length = max(round(3.0 * u), 2), max(place.height * shown / len(each), 16.0 * u)
            top = place.top + (place.height - length) * first / (len(each) - shown)
            left = round(place.right + self.beside * u) - width
            paper.marks.append(Panel(left, round(top), width, round(length), 0.0, self.bar))


def _last_first(heights: Sequence[float], gap: float, room: float) -> int:
    """The first row when scrolled to the end."""
    first, taken = len(heights), -gap
    while first and taken + gap + heights[first - 1] <= room + 0.5:
        first -= 1
        taken += gap + heights[first]
    return min(first, max(len(heights) - 1, 0))


@dataclass(frozen=True)
class Plate(Part):
    """A part on paper with round corners, which may be pressed.

    fill, outline: of the paper; None: none. hover, hover_outline: those under the pointer. inset: points between its
    place and the paper. action, …, again: of its hit, see there; it has none without an action and an item.
    """

    inside: Part
    fill: Colour | None = None
    outline: Colour | None = None
    hover: Colour | None = None
    hover_outline: Colour | None = None
    radius: float = 5.0
    inset: float = 0.0
    action: str | None = None
    enabled: bool = True
    item: Any = None
    at: Vector | None = None
    wheel: tuple[str, str] | None = None
    again: bool = False
    grow: float = 0.0

    def width(self, u: float) -> float:
        return self.inside.width(u)

    def height(self, u: float, width: float) -> float:
        return self.inside.height(u, width)

    def put(self, paper: Paper, place: Rectangle) -> None:
        if self.action is not None or self.item is not None:
            hit = Hit(*place.box, self.action, self.enabled, self.item, self.at, self.wheel, self.again)
            paper.hits.append(hit)
        under = self.hover is not None and self.enabled and paper.is_under_pointer(place)
        fill, by = self.hover if under else self.fill, self.inset * paper.unit
        outline = self.hover_outline if under and self.hover_outline else self.outline
        if fill is not None:
            size = place.width - 2 * by, place.height - 2 * by
            radius = self.radius * paper.unit
            paper.marks.append(Panel(place.left + by, place.top + by, *size, radius, fill, outline))
        self.inside.put(paper, place)


def in_columns(
    groups: Sequence[Sequence[Part]], between: Part, u: float, room: float, width: float, *, heads: bool = False
) -> list[list[Part]]:
    """Groups of rows in as few columns of that width as the room above each other needs, about equally high.

    between: what stands between two groups of a column. A group goes on in the next column only where it has to; heads:
    under its first row again, from which the second is not parted.
    """
    measured = [[(part, part.height(u, width)) for part in group] for group in groups]
    apart = between, between.height(u, width)
    columns = _filled(measured, apart, room, heads)
    lower = sum(high for group in measured for _, high in group) / len(columns)
    while lower < room:
        if len(even := _filled(measured, apart, lower, heads)) == len(columns):
            return even
        lower += 4.0 * u
    return columns


def _filled(
    groups: list[list[tuple[Part, float]]], between: tuple[Part, float], room: float, heads: bool
) -> list[list[Part]]:
    columns, taken = [list[Part]()], 0.0
    for group in groups:
        whole, ahead = sum(high for _, high in group), [high for _, high in group[1:]]
        if columns[-1] and taken + between[1] + min(whole, room) > room and not heads:
            columns.append([])
            taken = 0.0
        elif columns[-1]:
            columns[-1].append(between[0])
            taken += between[1]
        for number, (part, high) in enumerate(group):
            needed = high + (ahead[0] if heads and not number and ahead else 0.0)
            if columns[-1] and taken + needed > room:
                columns.append([group[0][0]] if heads and number else [])
                taken = group[0][1] if heads and number else 0.0
            columns[-1].append(part)
            taken += high
    return columns
