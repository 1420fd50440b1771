"""Complementarity: which of many contacts push, and how strongly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from systems.near import Floats

FIRM = 1e-11  # of what a contact yields by itself: forces that gaps leave open change the least then
ROUND_OFF = 1e-12  # of the largest gap
PATIENCE = 10  # exchanges of many contacts at once that may fail to leave fewer wrong
MOST_EXCHANGES = 500


def complementary(slope: Floats, gap: Floats, forces: Floats) -> Floats:
    """Forces F ≥ 0, shape (c,), that leave gaps ≥ 0, either being 0 in each contact.

    gap: that with the given forces, and slope: how gaps follow forces, so that they become gap + slope (F − forces).
    Contacts that are wrong, for they pull or overlap, change sides all at once, or, where that goes round in circles,
    the last of them (Júdice, Pires, 1994). What cannot yield is not pushed.
    """
    yields = np.sqrt(np.maximum(np.diag(slope), 0.0))
    free = yields > 0.0
    found = np.zeros(len(gap))
    scale = yields[free]
    scaled, before = slope[np.ix_(free, free)] / np.outer(scale, scale), forces[free] * scale
    scaled[np.diag_indices(len(scale))] += FIRM
    found[free] = _exchanged(scaled, gap[free] / scale - scaled @ before, before > 0.0) / scale
    return found


def _exchanged(slope: Floats, offset: Floats, pushes: NDArray[np.bool_]) -> Floats:
    """F ≥ 0 with slope F + offset ≥ 0, beginning with those contacts pushing."""
    least = ROUND_OFF * np.abs(offset).max(initial=0.0)
    best, patience = len(offset) + 1, PATIENCE
    forces = np.zeros(len(offset))
    for _ in range(MOST_EXCHANGES):
        forces = np.zeros(len(offset))
        forces[pushes] = np.linalg.solve(slope[np.ix_(pushes, pushes)], -offset[pushes])
        left = slope @ forces + offset
        wrong = np.flatnonzero(np.where(pushes, forces < 0.0, left < -least))
        if len(wrong) == 0:
            break
        patience = PATIENCE if len(wrong) < best else patience - 1
        best = min(best, len(wrong))
        changed = wrong if patience > 0 else wrong[-1:]
        pushes[changed] = ~pushes[changed]
    found: Floats = np.maximum(forces, 0.0)
    return found
