"""Rasterising: polygons, and anti-aliased strokes, rectangles and discs, written straight into the pixels of a surface.

Points are in pixels, y down; the pixel (row, column) covers [column, column + 1) × [row, row + 1). Pixels are
four channels of 8 bits, in whatever order. clip: left, top, right, bottom; nothing beyond it is touched.
"""

from __future__ import annotations

import math

import numpy as np

from pinjoint.systems.program.kernel import compiled

BLOCK = 32  # pixels side by side that are blended at once if any is covered
_EVEN = np.uint32(0x00FF00FF)  # every second channel of a pixel
_ODD = np.uint32(0xFF00FF00)
_HALVES = np.uint32(0x00800080)  # 0.5 in both of them, for rounding
_EIGHT = np.uint32(8)
_BLOCK = np.uint64(BLOCK)
_ONE = 16  # bits behind the point of a length


@compiled
def mixed(old, new, part):
    """A pixel of which `part` of 255 is replaced by another, each channel rounded to the nearest.

    Two channels at a time, 16 bits each. (v + 128 + ((v + 128) >> 8)) >> 8 is v / 255, rounded. All in 32 bits,
    so that vector instructions mix many pixels at once.
    """
    there = np.uint32(part)
    rest = np.uint32(np.uint32(255) - there)
    even = np.uint32((old & _EVEN) * rest + (new & _EVEN) * there + _HALVES)
    odd = np.uint32(((old >> _EIGHT) & _EVEN) * rest + ((new >> _EIGHT) & _EVEN) * there + _HALVES)
    even = np.uint32((even + ((even >> _EIGHT) & _EVEN)) >> _EIGHT) & _EVEN
    odd = np.uint32(odd + ((odd >> _EIGHT) & _EVEN)) & _ODD
    return np.uint32(even | odd)


@compiled
def cover_strokes(cover, touched, clip, start, end, width):
    """Raise `cover` (uint8, rows × columns) to what strokes from `start` to `end`, each (n, 2), cover.

    touched (uint8, rows × blocks of columns): set where they do. Returns the part of the clip that they can reach: a flat
    one is at most √2 times as high as it is wide.

    The compiled form of raster.stroke_coverage: where strokes cross, the one that covers most counts. Along a
    stroke, where it begins and how much of a column it crosses are whole numbers of 1 / 2¹⁶.
    """
    left, top, right, bottom = clip
    one = float(1 << _ONE)
    min_x, min_y, max_x, max_y = np.inf, np.inf, -np.inf, -np.inf
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
        begin = max(math.floor(m0), least)
        low = int((first[i, across] + (begin + 0.5 - m0) * slope - half) * one)
        thickness, rise = int(2.0 * half * one), int(slope * one)
        for major in range(begin, min(math.floor(m1), most - 1) + 1):
            share = int(255.0 * one * (min(major + 1.0, m1) - max(float(major), m0)))
            high = low + thickness
            for minor in range(max(low >> _ONE, lowest), min(high >> _ONE, highest - 1) + 1):
                part = min((minor + 1) << _ONE, high) - max(minor << _ONE, low)
                amount = np.uint8((part * share + (1 << (2 * _ONE - 1))) >> (2 * _ONE))
                row, column = (major, minor) if steep else (minor, major)
                at = np.uint64(row), np.uint64(column)  # signed indices would cost a check for negative ones
                cover[at] = max(cover[at], amount)
                touched[at[0], at[1] // _BLOCK] = 1
            low += rise
        min_x, max_x = min(min_x, start[i, 0], end[i, 0]), max(max_x, start[i, 0], end[i, 0])
        min_y, max_y = min(min_y, start[i, 1], end[i, 1]), max(max_y, start[i, 1], end[i, 1])
    beside = 0.75 * width + 1.0
    low_x, low_y = min(max(min_x - beside, left), right), min(max(min_y - beside, top), bottom)
    high_x, high_y = max(min(max_x + beside + 1.0, right), left), max(min(max_y + beside + 1.0, bottom), top)
    return int(low_x), int(low_y), int(high_x), int(high_y)


@compiled
def blend_cover(pixels, cover, touched, clip, colour, opacity):
    """Blend a colour into `pixels` (uint32, rows × columns) where they are covered; clear `cover` and `touched`."""
    left, top, right, bottom = clip
    opaque = np.uint32(opacity)
    for row in range(top, bottom):
        for block in range(left // BLOCK, (right + BLOCK - 1) // BLOCK):
            if not touched[row, block]:
                continue
            first = block * BLOCK
            line, covered = pixels[row, first : first + BLOCK], cover[row, first : first + BLOCK]
            for column in range(len(line)):
                product = np.uint32(np.uint32(covered[column]) * opaque + np.uint32(128))
                line[column] = mixed(line[column], colour, (product + (product >> _EIGHT)) >> _EIGHT)
            for column in range(len(covered)):
                covered[column] = 0
            touched[row, block] = 0


@compiled
def draw_strokes(pixels, cover, touched, clip, start, end, width, colour, opacity):
    """Blend strokes into `pixels`; each pixel by the stroke that covers most of it."""
    blend_cover(pixels, cover, touched, cover_strokes(cover, touched, clip, start, end, width), colour, opacity)


@compiled
def fill_polygons(pixels, clip, corners, colour, opacity):
    """Blend polygons with `corners` (n, k, 2) in whole pixels into `pixels`, one after the other.

    The same pixels as by pygame.gfxdraw.filled_polygon: in each row between the first crossing of an edge and the second,
    between the third and the fourth, and so on.
    """
    left, top, right, bottom = clip
    there = np.uint32(256 if opacity == 255 else opacity)
    rest, half = np.uint32(np.uint32(256) - there), 1 << (_ONE - 1)
    even_ink, odd_ink = np.uint32((colour & _EVEN) * there), np.uint32(((colour >> _EIGHT) & _EVEN) * there)
    count = np.zeros(max(bottom - top, 0), dtype=np.int64)  # of crossings, by row
    crossings = np.empty((len(count), corners.shape[1]), dtype=np.int64)  # in order
    for i in range(len(corners)):
        lowest, highest = corners[i, :, 1].min(), corners[i, :, 1].max()
        for k in range(corners.shape[1]):
            first, last = (k - 1, k) if corners[i, k - 1, 1] < corners[i, k, 1] else (k, k - 1)
            x, y, end = corners[i, first, 0], corners[i, first, 1], corners[i, last, 1]
            for row in range(max(y, top), min(end + int(y < end == highest), bottom)):
                crossing = ((row - y) << _ONE) // (end - y) * (corners[i, last, 0] - x) + (x << _ONE)
                place = count[row - top]
                while place > 0 and crossings[row - top, place - 1] > crossing:
                    crossings[row - top, place] = crossings[row - top, place - 1]
                    place -= 1
                crossings[row - top, place] = crossing
                count[row - top] += 1
        for row in range(max(lowest, top), min(highest + 1, bottom)):
            for k in range(0, count[row - top] - 1, 2):
                first = (crossings[row - top, k] + 1 + half) >> _ONE
                last = (crossings[row - top, k + 1] - 1 + half) >> _ONE
                line = pixels[row, max(min(first, last), left) : max(min(max(first, last) + 1, right), left)]
                for column in range(len(line)):
                    old = line[column]
                    even = np.uint32((old & _EVEN) * rest + even_ink) >> _EIGHT
                    odd = np.uint32(((old >> _EIGHT) & _EVEN) * rest + odd_ink)
                    line[column] = np.uint32((even & _EVEN) | (odd & _ODD))
            count[row - top] = 0


@compiled
def _overlap(middle, length):
    """How much of [middle − 1/2, middle + 1/2] lies within [0, length]."""
    half, nothing = np.float32(0.5), np.float32(0.0)
    return max(min(middle + half, length) - max(middle - half, nothing), nothing)


@compiled
def _crossing(at, slope, length):
    """The interval of t in which at + slope t may overlap [0, length]."""
    per = 1.0 / slope if abs(slope) > 1e-6 else 1e6
    t0, t1 = (-0.5 - at) * per, (length + 0.5 - at) * per
    return min(t0, t1), max(t0, t1)


@compiled
def _axis(x, y):
    """The direction of (x, y) scaled to a larger component of 1, and the length of (x, y) in that scale.

    Middles of neighbouring pixels are then 1 apart, the width of a pixel: the cover of a bar in a column, or in a
    row if the bar is steep, is exact.
    """
    most = max(abs(x), abs(y))
    return x / most, y / most, (x * x + y * y) / most


@compiled
def draw_bars(pixels, clip, start, end, rise, colour, opacity):
    """Blend rectangles into `pixels`, one after the other: each stands on a line from `start` to `end`, (n, 2).

    rise: from that line to the opposite one, (n, 2), at right angles. How much of a pixel is covered is the share
    of it along the rectangle, times that across; exact where the rectangle is upright.
    """
    left, top, right, bottom = clip
    opaque, half = np.float32(opacity), np.float32(0.5)
    for i in range(len(start)):
        x, y = start[i, 0], start[i, 1]
        dx, dy, up_x, up_y = end[i, 0] - x, end[i, 1] - y, rise[i, 0], rise[i, 1]
        if (dx == 0.0 and dy == 0.0) or (up_x == 0.0 and up_y == 0.0):
            continue
        (ax, ay, length), (bx, by, height) = _axis(dx, dy), _axis(up_x, up_y)
        low, high = y + min(dy, 0.0) + min(up_y, 0.0), y + max(dy, 0.0) + max(up_y, 0.0)
        for row in range(max(math.floor(low - 0.5), top), min(math.ceil(high + 0.5), bottom)):
            along, across = (row + 0.5 - y) * ay, (row + 0.5 - y) * by
            first_a, last_a = _crossing(along, ax, length)
            first_b, last_b = _crossing(across, bx, height)
            first = max(math.floor(x + max(first_a, first_b)), left)
            last = min(math.ceil(x + min(last_a, last_b)), right)
            if first >= last:
                continue
            # Whole sixteens: a processor blends those at once, and takes the rest one by one.
            line = pixels[row, first : min(first + (last - first + 15) // 16 * 16, right)]
            a, da, all_a = np.float32(along + (first + 0.5 - x) * ax), np.float32(ax), np.float32(length)
            b, db, all_b = np.float32(across + (first + 0.5 - x) * bx), np.float32(bx), np.float32(height)
            for column in range(len(line)):
                t = np.float32(column)
                share = _overlap(a + t * da, all_a) * _overlap(b + t * db, all_b)
                line[column] = mixed(line[column], colour, np.uint32(share * opaque + half))


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
