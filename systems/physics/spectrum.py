"""Highest frequency and damping of a model, and the pace at which its motion is best watched."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from components.model import Model

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


def largest_eigenvalue(operator: Callable[[Array], Array], rows: int, bound: float) -> float:
    """An upper bound of the largest eigenvalue of a symmetric operator by Lanczos' method.

    The Ritz value plus its residual, at most `bound`. The start vector is fixed, sums are in a fixed
    order, so that the result (and with it the step size) is the same on every run. Its entries, k²φ mod 1,
    differ differently from row to row: it must not be blind to a direction, as kφ is to that of (1, −1).
    """
    start = np.modf(np.arange(1, 2 * rows + 1) ** 2 * 0.6180339887498949)[0] - 0.5
    vector = start.reshape(rows, 2) / math.sqrt(float((start * start).sum()))
    basis: list[Array] = []
    diagonal: list[float] = []
    beside: list[float] = []
    for _ in range(min(LANCZOS_STEPS, 2 * rows)):
        basis.append(vector)
        product = operator(vector)
        diagonal.append(float((product * vector).sum()))
        for known in basis:
            product -= (product * known).sum() * known
        norm = math.sqrt(float((product * product).sum()))
        beside.append(norm)
        if norm <= 1e-13 * bound:
            break
        vector = product / norm
    size = len(diagonal)
    tridiagonal = np.diag(diagonal) + np.diag(beside[: size - 1], 1) + np.diag(beside[: size - 1], -1)
    values, vectors = np.linalg.eigh(tridiagonal)
    return min(float(values[-1] + abs(beside[-1] * vectors[-1, -1])), bound)


def spectrum(model: Model, axial_force: Array) -> Spectrum:
    """The highest frequency in the present state under these axial forces (kN, shape (rods,))."""
    rods = model.rods
    decay = 0.5 * model.environment.drag
    if rods.count == 0 or not (model.particles.mobility > 0.0).any():
        return Spectrum(0.0, decay)
    across = np.maximum(axial_force, 0.0) / rods.rest_length
    stiffness = RodOperator(model, rods.stiffness / rods.rest_length, across)
    frequency = math.sqrt(largest_eigenvalue(stiffness, stiffness.rows, stiffness.gershgorin()))
    if (rods.damping > 0.0).any():
        dampers = RodOperator(model, rods.damping)
        decay += 0.5 * largest_eigenvalue(dampers, dampers.rows, dampers.gershgorin())
    return Spectrum(frequency, decay)
