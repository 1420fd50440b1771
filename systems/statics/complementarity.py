"""The set of yielding rods at a limit: a linear complementarity problem."""

from __future__ import annotations

from itertools import product

import numpy as np

from systems.statics.equations import Array, Flags

ENUMERATED = 10  # rods up to which all sets are tried if pivoting does not end
PIVOTS = 200


def yielding_set(matrix: Array, growth: Array, guess: Flags) -> Flags | None:
    """The set A that solves γ ≥ 0, w = M γ − g ≥ 0, γᵀw = 0, with γ = 0 outside A and w = 0 in it.

    growth g (k,): the rates at which forces of rods would exceed their strengths if none yielded. matrix M (k, k),
    symmetric: yielding at the rates γ lowers them by M γ. None if no set was found. Principal pivoting on the least
    index [K. G. Murty, 1974] ends from any guess if M is positive definite.
    """
    chosen = guess.copy()
    for _ in range(PIVOTS):
        wrong = _violations(matrix, growth, chosen)
        if not wrong.any():
            return chosen
        first = int(wrong.argmax())
        chosen[first] = not chosen[first]
    if len(growth) <= ENUMERATED:
        for trial in product([True, False], repeat=len(growth)):
            chosen = np.array(trial)
            definite = not any(trial) or np.linalg.eigvalsh(matrix[np.ix_(chosen, chosen)])[0] > 0.0
            if definite and not _violations(matrix, growth, chosen).any():
                return chosen
    return None


def _violations(matrix: Array, growth: Array, chosen: Flags) -> Flags:
    rates = np.zeros_like(growth)
    if chosen.any():
        try:
            rates[chosen] = np.linalg.solve(matrix[np.ix_(chosen, chosen)], growth[chosen])
        except np.linalg.LinAlgError:
            return chosen.copy()
    excess = growth - matrix @ rates
    return np.where(chosen, rates < 0.0, excess > 1e-12 * np.abs(growth).max())
