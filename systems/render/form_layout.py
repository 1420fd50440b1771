"""Form layout: where boxes and tiles of a form are, in pixels, for drawing and for picking."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import groupby

from pinjoint.components.box import Box
from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.form import Form, Reading, Tile
from pinjoint.components.language import marked, tr, tr_in
from pinjoint.systems.render.typography import font_size, in_rows, text_width, wrapped

WIDEST = 1500.0  # points that tiles spread over
EDGE, CLOSE_EDGE, SLIM = 16.0, 10.0, 325.0  # points around all; in a viewport less wide than the last, less
LOW = 330.0  # points: a viewport less high does without explanations

TITLE, BOX, BELOW = 18.0, 26.0, 10.0  # points: title above a box, the box, to what follows
BOX_TITLE = 11.5  # points, size of type
PROBLEM = 14.0  # points that the reason for which a box is refused takes below it
READING, MOST_READINGS = 20.0, 0.4  # points of a row; share of the height that they take without being scrolled
MESSAGE, MESSAGE_LINE = 12.0, 16.0  # points, size of type and distance of lines of a message or explanation
HINT, EXPLAINED, MOST_EXPLAINED = 26.0, 2, 6  # points at the bottom; lines of explanation, usual and at most
SMALL, LOW_TYPE = 560.0, (11.0, 14.0)  # points: a viewport less high explains in smaller type, and lines apart
SECTION = 28.0
COLUMN_GAP = 10.0
HEADING = 104.0  # points, at least, where a low viewport has the box beside the heading, which is shortened
CLOSE, ACCEPT = (
    24.0,
    64.0,
)  # points, side of the button that leaves; least width of that which does what Return does
NARROW, NARROWEST = 140.0, 120.0  # points, a box less wide does not share its row; one of a vector
TILE, TILE_GAP, CAPTION, PROPORTION = 172.0, 16.0, 38.0, 0.6
PILL, PILL_WIDTH, PILL_GAP = 40.0, 184.0, 10.0  # points: tiles of a section without pictures
PILL_TITLE, PILL_TEXT, PILL_EDGE = (
    12.5,
    40.0,
    6.0,
)  # points: size of its title, where it begins, and room behind it
BESIDE, SEARCH = 985.0, 340.0  # points of width from which the name stands beside the heading; that it takes
LOWEST = 0.65  # share of a picture's height that it keeps where one more row fits then
LEAST_PICTURE = 24.0  # points
SECTIONS_SEEN = 2  # with pictures, that begin in sight in any window

PROPERTIES = marked("Properties")  # the heading of an element's own boxes, where its results stand above them

Row = str | list[Box] | list[Reading] | list[Tile]


@dataclass(frozen=True)
class Place(Rectangle):
    """The rectangle of a box (without its title), reading, tile or section heading."""

    item: Box | Reading | Tile | str


@dataclass(frozen=True)
class FormLayout:
    """The places of all parts of a form, in pixels.

    unit: pixels per point. left, right: the edges of all text. header: the middle of the heading's line, whose text
    has the room `heading_width`. message: the middle of the message's first line. top, bottom: the edges of the rows.
    rows: those that are scrolled. first, shown: the number of the first one in sight, and of those in sight.
    close, accept: the buttons that leave it, and that do what Return does. explained: how many lines an explanation has.
    """

    viewport: Viewport
    unit: float
    left: float
    right: float
    header: float
    heading_width: float
    message: float
    top: float
    bottom: float
    close: Rectangle
    accept: Rectangle | None
    explained: int = EXPLAINED
    first: int = 0
    shown: int = 0
    rows: list[Row] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)

    @property
    def count(self) -> int:
        """The number of rows that are scrolled."""
        return len(self.rows)

    def at(self, pixel: Vector) -> Box | Reading | Tile | None:
        """The box, reading or tile under a pixel."""
        found = (p.item for p in self.places if not isinstance(p.item, str) and p.contains(pixel))
        return next(found, None)

    def place_of(self, item: Box | Tile) -> Place | None:
        """Where a box or tile is; None if it is scrolled away."""
        return next((place for place in self.places if place.item is item), None)


def lay_out(form: Form, viewport: Viewport, unit: float) -> FormLayout:
    """Place all visible rows; rows that do not fit whole are scrolled away."""
    u, v = unit, viewport
    edge = EDGE if v.width >= SLIM * u else CLOSE_EDGE
    width = max(min(v.width - 2 * edge * u, WIDEST * u), 1.0)
    left = v.left + (v.width - width) / 2
    low = v.height < LOW * u
    header = v.top + (18.0 if low else 26.0) * u
    top = header + (16.0 if low else 24.0) * u
    explained = 0 if low else _lines_of_explanations(form, width, v, u)
    bottom = v.bottom - (22.0 if low else HINT + explanation_type(v, u)[1] * explained) * u
    close = Rectangle(left + width - CLOSE * u, header - CLOSE * u / 2, CLOSE * u, CLOSE * u)
    fixed: list[Place] = []
    accept, heading_width = None, width - (CLOSE + 8.0) * u
    if _has_files(form):
        fixed, accept, heading_width = _name_place(form, left, width, v, u)
        top = accept.bottom + 22.0 * u
        rows = list(_tile_rows(form, width / u))
    else:
        rows = list(_box_rows(form, width / u, u))
    readings = list(_reading_rows(form))
    if len(readings) * READING * u > MOST_READINGS * (bottom - top):
        rows, readings = readings + rows, []
    for row in readings:  # they stay while boxes are scrolled
        height = _height(row, 0.0, width, u)
        fixed += _placed(row, left, top, width, height, u)
        top += height
    lines = len(message_lines(form, width, u))
    message = (
        top + (0.5 * MESSAGE_LINE if readings else -11.0) * u
    )  # below the heading there is room for a line
    top += max(lines - (not readings), 0) * MESSAGE_LINE * u
    right, first = left + width, form.heading.first
    edges = left, right, header, heading_width, message, top, bottom
    return _with_rows(FormLayout(v, u, *edges, close, accept, explained, first), fixed, rows)


def explanation_type(v: Viewport, u: float) -> tuple[float, float]:
    """Points of the type of explanations, and between its lines."""
    return (MESSAGE, MESSAGE_LINE) if v.height >= SMALL * u else LOW_TYPE


def _lines_of_explanations(form: Form, width: float, v: Viewport, u: float) -> int:
    """How many lines the longest explanation takes, so that none is cut that is not very long."""
    size = font_size(explanation_type(v, u)[0], u)
    least = () if len(form.tiles) else (EXPLAINED,)
    lines = (_line_count(tr(item.explanation), width, size) for item in (*form.tiles, *form.boxes))
    return min(max((*least, *lines), default=EXPLAINED), MOST_EXPLAINED)


@lru_cache(maxsize=1000)
def _line_count(text: str, width: float, size: int) -> int:
    return len(wrapped(text, width, size))


def _name_place(
    form: Form, left: float, width: float, v: Viewport, u: float
) -> tuple[list[Place], Rectangle, float]:
    """The places of the box for a name and of the button beside it, and the heading's width.

    They stand beside the heading where there is room or little height, else below it.
    """
    said, head = tr(form.accept), tr(form.heading.text)
    pressed = max(text_width(said, font_size(13.0, u), "semibold") + 16.0 * u, ACCEPT * u)
    button, closes, heading = pressed + 8.0 * u, (CLOSE + 8.0) * u, width - (CLOSE + 8.0) * u
    x, top, room = left, v.top + 46.0 * u, 420.0 * u
    if v.height < LOW * u:
        least, most = HEADING * u, width - closes - button - NARROWEST * u
        taken = max(min(text_width(head, font_size(19.0, u), "semibold") + 9.0 * u, most), least)
        x, top, heading = left + taken, v.top + 6.0 * u, taken - 8.0 * u
        width -= taken + closes
    elif width >= BESIDE * u:
        room, top = SEARCH * u, v.top + 13.0 * u
        x = left + width - closes - button - room
        heading = x - left - COLUMN_GAP * u
    room = max(min(width - button, room), 40.0 * u)
    accept = Rectangle(x + room + 8.0 * u, top, pressed, BOX * u)
    return [Place(x, top, room, BOX * u, box) for box in form.boxes], accept, heading


def message_lines(form: Form, width: float, u: float) -> list[str]:
    """The message of a form, in lines."""
    return wrapped(form.heading.message, width, font_size(MESSAGE, u)) if form.heading.message else []


def _has_files(form: Form) -> bool:
    """True for forms that choose a file: their boxes stay, tiles are scrolled."""
    return any(box.target == "name" for box in form.boxes)


def _with_rows(layout: FormLayout, fixed: list[Place], rows: list[Row]) -> FormLayout:
    u, room, width = layout.unit, layout.bottom - layout.top, layout.right - layout.left
    picture = _picture_height(rows, width, room, u)
    heights = [_height(row, picture, width, u) for row in rows]
    first = min(layout.first, _last_first(heights, room))
    places, top, shown = list(fixed), layout.top, 0
    for row, height in zip(rows[first:], heights[first:], strict=True):
        if top + height > layout.bottom + 0.5 and shown:
            break
        beside = _most_beside(rows, first + shown)
        places += _placed(row, layout.left, top, width, height, u, beside)
        top += height
        shown += 1
    if shown > 1 and isinstance(rows[first + shown - 1], str):  # a heading without visible tiles
        places.pop()
    return replace(layout, first=first, shown=shown, rows=rows, places=places)


def _most_beside(rows: Sequence[Row], number: int) -> int:
    """How many items the first row of the section of a row has; the last one may have fewer."""
    while number and not isinstance(rows[number - 1], str):
        number -= 1
    return len(rows[number])


def _last_first(heights: Sequence[float], room: float) -> int:
    """The first row when scrolled to the end."""
    first, total = len(heights), 0.0
    while first > 0 and total + heights[first - 1] <= room + 0.5:
        first -= 1
        total += heights[first]
    return min(first, max(len(heights) - 1, 0))


def row_of(layout: FormLayout, item: Box | Tile) -> tuple[int, int]:
    """The number of the row in which a box or tile is, and that of the heading right above, else again of the row."""
    rows = layout.rows
    row = next(number for number, row in enumerate(rows) if not isinstance(row, str) and item in row)
    return row, row - 1 if row and isinstance(rows[row - 1], str) else row


# --- rows --------------------------------------------------------------------------------------------


def _reading_rows(form: Form) -> Iterator[Row]:
    for section, readings in groupby(form.readings, lambda reading: reading.section):
        yield section
        yield from in_rows(list(readings), 1)


def _box_rows(form: Form, width: float, u: float) -> Iterator[Row]:
    """Sections and boxes: the two components of a vector share a row, and so do single boxes, if their titles fit."""
    half = (width - COLUMN_GAP) / 2
    for section, boxes in groupby(form.boxes, lambda box: box.section):
        if section != form.heading.text or len(form.readings):
            yield section if section != form.heading.text else PROPERTIES
        for (vector, short), partners in groupby(boxes, lambda box: (_partner(box), _is_short(box, half, u))):
            yield from in_rows(list(partners), 2 if short and half >= (NARROWEST if vector else NARROW) else 1)


def _is_short(box: Box, width: float, u: float) -> bool:
    """True if the title of a box stands whole above it in so many points, with what is noted of its value."""
    unit = "" if box.text and box.text not in (box.words or ()) else box.unit
    beside = max(short_note(box.note), unit, key=len)
    said = f"{box.said_title} {beside}".rstrip()
    return text_width(said, font_size(BOX_TITLE, u)) + 8.0 * u * bool(beside) <= width * u


def short_note(note: str) -> str:
    """What is noted of the value of a box, where there is little room."""
    return note.replace(tr("automatic"), tr_in("note of a box", "auto"))


def _partner(box: Box) -> str:
    """The key that boxes of one row share: the vector that they belong to, or that they are single."""
    table, name, *axis = box.target.split(".")
    return f"{table}.{name}" if axis else ""


def _tile_rows(form: Form, width: float) -> Iterator[Row]:
    """Sections and tiles; of a section with a tile that stands for the rest one row."""
    shown = (tile for tile in form.tiles if not tile.hidden)
    for section, group in groupby(shown, lambda tile: tile.section):
        tiles = list(group)
        columns = pill_columns(width) if _are_pills(tiles) else tile_columns(width)
        those, rest = [t for t in tiles if not t.rest], [t for t in tiles if t.rest]
        if rest and len(those) > columns:
            those = [*those[: max(columns - 1, 1)], *rest[: columns - 1]]  # of one column the first tile only
        if section:
            yield section
        if _are_pills(tiles):  # rows about equally long, the longer ones first
            least, longer = divmod(len(those), math.ceil(len(those) / columns))
            yield from in_rows(those[: longer * (least + 1)], least + 1)
            those, columns = those[longer * (least + 1) :], least
        yield from in_rows(those, columns)


def _are_pills(tiles: Sequence[Tile]) -> bool:
    """True for tiles without pictures."""
    return all(tile.symbol for tile in tiles)


def tile_columns(width: float) -> int:
    """How many tiles stand side by side in a width in points."""
    return max(int((width + TILE_GAP) / (min(TILE, 0.45 * width) + TILE_GAP)), 1)


def pill_columns(width: float) -> int:
    """How many tiles without pictures stand side by side in a width in points."""
    return max(int((width + PILL_GAP) / (PILL_WIDTH + PILL_GAP)), 1)


def _height(row: Row, picture: float, width: float, u: float) -> float:
    if isinstance(row, str):
        return SECTION * u
    if isinstance(row[0], Reading):
        return READING * u
    if isinstance(row[0], Box):
        each = _box_width(row, width, u)
        return (TITLE + BOX + BELOW + PROBLEM * max(len(problem_lines(box, each, u)) for box in row)) * u
    return (PILL + PILL_GAP) * u if _are_pills(row) else picture + (CAPTION + TILE_GAP) * u


def _box_width(row: Sequence[Box], width: float, u: float) -> float:
    """Pixels that each box of a row is wide: half of the row unless a single one needs it all."""
    half = (width - COLUMN_GAP * u) / 2
    alone = half < NARROW * u or not _is_short(row[0], half / u, u)
    return width if alone and len(row) == 1 else half


def problem_lines(box: Box, width: float, u: float) -> list[str]:
    """Why a box is refused, in the lines below it."""
    return wrapped(box.problem, width, font_size(BOX_TITLE, u)) if box.problem else []


def _picture_height(rows: Sequence[Row], width: float, room: float, u: float) -> float:
    """Height of the pictures of tiles: reduced until two sections begin in sight, and where one more row fits then."""
    high, least = _tile_width(width, u) * PROPORTION, LEAST_PICTURE * u
    pictured = [not isinstance(row, str) and isinstance(row[0], Tile) and not _are_pills(row) for row in rows]
    ends = [number + 1 for number, has in enumerate(pictured) if has]
    begun = [end for end in ends if end < 2 or not pictured[end - 2]]  # ends of the first rows of sections
    needed = max(begun[:SECTIONS_SEEN], default=0)
    for end in reversed(ends):
        fixed = sum(_height(row, 0.0, width, u) for row in rows[:end])
        each = (room - fixed) / sum(pictured[:end])
        if each >= (least if end <= needed else LOWEST * high):
            return min(each, high)
    return least if ends else high


def _tile_width(width: float, u: float) -> float:
    columns = tile_columns(width / u)
    return (width - (columns - 1) * TILE_GAP * u) / columns


def _placed(
    row: Row, left: float, top: float, width: float, height: float, u: float, columns: int = 1
) -> Iterator[Place]:
    """The places of the items of a row; columns: how many pills stand side by side in its section."""
    if isinstance(row, str):
        yield Place(left, top, width, height, row)
    elif isinstance(row[0], Reading):
        yield Place(left, top, width, height, row[0])
    elif isinstance(row[0], Box):
        each = _box_width(row, width, u)
        for column, box in enumerate(row):
            yield Place(left + column * (each + COLUMN_GAP * u), top + TITLE * u, each, BOX * u, box)
    elif _are_pills(row):
        gap = PILL_GAP * u
        each = min((width - (columns - 1) * gap) / columns, 2.0 * PILL_WIDTH * u)
        for column, tile in enumerate(row):
            yield Place(left + column * (each + gap), top, each, height - gap, tile)
    else:
        each = _tile_width(width, u)
        for column, tile in enumerate(row):
            yield Place(left + column * (each + TILE_GAP * u), top, each, height - TILE_GAP * u, tile)
