"""Walls and floors: fixed straight lines on which particles bounce and rest."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import CM, Field, FieldError, Handle, Pieces, Selected, Table, Vector
from pinjoint.components.arrays import Rows
from pinjoint.components.language import marked
from pinjoint.components.tags import Hovered
from pinjoint.mods import App
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.nearness import LINE
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.labels.placing import Label
from pinjoint.systems.render.marks import Discs, Mark, Points, Strokes
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.model.structure import HALO_OPACITY
from pinjoint.systems.render.model.values import BACKING, beside, half_sizes
from pinjoint.systems.render.theme import Colour, faded

WIDTH = 4.0  # points, of the line that is drawn

ICON = (("line", (-8.5, -3, 8.5, -3)), *(("line", (x, -2.5, x - 4, 4)) for x in (-3.5, 1.5, 6.5)))


class Wall(Handle):
    """A straight line from one point to another; both of its sides and its ends are hard and smooth."""

    __slots__ = ()
    table, noun = "walls", "wall"
    points = ("start", "end")

    name: Field[str] = Field(doc="Unique among the walls.", dtype=str)
    start: Field[Vector] = Field("m", shape=(2,), doc="Where it begins.", shown=CM)
    end: Field[Vector] = Field("m", shape=(2,), doc="Where it ends.", shown=CM)
    restitution: Field[float | None] = Field(
        nullable=True,
        minimum=0.0,
        maximum=1.0,
        doc="For impacts with this wall; automatic: the value in the settings.",
    )

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """Raise FieldError for a wall without a length."""
        points = (table.start[rows] == table.end[rows]).all(axis=1)
        for row in rows[points][:1].tolist():
            where = table.world.describe(table[row])
            raise FieldError(
                "{wall}: its start and its end are the same point; place one elsewhere.", wall=where
            )


def draw(sheet: Sheet) -> Iterator[Mark]:
    """Every wall as a thick line, with its name while it is selected or pointed at."""
    walls = sheet.model.tables["walls"]
    ends = sheet.view.camera.to_pixels(np.stack([walls.start, walls.end], axis=1))
    low, high = sheet.viewport.corners
    width = WIDTH * sheet.unit
    start, end, rows = clip_segments(ends[:, 0], ends[:, 1], low - 2 * width, high + 2 * width)
    sheet.occupancy.line(start, end, STRONG)
    sheet.occupancy.parts.add(("walls", rows), start, end, width / 2, kind=LINE)
    selected, hovered = (sheet.tagged(tag, "walls") for tag in (Selected, Hovered))
    for which, halo in ((hovered, sheet.theme.hover), (selected, sheet.theme.selected)):
        chosen = sheet.chosen(which, rows)
        glow = faded(halo, HALO_OPACITY)
        yield from _thick(start[chosen], end[chosen], 3.5 * width, glow, rows[chosen])
    yield from _thick(start, end, width, sheet.theme.ink, rows)
    size, backing = sheet.font(12.0), faded(sheet.theme.background, BACKING)
    for row in np.union1d(selected, hovered).tolist():
        name = walls.names[row]
        half = half_sizes(sheet, [name])[0]
        places = beside(half, ends[row, 0], ends[row, 1], WIDTH * sheet.unit, (0.5, 0.3, 0.7))
        label = Label(name, places, size, sheet.theme.text, 1e11, "semibold", backing, of=("walls", row))
        sheet.labels.append(label)


def _thick(start: Points, end: Points, width: float, colour: Colour, rows: Rows) -> Iterator[Mark]:
    """Lines with round ends."""
    if len(start):
        yield Strokes(start, end, width, colour, ("walls", rows))
        caps = np.concatenate([start, end])
        radius = np.full(len(caps), 0.5 * width)
        yield Discs(caps, radius, colour, colour, of=("walls", np.tile(rows, 2)))


def plugin(app: App) -> None:
    """Register the kind, its shape, its picture and its tool."""
    app.kind(Wall)
    app.shape(
        Wall,
        lambda walls: Pieces(
            np.stack([walls.start, walls.end], axis=1), np.arange(walls.count), restitution=walls.restitution
        ),
    )
    app.layer(draw, below=True)
    app.tool(Wall, key="w", title=marked("draw a wall or floor"), icon=ICON)
