"""Complementarity: which of many contacts push, and how strongly; plainly, in numpy."""

import numpy as np
from numpy.typing import NDArray

from pinjoint.systems.collision.driven.kernels.complementarity import FIRM, MOST_EXCHANGES, PATIENCE, ROUND_OFF

Floats = NDArray[np.float64]


def complementary(slope: Floats, gap: Floats, forces: Floats) -> Floats:
    """Forces F ≥ 0, shape (c,), that leave gaps ≥ 0, either being 0 in each contact.

    gap: that with the given forces, and slope: how gaps follow forces, so that they become gap + slope (F − forces).
    As systems/collision/kernels/complementarity.py.
    """
    yields = np.sqrt(np.maximum(np.diag(slope), 0.0))
    free = yields > 0.0
    found = np.zeros(len(gap))
    scale = yields[free]
    scaled, before = slope[np.ix_(free, free)] / np.outer(scale, scale), forces[free] * scale
    offset = gap[free] / scale - scaled @ before
    scaled[np.diag_indices(len(scale))] += FIRM
    found[free] = _exchanged(scaled, offset, before > 0.0) / scale
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
