"""Listings: a table of results beside a model, with heads that order its rows, of which only those in sight are made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from pinjoint.components.camera import Viewport
from pinjoint.components.language import begun, tr
from pinjoint.components.view import Listing, View
from pinjoint.systems.render.marks import Panel, Picture
from pinjoint.systems.render.theme import Colour, Theme, faded, pale
from pinjoint.systems.render.typography import font_size, text_width
from pinjoint.systems.render.ui.buttons import button, closing
from pinjoint.systems.render.ui.layout import Column, Gap, Paper, Part, Plate, Row, Text

_BAR, _HEADS, _ROW, _EDGE = 28.0, 44.0, 18.0, 8.0  # points: high, of titles, heads and rows; around all
# Points: of type, across a column at least, between columns.
_SIZES = ((11.0, 46.0, 10.0), (9.0, 36.0, 4.0), (9.0, 0.0, 3.0))
_NAME, _WIDEST = 110.0, 30.0  # points: across names at most, and what a column gets more where there is room
_WHEEL = "table up", "table down"
PRESSED = "press table"  # the action of all that can be pressed in it


def rows_in(place: Viewport, unit: float) -> int:
    """How many rows a listing shows there."""
    return max(int((place.height / unit - height_of(0) + _EDGE / 2) / _ROW), 1)


def height_of(rows: int) -> float:
    """Points that a listing takes for so many rows."""
    return _BAR + _HEADS + rows * _ROW + _EDGE


def compose_listing(listing: Listing, view: View, theme: Theme) -> Picture:
    """A listing as marks in its part of the viewport."""
    v, paper = view.table_place, Paper(view.pixel_ratio, view.pointer)
    u, thin = paper.unit, max(round(paper.unit), 1)
    below = v.top > view.camera.viewport.top
    paper.marks.append(Panel(v.left, v.top, *((v.width, thin) if below else (thin, v.height)), 0.0, theme.line))
    size, gap, widths = _widths(listing, v.width, u)
    ink = pale(theme.text, theme.panel) if view.provisional else theme.text
    heads = Row([*_heads(listing, widths, size, theme)], gap, (_EDGE, 2.0, 3.0), high=_HEADS)
    rows: list[Part] = [_bar(listing, view, theme), heads]
    for number, selected, texts in listing.rows:
        cells = [
            Text(text, (size, 9.0), ink if at else theme.muted, anchor="right" if at else "left", wide=wide)
            for at, (text, wide) in enumerate(zip(texts, widths, strict=True))
        ]
        inside = Row(cells, gap, (_EDGE, 0.0, 0.0), high=_ROW)
        fill, hover = faded(theme.focus, 0.16) if selected else None, faded(theme.focus, 0.08 + 0.08 * selected)
        row = Plate(inside, fill, hover=hover, radius=0.0, action=PRESSED, item=("row", number))
        rows.append(replace(row, wheel=_WHEEL))
    paper.put(Plate(Column((*rows, Gap(grow=1.0))), action="", wheel=_WHEEL), v)
    if (hidden := listing.count - len(listing.rows)) > 0:
        top, room = v.top + (_BAR + _HEADS) * u, v.height - (_BAR + _HEADS) * u
        length = max(room * len(listing.rows) / listing.count, 16.0 * u)
        top += (room - length) * listing.first / hidden
        paper.marks.append(Panel(v.right - 5.0 * u, round(top), 3.0 * u, round(length), 0.0, theme.muted))
    return Picture(v, theme.panel, paper.marks, hits=paper.hits)


def _widths(listing: Listing, width: float, u: float) -> tuple[float, float, list[float]]:
    """The size of type, the gap between columns, and the points across each: as what is in sight needs, then more."""
    columns = zip(listing.heads, *(texts for _, _, texts in listing.rows), strict=True)
    said = [([*title.split(), f"{unit} ↑"], texts) for (title, unit), *texts in columns]
    for size, least, gap in _SIZES:
        font = font_size(size, u)
        needed = [
            max(least, *(text_width(t, font, weight) / u for words, weight in both for t in words))
            for both in (((heads, "semibold"), (texts, "regular")) for heads, texts in said)
        ]
        needed[0] = min(max(needed[0], text_width(listing.longest, font) / u), _NAME)
        spare = width / u - 2 * _EDGE - sum(needed) - gap * (len(needed) - 1)
        if spare >= 0.0:
            break
    more = min(spare / len(needed), _WIDEST)
    return size, gap, [points + more for points in needed]


def _bar(listing: Listing, view: View, theme: Theme) -> Part:
    """The titles of all tables, what can be done with the one that is shown, and the button that closes it."""
    looks = partial(button, theme=theme, inset=0.0)
    tabs = []
    for n, title in enumerate(listing.titles):
        text, shown = _padded(title, 12.0, theme.text, "semibold"), title == listing.title
        tabs.append(looks(text, PRESSED, pressed=shown, item=("title", n)))
    said = Text(view.provisional, 11.0, theme.halted, "semibold", grow=1.0)
    saves = [
        looks(_padded(title, 11.0, theme.muted), action)
        for title, action in ((tr("copy"), "copy table"), (tr("CSV"), "save table"))
    ]
    close = closing("toggle table", theme, 20.0, size=0.75)
    return Row((*tabs, Gap(4.0), said, *saves, close), 2.0, (_EDGE, 3.0, 3.0), high=_BAR)


def _padded(title: str, points: float, colour: Colour, weight: str = "regular") -> Part:
    return Row((Text(begun(title), points, colour, weight),), around=(6.0, 0.0, 0.0))


def _heads(listing: Listing, widths: Sequence[float], size: float, theme: Theme) -> Iterator[Part]:
    """Titles and units, with an arrow at the one by which the rows are ordered."""
    for number, ((title, unit), wide) in enumerate(zip(listing.heads, widths, strict=True)):
        arrow = (" ↓" if listing.falls else " ↑") if number == listing.by else ""
        anchor = "right" if number else "left"
        lines = (
            Text(title, size, theme.text, "semibold", anchor, lines=2, apart=13.0),
            Text(f"{unit}{arrow}".strip(), size, theme.muted, anchor=anchor, apart=13.0),
        )
        inside = Column((Gap(grow=1.0), *lines), wide=wide)
        yield button(inside, PRESSED, theme, item=("head", number), again=True, inset=-3.0)
