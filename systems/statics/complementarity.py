"""The set of yielding rods at a limit: a linear complementarity problem."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from pinjoint.components.arrays import Array, Flags

_ENUMERATED = 10  # rods up to which all sets are tried if pivoting does not end
_PIVOTS = 200
_OWN = 1e-4  # of what yielding lowers its own force by: if others lower all but this, they do as well


def yielding_set(matrix: Array, growth: Array, guess: Flags) -> Flags | None:
    """The set A that solves γ ≥ 0, w = M γ − g ≥ 0, γᵀw = 0, with γ = 0 outside A and w = 0 in it.

    growth g (k,): the rates at which forces of rods would exceed their strengths if none yielded. matrix M (k, k),
    symmetric: yielding at the rates γ lowers them by M γ. None if no set was found. Principal pivoting on the least
    index [K. G. Murty, 1974] ends from any guess if M is positive definite.
    """
    chosen = _pivoted(matrix, growth, guess)
    if chosen is not None:
        return chosen
    for chosen in yielding_sets(matrix, growth, guess):
        if not chosen.any() or np.linalg.eigvalsh(matrix[np.ix_(chosen, chosen)])[0] > 0.0:
            return chosen
    return None


def yielding_sets(matrix: Array, growth: Array, guess: Flags) -> Iterator[Flags]:
    """All sets that solve the problem, the largest first; of more than _ENUMERATED rods those that pivoting finds."""
    if len(growth) <= _ENUMERATED:
        trials = (np.array(trial, dtype=bool) for trial in product([True, False], repeat=len(growth)))
        yield from (trial for trial in trials if not _violations(matrix, growth, trial).any())
    else:
        for start in (guess, np.ones_like(guess), np.zeros_like(guess)):
            chosen = _pivoted(matrix, growth, start)
            if chosen is not None:
                yield chosen


def independent(matrix: Array, chosen: Flags, first: Flags) -> Flags:
    """Of a set as many as lower the forces in ways of their own, those of `first` before others: the rest need not yield."""
    kept: list[int] = []
    for row in sorted(np.flatnonzero(chosen).tolist(), key=lambda row: not first[row]):
        across = matrix[kept, row]
        own = matrix[row, row] - across @ np.linalg.solve(matrix[np.ix_(kept, kept)], across)
        if own > _OWN * matrix[row, row]:
            kept.append(row)
    found = np.zeros_like(chosen)
    found[kept] = True
    return found


def _pivoted(matrix: Array, growth: Array, guess: Flags) -> Flags | None:
    """The set that principal pivoting finds from a guess, if it ends."""
    chosen = guess.copy()
    for _ in range(_PIVOTS):
        wrong = _violations(matrix, growth, chosen)
        if not wrong.any():
            return chosen
        first = int(wrong.argmax())
        chosen[first] = not chosen[first]
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
