"""The elastica: a slender inextensible column between hinges, in any shape, by complete elliptic integrals."""

import math

from scipy.optimize import brentq
from scipy.special import ellipe, ellipk


def pinned_column(shortening: float) -> tuple[float, float]:
    """P/P_E and the deflection of the middle over the length L of a column whose ends came nearer by a share of L.

    With k = sin(α/2), α the slope at its ends: P = (2K/π)² P_E, shortening = 2 − 2E/K, deflection = k L/K
    [S. Timoshenko, J. Gere: Theory of elastic stability, 1961, section 2.7].
    """
    square = brentq(lambda m: 2.0 - 2.0 * ellipe(m) / ellipk(m) - shortening, 0.0, 0.9, xtol=1e-16)
    quarter = float(ellipk(square))
    return (2.0 * quarter / math.pi) ** 2, math.sqrt(square) / quarter
