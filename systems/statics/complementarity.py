"""Which of the rods at their strength go on yielding: a linear complementarity problem."""

from __future__ import annotations

from itertools import product

import numpy as np

from systems.statics.equations import Array, Flags

ENUMERATED = 10  # rods up to which all sets are tried if pivoting goes in circles
PIVOTS = 200


def yielding_set(matrix: Array, growth: Array, guess: Flags) -> Flags | None:
    """The set A that solves γ ≥ 0, w = M γ − g ≥ 0, γᵀw = 0, with γ = 0 outside A and w = 0 in it.

    g is how fast the force of each rod (k,) would exceed its strength if none yielded, M γ how much of that
    yielding at the rates γ takes away, M symmetric. None if there is no such set, or none was found.
    Principal pivoting on the least index [K. G. Murty, 1974], which ends from any guess if M is positive
    definite.
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
            if _is_positive(matrix, chosen) and not _violations(matrix, growth, chosen).any():
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


def _is_positive(matrix: Array, chosen: Flags) -> bool:
    return not chosen.any() or bool(np.linalg.eigvalsh(matrix[np.ix_(chosen, chosen)])[0] > 0.0)
