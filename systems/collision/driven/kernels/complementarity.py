"""Complementarity: which of several contacts push, and how strongly."""

import math

from pinjoint.systems.collision.driven.columns import Tried
from pinjoint.systems.collision.kernels import compiled

FIRM = 1e-11  # added to the compliance of each contact, as a share: makes forces unique, the least ones
ROUND_OFF = 1e-12  # of the largest gap
PATIENCE = 10  # exchanges of many contacts at once that need not leave fewer contacts wrong
MOST_EXCHANGES = 60
OPEN, PUSHING, FIXED = 0, 1, 2  # sides of a contact; FIXED: without compliance, never pushed


@compiled
def complementary(first, end, slope, search, matrix, marks):
    """Forces F ≥ 0 of some contacts, into FOUND, that leave gaps ≥ 0, either being 0 in each; False if there are none.

    first, end: the first of these contacts, and the one after the last.
    search: has the rows of Tried, of which GAP are the gaps with FORCES. slope: derivative of the gaps, which become
    gap + slope (F − forces).
    Contacts that are wrong, since they pull or overlap, change sides all at once, or, where that goes round in circles,
    only the last of them (Júdice, Pires, Computers & Operations Research 21, 1994).
    matrix, shape (c, c + 1), and marks, shape (2, c): work space.
    """
    gap, forces, found = search[Tried.GAP], search[Tried.FORCES], search[Tried.FOUND]
    scale, offset, sides, wrong = search[Tried.SCALE], search[Tried.OFFSET], marks[0], marks[1]
    largest = _prepare(first, end, slope, gap, forces, scale, offset, sides)
    best, patience, number = end - first + 1, PATIENCE, 0
    for _ in range(MOST_EXCHANGES):
        _close(first, end, slope, found, matrix, scale, offset, sides)
        number, last = _find_wrong(first, end, slope, ROUND_OFF * largest, found, scale, offset, sides, wrong)
        if number == 0:
            break
        patience = PATIENCE if number < best else patience - 1
        best = min(best, number)
        for c in range(first, end):
            if wrong[c] and (patience > 0 or c == last):
                sides[c] = OPEN if sides[c] == PUSHING else PUSHING
    for c in range(first, end):
        found[c] = max(found[c], 0.0) / scale[c] if sides[c] == PUSHING else 0.0
    return number == 0


@compiled
def _prepare(first, end, slope, gap, forces, scale, offset, sides):
    """Scale every contact by its compliance, and find the gaps without forces; returns the largest gap."""
    largest = 0.0
    for c in range(first, end):
        scale[c] = math.sqrt(max(slope[c, c], 0.0))
        sides[c] = FIXED if scale[c] == 0.0 else (PUSHING if forces[c] > 0.0 else OPEN)
    for c in range(first, end):
        if sides[c] != FIXED:
            left = gap[c]
            for d in range(first, end):
                if sides[d] != FIXED:
                    left -= slope[c, d] * forces[d]
            offset[c] = left / scale[c]
            largest = max(largest, abs(offset[c]))
    return largest


@compiled
def _close(first, end, slope, found, matrix, scale, offset, sides):
    """The forces that close the contacts that push, scaled, by elimination with the largest pivots."""
    n = 0
    for c in range(first, end):
        if sides[c] == PUSHING:
            m = 0
            for d in range(first, end):
                if sides[d] == PUSHING:
                    matrix[n, m] = slope[c, d] / (scale[c] * scale[d]) + (FIRM if c == d else 0.0)
                    m += 1
            matrix[n, m] = -offset[c]
            n += 1
    for k in range(n):
        _pivot(k, n, matrix)
        for r in range(k + 1, n):
            share = matrix[r, k] / matrix[k, k]
            for m in range(k + 1, n + 1):
                matrix[r, m] -= share * matrix[k, m]
    for k in range(n - 1, -1, -1):
        for m in range(k + 1, n):
            matrix[k, n] -= matrix[k, m] * matrix[m, n]
        matrix[k, n] /= matrix[k, k]
    k = 0
    for c in range(first, end):
        found[c] = 0.0
        if sides[c] == PUSHING:
            found[c] = matrix[k, n]
            k += 1


@compiled
def _pivot(k, n, matrix):
    """Bring the row with the largest number in column k, from row k on, to row k."""
    best = k
    for r in range(k + 1, n):
        if abs(matrix[r, k]) > abs(matrix[best, k]):
            best = r
    if best != k:
        for m in range(k, n + 1):
            matrix[k, m], matrix[best, m] = matrix[best, m], matrix[k, m]


@compiled
def _find_wrong(first, end, slope, least, found, scale, offset, sides, wrong):
    """Mark contacts that pull, or overlap by more than `least`; returns their number, and the last of them."""
    number, last = 0, -1
    for c in range(first, end):
        wrong[c] = found[c] < 0.0
        if sides[c] == OPEN:
            left = offset[c]
            for d in range(first, end):
                if sides[d] == PUSHING:
                    left += slope[c, d] / (scale[c] * scale[d]) * found[d]
            wrong[c] = left < -least
        if wrong[c]:
            number, last = number + 1, c
    return number, last
