"""Paper: headings, texts, tables, matrices and pictures on pages of A4, as a PDF; the same contents give the same file."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import Any
from xml.sax.saxutils import escape

from reportlab.lib.colors import Color, black
from reportlab.lib.pagesizes import A4, landscape
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus import (
    BaseDocTemplate,
    Flowable,
    Frame,
    NextPageTemplate,
    PageBreak,
    PageTemplate,
    Paragraph,
    Table,
)

from pinjoint.components.wording import UNPRINTABLE
from pinjoint.systems.render.backends.pdf import draw_picture, embed_fonts
from pinjoint.systems.render.marks import Picture

embed_fonts()  # widths of texts are wanted before there is a page

REGULAR, BOLD = "Inter regular", "Inter semibold"
MARGIN, _TOP, _BOTTOM = 16 * mm, 10 * mm, 11 * mm
ROOMS = [(wide - 2 * MARGIN, high - _TOP - _BOTTOM) for wide, high in (A4, landscape(A4))]  # points of pages
WIDTH = ROOMS[0][0]  # points of a column of text
PIXEL = 0.64  # points of a pixel of a picture
GUTTER = 4 * mm  # between what stands side by side
REST = 54 * mm  # the least width of a text that takes what is left of a row
_GREY = Color(0.35, 0.38, 0.45)
_LEAST = 7.5  # points of type; wider tables are divided
_PADDING = 2.6  # points to either side of what is in a table
_BRACKET, _BESIDE = 2.0, 2.5  # points: how far brackets of matrices reach, and beside their numbers

_STYLES = {  # font, size and leading relative to text, grey, space before and after in lines, indented
    "title": (BOLD, 1.6, 1.9, False, 0.0, 0.0, 0.0),
    "subtitle": (REGULAR, 0.95, 1.25, True, 0.0, 0.0, 0.0),
    "heading": (BOLD, 1.15, 1.4, False, 0.6, 0.15, 0.0),
    "text": (REGULAR, 1.0, 1.3, False, 0.0, 0.1, 0.0),
    "equation": (REGULAR, 1.0, 1.35, False, 0.0, 0.05, 1.0),
    "result": (BOLD, 1.05, 1.5, False, 0.0, 0.1, 1.0),
    "caption": (REGULAR, 0.9, 1.2, True, 0.0, 0.2, 0.0),
}

# parts below each other, and their width in points; 0: what is left of a row
Block = tuple[float, list[Flowable]]


@dataclass(frozen=True)
class Layout:
    """How large things are: type (points), the greatest height of a figure (points), and how many times as wide as high is
    a structure of which two figures stand in a row, not three."""

    size: float
    figure: float
    flat: float

    def text(self, words: str, style: str = "text") -> Paragraph:
        """A paragraph: "title", "subtitle", "heading", "text", "equation", "result" or "caption"."""
        font, size, leading, grey, before, after, indent = _STYLES[style]
        made = ParagraphStyle(
            style,
            fontName=font,
            fontSize=max(size * self.size, _LEAST),
            leading=max(size * self.size, _LEAST) * leading / size,
            spaceBefore=before * self.size,
            spaceAfter=after * self.size,
            leftIndent=indent * self.size,
            textColor=_GREY if grey else black,
            keepWithNext=style == "heading",
        )
        return Paragraph(escape(UNPRINTABLE.sub("�", words)), made)

    def tables(self, head: Sequence[str], rows: Sequence[Sequence[str]], *, summed: bool) -> list[Block]:
        """A table under a head, of which lines are parted by "\\n"; in several what is wider than a page.

        summed: the last row stands below a rule.
        """
        whole = [list(head), *map(list, rows)]
        found: list[Block] = []
        for columns in _fitting(whole, WIDTH):
            cells = [[row[at] for at in columns] for row in whole]
            size = max(0.9 * self.size, _LEAST)
            size = size if sum(_widths(cells, size)) <= WIDTH else _LEAST
            shown = [["\n".join(_printable(cell)) for cell in row] for row in cells]
            widths = _widths(cells, size)
            made = Table(shown, colWidths=widths, repeatRows=1, hAlign="LEFT", spaceAfter=0.5 * size)
            made.setStyle(_ruled(size, summed=summed))
            found.append((sum(widths), [made]))
        return found


LAYOUTS = (  # from the most comfortable to one by which most fits on a page
    Layout(9.2, 68 * mm, 0.0),
    Layout(9.0, 62 * mm, 1.6),
    Layout(8.4, 50 * mm, 1.6),
    Layout(7.8, 40 * mm, 2.6),
    Layout(7.5, 36 * mm, 9.0),
)


class Figure(Flowable):  # type: ignore[misc]
    """A picture, with a caption below it."""

    def __init__(self, picture: Picture, caption: Paragraph) -> None:
        super().__init__()
        self.picture, self.caption = picture, caption
        self.width, self.height = PIXEL * picture.viewport.width, PIXEL * picture.viewport.height

    @property
    def fills_page(self) -> bool:
        """Whether it is too large to stand among others."""
        return bool(max(self.width, self.height) > WIDTH)

    def wrap(self, width: float, height: float) -> tuple[float, float]:
        """Its size in points."""
        _, self._below = self.caption.wrap(self.width, height)
        return self.width, self.height + self._below

    def draw(self) -> None:
        """Draw it at the origin of the canvas."""
        page = self.canv
        self.caption.drawOn(page, 0, 0)
        page.saveState()
        page.translate(0, self._below)
        page.scale(PIXEL, PIXEL)
        draw_picture(page, self.picture, self.picture.viewport.height)
        page.restoreState()


def in_rows(blocks: Sequence[Block]) -> list[Flowable]:
    """Blocks side by side as they fit, row below row, which no page break separates."""
    found: list[Flowable] = []
    row: list[Block] = []
    for block in blocks:
        least = block[0] or REST
        taken = sum((width or REST) + GUTTER for width, _ in row)
        if row and taken + least > WIDTH + 0.5:
            found.append(_beside(row))
            row = []
        row.append(block)
    if row:
        found.append(_beside(row))
    return found


def _beside(row: Sequence[Block]) -> Flowable:
    flexible = sum(not width for width, _ in row)
    left = WIDTH - sum(width for width, _ in row) - GUTTER * (len(row) - 1)
    widths = [width or left / flexible for width, _ in row]
    gutter = GUTTER if flexible or len(row) < 2 else GUTTER + min(left / (len(row) - 1), 2 * GUTTER)
    columns = [width + gutter for width in widths[:-1]] + [widths[-1]]
    made = Table([[list(parts) for _, parts in row]], colWidths=columns, hAlign="LEFT")
    made.setStyle(
        [*_padded(0, 2), ("RIGHTPADDING", (0, 0), (-2, -1), gutter), ("VALIGN", (0, 0), (-1, -1), "TOP")]
    )
    return made


def _ruled(size: float, *, summed: bool) -> list[tuple[Any, ...]]:
    """The style of a table with a head and, perhaps, a sum at the foot."""
    style: list[tuple[Any, ...]] = [
        ("FONT", (0, 0), (-1, -1), REGULAR, size, 1.2 * size),
        ("FONT", (0, 0), (-1, 0), BOLD, size, 1.2 * size),
        ("ALIGN", (1, 0), (-1, -1), "RIGHT"),
        ("VALIGN", (0, 0), (-1, 0), "BOTTOM"),
        ("LEFTPADDING", (0, 0), (-1, -1), _PADDING),
        ("RIGHTPADDING", (0, 0), (-1, -1), _PADDING),
        ("TOPPADDING", (0, 0), (-1, -1), 0.03 * size),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 0.14 * size),
        ("LINEABOVE", (0, 0), (-1, 0), 0.8, black),
        ("LINEBELOW", (0, 0), (-1, 0), 0.4, black),
        ("LINEBELOW", (0, -1), (-1, -1), 0.8, black),
    ]
    if summed:
        style += [
            ("LINEABOVE", (0, -1), (-1, -1), 0.4, black),
            ("FONT", (0, -1), (-1, -1), BOLD, size, 1.2 * size),
        ]
    return style


def _widths(cells: Sequence[Sequence[str]], size: float) -> list[float]:
    """Of columns of cells (points)."""
    return [
        max(stringWidth(line, BOLD, size) for cell in column for line in _printable(cell)) + 2 * _PADDING
        for column in zip(*cells, strict=True)
    ]


def _printable(cell: str) -> list[str]:
    """The lines of a cell."""
    return [UNPRINTABLE.sub("�", line) for line in cell.split("\n")]


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


def matrices(parts: Sequence[str | Sequence[Sequence[str]]], layout: Layout) -> Block:
    """Matrices and signs in one line, such as [δ]{X} + {δ₀} = {0}: a list of rows for each matrix, a text for each sign."""

    def made(size: float) -> Table:
        cells: list[Any] = []
        style = [("FONT", (0, 0), (-1, -1), REGULAR, size, size), ("VALIGN", (0, 0), (-1, -1), "MIDDLE")]
        style += _padded(_BESIDE, 0)
        for at, part in enumerate(parts):
            if isinstance(part, str):
                cells.append(part)
                style.append(("RIGHTPADDING", (at, 0), (at, 0), 2 * _BESIDE))
                continue
            columns = [_BRACKET, *[None] * len(part[0]), _BRACKET]
            matrix = Table([["", *row, ""] for row in part], colWidths=columns, rowHeights=1.4 * size)
            matrix.setStyle(_in_brackets(size))
            cells.append([matrix])
        line = Table([cells], hAlign="LEFT", spaceBefore=3, spaceAfter=3)
        line.setStyle(style)
        return line

    size = max(0.92 * layout.size, _LEAST)
    line = made(size)
    line = line if line.minWidth() <= WIDTH else made(size * WIDTH / line.minWidth())
    return line.minWidth(), [line]


def _in_brackets(size: float) -> list[tuple[Any, ...]]:
    """The style of a matrix, whose first and last column are its brackets."""
    style: list[tuple[Any, ...]] = [
        ("FONT", (0, 0), (-1, -1), REGULAR, size, size),
        ("ALIGN", (0, 0), (-1, -1), "RIGHT"),
        ("VALIGN", (0, 0), (-1, -1), "MIDDLE"),
        *_padded(0, 0),
        ("LEFTPADDING", (1, 0), (-2, -1), _BESIDE),
        ("RIGHTPADDING", (1, 0), (-2, -1), _BESIDE),
    ]
    for column, upright in ((0, "LINEBEFORE"), (-1, "LINEAFTER")):
        for side, first, last in ((upright, 0, -1), ("LINEABOVE", 0, 0), ("LINEBELOW", -1, -1)):
            style.append((side, (column, first), (column, last), 0.7, black))
    return style


def _padded(right: float, below: float) -> list[tuple[Any, ...]]:
    sides = {"LEFT": 0.0, "RIGHT": right, "TOP": 0.0, "BOTTOM": below}
    return [(f"{side}PADDING", (0, 0), (-1, -1), points) for side, points in sides.items()]


def as_paper(
    title: str, made_of: Callable[[Layout], Sequence[Flowable]], foot: str, layouts: Sequence[Layout] = LAYOUTS
) -> bytes:
    """The contents of a PDF file: what is made in a layout, in the largest with which it takes the fewest pages of A4.

    foot: below every page. Figures wider than a column of text stand on pages turned on their side.
    """
    _, made = min((_built(title, made_of(layout), foot) for layout in layouts), key=itemgetter(0))
    return made


def _built(title: str, parts: Sequence[Flowable], foot: str) -> tuple[int, bytes]:
    """Parts below each other: the number of pages, and the contents of the file."""
    made = io.BytesIO()

    def number(page: Any, document: Any) -> None:
        page.setFont(REGULAR, _LEAST)
        page.setFillColor(_GREY)
        page.drawString(MARGIN, 6 * mm, UNPRINTABLE.sub("�", foot))
        if document.page > 1:
            page.drawRightString(page._pagesize[0] - MARGIN, 6 * mm, str(document.page))

    document = BaseDocTemplate(
        made,
        pageTemplates=[
            PageTemplate(
                str(turned), Frame(MARGIN, _BOTTOM, *ROOMS[turned], 0, 0, 0, 0), onPage=number, pagesize=size
            )
            for turned, size in enumerate((A4, landscape(A4)))
        ],
        title=UNPRINTABLE.sub("�", title),
        author="",
        creator="Pinjoint",
        invariant=1,
    )
    story: list[Flowable] = []
    for turned, some in groupby(parts, lambda part: isinstance(part, Figure) and part.width > WIDTH):
        story += [NextPageTemplate(str(int(turned))), PageBreak()] * bool(story) + list(some)
    document.build(story)
    return document.page, made.getvalue()
