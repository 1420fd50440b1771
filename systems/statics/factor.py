"""Symmetric matrices, full or sparse: solving, definiteness, and the softest modes."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import cache, cached_property
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pinjoint.components.arrays import ROUND_OFF, Array, Flags
from pinjoint.components.model import Model
from pinjoint.systems.statics.assembly import SYMMETRIC, Matrix
from pinjoint.systems.statics.equations import SOFT, Structure
from pinjoint.systems.statics.response import Response

if TYPE_CHECKING:  # only large structures need it
    from scipy.sparse import csc_matrix

HOLDS_LAPACK = "scipy.linalg._flapack"
_THREADS = "OPENBLAS_NUM_THREADS"
NO_STIFFNESS = 1e-13  # of the rods' stiffness at the same particle: round-off
SURELY_HELD = 8e-9  # of the same: what is resisted by more loses no digits, by any measure of a motion
SOFT_MODES = 8  # that are looked for at most
HELD = 1e-9  # of the largest stiffness: a motion that is resisted less is not held
INVERSE_ITERATIONS = 30


@cache
def lapack() -> Any:
    """The module with dsytrf and dsytrs; scipy.linalg.lapack, which has the same, where scipy keeps it elsewhere.

    Importing that takes 0.12 s, longer than most structures take to settle; the module of scipy that holds LAPACK, 3 ms.
    It keeps to one thread unless a person chose: while other programs take the cores, threads wait for one another, and
    one factorisation of 150 unknowns in twenty takes 100 ms and more in place of 0.2.
    """
    import scipy

    if HOLDS_LAPACK in sys.modules:
        return sys.modules[HOLDS_LAPACK]
    chosen = os.environ.get(_THREADS)
    os.environ[_THREADS] = chosen or "1"  # which it reads when it is loaded
    try:
        return _loaded_lapack(Path(scipy.__file__).parent)
    finally:
        if chosen is None:
            del os.environ[_THREADS]


def _loaded_lapack(scipy_folder: Path) -> Any:
    spec = PathFinder.find_spec(HOLDS_LAPACK, [str(scipy_folder / "linalg")])
    if spec is None or spec.loader is None:
        import scipy.linalg.lapack

        return scipy.linalg.lapack
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return sys.modules.setdefault(HOLDS_LAPACK, module)  # scipy.linalg takes the same one


class Factor:
    """A factored symmetric matrix: L D Lᵀ, full or sparse.

    negative: number of eigenvalues that are not positive, by Sylvester's law from the signs of D; all if it does not exist.
    exists: False if a pivot vanishes, so that the matrix cannot be solved with.
    """

    def __init__(self, matrix: Matrix) -> None:
        self._solve: Callable[[Array], Array] = np.zeros_like
        self._count: Callable[[], int] = lambda: 0
        self.exists, self._size = True, matrix.shape[0]
        if isinstance(matrix, np.ndarray):
            self._factor_full(matrix)
        else:
            self._factor_sparse(matrix)

    @cached_property
    def negative(self) -> int:
        return self._count() if self.exists else self._size

    def _factor_full(self, matrix: Array) -> None:
        """Bunch and Kaufman's pivoting; its 2 × 2 pivots have one eigenvalue of either sign."""
        if matrix.shape[0] == 0:
            return
        dsytrf, dsytrs = lapack().dsytrf, lapack().dsytrs
        factors, swaps, info = dsytrf(matrix, lower=1)
        self.exists = info == 0
        single = swaps >= 0
        self._count = lambda: int((np.diagonal(factors)[single] <= 0.0).sum()) + int((~single).sum()) // 2
        self._solve = lambda right: dsytrs(factors, swaps, right, lower=1)[0].reshape(right.shape)

    def _factor_sparse(self, matrix: csc_matrix) -> None:
        """Pivots on the diagonal only, so that they are those of a symmetric elimination."""
        from scipy.sparse.linalg import splu

        try:
            factors = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=SYMMETRIC)
        except RuntimeError:  # exactly singular
            self.exists = False
            return
        swaps = not np.array_equal(factors.perm_r, factors.perm_c)  # a diagonal entry was zero
        self._count = lambda: max(int(swaps), int((factors.U.diagonal() <= 0.0).sum()))
        self._solve = factors.solve

    @property
    def definite(self) -> bool:
        """True if the matrix is positive definite."""
        return self.exists and self.negative == 0

    def solve(self, right: Array) -> Array:
        """The solution for one or several right-hand sides, (N,) or (N, k)."""
        return self._solve(right)


def regular(matrix: Matrix, weight: Array, share: float = NO_STIFFNESS) -> Factor:
    """Factor of K + share × weight: as many eigenvalues are negative as there are motions resisted by less than −share."""
    return Factor(shifted(matrix, weight, share))


def shifted(matrix: Matrix, weight: Array, share: float = NO_STIFFNESS) -> Matrix:
    """K + share × weight."""
    if isinstance(matrix, np.ndarray):
        return matrix + np.diag(share * weight)
    found = copy(matrix)  # a fifth of the time of its own
    found.data = matrix.data.copy()
    own = found.indices == np.repeat(np.arange(len(weight)), np.diff(found.indptr))
    if np.count_nonzero(own) == len(weight):  # all of the diagonal is there: in a tenth of the time
        found.data[own] += share * weight
    else:
        found.setdiag(matrix.diagonal() + share * weight)
    return found


def is_stable(structure: Structure, response: Response, soft: Flags | None = None) -> bool:
    """True if every small motion is resisted while these rods are soft; None: those that are soft now."""
    matrix = structure.tangent(response, response.soft if soft is None else soft)
    return regular(matrix, structure.weight).definite


def is_held(model: Model, *, at_first: bool = False) -> bool:
    """True if every small displacement of the nodes is resisted, found quickly enough for every frame.

    at_first: as if no rod bore any force yet, so that mechanisms are not held, whatever tension keeps them in shape.
    Yielding rods and slack cables do not resist elongation, struts that have buckled hardly.
    """
    particles, rods = model.particles, model.rods
    structure = replace(Structure.of(model).with_translations(), sparse=False)
    place = structure.field(particles.displacement, particles.rotation)
    response = structure.respond(place, np.column_stack([rods.plastic_strain, rods.plastic_rotation]), 1.0)
    soft = rods.yielding | (rods.tension_only & (rods.axial_force <= 0.0))
    soft = soft | (rods.axial_force < -rods.buckling_load)
    if structure.ends_yield:
        hinges = structure.untied(rods.hinge_yielding, np.abs(rods.plastic_rotation))
        soft = np.column_stack([soft, hinges])
    tangent = structure.tangent(response, soft & (not at_first), geometric=not at_first)
    share = HELD if structure.bending is None else SOFT  # long members bend a million times more easily
    try:
        np.linalg.cholesky(tangent - share * np.eye(structure.size) * np.abs(tangent).max(initial=0.0))
    except np.linalg.LinAlgError:
        return False
    return structure.size > 0


def softest(
    structure: Structure, response: Response, soft: Flags | None = None, *, nearest: bool = False
) -> tuple[float, Array]:
    """The least eigenvalue λ of K φ = λ W φ and its mode, φᵀWφ = 1, by shifted inverse iteration.

    soft: the rods without stiffness; None: those that are soft now. nearest: of all eigenvalues that nearest to 0.
    """
    matrix, weight = structure.tangent(response, response.soft if soft is None else soft), structure.weight
    share = NO_STIFFNESS
    factor = regular(matrix, weight, share)
    while not (factor.definite or nearest):
        share *= 4.0
        factor = regular(matrix, weight, share)
    mode = pseudo_random(len(weight), 1)[:, 0]
    value = np.inf
    for _ in range(INVERSE_ITERATIONS):
        mode = factor.solve(weight * mode)
        mode /= np.sqrt(float((weight * mode * mode).sum()))
        previous, value = value, float(mode @ (matrix @ mode))
        if abs(value - previous) <= 1e-6 * abs(value + share):
            break
    return value, mode


def lowest(factor: Factor, weight: Array) -> float:
    """About the eigenvalue λ of K φ = λ W φ nearest to 0, of a factor as by `regular`; 0 where that is singular."""
    mode, inverse = pseudo_random(len(weight), 1)[:, 0], np.inf
    for _ in range(6 if factor.exists else 0):
        mode /= np.sqrt(float((weight * mode * mode).sum()))
        solved = factor.solve(weight * mode)
        inverse, mode = float((weight * mode * solved).sum()), solved
    return 1.0 / inverse - NO_STIFFNESS if factor.exists else 0.0


def soft_modes(matrix: Matrix, weight: Array, factor: Factor | None = None, most: int = SOFT_MODES) -> Array:
    """Up to `most` modes (N, k) that K resists by less than a share SOFT of W, orthonormal in W."""
    factor = factor or regular(matrix, weight)
    if len(weight) == 0 or most == 0 or not factor.exists:
        return np.zeros((len(weight), 0))
    if isinstance(matrix, np.ndarray) and regular(matrix, weight, -SOFT).definite:  # in a quarter of the time
        return np.zeros((len(weight), 0))
    root = np.sqrt(weight)
    block = pseudo_random(len(weight), min(most, len(weight)))
    for _ in range(4):
        block = root[:, None] * factor.solve(weight[:, None] * block)
        block = np.linalg.qr(block)[0] / root[:, None]
    resisted = block.T @ (matrix @ block)
    if not np.isfinite(resisted).all():  # beyond the numbers that one can compute with
        return np.zeros((len(weight), 0))
    values, turn = np.linalg.eigh(resisted)
    return (block @ turn)[:, np.abs(values) < SOFT]


def unresisted(
    structure: Structure,
    response: Response,
    matrix: Matrix,
    factor: Factor | None = None,
    most: int = SOFT_MODES,
) -> Array:
    """Soft modes (N, k) that round-off alone resists: not the bending of what many rods divide."""
    modes = soft_modes(matrix, structure.weight, factor, most)
    if structure.bending is None:
        return modes
    kept = [float(m @ (matrix @ m)) <= SOFT * structure.effort(m, response) + ROUND_OFF for m in modes.T]
    return modes[:, kept]  # a bar that turns takes no effort at all; modes are orthonormal in W


def pseudo_random(size: int, count: int) -> Array:
    """Fixed vectors with a part in every direction, the same in every run."""
    numbers = np.arange(1, size * count + 1) * 0.6180339887498949
    return (np.modf(numbers)[0] - 0.5).reshape(count, size).T.copy()
