"""Spectrum: upper bounds of the highest frequency and the highest decay of a model, by Lanczos' method."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.model import Model
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

    along: stiffness along each rod's present axis. tension: its axial force (kN) where it is in tension, which makes it
    stiff across the axis, by N/L. width: entries of a row.
    """

    width = 2

    def __init__(self, model: Model, along: Array, tension: Array | None = None) -> None:
        particles, rods = model.particles, model.rods
        ends = rods.between.astype(np.intp)
        self._first, self._second = np.ascontiguousarray(ends[:, 0]), np.ascontiguousarray(ends[:, 1])
        present = rods.difference + (particles.displacement[self._second] - particles.displacement[self._first])
        length = np.hypot(present[:, 0], present[:, 1])
        self._axis = present / np.where(length > 0.0, length, 1.0)[:, None]
        self._along, self._across = along, None if tension is None else tension / rods.rest_length
        self._excess = along if self._across is None else along - self._across  # (k a aᵀ + t (1 − a aᵀ)) v
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

    def gershgorin(self, blocks: int = 1) -> Array:
        """Upper bounds of the largest eigenvalues of so many equal blocks of rows: largest absolute row sums."""
        stiffness = np.maximum(self._along, self._across if self._across is not None else 0.0)
        worst = self._root.max(axis=1)
        reach = stiffness * (worst[self._first] + worst[self._second])
        sums = np.bincount(self._first, reach, self.rows) + np.bincount(self._second, reach, self.rows)
        bounds: Array = (worst * sums).reshape(blocks, -1).max(axis=1, initial=0.0)
        return bounds


class FrameOperator(RodOperator):
    """The same with the rotations of models that bend: vectors of shape (n, 3), the third entry for the rotation.

    The stiffness of a rod's axis follows the bow of its ends (their slopes to the chord): it acts along
    n·Δu + L₀ (Bφ)·φ, φ being the change of slopes; that of dampers, which know no tension, does not. ends: stiffness of
    slopes (ss, se, ee); with tension also N L₀ B.
    """

    width = 3

    def __init__(self, model: Model, along: Array, ends: Array, tension: Array | None = None) -> None:
        rods, particles = model.rods, model.particles
        super().__init__(model, along, tension)
        length = np.hypot(*(rods.difference + self._change(particles.displacement)).T)
        self._inverse = 1.0 / np.where(length > 0.0, length, 1.0)
        rest, bowing = rods.rest_length, rods.bowing
        bent = slopes(model) if tension is not None else np.zeros((rods.count, 2))
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

    def gershgorin(self, blocks: int = 1) -> Array:
        """Upper bounds of the largest eigenvalues of so many equal blocks of rows: largest sums of norms."""
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
        sums = np.maximum(worst * shifts, self._spin * turns)
        bounds: Array = sums.reshape(blocks, -1).max(axis=1, initial=0.0)
        return bounds


def _stiffness(model: Model, share: Array, tension: Array | None = None) -> RodOperator:
    """The operator of the stiffness of rods. share: of each rod, 1 or 0. tension: their axial forces, 0 where they push."""
    rods = model.rods
    along = share * rods.stiffness / rods.rest_length
    if bends(model):
        return FrameOperator(model, along, share[:, None] * rods.end_stiffness, tension)
    return RodOperator(model, along, tension)


def _damping(model: Model, share: Array) -> RodOperator:
    """The operator of the dampers of rods."""
    rods = model.rods
    along = share * rods.damping
    return (
        FrameOperator(model, along, share[:, None] * rods.end_damping)
        if bends(model)
        else RodOperator(model, along)
    )


def coarse_rates(model: Model, blocks: int = 1) -> tuple[Array, Array]:
    """Bounds of the largest eigenvalues ω² (1/s²) of the stiffness, without axial forces, and 2ζω (1/s) of the dampers.

    Of each of so many equal disjoint blocks; those of `spectra` are closer, and take longer.
    """
    all_of_them = np.ones(model.rods.count)
    return _stiffness(model, all_of_them).gershgorin(blocks), _damping(model, all_of_them).gershgorin(blocks)


def _largest_eigenvalues(operator: RodOperator, blocks: int) -> Array:
    """Upper bounds of the largest eigenvalues of so many equal blocks of a symmetric operator by Lanczos' method.

    The result is the Ritz value plus its residual. The start vector is fixed, sums are in a fixed order, so that the
    result (and with it the step size) is the same on every run, and for a block alone. Its entries, k²φ mod 1, differ
    differently from row to row: it must not be blind to a direction, as kφ is to that of (1, −1).
    """
    bounds, width, rows = operator.gershgorin(blocks), operator.width, operator.rows // blocks
    start = np.modf(np.arange(1, width * rows + 1) ** 2 * 0.6180339887498949)[0] - 0.5
    vector = np.tile(start / math.sqrt(float((start * start).sum())), (blocks, 1))
    basis: list[Array] = []
    diagonal: list[Array] = []
    off_diagonal: list[Array] = []
    sizes = np.zeros(blocks, dtype=np.int64)
    running = np.ones(blocks, dtype=bool)
    for _ in range(min(LANCZOS_STEPS, width * rows)):
        basis.append(vector)
        product = operator(vector.reshape(-1, width)).reshape(blocks, -1)
        diagonal.append((product * vector).sum(axis=1))
        for known in basis * 2:  # once leaves some of them where little else is left; twice is enough
            product -= (product * known).sum(axis=1)[:, None] * known
        norm = np.sqrt((product * product).sum(axis=1))
        off_diagonal.append(norm)
        sizes += running
        running &= norm > 1e-13 * bounds
        if not running.any():
            break
        vector = product / np.where(running, norm, math.inf)[:, None]
    found = np.empty(blocks)
    for size in np.unique(sizes).tolist():
        at = sizes == size
        found[at] = _ritz_bounds(np.array(diagonal[:size])[:, at].T, np.array(off_diagonal[:size])[:, at].T)
    return np.minimum(found, bounds)


def _ritz_bounds(diagonal: Array, off_diagonal: Array) -> Array:
    """Largest Ritz values plus their residuals of tridiagonal matrices, given by rows."""
    size = diagonal.shape[1]
    tridiagonal = np.zeros((len(diagonal), size, size))
    here = np.arange(size)
    tridiagonal[:, here, here] = diagonal
    tridiagonal[:, here[1:], here[:-1]] = tridiagonal[:, here[:-1], here[1:]] = off_diagonal[:, :-1]
    values, vectors = np.linalg.eigh(tridiagonal)
    bounds: Array = values[:, -1] + np.abs(off_diagonal[:, -1] * vectors[:, -1, -1])
    return bounds


def spectrum(model: Model, axial_force: Array, rods: NDArray[np.bool_] | None = None) -> Spectrum:
    """The highest frequency in the present state under these axial forces (kN, shape (rods,)).

    rods: which of them count; none given: all.
    """
    frequency, decay = spectra(model, axial_force, np.array([model.environment.drag]), rods)
    return Spectrum(float(frequency[0]), float(decay[0]))


def spectra(
    model: Model, axial_force: Array, drag: Array, counts: NDArray[np.bool_] | None = None
) -> tuple[Array, Array]:
    """Frequency and decay, as in Spectrum, of each of the equal disjoint blocks that a model consists of.

    drag: the environment's (1/s), one for each block. counts: which rods do; None: all.
    """
    rods, blocks = model.rods, len(drag)
    decay = 0.5 * drag
    particles = model.particles
    if rods.count == 0 or not ((particles.mobility > 0.0).any() or particles.turning.any()):
        return np.zeros(blocks), decay
    share = np.ones(rods.count) if counts is None else counts.astype(np.float64)
    stiffness = _stiffness(model, share, share * np.maximum(axial_force, 0.0))
    frequency = np.sqrt(_largest_eigenvalues(stiffness, blocks))
    if (rods.damping > 0.0).any() or (bends(model) and rods.end_damping.any()):
        decay = decay + 0.5 * _largest_eigenvalues(_damping(model, share), blocks)
    return frequency, decay
