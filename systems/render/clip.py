"""Clipping of segments and polygons to a rectangle, so that no mark lies far outside the window."""

from __future__ import annotations

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.systems.render.marks import Points


def clip_segments(start: Points, end: Points, low: Points, high: Points) -> tuple[Points, Points, Rows]:
    """The parts of segments, each (n, 2), inside the rectangle from `low` to `high`, and their rows.

    Those neither whole inside nor beyond one side are cut: along start + t (end − start) each side bounds t (Liang and
    Barsky's method). Those with a coordinate that is not finite are left out.
    """
    kept, away = np.ones(len(start), dtype=bool), np.zeros(len(start), dtype=bool)
    for axis in (0, 1):  # faster than by rows
        least, most = np.minimum(start[:, axis], end[:, axis]), np.maximum(start[:, axis], end[:, axis])
        kept &= (least >= low[axis]) & (most <= high[axis])
        away |= (most < low[axis]) | (least > high[axis])
    if kept.all():
        return start, end, np.arange(len(start))
    rows = np.flatnonzero(~away)
    start, end, cut = start[rows], end[rows], ~kept[rows]
    origin, step = start[cut], end[cut] - start[cut]
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        at_low, at_high = (low - origin) / step, (high - origin) / step
        parallel, inside = step == 0.0, (origin >= low) & (origin <= high)
        begin = np.where(parallel, np.where(inside, 0.0, np.inf), np.fmin(at_low, at_high))
        stop = np.where(parallel, np.where(inside, 1.0, -np.inf), np.fmax(at_low, at_high))
        t0, t1 = np.maximum(begin.max(axis=1), 0.0)[:, None], np.minimum(stop.min(axis=1), 1.0)[:, None]
        start[cut], end[cut] = origin + t0 * step, origin + t1 * step
        kept = ~cut
        kept[cut] = (t0 <= t1)[:, 0] & np.isfinite(step).all(axis=1)
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
