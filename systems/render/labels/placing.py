"""Labels: texts placed where they are free, the important ones first; values without a place, at the end of a line.

While a hand drags, they keep their places and are moved only where others take these (`_Placing.kept`): 3 ms in place
of 71 where a joint of a frame of 104 members is moved, which would lag behind the hand by them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.systems.render.labels.nearness import NOBODY, Boxes, Codes, ranges, within
from pinjoint.systems.render.labels.occupancy import FAINT, STRONG, Occupancy
from pinjoint.systems.render.marks import Discs, Mark, Owner, Panel, Points, Strokes, Text, Truths, Values
from pinjoint.systems.render.theme import Colour, faded
from pinjoint.systems.render.typography import font_size, line_height, text_width

ANCHORS = np.array([0.5, 0.35, 0.65, 0.2, 0.8])  # shares of a line where one that leads to it may end
# From which on numbers of places mean those with a line, those of numbers, none of these, those of smaller type.
_LED, _REFERRED, _LISTED, _SMALLER = 1_000, 90_000, 99_999, 100_000
_SMALL, _ENDS = 9.0, 6  # points, of smaller type; places where a line from a value may end that are tried
_TRIED, _MOST_LED = 32, 16  # values of a picture that may have lines, and lines, since more would confuse
LEADER_OPACITY, _DOT = 0.75, 1.75  # of these lines, and points, radius of the dot at their end
_TURNS = np.array([0, *(way * k for k in range(1, 8) for way in (1, -1)), 8]) * np.pi / 8.0  # from the best way
_LENGTHS = (14.0, 26.0, 40.0, 58.0, 80.0, 110.0, 150.0, 200.0)  # points
_WAYS = len(_TURNS) * len(_LENGTHS)  # of lines from one anchor
# Of these lengths, of lines to values that need not cover a rod, and to values in their usual type.
_NEAR, _USUAL = 3, 5
_STEP, _HALF = 4.0, 1.5  # points between the places where a line is tested; half the room it needs there
_CLEAR, _OFF_DIAGRAMS = 3.0, 1.0  # points between a value and all else
_NEAR_NUMBERS = (0.5, -1.0, 0.5), (0.5, -1.0, -1.0)  # points from numbers to lines, diagrams, symbols of others
_COVERED = {"cover": (STRONG,), "spare": (FAINT, STRONG), "avoid": (0,)}  # by each attempt, at most


# The anchors of a label from which none may lead, and its way out.
NO_LINE = (np.empty((0, 2)), np.array([0.0, -1.0]))
GIVEN = "particles.applied"  # how names of the fields of loads begin

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
    in any case, in smaller type or beside a number; "": nothing. small: it is told so.
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
    anchors: Points = NO_LINE[0]
    outward: Points = NO_LINE[1]
    close: int = 0
    short: str = ""
    small: bool = False

    def is_given(self) -> bool:
        """Whether it is the value of a load, which a person gave, and gives way to results."""
        return self.key is not None and self.key[0].startswith(GIVEN)

    def smaller(self, unit: float) -> Label:
        """As it is told in smaller type."""
        return self._replace(text=self.short, size=font_size(_SMALL, unit), small=True)


_Line = tuple[Points, Points, Rows]  # from a label to what it belongs to, and the cells along it
Numbered = tuple[int, Label, list[Mark]]  # a number that stands for a value, and its marks; 0: no room for it


@lru_cache(maxsize=8192)
def half_size(text: str, size: int, weight: str, unit: float) -> tuple[float, float]:
    """Half the width and height in pixels of a label, its margins included."""
    return text_width(text, size, weight) / 2 + 3.5 * unit, line_height(size) / 2 + 0.5 * unit


def place_labels(
    labels: Iterable[Label], occupancy: Occupancy, unit: float, placed: Placed, *, steady: bool = False
) -> tuple[list[Mark], list[Numbered]]:
    """Marks of the labels that found a free place, values first, each in order of rank, and the values in whose places
    stand numbers, since these found none; others are left out.

    placed: the places of labels in the last picture, updated; a label moves only where it then covers less. steady: only
    where something else takes its place.
    """
    ranked, symbols = sorted(labels, key=lambda label: label.rank), occupancy.taken.copy()
    at, numbers = _Placing(occupancy, unit, dict(placed), placed), list[Label]()
    placed.clear()
    if steady:
        ranked, numbers = at.kept(ranked)
    if ranked:
        occupancy.parts.gather(np.concatenate([label.places for label in ranked]))
    values, names = ([label for label in ranked if (len(label.anchors) == 0) == name] for name in (False, True))
    left = at.beside(values, covering=False)
    spare, cover = ([n for n in left if (n.lines == "spare") == way] for way in (True, False))
    results, given = ([n for n in spare if n.is_given() == way] for way in (False, True))
    spare = given + at.led(results, range(1), _LENGTHS[:_NEAR], over=False)
    left = cover + at.beside(sorted(spare, key=lambda n: n.rank))
    left.sort(key=lambda n: (n.is_given(), n.rank))
    for smaller, over in ((False, False), (True, False), (True, True)) if left else ():
        if smaller and not over:
            left = at.beside([label.smaller(unit) for label in left])
        left = [n for index, n in enumerate(left) if n.short or index < _TRIED]
        lengths = _LENGTHS if smaller and len(left) <= _MOST_LED else _LENGTHS[:_USUAL]
        left = [n for n in at.led(left, range(1), lengths, over) if n.short]
        left = at.led(left, range(1, _ENDS), lengths, over)
    referred = at.referred(numbers + left, len(numbers), symbols)
    left = at.beside(names)
    at.beside([n._replace(places=n.places[: n.close], own=None) for n in left if n.close])
    return [*at.leaders(), *at.marks], referred


@dataclass
class _Placing:
    """Labels on their way to places, whose numbers `former` and `placed` hold. lines: from them, by table and colour:
    row, from, to."""

    occupancy: Occupancy
    unit: float
    former: Placed
    placed: Placed
    marks: list[Mark] = field(default_factory=list)
    lines: dict[tuple[str, Colour], list[tuple[int, Points, Points]]] = field(default_factory=dict)

    def leaders(self) -> Iterator[Mark]:
        """The lines from labels to what they belong to, those of one table and colour at once."""
        for (table, colour), lines in self.lines.items():
            rows, start, end = (np.array(column) for column in zip(*lines, strict=True))
            of, faint = (table, rows) if table else None, faded(colour, LEADER_OPACITY)
            yield Strokes(start, end, self.unit, faint, of)
            yield Discs(end, np.full(len(end), _DOT * self.unit), faint, faint, of=of)

    def kept(self, ranked: Sequence[Label]) -> tuple[list[Label], list[Label]]:
        """Let labels stand where they stood by what they belong to; returns those that are to be placed, since something
        takes their place or they must be told and were not, and those for which numbers stand."""
        left, numbers, held = list[Label](), list[Label](), list[Label]()
        for label in ranked:
            code = self.former.get(label.key, -1) if label.key else -1
            kind = left if code < 0 else numbers if code % _SMALLER >= _REFERRED else held
            if code >= 0 or label.short or not label.key:
                kind.append(label.smaller(self.unit) if code >= _SMALLER else label)
        if not held:
            return left, numbers
        place, half, (low, high) = self._before(held), self._halves(held), self.occupancy.viewport.corners
        led, (anchor, way) = place >= _LED, np.divmod(place - _LED, _WAYS)
        sources = zip(held, np.where(led, anchor, place).tolist(), led.tolist(), strict=True)
        lists = ((n.anchors if by_line else n.places, k) for n, k, by_line in sources)
        ends = np.array([points[min(k, len(points) - 1)] for points, k in lists])
        length, turn = np.divmod(way[:, None], len(_TURNS))
        outward = np.array([n.outward for n in held])
        ways = self._ways(outward, half, _TURNS[turn], np.array(_LENGTHS)[length])
        middle = ends + np.where(led[:, None], ways[:, 0], 0.0)
        inside = within(middle, low + half, high - half)
        free = ~(led & (middle != inside).any(axis=1))
        cells = self.occupancy.cells_of(inside - half, 2.0 * half).tolist()
        start, end = within(ends, inside - half, inside + half)[led], ends[led]
        lines = zip(start, end, self.occupancy.cells_along(start, end, _STEP * self.unit), strict=True)
        boxes = np.concatenate([inside, half], axis=1).tolist()
        for label, number, box, taken, by_line, is_free in zip(
            held, place.tolist(), boxes, cells, led.tolist(), free.tolist(), strict=True
        ):
            line = next(lines) if by_line else None
            if not (is_free and self._stand(label, number, box, taken, line)):
                left += [label] * bool(label.short)
        return sorted(left, key=lambda label: label.rank), numbers

    def beside(self, labels: Sequence[Label], *, covering: bool = True) -> list[Label]:
        """Let labels stand at one of their places; returns those that cannot. covering: on rods and arrows in need.

        The places of each are tried in order, first a few of all labels, since most of them stand at one of these.
        """
        if not labels:
            return []
        occupancy, count = self.occupancy, np.array([len(label.places) for label in labels])
        of, first = np.repeat(np.arange(len(labels)), count), np.cumsum(count) - count
        half, (low, high) = self._halves(labels)[of], occupancy.viewport.corners
        middle = np.concatenate([label.places for label in labels])
        middle = within(middle, low + half, high - half)  # into the viewport where it sticks out
        cells = occupancy.cells_of(middle - half, 2.0 * half)
        held = np.arange(len(of)) - first[of] == self._before(labels)[of]
        clearly = ~held & np.array([label.backing is not None for label in labels])[of]
        own, kin = _codes(labels, occupancy)
        boxes, found = Boxes(middle, half, of), np.full(len(labels), -1)
        tried = _attempts(labels, of, held, cells, occupancy, covering)
        number = np.arange(len(tried)) - np.searchsorted(of[tried], of[tried])
        for begin, end in pairwise((0, 3, 1000)):  # candidates: the nearest first, then all
            now = tried[(number >= begin) & (number < end) & (found[of[tried]] < 0)]
            now = now[(own[of[now]] == NOBODY) | occupancy.may_be_of(cells[now], own[of[now]], kin[of[now]])]
            now = now[occupancy.parts.own_is_nearest(boxes.some(now), own, kin, clearly[now])]
            _take(now, of[now], cells[now], found, occupancy)
        for index in np.flatnonzero(found >= 0).tolist():
            place = int(found[index])
            box = *middle[place].tolist(), *half[place].tolist()
            self._write(labels[index], place - int(first[index]), box)
        return [label for index, label in enumerate(labels) if found[index] < 0]

    def led(self, labels: Sequence[Label], turns: range, lengths: Sequence[float], over: bool) -> list[Label]:
        """Let labels stand away from what they belong to, the first of them first, with a line that leads to an anchor;
        returns those that cannot.

        Of its anchors the first is taken that nothing else is near, or in turn those after it. Lines may cross the own
        parts, and diagrams. over: labels may stand on these.
        """
        if not labels:
            return []
        half, (own, kin), before = self._halves(labels), _codes(labels, self.occupancy), self._before(labels)
        which, anchor, turn, ends = _clear_ends(labels, turns, own, kin, self.occupancy)
        turns_of_ways, lengths_of_ways = np.tile(_TURNS, len(lengths)), np.repeat(lengths, len(_TURNS))
        outward = np.array([n.outward for n in labels])[which]
        ways = self._ways(outward, half[which], turns_of_ways, lengths_of_ways)
        of, place = np.repeat(which, ways.shape[1]), np.arange(ways.shape[1])
        middle, end = (ends[:, None] + ways).reshape(-1, 2), np.repeat(ends, len(place), axis=0)
        place, turn = (_LED + _WAYS * anchor[:, None] + place).ravel(), np.repeat(turn, len(place))
        at = _clear_boxes(Boxes(middle, half[of], of), len(labels), over, self.occupancy)
        at = at[np.lexsort((place[at] != before[of[at]], of[at], turn[at]))]  # stable
        middle, of, end, place = middle[at], of[at], end[at], place[at]
        start = within(end, middle - half[of], middle + half[of])
        cells = self.occupancy.cells_of(middle - half[of], 2.0 * half[of]).tolist()
        led, others = set[int](), 0
        possible = _meet_nothing(start, end, own[of], kin[of], self.occupancy)
        along = self.occupancy.cells_along(start[possible], end[possible], _STEP * self.unit)
        for k, line in zip(possible.tolist(), along, strict=True):
            number, label = int(of[k]), labels[of[k]]
            if number in led or (not label.short and others == _MOST_LED):
                continue
            box = *middle[k].tolist(), *half[of[k]].tolist()
            if self._stand(label, int(place[k]), box, cells[k], (start[k], end[k], line)):
                led.add(number)
                others += not label.short
        return [label for number, label in enumerate(labels) if number not in led]

    def referred(self, labels: Sequence[Label], kept: int, symbols: Truths) -> list[Numbered]:
        """Numbers in place of values, one of all that read alike, on what these belong to, in need over `symbols`; the first
        stay where they were."""
        if not labels:
            return []
        numbers = dict[tuple[str, Colour], int]()
        digits = "0" * len(str(len({(label.short, label.colour) for label in labels})))
        occupancy, unit = self.occupancy, self.unit
        half = np.array(half_size(digits, labels[0].size, "semibold", unit)) - [2.5 * unit, 0.5 * unit]
        half[0] = max(half)
        own, kin = _codes(labels, occupancy)
        of = np.repeat(np.arange(len(labels)), [len(label.anchors) for label in labels])
        middle = np.concatenate([label.anchors for label in labels])
        boxes = Boxes(middle, np.broadcast_to(half, middle.shape), of)
        number = np.arange(len(of)) - np.searchsorted(of, of)
        held = number == (self._before(labels) - _REFERRED)[of]
        inner = half - unit  # they may touch
        cells = occupancy.cells_of(middle - inner, np.broadcast_to(2.0 * inner, middle.shape))
        found, stay = np.repeat([-2, -1], [kept, len(labels) - kept]), np.flatnonzero(held & (of < kept))
        found[of[stay]] = stay
        for near in _NEAR_NUMBERS if kept < len(labels) else ():  # what may be on it, more in need
            limits = np.array(near)[:, None] * unit * np.ones(len(of))
            clear = occupancy.parts.are_clear(boxes, own, kin, limits) & occupancy.parts.are_on(boxes, own)
            at = np.flatnonzero(clear)
            at = at[np.lexsort((~held[at], of[at]))]
            at = at[found[of[at]] == -1]
            if near is _NEAR_NUMBERS[-1]:
                occupancy.taken &= ~symbols
            _take(at, of[at], cells[at], found, occupancy)
        occupancy.taken |= symbols
        numbered: list[Numbered] = []
        for label, place in sorted(zip(labels, found.tolist(), strict=True), key=lambda pair: pair[1] < 0):
            count, marks = 0, list[Mark]()
            if place >= 0:
                count = numbers.setdefault((label.short, label.colour), len(numbers) + 1)
                (x, y), (wide, tall) = middle[place].tolist(), half.tolist()
                box = x - wide, y - tall, 2.0 * wide, 2.0 * tall
                marks.append(Panel(*box, tall, label.backing or label.colour, label.colour, label.of))
                marks.append(Text(str(count), x, y, label.size, label.colour, "semibold", "centre", label.of))
            self._note(label, _REFERRED + int(number[place]) if place >= 0 else _LISTED)
            numbered.append((count, label, marks))
        return numbered

    def _before(self, labels: Sequence[Label]) -> Rows:
        """The number of the place of each in the last picture if it was as large there, else -1."""
        former = [divmod(self.former.get(n.key, -1) if n.key else -1, _SMALLER) for n in labels]
        found = (place if small == n.small else -1 for n, (small, place) in zip(labels, former, strict=True))
        return np.fromiter(found, np.intp)

    def _halves(self, labels: Sequence[Label]) -> Points:
        return np.array([half_size(n.text, n.size, n.weight, self.unit) for n in labels])

    def _ways(self, outward: Points, half: Points, turns: Values, lengths: Values) -> Points:
        """From ends of lines of these lengths, (k,) or (n, k), to the middles of labels, `half` their size, (n, k, 2).

        outward: which way is the best, from which they turn.
        """
        angle = np.arctan2(outward[:, 1], outward[:, 0])[:, None] + turns
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=2)
        reach = lengths * self.unit + (np.abs(direction) * half[:, None]).sum(axis=2)
        return direction * reach[:, :, None]

    def _stand(
        self, label: Label, place: int, box: Sequence[float], cells: Sequence[int], line: _Line | None
    ) -> bool:
        """Let a label stand there, if all that it and a line take is free."""
        taken, (left, top, right, bottom) = self.occupancy.taken, cells
        if np.count_nonzero(taken[top:bottom, left:right]):  # in half the time of any()
            return False
        if line is not None:
            start, end, along = line
            if np.count_nonzero(taken.ravel()[along]):
                return False
            taken.ravel()[along] = True
            table, row = label.of or ("", 0)
            self.lines.setdefault((table, label.colour), []).append((row, start, end))
        taken[top:bottom, left:right] = True
        self._write(label, place, box)
        return True

    def _write(self, label: Label, place: int, box: Sequence[float]) -> None:
        """Write a label in a box, of its middle and half its width and height: the place of that number."""
        self._note(label, place)
        x, y, wide, tall = box
        if label.backing is not None:
            paper = x - wide, y - tall, 2.0 * wide, 2.0 * tall, 4.0 * self.unit
            self.marks.append(Panel(*paper, label.backing, None, label.of))
        self.marks.append(Text(label.text, x, y, label.size, label.colour, label.weight, "centre", label.of))

    def _note(self, label: Label, place: int) -> None:
        if label.key:
            self.placed[label.key] = place + label.small * _SMALLER


def _codes(labels: Sequence[Label], occupancy: Occupancy) -> tuple[Codes, Codes]:
    """Codes of what each label must be nearest to, and of whose it is."""
    own, of = (
        [occupancy.parts.code(key) for key in keys]
        for keys in zip(*((n.own, n.of) for n in labels), strict=True)
    )
    return np.array(own, dtype=np.int64), np.array(of, dtype=np.int64)


def _attempts(
    labels: Sequence[Label], of: Rows, held: Truths, cells: Rows, occupancy: Occupancy, covering: bool
) -> Rows:
    """The places free of panels and lines, all of one label in the order in which to try them, then those of the next.

    of: the label of each place. held: whether the label was there in the last picture. cells: (k, 4) of each place.
    covering: as of `beside`.
    """
    kinds = np.array([label.lines for label in labels])
    strengths = sorted({strength for lines in set(kinds.tolist()) for strength in _COVERED[lines]})
    free = {strength: occupancy.are_free(cells, strength) for strength in strengths}
    attempts = [np.empty(0, dtype=np.intp)]
    for lines, coverings in _COVERED.items():
        theirs = np.flatnonzero((kinds == lines)[of])
        for strength in (coverings if covering else coverings[:1]) if len(theirs) else ():
            possible = theirs[free[strength][theirs]]
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


def _clear_ends(
    labels: Sequence[Label], turns: range, own: Codes, kin: Codes, occupancy: Occupancy
) -> tuple[Rows, Rows, Rows, Points]:
    """Anchors that nothing else is near, but for diagrams in need, so many of each value in turn: whose, which of its
    anchors, in which turn, and where, (n, 2)."""
    of = np.repeat(np.arange(len(labels)), [len(label.anchors) for label in labels])
    points, unit = np.concatenate([label.anchors for label in labels]), occupancy.parts.unit
    boxes, possible = Boxes(points, np.zeros_like(points), of), []
    for near in ((_CLEAR, 0.0, _CLEAR), (_HALF, -1.0, _HALF)):
        limits = np.array(near)[:, None] * unit * np.ones(len(of))
        possible.append(np.flatnonzero(occupancy.parts.are_clear(boxes, own, kin, limits)))
    clear = np.concatenate(possible)
    _, first = np.unique(clear, return_index=True)
    clear = clear[np.sort(first)]
    clear = clear[np.argsort(of[clear], kind="stable")]
    turn = np.arange(len(clear)) - np.searchsorted(of[clear], of[clear])
    wanted = (turn >= turns.start) & (turn < turns.stop)
    clear = clear[wanted]
    return of[clear], clear - np.searchsorted(of, of[clear]), turn[wanted], points[clear]


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
    meets = np.zeros(len(start), dtype=bool)
    meets[line[occupancy.taken[rows, columns]]] = True
    points, line = points[~meets[line]], line[~meets[line]]
    limits = np.array([_HALF, -1.0, _HALF])[:, None] * unit * np.ones(len(line))
    boxes = Boxes(points, np.full(points.shape, _HALF * unit), line)
    meets[line[~occupancy.parts.are_clear(boxes, own, kin, limits)]] = True
    return np.flatnonzero(~meets)
