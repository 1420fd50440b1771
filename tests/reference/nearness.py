"""How near the texts of a picture stand to what is drawn: exact distances of boxes to lines, areas and circles."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from pinjoint.systems.render.marks import Bars, Discs, Fills, Owner, Picture, Points, Stamps, Strokes
from pinjoint.systems.render.theme import Colour, Theme
from tests.reference.boxes import Box


@dataclass(frozen=True, eq=False)
class Part:
    """A convex polygon (k, 2), such as a line of two points, or a disc about one point, and whose it is."""

    owner: Owner
    kind: str  # "line", "diagram", "disc", "shaft", "head" or "support"
    points: Points
    colour: Colour
    radius: float = 0.0


class Parts(list[Part]):
    """Several of them, of which those near many boxes are looked for."""

    @cached_property
    def boxes(self) -> tuple[Points, Points]:
        """The corners of the boxes around them: the least and the largest x and y, shape (n, 2) each."""
        low = [part.points.min(axis=0) - part.radius for part in self]
        high = [part.points.max(axis=0) + part.radius for part in self]
        return np.reshape(low, (-1, 2)), np.reshape(high, (-1, 2))


def parts_of(picture: Picture, theme: Theme) -> Parts:
    """All that is drawn of elements, without ghosts, halos and other hints."""
    return Parts(part for mark in picture.marks for part in _parts(mark, theme))


def _parts(mark: object, theme: Theme) -> Iterator[Part]:
    if not isinstance(mark, Strokes | Fills | Bars | Stamps | Discs) or mark.of is None:
        return
    table, rows = mark.of
    owners = [(table, row) for row in rows.tolist()]
    match mark:
        case Strokes() if mark.colour[3] == 255 and mark.colour != theme.ghost:
            kind = "line" if table == "rods" and mark.colour != theme.load else "shaft"
            pieces = list(zip(owners, mark.start, mark.end, strict=True))
            gaps = [
                (a[0], a[2], b[1]) for a, b in pairwise(pieces) if a[0] == b[0] and kind == "line"
            ]  # of dashes
            for owner, *ends in pieces + gaps:
                yield Part(owner, kind, np.array(ends), mark.colour)
        # an area along a rod, from its start and back
        case Fills() if table == "rods" and mark.corners.shape[1] > 4:
            count = mark.corners.shape[1] // 2
            for owner, corners in zip(owners, mark.corners, strict=True):
                back = corners[::-1]
                for k in range(count - 1):
                    piece = np.array([corners[k], corners[k + 1], back[k + 1], back[k]])
                    yield Part(owner, "diagram", piece, mark.colour)
        case Bars() | Fills():
            kind = "diagram" if table == "rods" else "head" if mark.corners.shape[1] == 3 else "disc"
            for owner, corners in zip(owners, mark.corners, strict=True):
                yield Part(owner, kind, corners, mark.colour)
        case Stamps():
            for owner, at in zip(owners, mark.at, strict=True):
                angle = 0.5 * np.pi * mark.turns
                along = np.round([np.cos(angle), np.sin(angle)], 15)
                yield Part(owner, "support", np.array([at, at + mark.size * along]), mark.ink)
        case Discs() if mark.ink[3] == 255:
            for owner, at, radius in zip(owners, mark.at, mark.radius.tolist(), strict=True):
                yield Part(owner, "disc", at[None], mark.ink, radius)


def distance(box: Box, part: Part) -> float:
    """From a box to a part, in pixels; 0 where they meet."""
    low, high = np.array(box[:2]), np.array(box[2:])
    points = part.points
    nearest = float(np.hypot(*np.maximum(np.maximum(low - points, points - high), 0.0).T).min())
    if len(points) == 1:
        return max(nearest - part.radius, 0.0)
    if _meet(low, high, points):
        return 0.0
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    start, end = points, np.roll(points, -1, axis=0)
    step = end - start
    length = np.maximum((step**2).sum(axis=1), 1e-300)
    share = np.clip(((corners[:, None] - start) * step).sum(axis=2) / length, 0.0, 1.0)
    away = corners[:, None] - (start + share[:, :, None] * step)
    return min(nearest, float(np.hypot(away[..., 0], away[..., 1]).min()))


def _meet(low: Points, high: Points, points: Points) -> bool:
    """Whether a box and a convex polygon have a point in common: no line along one of their sides parts them."""
    step = np.roll(points, -1, axis=0) - points
    normals = np.concatenate([[[1.0, 0.0], [0.0, 1.0]], step[:, ::-1] * [1.0, -1.0]])
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    one, other = corners @ normals.T, points @ normals.T
    parted = (one.min(axis=0) > other.max(axis=0)) | (other.min(axis=0) > one.max(axis=0))
    return not bool(parted.any())


def near(box: Box, parts: Parts, within: float) -> list[tuple[Part, float]]:
    """The parts at most that far away from a box, with their distances."""
    low, high = parts.boxes
    close = np.flatnonzero((np.maximum(low - box[2:], box[:2] - high) <= within).all(axis=1))
    found = [(parts[index], distance(box, parts[index])) for index in close.tolist()]
    return [entry for entry in found if entry[1] <= within]
