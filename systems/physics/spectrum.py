"""Spectrum: upper bounds of the highest frequency and the highest decay of a model, by Lanczos' method."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.model import Model
from pinjoint.components.particle import spring_stiffness
from pinjoint.components.rod import bends
from pinjoint.systems.physics.bending import slopes

_LANCZOS_STEPS = 24  # more: closer bounds; the bound is safe at any number


@dataclass(frozen=True)
class Spectrum:
    """Bounds over all modes. frequency: highest ω (rad/s); decay: λ_max(M⁻¹C)/2 ≥ every ζω (1/s)."""

    frequency: float
    decay: float


class RodOperator:
    """Products of M^-½ K M^-½ (or C for K) with vectors of `shape` (n, 2), K = Σ B_rᵀ k_r B_r over the rods.

    Where rods bend it is (n, 3), with the rotations; the stiffness of an axis then follows the bow of its ends (their slopes
    to the chord): it acts along n·Δu + L₀ (Bφ)·φ, φ being the change of slopes.
    along: stiffness along each rod's present axis. ends: of the slopes of its ends (ss, se, ee). tension: axial forces (kN)
    of rods in tension, which resist across the axis by N/L, and slopes by N L₀ B; None: of dampers, which follow no bow.
    """

    def __init__(self, model: Model, along: Array, ends: Array, tension: Array | None = None) -> None:
        particles, rods = model.particles, model.rods
        between = rods.between.astype(np.intp)
        self._first, self._second = np.ascontiguousarray(between[:, 0]), np.ascontiguousarray(between[:, 1])
        present = rods.difference + (particles.displacement[self._second] - particles.displacement[self._first])
        length = np.hypot(present[:, 0], present[:, 1])
        length = np.where(length > 0.0, length, 1.0)
        self._axis, self._inverse = (present / length[:, None]).T.copy(), 1.0 / length
        self._along, self._across = along, 0.0 if tension is None else tension / rods.rest_length
        self._root = np.sqrt(particles.mobility)
        self._bends = bends(model)
        self.shape = particles.count, 3 if self._bends else 2
        if self._bends:
            bent = np.zeros((rods.count, 2)) if tension is None else slopes(model)
            thrust = 0.0 if tension is None else (tension * rods.rest_length)[:, None]
            bowing = rods.bowing
            bow = (bowing[:, :2] * bent).sum(axis=1), (bowing[:, 1:] * bent).sum(axis=1)
            self._bow, self._ends = rods.rest_length * np.stack(bow), (ends + thrust * bowing).T
            self._spin = np.sqrt(particles.turning)

    def __call__(self, vector: Array) -> Array:
        (x, y), first, second, (count, _) = self._axis, self._first, self._second, self.shape
        change = [at.take(second) - at.take(first) for at in (self._root * vector[:, :2]).T]
        along = change[0] * x + change[1] * y
        # (k a aᵀ + t (1 − a aᵀ)) v.
        forces = [(self._along - self._across) * along * axis for axis in self._axis]
        product = np.empty_like(vector)
        if self._bends:
            turn, leaning = self._spin * vector[:, 2], (change[1] * x - change[0] * y) * self._inverse
            start, end = turn[first] - leaning, turn[second] - leaning
            bowed = self._along * (self._bow[0] * start + self._bow[1] * end)
            pull = self._along * along + bowed
            of_start = self._ends[0] * start + self._ends[1] * end + pull * self._bow[0]
            of_end = self._ends[1] * start + self._ends[2] * end + pull * self._bow[1]
            push = -(of_start + of_end) * self._inverse
            forces = [forces[0] + bowed * x - push * y, forces[1] + bowed * y + push * x]
            turned = np.bincount(first, of_start, count) + np.bincount(second, of_end, count)
            product[:, 2] = self._spin * turned
        for d, force in enumerate(forces):
            force += self._across * change[d]
            product[:, d] = np.bincount(second, force, count)
            product[:, d] -= np.bincount(first, force, count)
        product[:, :2] *= self._root
        return product

    def gershgorin(self) -> float:
        """An upper bound of the largest eigenvalue: the largest sum of norms in a row."""
        worst, first, second, (count, _) = self._root.max(axis=1), self._first, self._second, self.shape
        reach, turns = worst[first] + worst[second], np.zeros(0)
        force = np.maximum(self._along, self._across) * reach
        if self._bends:
            lean, bow, ends = reach * self._inverse, np.abs(self._bow), np.abs(self._ends)
            at_start, at_end = self._spin[first] + lean, self._spin[second] + lean
            bowed = self._along * (bow[0] * at_start + bow[1] * at_end)
            pull = self._along * reach + bowed
            of_start = ends[0] * at_start + ends[1] * at_end + pull * bow[0]
            of_end = ends[1] * at_start + ends[2] * at_end + pull * bow[1]
            force += bowed + (of_start + of_end) * self._inverse
            turns = self._spin * (np.bincount(first, of_start, count) + np.bincount(second, of_end, count))
        shifts = worst * (np.bincount(first, force, count) + np.bincount(second, force, count))
        return float(max(shifts.max(initial=0.0), turns.max(initial=0.0)))


def _largest_eigenvalue(operator: RodOperator) -> float:
    """An upper bound of the largest eigenvalue of an operator by Lanczos' method: Ritz value plus residual.

    The start vector is fixed, sums are in a fixed order, so that the result (and with it the step size) is the same on every
    run. Its entries, k²φ mod 1, differ differently from row to row: it must not be blind to a direction, as kφ is to that
    of (1, −1).
    """
    size, bound = math.prod(operator.shape), operator.gershgorin()
    if size <= _LANCZOS_STEPS:  # the method would go all the way
        matrix = [operator(unit.reshape(operator.shape)).ravel() for unit in np.eye(size)]
        return min(max(float(np.linalg.eigvalsh(matrix)[-1]), 0.0), bound)
    vector = np.modf(np.arange(1, size + 1) ** 2 * 0.6180339887498949)[0] - 0.5
    vector /= math.sqrt(float((vector * vector).sum()))
    basis = np.empty((_LANCZOS_STEPS, size))
    diagonal: list[float] = []
    off_diagonal: list[float] = []
    for step in range(1, _LANCZOS_STEPS + 1):
        basis[step - 1] = vector
        product = operator(vector.reshape(operator.shape)).ravel()
        diagonal.append(float((product * vector).sum()))
        for _ in range(2):  # once leaves some of them where little else is left; twice is enough
            known = np.einsum("kn,n->k", basis[:step], product)
            product -= np.einsum("kn,k->n", basis[:step], known)
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
    if (rods.damping > 0.0).any() or of_ends.any():
        decay += 0.5 * _largest_eigenvalue(RodOperator(model, damping, of_ends))
    highest = _largest_eigenvalue(RodOperator(model, along, ends, tension)) + sprung
    return Spectrum(math.sqrt(highest), decay)


def highest_sprung(model: Model) -> float:
    """The highest ω² of particles on springs of supports alone, by which these raise any ω² at most."""
    mobility = np.column_stack([model.particles.mobility, model.particles.turning])
    return float((spring_stiffness(model) * mobility).max(initial=0.0))
