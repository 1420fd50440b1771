"""The equilibrium of a pile: where a pile that hardly moves any more comes to rest.

The equilibrium sought is that in which the motion ends, not a short cut to another one: it counts only where no disc
is farther from it than a fortieth of its radius; from farther away, the pile goes on moving.

The equilibrium is a minimum of the potential energy −f·x under gaps ≥ 0. Since discs are convex, a stable one has
as many contacts as freedoms, and these alone determine it. It is found by the interior-point method: gaps s and
forces λ follow
    f + Nᵀ λ = 0,   s = gap(x),   λ s = μ,   μ → 0
by Newton's method, with the normals N at the present x and a little inertia, so that discs that nothing holds yet do
not drift away (Nocedal, Wright, Numerical Optimization (2006), chapter 19).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import splu

from pinjoint.components.arrays import Array
from pinjoint.components.obstacles import Obstacles
from pinjoint.systems.broad_phase import Rows, gaps, near_pairs

AROUND = 0.1  # of its radius around each disc, in which its neighbours are listed, and iterates are sought
FARTHEST = 0.025  # of its radius: an equilibrium to which a disc would go farther is not near
_FIRST_BARRIER = 1e-5  # μ at first, in weight × radius of the lighter and the smaller of a pair
QUICK, SLOW = 0.03, 0.8  # what is left of μ after an iteration that got far, and after others
_LONG_STEP = 0.5  # of Newton's step: an iteration that takes more of it got far
_TO_EDGE = 0.995  # of the way to where a gap or a force vanishes
STILL, BALANCED = 1e-10, 5e-10  # at the end: motion in radii, residual force in largest weights
_CLOSED = 1e-13  # μ at the end
_EARLY_ITERATIONS = 10  # after which discs move less than _LITTLE radii, or no equilibrium is near
_LITTLE = 1e-2
_MOST_NEWTON_ITERATIONS = 60  # 10 to 30 are usual


class EquilibriumSearch:
    """The search for the equilibrium of discs that lie on one another, on held discs and on obstacles.

    place: centres, shape (n, 2), m. radius: shape (n,), m. inverse_mass: of each direction, shape (n, 2), 1/kg,
    0 where it is held. pull: acceleration without contacts, shape (n, 2), m/s². In pairs, the numbers of obstacles follow
    those of the discs. pushing: pairs that are known to push, the lower number first, shape (c, 2); forces: between them,
    shape (c,), N. A disc in none of these pairs flies: it is not moved, and a disc that it comes near is not at rest.
    """

    def __init__(
        self,
        place: Array,
        radius: Array,
        inverse_mass: Array,
        pull: Array,
        obstacles: Obstacles,
        pushing: Rows,
        forces: Array,
    ) -> None:
        self._start, self._place, self._radius = place, place.copy(), radius
        self._obstacles = obstacles
        count = len(place)
        self._moves: NDArray[np.bool_] = np.zeros(count + len(obstacles), dtype=bool)
        self._moves[pushing] = True
        self._moves[:count] &= (inverse_mass > 0.0).any(axis=1)
        self._moves[count:] = False
        self._flies = np.zeros_like(self._moves)
        self._flies[:count] = (inverse_mass > 0.0).any(axis=1) & ~self._moves[:count]
        self._free = (inverse_mass > 0.0) & self._moves[:count, None]
        self._unknown = np.full((len(self._moves), 2), -1)
        self._unknown[:count][self._free] = np.arange(self._free.sum())
        self._force: Array = (pull / np.where(self._free, inverse_mass, 1.0))[self._free]
        mass = 1.0 / np.where(self._free.any(axis=1), inverse_mass.max(axis=1), 1.0)
        everywhere = np.full(len(obstacles), np.inf)
        self._weight = np.append(mass * float(np.hypot(*pull.T).max(initial=0.0)), everywhere)
        self._weight[~self._moves] = np.inf
        self._size = np.append(radius, everywhere)
        # Lets a disc that nothing holds go by a radius in an iteration.
        inertia = (self._weight[:count] / radius)[:, None]
        self._inertia = np.broadcast_to(inertia, place.shape)[self._free]
        self._list(pushing, forces)

    def solve(self) -> tuple[Rows, Array, Rows, Array] | None:
        """The equilibrium, if it is near and no disc in it rests on a flying one; else None.

        The discs that lie in the pile, shape (k,); displacements of all discs to the equilibrium, shape (n, 2), m; the
        pairs that push each other, shape (c, 2); and the forces between them, shape (c,), N.
        """
        if len(self._force) == 0 or not self._iterate():
            return None
        pairs, slack, force = self._pairs, self._slack, self._forces
        weight, size = self._weight[pairs].min(axis=1), self._size[pairs].min(axis=1)
        pushing = force / weight > slack / size
        if self._flies[pairs[pushing]].any():
            return None
        return np.flatnonzero(self._moves), self._place - self._start, pairs[pushing], force[pushing]

    def _iterate(self) -> bool:
        """Iterate by Newton's method; True if it converges to an equilibrium near by."""
        barrier = _FIRST_BARRIER
        for turn in range(_MOST_NEWTON_ITERATIONS):
            try:
                motion, opening, change, left = self._newton(barrier)
            except RuntimeError:  # singular
                return False
            forward, stronger = _share(self._slack, opening), _share(self._forces, change)
            self._place = self._place + forward * motion
            astray = turn >= _EARLY_ITERATIONS and self._farthest(motion) > _LITTLE
            if astray or not self._farthest(self._place - self._start) <= AROUND:
                return False
            self._slack += forward * opening
            self._forces += stronger * change
            present = float((self._forces * self._slack / self._scale).mean())
            if self._farthest(motion) <= STILL and left <= BALANCED and present <= _CLOSED:
                return self._farthest(self._place - self._start) <= FARTHEST
            barrier = max((QUICK if min(forward, stronger) > _LONG_STEP else SLOW) * present, 0.1 * _CLOSED)
        return False

    def _farthest(self, motion: Array) -> float:
        """The longest of displacements, in radii of its disc."""
        return float((np.abs(motion).max(axis=1) / self._radius).max())

    def _list(self, pushing: Rows, forces: Array) -> None:
        """List the pairs that may touch, and iterates of their gaps (slack, m) and forces (N), and the scale of λ s (J).

        Forces of pairs that push are known; λ s = μ where gaps are small.
        """
        near = near_pairs(self._place, (1.0 + AROUND) * self._radius, self._obstacles)
        pairs = near[self._moves[near].any(axis=1)]
        size = self._size[pairs].min(axis=1)
        scale = self._weight[pairs].min(axis=1) * size
        known, count = np.zeros(len(pairs)), len(self._moves)
        _, here, there = np.intersect1d(pairs @ [count, 1], pushing @ [count, 1], return_indices=True)
        known[here] = forces[there]
        force = np.maximum(known, np.sqrt(_FIRST_BARRIER) * scale / size)
        gap, _ = gaps(self._place, self._radius, pairs, self._obstacles)
        slack = np.maximum(gap, _FIRST_BARRIER * scale / force)
        self._pairs, self._slack, self._scale = pairs, slack, scale
        self._forces = np.where(known > 0.0, force, _FIRST_BARRIER * scale / slack)

    def _newton(self, barrier: float) -> tuple[Array, Array, Array, float]:
        """Newton's step: of places, gaps and forces; and the residual force before it, as a share of the largest weight."""
        gap, normal = gaps(self._place, self._radius, self._pairs, self._obstacles)
        slack, force = self._slack, self._forces
        np.maximum(slack, gap, out=slack)
        opens = self._derivative(self._pairs, normal)
        pushes = opens.T.tocsr()
        unbalanced = self._force + pushes @ force
        stiffness = force / slack
        matrix = (pushes @ diags(stiffness) @ opens + diags(self._inertia)).tocsc()
        factors = splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        missing = gap - slack
        wanted = barrier * self._scale / slack
        moved = factors.solve(self._force + pushes @ (wanted - stiffness * missing))
        opening = opens @ moved + missing
        motion = np.zeros_like(self._place)
        motion[self._free] = moved
        left = float(np.abs(unbalanced).max() / self._weight[self._moves].max())
        return motion, opening, wanted - force - stiffness * opening, left

    def _derivative(self, pairs: Rows, normal: Array) -> csr_matrix:
        """N: the derivative of the gaps by the unknown displacements."""
        unknown = self._unknown[pairs]
        known = unknown >= 0
        rows = np.broadcast_to(np.arange(len(pairs))[:, None, None], unknown.shape)
        values = np.stack([-normal, normal], axis=1)
        shape = len(pairs), len(self._force)
        return csr_matrix((values[known], (rows[known], unknown[known])), shape=shape)


def _share(value: Array, change: Array) -> float:
    """The largest share of a change, at most 1, that leaves all values positive."""
    shrinking = change < 0.0
    return min(1.0, _TO_EDGE * float((-value[shrinking] / change[shrinking]).min(initial=np.inf)))
