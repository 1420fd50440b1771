"""Forms: boxes of properties, save and load, results beside them, and tiles to choose from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import groupby
from typing import NamedTuple

import numpy as np

from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.form import Box, Form, Reading, Tile
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.view import BETWEEN, Hit, View
from pinjoint.systems.render.marks import Mark, Panel, Picture, Stamps
from pinjoint.systems.render.marks import Text as Written
from pinjoint.systems.render.theme import Colour, Theme, faded
from pinjoint.systems.render.typography import ALL, font_size, in_rows, text_width
from pinjoint.systems.render.ui.buttons import button, closing
from pinjoint.systems.render.ui.form_box import bare_box, is_short, titled_box
from pinjoint.systems.render.ui.help import put_help
from pinjoint.systems.render.ui.layout import Column, Drawn, Gap, Paper, Part, Plate, Row, Scroll, Text
from pinjoint.systems.render.ui.menu import put_menu
from pinjoint.systems.render.ui.thumbnails import thumbnail

PROPERTIES = marked("Properties")  # the heading of an element's own boxes, where its results stand above them
_WIDEST, _EDGE = 1500.0, 16.0  # points that tiles spread over, and around all
_SECTION, _READING, _GAP = 28.0, 20.0, 10.0  # points: of a heading, of a result, between boxes
# Points across a tile, between, below; of its picture.
_TILE, _TILE_GAP, _CAPTION, _PROPORTION = 172.0, 16.0, 38.0, 0.6
_PILL, _PILL_WIDTH = 40.0, 184.0  # points: tiles without pictures
# Points of width from which the name stands beside the heading; that it takes.
_BESIDE, _NAMES = 985.0, (412.0, 492.0)
# Points: of the title of the box for a folder; from which it shares a row with the name, which has this share of it.
_FOLDER, _SHARED, _SHARE_OF_NAME = 40.0, 480.0, 0.62
_LOWEST, _LEAST_PICTURE = 0.65, 24.0  # of a picture's height that it keeps where one more row fits then; points
_EXPLAINED, _MOST_EXPLAINED = 2, 6  # lines of explanation: of boxes, and at most
_LOW, _SHARE = 240.0, 0.35  # points of a height that explains nothing, and share of what is above that
_TOLD, _APART = 11.0, 14.0  # points: type and distance of lines of an explanation

Item = Box | Reading | Tile


class _Line(NamedTuple):
    """A row of items, with the heading above it, if it is the first of a section. columns: that it has, full or not."""

    section: str
    items: Sequence[Item]
    columns: int = 1


def compose_form(form: Form, view: View, theme: Theme) -> Picture:
    """A form as marks in the pixels of the view's viewport. Reads the form, changes nothing."""
    v, window = view.aside or view.camera.viewport, view.camera.viewport
    paper, thin = Paper(view.pixel_ratio, view.pointer), max(round(view.pixel_ratio), 1)
    sides = [v.left] * (v.left > window.left) + [v.left + v.width - thin] * (v.right < window.right)
    paper.marks += [Panel(x, v.top, thin, v.height, 0.0, theme.line) for x in sides]
    FormLayout(form, v, paper, theme, view.status.hint)
    put_menu(paper, view, theme)
    put_help(paper, view, v, theme)
    return Picture(v, theme.panel, paper.marks, hits=paper.hits)


class FormLayout:
    """Places the parts of a form on a paper: what stays at the top, the rows that are scrolled, what stays at the bottom.

    These are boxes, readings, tiles, and the buttons "close" and "accept". lines: all rows, in sight or not.
    """

    def __init__(self, form: Form, viewport: Viewport, paper: Paper, theme: Theme, hint: str = "") -> None:
        self.form, self.v, self.paper, self.theme, self.u = form, viewport, paper, theme, paper.unit
        self.selected, self.chosen = form.selected, form.chosen
        self.width = max(min(self.v.width - 2 * _EDGE * self.u, _WIDEST * self.u), 1.0)
        # it stays, tiles are scrolled
        self.files = next((box for box in form.boxes if box.target == "name"), None)
        lines = _tile_lines(form, self.width / self.u) if self.files else _box_lines(form, self.width, self.u)
        self.lines = list(lines)
        self._put(hint)

    @property
    def places(self) -> list[Hit]:
        """All that can be pressed or read, and where it is."""
        return [hit for hit in self.paper.hits if isinstance(hit.item, Item)]

    def at(self, pixel: Vector) -> Hit | None:
        """What is at a pixel."""
        return next((hit for hit in reversed(self.paper.hits) if hit.contains(pixel)), None)

    def place_of(self, item: object) -> Hit | None:
        """Where a box, tile or button is; None if it is scrolled away."""
        return next((hit for hit in self.paper.hits if hit.item is item), None)

    def _put(self, hint: str) -> None:
        paper, u, v, width, theme = self.paper, self.u, self.v, self.width, self.theme
        left = v.left + (v.width - width) / 2
        sections = [reading.section for reading in self.form.readings]
        readings = [
            _Line("" if section in sections[:number] else section, [reading])
            for number, (section, reading) in enumerate(zip(sections, self.form.readings, strict=True))
        ]  # they stay while boxes are scrolled
        if len(readings) * _READING * u > 0.4 * (v.height - 100.0 * u):
            self.lines, readings = readings + self.lines, []
        message = Text(self.form.message, 12.0, theme.problem, lines=ALL, apart=16.0)
        said = Column([message] * bool(message.text), around=(0.0, 3.0, 3.0), high=22.0 if self.files else 8.0)
        head = Column(
            (*self._header(), *(self._row(line, 0.0) for line in readings), said), around=(0.0, 12.0, 0.0)
        )
        foot = self._footer(hint, None)
        top, bottom = v.top + head.height(u, width), v.bottom - foot.height(u, width)
        paper.put(head, Rectangle(left, v.top, width, top - v.top))
        picture = self._picture_height(bottom - top)
        rows = [self._row(line, picture) for line in self.lines]
        beside = (v.right - left - width) / u - 3.0
        scroll = Scroll(rows, first=self.form.first, bar=theme.muted, beside=beside)
        paper.put(scroll, Rectangle(left, top, width, max(bottom - top, 0.0)))
        hovered = [hit.item for hit in paper.hits if paper.is_under_pointer(hit)]
        paper.put(
            self._footer(hint, hovered[-1] if hovered else None),
            Rectangle(left, bottom, width, v.bottom - bottom),
        )

    # --- what stands in fixed places -------------------------------------------------------------

    def _header(self) -> list[Part]:
        """The heading, the button that leaves the form, and the box for a name beside or below it."""
        theme, u, heading = self.theme, self.u, begun(tr(self.form.heading))
        title = Text(heading, (19.0, 16.0, 14.0), theme.text, "semibold", grow=1.0)
        close = closing(None, theme, 24.0, "close")
        if self.files is None:
            return [Row((title, close), 8.0, high=28.0)]
        beside = self.width >= _BESIDE * u
        shares = not beside and self.width >= _SHARED * u
        wide = _SHARE_OF_NAME * self.width / u if shares else min(_NAMES[not beside], self.width / u)
        name = bare_box(self.files, (wide - 80.0) * u, theme, u, selected=self.files is self.selected, grow=1.0)
        said = Text(tr(self.form.accept), 13.0, theme.text, "semibold", "centre", grow=1.0)
        inside = Row((said,), around=(8.0, 0.0, 0.0), wide=64.0)
        accept = button(inside, None, theme, stands_out=True, item="accept", inset=0.0)
        both = Row((name, accept), 8.0, wide=wide, high=26.0)
        room = (1.0 - _SHARE_OF_NAME * shares) * self.width - (_FOLDER + 32.0) * u
        others = [self._beside_title(box, room) for box in self.form.boxes if box is not self.files]
        if beside:
            return [Row((title, both, close), 8.0, high=28.0), Gap(high=5.0), *others]
        rows = [Row((both, *others), 16.0)] if shares else [Row((both,)), Gap(high=5.0), *others]
        return [Row((title, close), 8.0, high=28.0), Gap(high=6.0), *rows]

    def _beside_title(self, box: Box, room: float) -> Row:
        """A box with its title in front of it."""
        bare = bare_box(box, room, self.theme, self.u, selected=box is self.selected, grow=1.0)
        return Row((Text(box.said_title, 12.0, self.theme.muted), bare), 8.0, high=26.0, grow=1.0)

    def _footer(self, hint: str, hovered: object) -> Column:
        """The explanation of what is pointed at, chosen or selected, and the next possible steps."""
        items: list[Tile | Box] = [*self.form.tiles, *self.form.boxes]
        texts = [tr(item.explanation) for item in items]
        needed = (
            Text(text, _TOLD, self.theme.text, lines=ALL, apart=_APART).height(self.u, self.width)
            for text in texts
        )
        least = 0.0 if len(self.form.tiles) else _EXPLAINED * _APART * self.u
        most = min(_MOST_EXPLAINED * _APART, _SHARE * (self.v.height / self.u - _LOW))
        high = max(min(max((least, *needed)) / self.u, most), 0.0)
        told, colour = self._explanation(hovered)
        text = Text(
            told if high >= _APART else "", _TOLD, colour, lines=max(int(high / _APART + 0.01), 1), apart=_APART
        )
        steps = Text(_steps(hint, self.width, font_size(12.0, self.u)), 12.0, self.theme.muted)
        return Column((Column((text, Gap(grow=1.0)), high=high), Row((steps,), high=24.0)))

    def _explanation(self, hovered: object) -> tuple[str, Colour]:
        """What is said about the item under the pointer, else about the chosen or selected one; and its colour."""
        for item in (hovered, self.chosen, self.selected, self.files):
            if isinstance(item, Box) and item.problem:
                return f"{item.said_title}: {item.problem}", self.theme.problem
            if isinstance(item, Item) and item.explanation:
                return tr(item.explanation), self.theme.text
        return "", self.theme.text

    # --- rows ------------------------------------------------------------------------------------

    def _row(self, line: _Line, picture: float) -> Column:
        """A row of items below its heading. picture: points that the pictures of tiles are high."""
        title = Row((Text(tr(line.section), 13.0, self.theme.text, "semibold"),), high=_SECTION)
        pills, of_tiles = _are_pills(line.items), isinstance(line.items[0], Tile)
        gap = _TILE_GAP if of_tiles and not pills else _GAP
        each = (self.width - (line.columns - 1) * gap * self.u) / line.columns
        parts = [self._item(item, each, picture, pills) for item in line.items]
        row = Row(
            [*parts, *[Gap()] * (line.columns - len(parts))],
            gap,
            (0.0, 0.0, gap * of_tiles),
            even=True,
            top=True,
        )
        return Column((title, row) if line.section else (row,))

    def _item(self, item: Item, width: float, picture: float, pills: bool) -> Part:
        theme = self.theme
        if isinstance(item, Box):
            return titled_box(item, width, theme, self.u, selected=item is self.selected)
        if isinstance(item, Tile):
            return self._pill(item, width) if pills else self._tile(item, width, picture)
        name = Text(tr(item.title), 12.0, theme.muted, grow=1.0)
        return Plate(Row((name, Text(item.text, 12.0, theme.text, "semibold")), 8.0, high=_READING), item=item)

    def _pill(self, tile: Tile, width: float) -> Plate:
        """A tile without a picture: its symbol, and beside it its title and its caption."""
        theme = self.theme
        sign = Drawn(partial(_symbol, tile, theme), 42.0)
        row = Row((sign, self._legend(tile, width - 50.0 * self.u), Gap(8.0)), high=_PILL)
        return Plate(self._card(row, tile, 8.0), item=tile)

    def _tile(self, tile: Tile, width: float, picture: float) -> Plate:
        """A picture of the model, its title and its caption."""
        drawn = Drawn(partial(_picture, tile, self.theme), high=picture)
        legend = Column((self._legend(tile, width),), high=_CAPTION)
        return Plate(Column((self._card(drawn, tile, 6.0), legend)), item=tile)

    def _card(self, inside: Part, tile: Tile, radius: float) -> Plate:
        """The paper of a tile, with a ring around it when Return or a click opens it."""
        theme = self.theme
        card = Plate(inside, theme.background, theme.line, theme.background, theme.focus, radius)
        return Plate(card, theme.focus if tile is self.chosen else None, radius=radius + 2.0, inset=-2.5)

    def _legend(self, tile: Tile, width: float) -> Column:
        """The title in at most two lines, and the caption if one is enough."""
        title = Text(tile.title, 12.5, self.theme.text, "semibold", lines=2, apart=15.5)
        caption = Text(tile.caption, 11.0, self.theme.muted, apart=15.5)
        fits = title.height(self.u, width) < 16.0 * self.u
        return Column((title, caption) if fits else (title,), around=(0.0, 4.5, 0.0), grow=1.0)

    def _picture_height(self, room: float) -> float:
        """Points of the pictures of tiles: fewer until two sections begin in sight, and where one more row fits then."""
        columns = _tile_columns(self.width / self.u)
        high = (self.width / self.u - (columns - 1) * _TILE_GAP) / columns * _PROPORTION
        pictured = [isinstance(line.items[0], Tile) and not _are_pills(line.items) for line in self.lines]
        ends = [number + 1 for number, has in enumerate(pictured) if has]
        begin = [end for end in ends if self.lines[end - 1].section]
        needed = max(begin[:2], default=0)
        for end in reversed(ends):
            fixed = sum(self._row(line, 0.0).height(self.u, self.width) for line in self.lines[:end])
            each = (room - fixed) / sum(pictured[:end]) / self.u
            if each >= (_LEAST_PICTURE if end <= needed else _LOWEST * high):
                return min(each, high)
        return _LEAST_PICTURE if ends else high


def _picture(tile: Tile, theme: Theme, place: Rectangle, u: float) -> list[Mark]:
    """The model of a tile, or its symbol."""
    if tile.picture is not None:
        box = [round(number) for number in place.box]
        return [*thumbnail(tile.picture, Viewport(*box), u, theme)]
    size = font_size(32.0, u)
    return [Written(tile.symbol, *place.middle, size, theme.muted, anchor="centre")] if tile.symbol else []


def _symbol(tile: Tile, theme: Theme, place: Rectangle, u: float) -> list[Mark]:
    """The symbol of a tile without a picture, in a disc."""
    disc = Stamps("disc", np.array([place.middle]), 12.0 * u, u, faded(theme.focus, 0.14), theme.background)
    return [disc, Written(tile.symbol, *place.middle, font_size(15.0, u), theme.focus, anchor="centre")]


def _steps(hint: str, width: float, size: int) -> str:
    """The next possible steps, as many as there is room for; the last says how to leave."""
    steps = hint.split(BETWEEN)
    while len(steps) > 2 and text_width(BETWEEN.join(steps), size) > width:
        del steps[-2]
    return BETWEEN.join(steps)


# --- which items share a row -------------------------------------------------------------------------


def _box_lines(form: Form, width: float, u: float) -> Iterator[_Line]:
    """Boxes by sections: the two components of a vector share a row, and so do single boxes, if their titles fit."""
    half = (width - _GAP * u) / 2
    for section, those in groupby(form.boxes, lambda box: box.section):
        own = section == form.heading
        title = PROPERTIES if own and len(form.readings) else "" if own else section
        for (_, columns), some in groupby(
            those, lambda box: (box.vector, box.across or 1 + is_short(box, half, u))
        ):
            for row in in_rows(list(some), columns):
                yield _Line(title, row, columns)
                title = ""


def _tile_lines(form: Form, width: float) -> Iterator[_Line]:
    """Tiles by sections; of a section with a tile that stands for the rest one row."""
    shown = (tile for tile in form.tiles if not tile.hidden)
    for section, group in groupby(shown, lambda tile: tile.section):
        tiles = list(group)
        pills = _are_pills(tiles)
        columns = max(int((width + _GAP) / (_PILL_WIDTH + _GAP)), 1) if pills else _tile_columns(width)
        those, rest = [t for t in tiles if not t.rest], [t for t in tiles if t.rest]
        if rest and len(those) > columns:
            those = [*those[: max(columns - 1, 1)], *rest[: columns - 1]]  # of one column the first tile only
        rows = in_rows(those, columns)
        if pills:  # rows equally long but for the last, none wider than two
            rows = in_rows(those, math.ceil(len(those) / len(rows)))
            columns = max(len(rows[0]), math.ceil(width / (2 * _PILL_WIDTH + _GAP)))
        for number, row in enumerate(rows):
            yield _Line("" if number else section, row, columns)


def _are_pills(items: Sequence[Item]) -> bool:
    """True for tiles without pictures."""
    return all(isinstance(item, Tile) and item.symbol for item in items)


def _tile_columns(width: float) -> int:
    """How many tiles stand side by side in a width in points."""
    return max(int((width + _TILE_GAP) / (min(_TILE, 0.45 * width) + _TILE_GAP)), 1)
