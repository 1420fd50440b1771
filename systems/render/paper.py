"""Paper: headings, texts, tables, matrices and pictures on pages of A4, as a PDF; the same contents give the same file."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any
from xml.sax.saxutils import escape

from reportlab.lib.colors import Color, black
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus import Flowable, KeepTogether, Paragraph, SimpleDocTemplate, Spacer, Table

from components.wording import UNPRINTABLE
from systems.render.marks import Picture
from systems.render.pdf import draw_picture, embed_fonts

embed_fonts()  # widths of texts are wanted before there is a page

REGULAR, BOLD = "Inter regular", "Inter semibold"
MARGIN = 18 * mm
WIDTH = A4[0] - 2 * MARGIN  # points of a column of text
PIXEL = 0.6  # points of a pixel of a picture
_FRAME = 6.0  # points that frames of reportlab leave inside margins
_GUTTER = 5 * mm  # between what stands side by side
_GREY = Color(0.35, 0.38, 0.45)
_SIZE, _TABLE = 9.0, 7.6  # points of text, and of what tables contain
_LEAST = 6.2  # points of a wide table; wider ones are divided
_PADDING = 3.2  # points to either side of what is in a table

_STYLES = {
    "title": ParagraphStyle("title", fontName=BOLD, fontSize=16, leading=20, spaceAfter=1 * mm),
    "subtitle": ParagraphStyle("subtitle", fontName=REGULAR, fontSize=_SIZE, leading=12, textColor=_GREY),
    "heading": ParagraphStyle(
        "heading",
        fontName=BOLD,
        fontSize=11,
        leading=14,
        spaceBefore=5 * mm,
        spaceAfter=1.5 * mm,
        keepWithNext=1,
    ),
    "text": ParagraphStyle("text", fontName=REGULAR, fontSize=_SIZE, leading=13, spaceAfter=1 * mm),
    "equation": ParagraphStyle(
        "equation", fontName=REGULAR, fontSize=9.5, leading=15, leftIndent=6 * mm, spaceAfter=1 * mm
    ),
    "result": ParagraphStyle(
        "result", fontName=BOLD, fontSize=10, leading=15, leftIndent=6 * mm, spaceAfter=1 * mm
    ),
    "caption": ParagraphStyle(
        "caption", fontName=REGULAR, fontSize=8, leading=10, textColor=_GREY, spaceAfter=1 * mm
    ),
}


def text(words: str, style: str = "text") -> Paragraph:
    """A paragraph: "title", "subtitle", "heading", "text", "equation", "result" or "caption"."""
    return Paragraph(escape(UNPRINTABLE.sub("�", words)), _STYLES[style])


def together(*parts: Flowable) -> Flowable:
    """Parts that no page break separates, unless they are longer than a page."""
    return KeepTogether(list(parts))


class Figure(Flowable):  # type: ignore[misc]
    """A picture, with a caption below it."""

    def __init__(self, picture: Picture, caption: str) -> None:
        super().__init__()
        self._picture = picture
        self._caption = text(caption, "caption")
        self.width, self.height = PIXEL * picture.viewport.width, PIXEL * picture.viewport.height

    def wrap(self, width: float, height: float) -> tuple[float, float]:
        """Its size in points."""
        _, self._below = self._caption.wrap(self.width, height)
        return self.width, self.height + self._below

    def draw(self) -> None:
        """Draw it at the origin of the canvas."""
        page = self.canv
        self._caption.drawOn(page, 0, 0)
        page.saveState()
        page.translate(0, self._below)
        page.scale(PIXEL, PIXEL)
        draw_picture(page, self._picture, self._picture.viewport.height)
        page.restoreState()


HALF = (WIDTH - _GUTTER) / 2  # points


def beside(left: Sequence[Flowable], right: Sequence[Flowable]) -> Flowable:
    """Parts side by side, which no page break separates."""
    row = Table([[list(left), list(right)]], colWidths=[HALF + _GUTTER, HALF], hAlign="LEFT")
    row.setStyle(
        [
            ("LEFTPADDING", (0, 0), (-1, -1), 0),
            ("RIGHTPADDING", (0, 0), (-1, -1), 0),
            ("TOPPADDING", (0, 0), (-1, -1), 0),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 0),
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ]
    )
    return row


def tables(
    head: Sequence[str], rows: Sequence[Sequence[str]], *, summed: bool, width: float = WIDTH
) -> list[Flowable]:
    """A table under a head, of which lines are parted by "\\n"; side by side what is wider than a page, below each other.

    summed: the last row stands below a rule.
    """
    whole = [list(head), *map(list, rows)]
    found: list[Flowable] = []
    for columns in _fitting(whole, width):
        size = _size([[row[at] for at in columns] for row in whole], width)
        shown = [["\n".join(_printable(row[at])) for at in columns] for row in whole]
        made = Table(shown, repeatRows=1, hAlign="LEFT", spaceAfter=2 * mm, spaceBefore=1 * mm)
        style: list[tuple[Any, ...]] = [
            ("FONT", (0, 0), (-1, -1), REGULAR, size, 1.25 * size),
            ("FONT", (0, 0), (-1, 0), BOLD, size, 1.25 * size),
            ("ALIGN", (1, 0), (-1, -1), "RIGHT"),
            ("VALIGN", (0, 0), (-1, 0), "BOTTOM"),
            ("LEFTPADDING", (0, 0), (-1, -1), _PADDING),
            ("RIGHTPADDING", (0, 0), (-1, -1), _PADDING),
            ("TOPPADDING", (0, 0), (-1, -1), 1.2),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 1.8),
            ("LINEABOVE", (0, 0), (-1, 0), 0.8, black),
            ("LINEBELOW", (0, 0), (-1, 0), 0.4, black),
            ("LINEBELOW", (0, -1), (-1, -1), 0.8, black),
        ]
        if summed:
            style += [
                ("LINEABOVE", (0, -1), (-1, -1), 0.4, black),
                ("FONT", (0, -1), (-1, -1), BOLD, size, 1.25 * size),
            ]
        made.setStyle(style)
        found.append(made)
    return found


def _widths(cells: Sequence[Sequence[str]], size: float) -> list[float]:
    """Of columns of cells (points)."""
    return [
        max(stringWidth(line, BOLD, size) for cell in column for line in _printable(cell)) + 2 * _PADDING
        for column in zip(*cells, strict=True)
    ]


def _printable(cell: str) -> list[str]:
    """The lines of a cell."""
    return [UNPRINTABLE.sub("�", line) for line in cell.split("\n")]


def _size(cells: Sequence[Sequence[str]], room: float) -> float:
    """The size of type with which cells fit beside each other, at most the usual one."""
    size = _TABLE
    while size > _LEAST and sum(_widths(cells, size)) > room:
        size -= 0.2
    return size


def _fitting(cells: Sequence[Sequence[str]], whole: float) -> list[list[int]]:
    """Columns in groups that fit beside each other, each behind the first column."""
    widths = _widths(cells, _LEAST)
    groups, room = [[0]], whole - widths[0]
    for at, width in enumerate(widths[1:], start=1):
        if width > room and len(groups[-1]) > 1:
            groups.append([0])
            room = whole - widths[0]
        groups[-1].append(at)
        room -= width
    return groups


class Matrices(Flowable):  # type: ignore[misc]
    """Matrices and signs in one line, such as [δ]{X} + {δ₀} = {0}: a list of rows for each matrix, a text for each sign."""

    _FONT, _STEP, _GAP, _REACH = 9.0, 14.0, 9.0, 3.0

    def __init__(self, parts: Sequence[str | Sequence[Sequence[str]]]) -> None:
        super().__init__()
        self._parts = parts
        widest = sum(self._wide(part) + self._GAP for part in parts) + 17.0
        self._font = self._FONT * min(1.0, WIDTH / widest)
        rows = max(len(part) for part in parts if not isinstance(part, str))
        self.width, self.height = WIDTH, rows * self._STEP + 6.0

    def _columns(self, part: Sequence[Sequence[str]], font: float) -> list[float]:
        return [max(stringWidth(cell, REGULAR, font) for cell in column) for column in zip(*part, strict=True)]

    def _wide(self, part: str | Sequence[Sequence[str]], font: float = _FONT) -> float:
        if isinstance(part, str):
            return float(stringWidth(part, REGULAR, font))
        return sum(self._columns(part, font)) + self._GAP * (len(part[0]) - 1) + 4 * self._REACH

    def wrap(self, width: float, height: float) -> tuple[float, float]:
        """Its size in points."""
        return self.width, self.height

    def draw(self) -> None:
        """Draw it at the origin of the canvas."""
        page, font = self.canv, self._font
        page.setFont(REGULAR, font)
        page.setFillColor(black)
        page.setStrokeColor(black)
        page.setLineWidth(0.7)
        middle, x = self.height / 2, 17.0
        for part in self._parts:
            wide = self._wide(part, font)
            if isinstance(part, str):
                page.drawString(x, middle - 0.35 * font, part)
            else:
                self._matrix(part, x, middle, wide)
            x += wide + self._GAP

    def _matrix(self, part: Sequence[Sequence[str]], x: float, middle: float, wide: float) -> None:
        page, font = self.canv, self._font
        high = len(part) * self._STEP / 2
        for side, inward in ((x, self._REACH), (x + wide, -self._REACH)):
            page.line(side, middle - high, side, middle + high)
            for end in (middle - high, middle + high):
                page.line(side, end, side + inward, end)
        right = x + 2 * self._REACH
        for at, column in enumerate(self._columns(part, font)):
            right += column
            for row, cells in enumerate(part):
                page.drawRightString(right, middle + high - (row + 0.5) * self._STEP - 0.35 * font, cells[at])
            right += self._GAP


def as_paper(title: str, parts: Sequence[Flowable], foot: str) -> bytes:
    """Parts below each other on as many pages as it takes, as the contents of a PDF file; foot: below every page."""
    made = io.BytesIO()

    def number(page: Any, document: Any) -> None:
        page.setFont(REGULAR, 7.5)
        page.setFillColor(_GREY)
        page.drawString(MARGIN, 10 * mm, UNPRINTABLE.sub("�", foot))
        page.drawRightString(A4[0] - MARGIN, 10 * mm, str(document.page))

    document = SimpleDocTemplate(
        made,
        pagesize=A4,
        leftMargin=MARGIN - _FRAME,
        rightMargin=MARGIN - _FRAME,
        topMargin=15 * mm,
        bottomMargin=17 * mm,
        title=UNPRINTABLE.sub("�", title),
        author="",
        creator="Pinjoint",
        invariant=1,
    )
    document.build(list(parts), onFirstPage=number, onLaterPages=number)
    return made.getvalue()


def gap(millimetres: float) -> Flowable:
    """Room."""
    return Spacer(0, millimetres * mm)
