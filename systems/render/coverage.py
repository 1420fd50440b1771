"""Coverage: which pixels anti-aliased strokes touch, and how much of each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

BLOCK = 32  # pixels side by side that compiled drawing blends at once if any is covered


def stroke_pixels_estimate(start: Points, end: Points, width: float) -> float:
    """An estimate of the pixels that stroke_coverage visits."""
    return float(np.abs(end - start).max(axis=1, initial=0.0).sum() + 2.0 * len(start)) * (1.42 * width + 2.0)


def stroke_coverage(
    start: Points, end: Points, width: float
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.uint8]]:
    """Columns, rows and coverage (1 to 255) of the pixels that strokes from `start` to `end` touch.

    In every column of a flat stroke (every row of a steep one) the stroke covers the interval of height
    width / cos(slope) about its middle line; a pixel's coverage is its share of that interval. Pixels
    come in ascending coverage, so that where strokes cross, the last one written covers most.
    """
    delta = end - start
    steep = np.abs(delta[:, 1]) > np.abs(delta[:, 0])
    along = np.where(steep, 1, 0)
    row = np.arange(len(start))
    backwards = delta[row, along] < 0.0
    first = np.where(backwards[:, None], end, start)
    last = np.where(backwards[:, None], start, end)
    m0, m1 = first[row, along], last[row, along]
    length = np.hypot(delta[:, 0], delta[:, 1])
    reach = np.maximum(m1 - m0, 1e-9)
    slope = (last[row, 1 - along] - first[row, 1 - along]) / reach
    half = (0.5 * width * length / reach).astype(np.float32)

    base = np.floor(m0).astype(np.int32)
    count = np.floor(m1).astype(np.int32) - base + 1
    of = np.repeat(row, count)
    step = np.arange(len(of), dtype=np.int32) - np.repeat(np.cumsum(count) - count, count).astype(np.int32)
    major = base[of] + step
    ends = np.minimum(major + 1, m1[of]) - np.maximum(major, m0[of])  # share of this column that it crosses
    middle = (first[row, 1 - along] + (base + 0.5 - m0) * slope)[of] + step * slope[of]
    low = np.floor(middle - half[of]).astype(np.int32)
    offset = (middle - low).astype(np.float32)[:, None]
    pixels = np.arange(int(np.ceil(2.0 * half.max(initial=0.0))) + 1, dtype=np.float32)
    thickness = half[of][:, None]
    share = np.minimum(pixels + 1.0, offset + thickness) - np.maximum(pixels, offset - thickness)
    amount = (np.clip(share, 0.0, 1.0) * (255.0 * ends.astype(np.float32))[:, None] + 0.5).astype(np.uint8)

    touched = np.flatnonzero(amount)
    touched = touched[np.argsort(amount.ravel()[touched], kind="stable")]
    sample, pixel = np.divmod(touched, len(pixels))
    minor = low[sample] + pixel.astype(np.int32)
    is_steep = steep[of[sample]]
    x, y = np.where(is_steep, minor, major[sample]), np.where(is_steep, major[sample], minor)
    return x, y, amount.ravel()[touched]
