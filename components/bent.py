"""Bent rods: where their axes are between their ends, and the forces in them there, by statics in the present state.

Shares ξ count from 0 at the start of a rod to 1 at its end. Polynomials in ξ are rows of coefficients, the lowest first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.derived import (
    all_slopes,
    along_and_across,
    chord_rotation,
    cubic,
    moments_along,
    own_slopes,
    rigid_slopes,
)
from pinjoint.components.model import Model
from pinjoint.components.settings import DIAGRAMS

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

AXIAL, MOMENT, SHEAR = DIAGRAMS
FLAT = 0.25  # pixels by which a curve may differ from the lines that are drawn of it
_MOST_PIECES = 32  # of a drawn rod
_LARGEST = 1e6  # pieces that a rod would have to be cut into; such are left out
_STEEP, _STEEPEST = 0.05, 2.5  # rad, slopes from which on tangents are drawn truly, and up to which
# Between which a zero of a polynomial is looked for, and the shares that are one to it.
_SAMPLES, _ROUNDING = 33, 2e-16


@dataclass(frozen=True)
class Parts:
    """Rods: original positions of their ends (n, 2) in m, which two each joins, (p, 2), and how firmly, (p, 2)."""

    position: Array
    between: Rows
    fixity: Array

    @classmethod
    def of(cls, model: Model) -> Parts:
        """All rods of a model."""
        rods = model.rods
        return cls(model.particles.position, rods.between.astype(np.intp), rods.fixity)


@dataclass(frozen=True)
class Axes:
    """The axes of some rods as drawn (m): chords, unit vectors to their left, and by how much they bend away there.

    start, end, left: (n, 2). bow: polynomials (n, 5), the present deflection × displacement scale. drift: likewise by how
    much their points move along the chords, which lets strongly bent rods leave joints in the right direction; None: not.
    """

    start: Array
    end: Array
    left: Array
    bow: Array
    drift: Array | None = None

    @classmethod
    def of(cls, model: Model, rows: Rows, scale: float | None = None) -> Axes:
        """The axes of some rods, as they are drawn, or with displacements to another scale.

        Cubics by the slopes of their ends, and what a distributed force adds between: q ξ²(1 − ξ)² L₀⁴/24EI across. In small
        displacements both together are exact.
        """
        rods, state = model.rods, _state(model, rows)
        particles, scale = model.particles, drawn_scale(model) if scale is None else scale
        ends = rods.between[rows].astype(np.intp)
        drawn = particles.position[ends] + particles.displacement[ends] * scale
        drift = _drift(state)
        drift = None if drift is None else scale * drift
        return cls(drawn[:, 0], drawn[:, 1], state.left, scale * (state.cubic + state.sag), drift)

    @classmethod
    def moved(cls, parts: Parts, places: Array, displacement: Array, rotation: Array) -> Axes:
        """The axes of rods by small displacements (particles, 2) and rotations (particles,) that lead to places.

        Their ends, at places (particles, 2), are all that is drawn of what was before.
        """
        ends = parts.between
        difference = parts.position[ends[:, 1]] - parts.position[ends[:, 0]]
        length = np.hypot(*difference.T)
        left = np.stack([-difference[:, 1], difference[:, 0]], axis=1) / np.maximum(length, 1e-300)[:, None]
        chord = ((displacement[ends[:, 1]] - displacement[ends[:, 0]]) * left).sum(axis=1)
        turned = length[:, None] * rotation[ends] - chord[:, None]
        slopes = np.einsum("rij,rj->ri", own_slopes(parts.fixity), turned)
        return cls(places[ends[:, 0]], places[ends[:, 1]], left, _cubic(*slopes.T))

    def some(self, which: Rows | NDArray[np.bool_]) -> Axes:
        """Those of some of the rods."""
        drift = None if self.drift is None else self.drift[which]
        return Axes(self.start[which], self.end[which], self.left[which], self.bow[which], drift)

    def points(self, shares: Array) -> Array:
        """Points at shares (k,) or (n, k), shape (n, k, 2)."""
        along = np.broadcast_to(shares, (len(self.start), np.shape(shares)[-1]))[..., None]
        chord = self.start[:, None] * (1.0 - along) + self.end[:, None] * along
        found: Array = chord + self._away(self.bow, self.drift, shares)
        return found

    def tangents(self, shares: Array) -> Array:
        """Their directions at shares (k,) or (n, k), not of unit length, shape (n, k, 2)."""
        drift = None if self.drift is None else derivative(self.drift)
        found: Array = (self.end - self.start)[:, None] + self._away(derivative(self.bow), drift, shares)
        return found

    def _away(self, bow: Array, drift: Array | None, shares: Array) -> Array:
        found: Array = values(bow, shares)[..., None] * self.left[:, None]
        if drift is not None:
            ahead = np.stack([self.left[:, 1], -self.left[:, 0]], axis=1)
            found = found + values(drift, shares)[..., None] * ahead[:, None]
        return found

    @property
    def curvature(self) -> Array:
        """Into how many pieces each would have to be cut to be straight within a metre, (n,); a root of a length."""
        second = np.abs(derivative(derivative(self.bow))).sum(axis=1)
        if self.drift is not None:
            second += np.abs(derivative(derivative(self.drift))).sum(axis=1)
        most: Array = np.sqrt(second / 8.0)
        return most

    def pieces(self, rows: Rows, fineness: float) -> Lines | None:
        """These axes, of the rods in `rows`, cut into pieces flat within `fineness` (m); None where all look straight."""
        wanted = self.curvature / np.sqrt(fineness)
        curved = np.flatnonzero((wanted > 1.0) & (wanted < _LARGEST))
        if not len(curved):
            return None
        least = np.array([2, 4, 8, 16, _MOST_PIECES])
        count = least[np.minimum(np.searchsorted(least, wanted[curved]), len(least) - 1)]
        starts, ends, of = [], [], []
        for number in np.unique(count).tolist():
            some = curved[count == number]
            points = self.some(some).points(np.linspace(0.0, 1.0, number + 1))
            starts.append(points[:, :-1].reshape(-1, 2))
            ends.append(points[:, 1:].reshape(-1, 2))
            of.append(np.repeat(rows[some], number))
        row = np.concatenate(of)
        order = np.argsort(row, kind="stable")
        return Lines(np.concatenate(starts)[order], np.concatenate(ends)[order], row[order])


def drawn_scale(model: Model) -> float:
    """By how much displacements are enlarged where elements are drawn and picked: 0 in statics, if a person wants it."""
    settings = model.settings
    original = model.solution is not None and settings.original_diagrams
    return 0.0 if original else float(settings.displacement_scale)


def is_frame(model: Model) -> bool:
    """True if some rod bends, if only by what acts along it between hinges."""
    return bool(model.rods.bending_stiffness.any())


def deflected(model: Model, row: int, shares: Array) -> tuple[Array, Array]:
    """Of points at shares (k,) of a rod's axis as it is bent now: how far they are from its chord (m, (k, 2)), and the
    slopes there to it (k,).
    """
    state = _state(model, np.array([row]))
    bow = state.cubic + state.sag
    slopes = values(derivative(bow), shares)[0]
    return values(bow, shares).T * state.left, slopes / max(float(state.length[0]), 1e-300)


def deflections(model: Model, rows: Rows) -> Array:
    """How far the axes of some rods are from their chords now (m), to the left, as polynomials (n, 5)."""
    state = _state(model, rows)
    return state.cubic + state.sag


def displacements(model: Model, rows: Rows) -> Array:
    """How far points of the axes of some rods have moved (m), as polynomials of x and y, (n, 2, 5)."""
    state, (start, end) = _state(model, rows), model.particles.displacement[model.rods.between[rows].T]
    found: Array = state.left[..., None] * (state.cubic + state.sag)[:, None]
    found[..., 0] += start
    found[..., 1] += end - start
    return found


class Station(NamedTuple):
    """A point of the axis of a rod: how far from its start (m), the forces there by their letters (kN, kN·m), how far it has
    moved (m, (2,)) and the axis turned (rad).
    """

    distance: float
    forces: dict[str, float]
    moved: Array
    rotation: float

    @classmethod
    def of(cls, model: Model, row: int, distance: float) -> Station:
        """That of a rod at a distance, or at its end where it does not reach so far."""
        rows, rods = np.array([row]), model.rods
        length = float((rods.original_length if model.first_order else rods.length)[row])
        at = np.array([min(distance / length, 1.0) if length > 0.0 else 0.0])
        forces = {name: float(values(inner_forces(model, rows, name), at)[0, 0]) for name in DIAGRAMS}
        moved = values(displacements(model, rows)[0], at)[:, 0]
        rotation = chord_rotation(model)[row] + deflected(model, row, at)[1][0]
        return cls(float(at[0]) * length, forces, moved, float(rotation))


def farthest(model: Model, rows: Rows) -> tuple[Array, Array]:
    """The largest displacement (m) along each of some rods, and the share where it is, (n,) each."""
    if not rows.size:  # for the state of all rods, of which nothing is asked: half of a picture of 100 000
        return np.zeros(0), np.zeros(0)
    moved = displacements(model, rows)
    squares = np.zeros((len(moved), 9))
    for power in range(5):
        squares[:, power : power + 5] += (moved[..., power, None] * moved).sum(axis=1)
    found, shares = extremes(squares)
    return np.sqrt(found[:, 1]), shares[:, 1]


def _drift(state: _State) -> Array | None:
    """How far points move along the chords, so that ends with slopes φ lie at angles φ to them, not arctan φ."""
    length = state.length
    slopes = state.cubic[:, [1, 3]] / np.where(length > 0.0, length, 1.0)[:, None]
    slopes[:, 1] -= slopes[:, 0]  # the cubic has φ_s and φ_s + φ_e
    steep = np.clip(np.abs(slopes), 0.0, _STEEPEST)
    if not (steep > _STEEP).any():
        return None
    shorter = np.where(steep > _STEEP, steep / np.tan(np.maximum(steep, _STEEP)) - 1.0, -(steep**2) / 3.0)
    return length[:, None] * _cubic(*shorter.T)


def _cubic(start: Array, end: Array) -> Array:
    """The deflection (n, 5) between ends with slopes × length (n,)."""
    return np.pad(cubic(start, end), ((0, 0), (0, 1)))


class _State(NamedTuple):
    """Of some rods: length, unit vector to the left, force across, deflections (n, 5): by slopes, and by that force."""

    length: Array
    left: Array
    across: Array
    cubic: Array
    sag: Array


def _state(model: Model, rows: Rows) -> _State:
    revision, found = model.bent
    if revision != model.revision:  # a picture asks nine times
        with np.errstate(invalid="ignore"):  # of rods whose ends are nowhere, which are not drawn
            found = _states(model)
        model.bent = model.revision, found
    return _State(*(column[rows] for column in found))


def _states(model: Model) -> _State:
    rods, particles = model.rods, model.particles
    first, second = rods.between.astype(np.intp).T
    present = rods.difference
    if not model.first_order:
        present = present + particles.displacement[second] - particles.displacement[first]
    length = np.hypot(present[:, 0], present[:, 1])
    along = present / np.where(length > 0.0, length, 1.0)[:, None]
    left = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across = along_and_across(model.share * rods.distributed_force, along)[1]
    rigid = rigid_slopes(rods, particles.rotation[rods.between], chord_rotation(model))
    start, end = (length[:, None] * all_slopes(rods, rigid, across)).T
    bent, zero = rods.bending_stiffness > 0.0, np.zeros(rods.count)
    sag = np.divide(across * rods.rest_length**4, 24.0 * rods.bending_stiffness, out=zero.copy(), where=bent)
    cubic = _cubic(start, end)
    cubic[~bent] = 0.0
    return _State(length, left, across, cubic, np.stack([zero, zero, sag, -2.0 * sag, sag], axis=1))


def inner_forces(model: Model, rows: Rows, quantity: str) -> Array:
    """N, V (kN) or M (kN·m) along some rods as polynomials; at their ends the computed columns.

    M as in `moments_along`, with the force q across and, but for first-order theory, the cubic deflection v.
    """
    rods, state = model.rods, _state(model, rows)
    name = {AXIAL: "end_axial_force", SHEAR: "shear", MOMENT: "bending_moment"}[quantity]
    ends = getattr(rods, name)[rows]
    if quantity != MOMENT:
        return np.stack([ends[:, 0], ends[:, 1] - ends[:, 0]], axis=1)
    load = state.across * rods.rest_length[rows] * state.length
    by_deflection = 0.0 if model.first_order else rods.axial_force[rows, None]
    return moments_along(ends, load, by_deflection * state.cubic[:, :4])


def zeros(polynomials: Array) -> tuple[Rows, Array]:
    """Where polynomials (n, d) change sign between 0 and 1: which one, and at which share, in order."""
    samples = np.linspace(0.0, 1.0, _SAMPLES)
    sampled = values(polynomials, samples)
    signs = np.sign(sampled)
    which, place = np.nonzero(signs[:, :-1] * signs[:, 1:] < 0.0)
    low, high = samples[place], samples[place + 1]
    before, slopes, step = signs[which, place], derivative(polynomials), 0.5 * (high - low)
    with np.errstate(over="ignore", invalid="ignore"):  # of numbers beyond computing
        part = sampled[which, place] / (sampled[which, place] - sampled[which, place + 1])
    share = low + (high - low) * np.nan_to_num(part, nan=0.5)
    # From where a straight line is zero, Newton's method, or half the interval where that is less: down to rounding.
    for _ in range(60):
        value = values(polynomials[which], share[:, None])[:, 0]
        low, high = np.where(value * before > 0.0, share, low), np.where(value * before > 0.0, high, share)
        slope = values(slopes[which], share[:, None])[:, 0]
        newton = -np.divide(value, slope, out=np.full(len(value), np.inf), where=slope != 0.0)
        safe = (share + newton >= low) & (share + newton <= high) & (np.abs(newton) < 0.5 * np.abs(step))
        step = np.where(safe | (np.abs(newton) < _ROUNDING), newton, 0.5 * (low + high) - share)
        if not (np.abs(step) >= _ROUNDING).any():
            break
        share = share + step
    touching, at = np.nonzero(signs[:, 1:-1] == 0.0)  # a sample that is a zero itself
    touching, at = (part[signs[touching, at] * signs[touching, at + 2] < 0.0] for part in (touching, at))
    which, shares = np.concatenate([which, touching]), np.concatenate([share, samples[at + 1]])
    order = np.lexsort((shares, which))
    return which[order], shares[order]


def extremes(polynomials: Array) -> tuple[Array, Array]:
    """The least and the greatest value of polynomials (n, d) from 0 to 1, and the shares where they are, (n, 2) each."""
    count = len(polynomials)
    which, inside = zeros(derivative(polynomials))
    which = np.concatenate([np.arange(count), np.arange(count), which])
    shares = np.concatenate([np.zeros(count), np.ones(count), inside])
    found = values(polynomials[which], shares[:, None])[:, 0]
    order = np.lexsort((found, which))
    both = order[np.searchsorted(which[order], np.arange(count)[:, None] + [0, 1]) - [0, 1]]
    return found[both], shares[both]


def values(polynomials: Array, shares: Array) -> Array:
    """Values of polynomials (n, d) at shares (k,) or (n, k), shape (n, k)."""
    found = np.zeros((len(polynomials), np.shape(shares)[-1]))
    for coefficient in polynomials.T[::-1]:
        found = found * shares + coefficient[:, None]
    return found


def derivative(polynomials: Array) -> Array:
    """Of polynomials (n, d), by ξ, (n, d − 1)."""
    found: Array = polynomials[:, 1:] * np.arange(1.0, polynomials.shape[1])
    return found


def largest_sag(model: Model) -> float:
    """The largest deflection of a rod from the straight line between its ends (m), about."""
    if not is_frame(model):
        return 0.0
    state = _state(model, np.flatnonzero(model.rods.bending_stiffness > 0.0))
    middle = values(state.cubic + state.sag, np.array([0.5]))
    return float(np.abs(middle[np.isfinite(middle)]).max(initial=0.0))


def middles(model: Model) -> Array:
    """Some points between the ends of the rods that bend, deflected to the displacement scale (m), (n, 2)."""
    if not is_frame(model):
        return np.empty((0, 2))
    rows = np.flatnonzero(model.rods.bending_stiffness > 0.0)
    axes = Axes.of(model, rows, float(model.settings.displacement_scale))
    return axes.points(np.array([0.25, 0.5, 0.75])).reshape(-1, 2)


class Lines(NamedTuple):
    """Straight pieces along rods, as drawn (m): from, to (p, 2), and whose row each is (p,)."""

    start: Array
    end: Array
    rods: Rows


def curved_lines(model: Model, fineness: float, rows: Rows | None = None) -> Lines | None:
    """Pieces along the rods that do not look straight, flat within `fineness` (m); None where all do.

    rows: of the rods among which to look, in order, without them all.
    """
    if not is_frame(model):
        return None
    stiff = model.rods.bending_stiffness > 0.0
    rows = np.flatnonzero(stiff) if rows is None else rows[stiff[rows]]
    return Axes.of(model, rows).pieces(rows, fineness)


def distributed_shares(model: Model) -> Array:
    """What of the force (kN) on each particle is its share of forces distributed along rods, (particles, 2)."""
    rods, found = model.rods, np.zeros((model.particles.count, 2))
    if rods.distributed_force.any():
        half = 0.5 * model.share * rods.distributed_force * rods.rest_length[:, None]
        np.add.at(found, rods.between.ravel(), np.repeat(half, 2, axis=0))
    return found
