"""Sparse symmetric matrices: solving, definiteness, and the modes that offer least resistance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]

NO_STIFFNESS = 1e-13  # of the rods' at the same particle: what is softer than that is round-off
SOFT = 1e-12  # of the rods' at the same particle: such a motion counts as not resisted
INVERSE_ITERATIONS = 30
BLOCK = 8  # soft modes that are looked for at once


class Factor:
    """LU factors of a symmetric matrix with pivots on its diagonal only.

    By Sylvester's law the pivots have the signs of the eigenvalues. If a pivot vanishes there is nothing
    to solve with: `exists` is False.
    """

    def __init__(self, matrix: csc_matrix) -> None:
        self.size = matrix.shape[0]
        self.exists, self.negative = True, 0
        if self.size == 0:
            return
        try:
            self._lu = splu(
                matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:  # exactly singular
            self.exists, self.negative = False, self.size
            return
        pivots = self._lu.U.diagonal()
        moved = not np.array_equal(self._lu.perm_r, self._lu.perm_c)
        self.negative = int((pivots <= 0.0).sum()) if not moved else max(1, int((pivots <= 0.0).sum()))

    @property
    def definite(self) -> bool:
        """True if the matrix is positive definite."""
        return self.exists and self.negative == 0

    def solve(self, right: Array) -> Array:
        """The solution for one or several right-hand sides, (N,) or (N, k)."""
        if self.size == 0:
            return np.zeros_like(right)
        solution: Array = self._lu.solve(right)
        return solution


def regular(matrix: csc_matrix, weight: Array, share: float = NO_STIFFNESS) -> Factor:
    """Factor of K + share × weight: definite if no motion is resisted by less than −share."""
    return Factor(csc_matrix(matrix + diags(share * weight, format="csc")))


def lowest_mode(matrix: csc_matrix, weight: Array) -> tuple[float, Array]:
    """The least eigenvalue λ of K φ = λ W φ and its mode, φᵀWφ = 1, by shifted inverse iteration."""
    share = NO_STIFFNESS
    factor = regular(matrix, weight, share)
    while not factor.definite:
        share *= 4.0
        factor = regular(matrix, weight, share)
    mode = _start(len(weight), 1)[:, 0]
    value = np.inf
    for _ in range(INVERSE_ITERATIONS):
        mode = factor.solve(weight * mode)
        mode /= np.sqrt(float((weight * mode * mode).sum()))
        previous, value = value, float(mode @ (matrix @ mode))
        if abs(value - previous) <= 1e-6 * abs(value + share):
            break
    return value, mode


def soft_modes(matrix: csc_matrix, weight: Array, factor: Factor | None = None) -> Array:
    """Up to 8 modes (N, k) that K resists by less than a share SOFT of W, orthonormal in W."""
    factor = factor or regular(matrix, weight)
    if len(weight) == 0 or not factor.exists:
        return np.zeros((len(weight), 0))
    root = np.sqrt(weight)
    block = _start(len(weight), min(BLOCK, len(weight)))
    for _ in range(4):
        block = root[:, None] * factor.solve(weight[:, None] * block)
        block = np.linalg.qr(block)[0] / root[:, None]
    values, turn = np.linalg.eigh(block.T @ (matrix @ block))
    modes: Array = (block @ turn)[:, np.abs(values) < SOFT]
    return modes


def _start(size: int, count: int) -> Array:
    """Fixed vectors with a part in every direction, the same in every run."""
    numbers = np.arange(1, size * count + 1) * 0.6180339887498949
    return (np.modf(numbers)[0] - 0.5).reshape(count, size).T.copy()
