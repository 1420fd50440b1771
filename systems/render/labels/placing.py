"""Labels: texts placed where they are free, the important ones first; values without a place, at the end of a line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from pinjoint.systems.render.labels.nearness import NOBODY, Boxes, Codes, ranges
from pinjoint.systems.render.labels.occupancy import FAINT, STRONG, Occupancy
from pinjoint.systems.render.marks import Discs, Mark, Owner, Panel, Points, Rows, Strokes, Text, Truths
from pinjoint.systems.render.theme import Colour, faded
from pinjoint.systems.render.typography import font_size, line_height, text_width

ANCHORS = np.array([0.5, 0.35, 0.65, 0.2, 0.8])  # shares of a line where one that leads to it may end
_LED, _REFERRED = 1000, 2000  # from which on numbers of places mean those with a line, and those of numbers
_SMALL, _ENDS = 9.0, 6  # points, of smaller type; places where a line from a value may end that are tried
_TRIED, _MOST_LED = 32, 16  # values of a picture that may have lines, and lines, since more would confuse
LEADER_OPACITY, _DOT = 0.75, 1.75  # of these lines, and points, radius of the dot at their end
_TURNS = np.array([0, *(way * k for k in range(1, 8) for way in (1, -1)), 8]) * np.pi / 8.0  # from the best way
_LENGTHS = (14.0, 26.0, 40.0, 58.0, 80.0, 110.0, 150.0, 200.0)  # points
_USUAL = 5  # of these lengths, of lines from values in their usual type
_STEP, _HALF = 4.0, 1.5  # points between the places where a line is tested; half the room it needs there
_CLEAR, _OFF_DIAGRAMS = 3.0, 1.0  # points between a value and all else
_NEAR_NUMBERS = (0.5, -1.0, 0.5), (0.5, -1.0, -1.0)  # points from numbers to lines, diagrams, symbols of others
_STAGES = 0, 3, 1000
_COVERED = {"cover": (STRONG,), "spare": (FAINT, STRONG), "avoid": (0,)}  # by each attempt, at most


Key = tuple[str, int]  # such as ("rods.axial_force", its row)
Placed = dict[Key, int]  # which of its places each label has taken


class Label(NamedTuple):
    """A text that is to be placed with its middle at one of `places` (k, 2), the best first.

    rank: labels of lower rank come first. backing: colour behind the text, or None. lines: whether it may
    cover rods ("cover"), only if there is no other place ("spare"), or no line ever ("avoid"). key: the
    quantity and row, if the label is to stay where it was in the last picture. of: whose it is. own: what it must be
    nearest to among the parts of the picture, if anything. anchors: of a value, where a line from it may lead, (k, 2), the
    best first; none: it is a name, which gives way to values. outward: the direction in which it had best stand from there.
    close: how many of the first places are so close that it may be nearer to something else if need be. short: what is told
    in any case, in smaller type or beside a number; "": nothing.
    """

    text: str
    places: Points | Sequence[tuple[float, float]]
    size: int
    colour: Colour
    rank: float
    weight: str = "regular"
    backing: Colour | None = None
    lines: Literal["cover", "spare", "avoid"] = "spare"
    key: Key | None = None
    of: Owner | None = None
    own: Owner | None = None
    anchors: Points = np.empty((0, 2))
    outward: Points = np.array([0.0, -1.0])
    close: int = 0
    short: str = ""


Numbered = tuple[int, Label, list[Mark]]  # a number that stands for a value, and its marks; 0: no room for it


def half_size(text: str, size: int, weight: str, unit: float) -> tuple[float, float]:
    """Half the width and height in pixels of a label, its margins included."""
    return text_width(text, size, weight) / 2 + 3.5 * unit, line_height(size) / 2 + 0.5 * unit


def place_labels(
    labels: Iterable[Label], occupancy: Occupancy, unit: float, placed: Placed
) -> tuple[list[Mark], list[Numbered]]:
    """Marks of the labels that found a free place, values first, each in order of rank, and the values in whose places
    stand numbers, since these found none; others are left out.

    placed: the places of labels in the last picture, updated; a label moves only where it then covers less.
    """
    ranked = sorted(labels, key=lambda label: label.rank)
    former = {label.key: placed.get(label.key, -1) for label in ranked if label.key}
    placed.clear()
    marks: list[Mark] = []
    symbols = occupancy.taken.copy()
    if ranked:
        occupancy.parts.gather(np.concatenate([label.places for label in ranked]))
    values, names = ([label for label in ranked if (len(label.anchors) == 0) == name] for name in (False, True))
    left = _put(values, former, occupancy, unit, placed, marks)
    for smaller, over in ((False, False), (True, False), (True, True)) if left else ():
        if smaller and not over:
            left = [n._replace(text=n.short, size=font_size(_SMALL, unit)) for n in left]
            left = _put(left, former, occupancy, unit, placed, marks)
        left = [n for index, n in enumerate(left) if n.short or index < _TRIED]
        lengths = _LENGTHS if smaller and len(left) <= _MOST_LED else _LENGTHS[:_USUAL]
        for turn in range(_ENDS):
            left = _led(left, turn, lengths, over, former, occupancy, unit, placed, marks) if left else left
            left = [n for n in left if n.short]
    referred = _referred(left, symbols, former, occupancy, unit, placed) if left else []
    left = _put(names, former, occupancy, unit, placed, marks)
    close = [n._replace(places=n.places[: n.close], own=None) for n in left if n.close]
    _put(close, former, occupancy, unit, placed, marks)
    return marks, referred


def _put(
    labels: Sequence[Label],
    former: dict[Key, int],
    occupancy: Occupancy,
    unit: float,
    placed: Placed,
    marks: list[Mark],
) -> list[Label]:
    """Add the marks of labels that may be at one of their places; returns the others."""
    before = [former.get(label.key, -1) if label.key else -1 for label in labels]
    found = _beside(labels, before, occupancy, unit)
    for index, (place, x, y) in found.items():
        marks += _marks(labels[index], place, x, y, unit, placed)
    return [label for index, label in enumerate(labels) if index not in found]


def _referred(
    labels: Sequence[Label],
    symbols: Truths,
    former: dict[Key, int],
    occupancy: Occupancy,
    unit: float,
    placed: Placed,
) -> list[Numbered]:
    """Numbers in place of values, on what these belong to, in need over `symbols`."""
    digits = "0" * len(str(len(labels)))
    half = np.array(half_size(digits, labels[0].size, "semibold", unit)) - [2.5 * unit, 0.5 * unit]
    half[0] = max(half)
    own, kin = _codes(labels, occupancy)
    of = np.repeat(np.arange(len(labels)), [len(label.anchors) for label in labels])
    middle = np.concatenate([label.anchors for label in labels])
    boxes = Boxes(middle, np.broadcast_to(half, middle.shape), of)
    number = np.arange(len(of)) - np.searchsorted(of, of)
    held = (
        number == np.array([former.get(label.key, -1) - _REFERRED if label.key else -1 for label in labels])[of]
    )
    inner = half - unit  # they may touch
    cells = occupancy.cells_of(middle - inner, np.broadcast_to(2.0 * inner, middle.shape))
    found = np.full(len(labels), -1)
    for near in _NEAR_NUMBERS:  # what may be on it, more in need
        limits = np.array(near)[:, None] * unit * np.ones(len(of))
        at = np.flatnonzero(
            occupancy.parts.are_clear(boxes, own, kin, limits) & occupancy.parts.are_on(boxes, own)
        )
        at = at[np.lexsort((~held[at], of[at]))]
        at = at[found[of[at]] < 0]
        if near is _NEAR_NUMBERS[-1]:
            occupancy.taken &= ~symbols
        _take(at, of[at], cells[at], found, occupancy)
    occupancy.taken |= symbols
    numbered: list[Numbered] = []
    for label, place in sorted(zip(labels, found.tolist(), strict=True), key=lambda pair: pair[1] < 0):
        count, marks = len(numbered) + 1, list[Mark]()
        if place < 0:
            count = 0
        else:
            (x, y), (wide, tall) = middle[place].tolist(), half.tolist()
            box = x - wide, y - tall, 2.0 * wide, 2.0 * tall
            marks.append(Panel(*box, tall, label.backing or label.colour, label.colour, label.of))
            marks.append(Text(str(count), x, y, label.size, label.colour, "semibold", "centre", label.of))
        numbered.append((count, label, marks))
        if label.key:
            placed[label.key] = _REFERRED + int(number[place])
    return numbered


def _marks(label: Label, place: int, x: float, y: float, unit: float, placed: Placed) -> list[Mark]:
    """A label with its middle at x, y, the place of that number."""
    if label.key:
        placed[label.key] = place
    marks: list[Mark] = []
    if label.backing is not None:
        wide, tall = half_size(label.text, label.size, label.weight, unit)
        box = x - wide, y - tall, 2.0 * wide, 2.0 * tall
        marks.append(Panel(*box, 4.0 * unit, label.backing, None, label.of))
    return [*marks, Text(label.text, x, y, label.size, label.colour, label.weight, "centre", label.of)]


def _codes(labels: Sequence[Label], occupancy: Occupancy) -> tuple[Codes, Codes]:
    """Codes of what each label must be nearest to, and of whose it is."""
    own, of = (
        [occupancy.parts.code(key) for key in keys]
        for keys in zip(*((n.own, n.of) for n in labels), strict=True)
    )
    return np.array(own, dtype=np.int64), np.array(of, dtype=np.int64)


def _beside(
    ranked: Sequence[Label], former: Sequence[int], occupancy: Occupancy, unit: float
) -> dict[int, tuple[int, float, float]]:
    """Of the labels that may be at one of their places its number, and where that is; former: in the last picture.

    The places of each are tried in order, first a few of all labels, since most of them stand at one of these.
    """
    if not ranked:
        return {}
    count = np.array([len(label.places) for label in ranked])
    of, first = np.repeat(np.arange(len(ranked)), count), np.cumsum(count) - count
    half = np.array([half_size(label.text, label.size, label.weight, unit) for label in ranked])[of]
    low, high = occupancy.viewport.corners
    middle = np.concatenate([label.places for label in ranked])
    middle = np.minimum(np.maximum(middle, low + half), high - half)  # into the viewport where it sticks out
    cells = occupancy.cells_of(middle - half, 2.0 * half)
    held = np.arange(len(of)) - first[of] == np.array(former)[of]
    clearly = ~held & np.array([label.backing is not None for label in ranked])[of]
    own, kin = _codes(ranked, occupancy)
    boxes, found = Boxes(middle, half, of), np.full(len(ranked), -1)
    tried = _attempts(ranked, of, held, cells, occupancy)
    number = np.arange(len(tried)) - np.searchsorted(of[tried], of[tried])
    for begin, end in pairwise(_STAGES):
        now = tried[(number >= begin) & (number < end) & (found[of[tried]] < 0)]
        now = now[(own[of[now]] == NOBODY) | occupancy.may_be_of(cells[now], own[of[now]], kin[of[now]])]
        now = now[occupancy.parts.own_is_nearest(boxes.some(now), own, kin, clearly[now])]
        _take(now, of[now], cells[now], found, occupancy)
    settled = np.flatnonzero(found >= 0)
    at = found[settled]
    return dict(
        zip(
            settled.tolist(),
            zip((at - first[settled]).tolist(), *middle[at].T.tolist(), strict=True),
            strict=True,
        )
    )


def _attempts(
    labels: Sequence[Label],
    of: Rows,
    held: Truths,
    cells: Rows,
    occupancy: Occupancy,
) -> Rows:
    """The places free of panels and lines, all of one label in the order in which to try them, then those of the next.

    of: the label of each place. held: whether the label was there in the last picture. cells: (k, 4) of each place.
    """
    kinds = np.array([label.lines for label in labels])
    strengths = sorted({strength for lines in set(kinds.tolist()) for strength in _COVERED[lines]})
    free = {strength: occupancy.are_free(cells, strength) for strength in strengths}
    attempts = [np.empty(0, dtype=np.intp)]
    for lines, coverings in _COVERED.items():
        theirs = np.flatnonzero((kinds == lines)[of])
        for covering in coverings if len(theirs) else ():
            possible = theirs[free[covering][theirs]]
            attempts += [possible[held[possible]], possible]
    tried = np.concatenate(attempts)
    return tried[np.argsort(of[tried], kind="stable")]


def _take(places: Rows, of: Rows, cells: Rows, found: Rows, occupancy: Occupancy) -> None:
    """Let each label have the first of its places, one label's after the other's, that no label has taken.

    of, cells: of these places. found: the place of each label, or -1; updated.
    """
    settled = -1
    for index, place, (left, top, right, bottom) in zip(
        of.tolist(), places.tolist(), cells.tolist(), strict=True
    ):
        if index == settled or occupancy.taken[top:bottom, left:right].any():
            continue
        occupancy.taken[top:bottom, left:right] = True
        found[index] = place
        settled = index


# --- lines to what labels belong to ----------------------------------------------------------------------


def _led(
    labels: Sequence[Label],
    turn: int,
    lengths: Sequence[float],
    over: bool,
    former: dict[Key, int],
    occupancy: Occupancy,
    unit: float,
    placed: Placed,
    marks: list[Mark],
) -> list[Label]:
    """Add labels that stand away from what they belong to, the first of them first, with a line that leads to an anchor;
    returns the others.

    Of its anchors the first is taken that nothing else is near, or that after so many turns. Lines may cross the own parts,
    and diagrams. over: labels may stand on these.
    """
    anchors, outward = [label.anchors for label in labels], np.array([label.outward for label in labels])
    half = np.array([half_size(label.text, label.size, label.weight, unit) for label in labels])
    own, kin = _codes(labels, occupancy)
    before = np.array([former.get(label.key, -1) - _LED if label.key else -1 for label in labels])
    which, ends = _clear_ends(anchors, turn, own, kin, occupancy)
    count = len(_TURNS) * len(lengths)
    angle = np.arctan2(outward[which, 1], outward[which, 0])[:, None] + np.tile(_TURNS, len(lengths))
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    reach = np.repeat(lengths, len(_TURNS)) * unit + (np.abs(direction) * half[which, None]).sum(axis=2)
    middle = (ends[:, None] + direction * reach[:, :, None]).reshape(-1, 2)
    of, end = np.repeat(which, count), np.repeat(ends, count, axis=0)
    place = np.tile(np.arange(count), len(which))
    at = _clear_boxes(Boxes(middle, half[of], of), len(labels), over, occupancy)
    middle, of, end, place = middle[at], of[at], end[at], place[at]
    start = np.clip(end, middle - half[of], middle + half[of])
    order = np.lexsort((place != before[of], of))  # stable
    clear = _meet_nothing(start[order], end[order], own[of[order]], kin[of[order]], occupancy)
    led, others = set[int](), 0
    for index in order[clear].tolist():
        number, line = int(of[index]), (start[index], end[index])
        label = labels[number]
        if number in led or (not label.short and others == _MOST_LED):
            continue
        if not _take_line(middle[index], half[number], *line, occupancy):
            continue
        led.add(number)
        others += not label.short
        whose = (label.of[0], np.array([label.of[1]])) if label.of else None
        colour = faded(label.colour, LEADER_OPACITY)
        marks.append(Strokes(line[0][None], line[1][None], unit, colour, whose))
        marks.append(Discs(line[1][None], np.array([_DOT * unit]), colour, colour, of=whose))
        x, y = middle[index].tolist()
        marks += _marks(label, _LED + int(place[index]), x, y, unit, placed)
    return [label for number, label in enumerate(labels) if number not in led]


def _clear_ends(
    anchors: Sequence[Points], turn: int, own: Codes, kin: Codes, occupancy: Occupancy
) -> tuple[Rows, Points]:
    """Which values have an anchor that nothing else is near, but for diagrams in need, and of each the one after so
    many turns, (n, 2)."""
    of, points = np.repeat(np.arange(len(anchors)), [len(each) for each in anchors]), np.concatenate(anchors)
    boxes, unit, possible = Boxes(points, np.zeros_like(points), of), occupancy.parts.unit, []
    for near in ((_CLEAR, 0.0, _CLEAR), (_HALF, -1.0, _HALF)):
        limits = np.array(near)[:, None] * unit * np.ones(len(of))
        possible.append(np.flatnonzero(occupancy.parts.are_clear(boxes, own, kin, limits)))
    clear = np.concatenate(possible)
    _, first = np.unique(clear, return_index=True)
    clear = clear[np.sort(first)]
    clear = clear[np.argsort(of[clear], kind="stable")]
    number = np.arange(len(clear)) - np.searchsorted(of[clear], of[clear])
    clear = clear[number == turn]
    return of[clear], points[clear]


def _clear_boxes(boxes: Boxes, labels: int, over: bool, occupancy: Occupancy) -> Rows:
    """Those boxes of so many labels that lie in the picture, on nothing and near nothing; over: or on diagrams."""
    nobody, unit = np.full(labels, NOBODY), occupancy.parts.unit
    low, high = occupancy.viewport.corners
    inside = (boxes.middle - boxes.half >= low) & (boxes.middle + boxes.half <= high)
    at = np.flatnonzero(inside[:, 0] & inside[:, 1])
    corner = boxes.middle[at] - boxes.half[at]
    at = at[occupancy.are_free(occupancy.cells_of(corner, 2.0 * boxes.half[at]), FAINT)]
    limits = np.array([_CLEAR, -1.0 if over else _OFF_DIAGRAMS, _CLEAR])[:, None] * unit * np.ones(len(at))
    return at[occupancy.parts.are_clear(boxes.some(at), nobody, nobody, limits)]


def _meet_nothing(start: Points, end: Points, own: Codes, kin: Codes, occupancy: Occupancy) -> Rows:
    """Those of the lines from `start` to `end` that meet nothing."""
    unit = occupancy.parts.unit
    count = np.ceil(np.hypot(*(end - start).T) / (_STEP * unit)).astype(np.intp) + 1
    line = np.repeat(np.arange(len(start)), count)
    share = (ranges(np.zeros_like(count), count) / np.repeat(count, count))[:, None]
    points = end[line] + share * (start[line] - end[line])
    rows, columns = occupancy.cell_of(points).T
    limits = np.array([_HALF, -1.0, _HALF])[:, None] * unit * np.ones(len(line))
    boxes = Boxes(points, np.full(points.shape, _HALF * unit), line)
    clear = ~occupancy.taken[rows, columns] & occupancy.parts.are_clear(boxes, own, kin, limits)
    return np.setdiff1d(np.arange(len(start)), line[~clear])


def _take_line(middle: Points, half: Points, start: Points, end: Points, occupancy: Occupancy) -> bool:
    """Take a box and a line to it, if both are free."""
    ((left, top, right, bottom),) = occupancy.cells_of((middle - half)[None], 2.0 * half[None]).tolist()
    count = int(np.hypot(*(end - start)) / (_STEP * occupancy.parts.unit)) + 2
    row, column = occupancy.cell_of(end + np.arange(count)[:, None] / count * (start - end)).T
    if occupancy.taken[top:bottom, left:right].any() or occupancy.taken[row, column].any():
        return False
    occupancy.taken[top:bottom, left:right] = True
    occupancy.taken[row, column] = True
    return True
