"""Spectrum: upper bounds of the highest frequency and the highest decay of a model, by Lanczos' method."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.model import Model
from pinjoint.components.particle import spring_stiffness
from pinjoint.components.rod import bends
from pinjoint.systems.physics.bending import slopes

Array = NDArray[np.float64]

LANCZOS_STEPS = 24  # more: closer bounds; the bound is safe at any number


@dataclass(frozen=True)
class Spectrum:
    """Bounds over all modes. frequency: highest ω (rad/s); decay: λ_max(M⁻¹C)/2 ≥ every ζω (1/s)."""

    frequency: float
    decay: float


class RodOperator:
    """Products of M^-½ K M^-½ (or C for K) with vectors of shape (n, 2), K = Σ B_rᵀ k_r B_r over the rods.

    along: stiffness along each rod's present axis; across: stiffness across it (N/L of rods in tension).
    """

    def __init__(self, model: Model, along: Array, across: Array | None = None) -> None:
        particles, rods = model.particles, model.rods
        ends = rods.between.astype(np.intp)
        self._first, self._second = np.ascontiguousarray(ends[:, 0]), np.ascontiguousarray(ends[:, 1])
        present = rods.difference + (particles.displacement[self._second] - particles.displacement[self._first])
        length = np.hypot(present[:, 0], present[:, 1])
        self._axis = present / np.where(length > 0.0, length, 1.0)[:, None]
        self._along, self._across = along, across
        self._excess = along if across is None else along - across  # (k a aᵀ + t (1 − a aᵀ)) v
        self._root = np.sqrt(particles.mobility)
        self.rows = particles.count

    def __call__(self, vector: Array) -> Array:
        scaled = self._root * vector
        change = [at.take(self._second) - at.take(self._first) for at in scaled.T]
        pull = (change[0] * self._axis[:, 0] + change[1] * self._axis[:, 1]) * self._excess
        product = np.empty_like(vector)
        for d in range(2):
            force = pull * self._axis[:, d]
            if self._across is not None:
                force += self._across * change[d]
            product[:, d] = np.bincount(self._second, force, self.rows)
            product[:, d] -= np.bincount(self._first, force, self.rows)
        return self._root * product

    def gershgorin(self) -> float:
        """An upper bound of the largest eigenvalue: the largest absolute row sum."""
        stiffness = np.maximum(self._along, self._across if self._across is not None else 0.0)
        worst = self._root.max(axis=1)
        reach = stiffness * (worst[self._first] + worst[self._second])
        sums = np.bincount(self._first, reach, self.rows) + np.bincount(self._second, reach, self.rows)
        return float((worst * sums).max(initial=0.0))


class FrameOperator(RodOperator):
    """The same with the rotations of models that bend: vectors of shape (n, 3), the third entry for the rotation.

    The stiffness of a rod's axis follows the bow of its ends (their slopes to the chord): it acts along
    n·Δu + L₀ (Bφ)·φ, φ being the change of slopes. ends: stiffness of slopes (ss, se, ee); with axial forces (kN) of rods
    in tension also N L₀ B. bows: whether `along` follows the bow, which dampers do not.
    """

    def __init__(self, model: Model, along: Array, ends: Array, tension: Array | None = None) -> None:
        rods, particles = model.rods, model.particles
        bows = tension is not None
        super().__init__(model, along, tension / rods.rest_length if tension is not None else None)
        length = np.hypot(*(rods.difference + self._change(particles.displacement)).T)
        self._inverse = 1.0 / np.where(length > 0.0, length, 1.0)
        rest, bowing = rods.rest_length, rods.bowing
        bent = slopes(model) if bows else np.zeros((rods.count, 2))
        bow = np.stack([(bowing[:, :2] * bent).sum(axis=1), (bowing[:, 1:] * bent).sum(axis=1)], axis=1)
        self._bow = rest[:, None] * bow
        thrust = tension * rest if tension is not None else np.zeros(rods.count)
        self._ends = ends + thrust[:, None] * bowing
        self._spin = np.sqrt(particles.turning)

    def _change(self, values: Array) -> Array:
        return values[self._second] - values[self._first]

    def __call__(self, vector: Array) -> Array:
        shift, turn = self._root * vector[:, :2], self._spin * vector[:, 2]
        change = self._change(shift)
        along = (change * self._axis).sum(axis=1)
        aside = change[:, 1] * self._axis[:, 0] - change[:, 0] * self._axis[:, 1]
        leaning = aside * self._inverse
        start, end = turn[self._first] - leaning, turn[self._second] - leaning
        pull = self._along * (along + self._bow[:, 0] * start + self._bow[:, 1] * end)
        of_start = self._ends[:, 0] * start + self._ends[:, 1] * end + pull * self._bow[:, 0]
        of_end = self._ends[:, 1] * start + self._ends[:, 2] * end + pull * self._bow[:, 1]
        push = -(of_start + of_end) * self._inverse
        if self._across is not None:
            push += self._across * aside
        product = np.empty_like(vector)
        left = np.stack([-self._axis[:, 1], self._axis[:, 0]], axis=1)
        force = pull[:, None] * self._axis + push[:, None] * left
        for d in range(2):
            product[:, d] = np.bincount(self._second, force[:, d], self.rows)
            product[:, d] -= np.bincount(self._first, force[:, d], self.rows)
        product[:, :2] *= self._root
        product[:, 2] = np.bincount(self._first, of_start, self.rows)
        product[:, 2] += np.bincount(self._second, of_end, self.rows)
        product[:, 2] *= self._spin
        return product

    def gershgorin(self) -> float:
        """An upper bound of the largest eigenvalue: the largest sum of norms in a row."""
        worst, first, second = self._root.max(axis=1), self._first, self._second
        reach = worst[first] + worst[second]
        lean = reach * self._inverse
        at_start, at_end = self._spin[first] + lean, self._spin[second] + lean
        bow = np.abs(self._bow)
        ends = np.abs(self._ends)
        pull = np.abs(self._along) * (reach + bow[:, 0] * at_start + bow[:, 1] * at_end)
        of_start = ends[:, 0] * at_start + ends[:, 1] * at_end + pull * bow[:, 0]
        of_end = ends[:, 1] * at_start + ends[:, 2] * at_end + pull * bow[:, 1]
        force = pull + (of_start + of_end) * self._inverse
        force += self._across * reach if self._across is not None else 0.0
        shifts = np.bincount(first, force, self.rows) + np.bincount(second, force, self.rows)
        turns = np.bincount(first, of_start, self.rows) + np.bincount(second, of_end, self.rows)
        return float(np.maximum(worst * shifts, self._spin * turns).max(initial=0.0))


def operator_of(model: Model, along: Array, ends: Array, tension: Array | None = None) -> RodOperator:
    """The operator of a stiffness, or of dampers, of the rods and of the slopes of their ends: see FrameOperator."""
    if bends(model):
        return FrameOperator(model, along, ends, tension)
    return RodOperator(model, along, None if tension is None else tension / model.rods.rest_length)


def _largest_eigenvalue(operator: RodOperator, width: int) -> float:
    """An upper bound of the largest eigenvalue of an operator by Lanczos' method: Ritz value plus residual.

    width: entries of a row. The start vector is fixed, sums are in a fixed order, so
    that the result (and with it the step size) is the same on every run. Its entries, k²φ mod 1, differ differently
    from row to row: it must not be blind to a direction, as kφ is to that of (1, −1).
    """
    rows, bound = operator.rows, operator.gershgorin()
    if width * rows <= LANCZOS_STEPS:  # the method would go all the way
        matrix = [operator(unit.reshape(-1, width)).ravel() for unit in np.eye(width * rows)]
        return min(max(float(np.linalg.eigvalsh(matrix)[-1]), 0.0), bound)
    vector = np.modf(np.arange(1, width * rows + 1) ** 2 * 0.6180339887498949)[0] - 0.5
    vector /= math.sqrt(float((vector * vector).sum()))
    basis = np.empty((LANCZOS_STEPS, width * rows))
    diagonal: list[float] = []
    off_diagonal: list[float] = []
    for size in range(1, LANCZOS_STEPS + 1):
        basis[size - 1] = vector
        product = operator(vector.reshape(-1, width)).ravel()
        diagonal.append(float((product * vector).sum()))
        for _ in range(2):  # once leaves some of them where little else is left; twice is enough
            known = np.einsum("kn,n->k", basis[:size], product)
            product -= np.einsum("kn,k->n", basis[:size], known)
        off_diagonal.append(math.sqrt(float((product * product).sum())))
        if off_diagonal[-1] <= 1e-13 * bound:
            break
        vector = product / off_diagonal[-1]
    beside = off_diagonal[:-1]
    values, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(beside, -1))  # it reads the lower half
    return min(float(values[-1] + abs(off_diagonal[-1] * vectors[-1, -1])), bound)


def spectrum(model: Model, axial_force: Array, counts: NDArray[np.bool_] | None = None) -> Spectrum:
    """The highest frequency in the present state under these axial forces (kN, shape (rods,)).

    counts: which rods do; None: all.
    """
    rods, particles = model.rods, model.particles
    decay = 0.5 * model.environment.drag
    sprung = highest_sprung(model)
    if rods.count == 0 or not ((particles.mobility > 0.0).any() or particles.turning.any()):
        return Spectrum(math.sqrt(sprung), decay)
    share = np.ones(rods.count) if counts is None else counts.astype(np.float64)
    tension = share * np.maximum(axial_force, 0.0)
    along, damping = share * rods.stiffness / rods.rest_length, share * rods.damping
    ends, of_ends = share[:, None] * rods.end_stiffness, share[:, None] * rods.end_damping
    width = 3 if bends(model) else 2
    if (rods.damping > 0.0).any() or of_ends.any():
        dampers = operator_of(model, damping, of_ends)
        decay += 0.5 * _largest_eigenvalue(dampers, width)
    stiffness = operator_of(model, along, ends, tension)
    highest = _largest_eigenvalue(stiffness, width) + sprung
    return Spectrum(math.sqrt(highest), decay)


def highest_sprung(model: Model) -> float:
    """The highest ω² of particles on springs of supports alone, by which these raise any ω² at most."""
    mobility = np.column_stack([model.particles.mobility, model.particles.turning])
    return float((spring_stiffness(model) * mobility).max(initial=0.0))
