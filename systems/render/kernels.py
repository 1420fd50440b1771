"""Rasterising: anti-aliased strokes, polygons and discs, written straight into the pixels of a surface.

Points are in pixels, y down; the pixel (row, column) covers [column, column + 1) × [row, row + 1). Pixels are
four channels of 8 bits, in whatever order. clip: left, top, right, bottom; nothing beyond it is touched.
"""

from __future__ import annotations

import math

import numpy as np

from systems.kernels import compiled

_EVEN = np.uint64(0x00FF00FF)  # every second channel of a pixel
_HALVES = np.uint64(0x00800080)  # 0.5 in both of them, for rounding
_EIGHT = np.uint64(8)


@compiled
def mixed(old, new, part):
    """A pixel of which `part` of 255 is replaced by another, each channel rounded to the nearest.

    Two channels at a time, 16 bits each. (v + 128 + ((v + 128) >> 8)) >> 8 is v / 255, rounded.
    """
    there, rest = np.uint64(part), np.uint64(255 - part)
    below, above = np.uint64(old), np.uint64(new)
    even = (below & _EVEN) * rest + (above & _EVEN) * there + _HALVES
    odd = ((below >> _EIGHT) & _EVEN) * rest + ((above >> _EIGHT) & _EVEN) * there + _HALVES
    even = ((even + ((even >> _EIGHT) & _EVEN)) >> _EIGHT) & _EVEN
    odd = (odd + ((odd >> _EIGHT) & _EVEN)) & (_EVEN << _EIGHT)
    return np.uint32(even | odd)


@compiled
def cover_strokes(cover, clip, start, end, width):
    """Raise `cover` (uint8, rows × columns) to what strokes from `start` to `end`, each (n, 2), cover.

    The compiled form of coverage.stroke_coverage: where strokes cross, the one that covers most counts.
    """
    left, top, right, bottom = clip
    for i in range(len(start)):
        dx, dy = end[i, 0] - start[i, 0], end[i, 1] - start[i, 1]
        steep = abs(dy) > abs(dx)
        along, across = (1, 0) if steep else (0, 1)
        least, most, lowest, highest = (top, bottom, left, right) if steep else (left, right, top, bottom)
        first, last = (start, end) if end[i, along] >= start[i, along] else (end, start)
        m0, m1 = first[i, along], last[i, along]
        reach = max(m1 - m0, 1e-9)
        slope = (last[i, across] - first[i, across]) / reach
        half = 0.5 * width * math.hypot(dx, dy) / reach
        for major in range(max(math.floor(m0), least), min(math.floor(m1), most - 1) + 1):
            share = 255.0 * (min(major + 1.0, m1) - max(float(major), m0))
            middle = first[i, across] + (major + 0.5 - m0) * slope
            low, high = middle - half, middle + half
            for minor in range(max(math.floor(low), lowest), min(math.floor(high), highest - 1) + 1):
                amount = int((min(minor + 1.0, high) - max(float(minor), low)) * share + 0.5)
                row, column = (major, minor) if steep else (minor, major)
                if cover[row, column] < amount:
                    cover[row, column] = amount


@compiled
def blend_cover(pixels, cover, clip, colour, opacity):
    """Blend a colour into `pixels` (uint32, rows × columns) where they are covered, and clear `cover`."""
    left, top, right, bottom = clip
    for row in range(top, bottom):
        line, covered = pixels[row], cover[row]
        for column in range(left, right):
            if covered[column]:
                product = int(covered[column]) * opacity + 128
                part = (product + (product >> 8)) >> 8
                line[column] = mixed(line[column], colour, part)
                covered[column] = 0


@compiled
def _ramp(t):
    """∫ min(max(s, 0), 1) ds up to t."""
    if t <= 0.0:
        return 0.0
    return 0.5 * t * t if t < 1.0 else t - 0.5


@compiled
def _accumulate_edge(change, reach, clip, x0, y0, x1, y1):
    """Add what lies right of one edge of a polygon to `change`, row by row.

    change (float64, rows × (columns + 2)): by how much the covered share of a pixel exceeds that of the pixel
    left of it. reach (rows × 2): first and last column touched. Edges downwards count positive, upwards
    negative. In a row where the edge runs from xa to xb, the share of the pixel [c, c + 1) that lies right
    of it is the mean of min(max(c + 1 − x, 0), 1) over xa ≤ x ≤ xb.
    """
    left, top, right, bottom = clip
    sign = 1.0
    if y1 < y0:
        x0, y0, x1, y1, sign = x1, y1, x0, y0, -1.0
    if y1 == y0:
        return
    slope = (x1 - x0) / (y1 - y0)
    for row in range(max(math.floor(y0), top), min(math.ceil(y1), bottom)):
        ya, yb = max(y0, float(row)), min(y1, row + 1.0)
        height = sign * (yb - ya)
        xa = min(max(x0 + (ya - y0) * slope, float(left)), float(right))
        xb = min(max(x0 + (yb - y0) * slope, float(left)), float(right))
        if xb < xa:
            xa, xb = xb, xa
        first, last = math.floor(xa), math.floor(xb)
        if first == last:
            share = first + 1.0 - 0.5 * (xa + xb)
            change[row, first] += height * share
            change[row, first + 1] += height * (1.0 - share)
        else:
            scale, before = height / (xb - xa), 0.0
            for column in range(first, last + 1):
                share = scale * (_ramp(column + 1.0 - xa) - _ramp(column + 1.0 - xb))
                change[row, column] += share - before
                before = share
            change[row, last + 1] += height - before
        reach[row, 0] = min(reach[row, 0], first)
        reach[row, 1] = max(reach[row, 1], last + 1)


@compiled
def fill_polygons(pixels, change, reach, clip, corners, colour, opacity):
    """Blend polygons with `corners` (n, k, 2) into `pixels`, one after the other, by the area they cover.

    change, reach: scratch, see _accumulate_edge; all 0, and no column touched, before and after.
    """
    _, top, right, bottom = clip
    for i in range(len(corners)):
        low, high = float(bottom), float(top)
        for k in range(corners.shape[1]):
            x0, y0 = corners[i, k - 1]
            x1, y1 = corners[i, k]
            _accumulate_edge(change, reach, clip, x0, y0, x1, y1)
            low, high = min(low, y1), max(high, y1)
        for row in range(max(math.floor(low), top), min(math.ceil(high), bottom)):
            line, changed, share = pixels[row], change[row], 0.0
            for column in range(reach[row, 0], reach[row, 1] + 1):
                share += changed[column]
                changed[column] = 0.0
                part = int(min(abs(share), 1.0) * opacity + 0.5)
                if part > 0 and column < right:
                    line[column] = mixed(line[column], colour, part)
            reach[row, 0], reach[row, 1] = len(line), -1


@compiled
def _softened(radius):
    """The radius r of a disc whose edge fades over r ± 1/2 and whose area, π (r² + 1/12), is π radius²."""
    return math.sqrt(max(radius * radius - 1.0 / 12.0, 0.0))


@compiled
def draw_discs(pixels, clip, at, radius, rim, ink, ink_opacity, hollow, hollow_opacity):
    """Discs about `at` (n, 2) of `radius` (n,), one after the other; `rim` > 0 leaves them hollow within it.

    A pixel is covered by how far its middle lies inside, up to half a pixel each way.
    """
    left, top, right, bottom = clip
    for i in range(len(at)):
        x, y, r = at[i, 0] - 0.5, at[i, 1] - 0.5, _softened(radius[i])
        inner = _softened(radius[i] - rim) if rim > 0.0 else -1.0
        for row in range(max(math.ceil(y - r - 0.5), top), min(math.floor(y + r + 0.5), bottom - 1) + 1):
            square = (row - y) ** 2
            half, line = math.sqrt(max((r + 0.5) ** 2 - square, 0.0)), pixels[row]
            for column in range(max(math.ceil(x - half), left), min(math.floor(x + half), right - 1) + 1):
                distance = math.sqrt(square + (column - x) ** 2)
                pixel = mixed(line[column], ink, int(min(r + 0.5 - distance, 1.0) * ink_opacity + 0.5))
                if distance < inner + 0.5:
                    part = int(min(inner + 0.5 - distance, 1.0) * hollow_opacity + 0.5)
                    pixel = mixed(pixel, hollow, part)
                line[column] = pixel
