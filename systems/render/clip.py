"""Clipping of segments and polygons to a rectangle, so that no mark lies far outside the window."""

from __future__ import annotations

import numpy as np

from pinjoint.systems.render.marks import Points, Rows


def clip_segments(start: Points, end: Points, low: Points, high: Points) -> tuple[Points, Points, Rows]:
    """The parts of segments, each (n, 2), inside the rectangle from `low` to `high`, and their rows.

    Liang and Barsky's method: along start + t (end − start) each side of the rectangle bounds t.
    Segments with a coordinate that is not finite are left out.
    """
    step = end - start
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        at_low, at_high = (low - start) / step, (high - start) / step
        first, last = np.fmin(at_low, at_high), np.fmax(at_low, at_high)
        parallel = step == 0.0
        inside = (start >= low) & (start <= high)
        first = np.where(parallel, np.where(inside, 0.0, np.inf), first)
        last = np.where(parallel, np.where(inside, 1.0, -np.inf), last)
        t0 = np.maximum(first.max(axis=1, initial=0.0), 0.0)
        t1 = np.minimum(last.min(axis=1, initial=1.0), 1.0)
        rows = np.flatnonzero((t0 <= t1) & np.isfinite(step).all(axis=1))
    t0, t1, origin, step = t0[rows, None], t1[rows, None], start[rows], step[rows]
    return origin + t0 * step, origin + t1 * step, rows


def clip_rods(points: Points, ends: Rows, low: Points, high: Points) -> tuple[Points, Points, Rows]:
    """clip_segments of the rods between rows `ends` (m, 2) of `points`, where most lie wholly inside or outside.

    A point is marked by the sides of the rectangle that it lies beyond. A rod is inside if neither end is
    marked, outside if both are by the same side; only the others are cut (Cohen and Sutherland's method).
    """
    beyond = np.zeros(len(points), dtype=np.uint8)
    for axis in (0, 1):
        beyond |= (points[:, axis] < low[axis]).astype(np.uint8) << (2 * axis)
        beyond |= (points[:, axis] > high[axis]).astype(np.uint8) << (2 * axis + 1)
        beyond |= (~np.isfinite(points[:, axis])).astype(np.uint8) << 4
    first, last = ends[:, 0], ends[:, 1]
    if not beyond.any():
        return points.take(first, axis=0), points.take(last, axis=0), np.arange(len(ends))
    rows = np.flatnonzero((beyond[first] & beyond[last]) == 0)
    first, last = first[rows], last[rows]
    start, end = points.take(first, axis=0), points.take(last, axis=0)
    cut = np.flatnonzero(beyond[first] | beyond[last])
    kept = np.ones(len(rows), dtype=bool)
    kept[cut] = False
    cut_start, cut_end, remaining = clip_segments(start[cut], end[cut], low, high)
    cut = cut[remaining]
    start[cut], end[cut], kept[cut] = cut_start, cut_end, True
    return start[kept], end[kept], rows[kept]


def clip_polygon(polygon: Points, low: Points, high: Points) -> Points:
    """The part of a polygon (k, 2) inside a rectangle, cut side by side (Sutherland and Hodgman's method)."""
    for axis in (0, 1):
        for limit, sign in ((low[axis], 1.0), (high[axis], -1.0)):
            depth = sign * (polygon[:, axis] - limit)  # positive inside
            following, after = np.roll(polygon, -1, axis=0), np.roll(depth, -1)
            crosses = (depth >= 0.0) != (after >= 0.0)
            with np.errstate(divide="ignore", invalid="ignore"):
                crossing = polygon + (depth / (depth - after))[:, None] * (following - polygon)
            both = np.stack([polygon, crossing], axis=1).reshape(-1, 2)
            polygon = both[np.stack([depth >= 0.0, crosses], axis=1).ravel()]
            if len(polygon) == 0:
                return polygon
    return polygon
