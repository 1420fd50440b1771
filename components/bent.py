"""Bent rods: where their axes are between their ends, and the forces in them there, by statics in the present state.

Shares ξ count from 0 at the start of a rod to 1 at its end. Polynomials in ξ are rows of coefficients, the lowest first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array, Rows
from pinjoint.components.cases import Acting
from pinjoint.components.derived import (
    HALF_SINE,
    all_slopes,
    chord_rotation,
    cubic,
    moments_along,
    on_axis,
    own_slopes,
    rigid_slopes,
)
from pinjoint.components.model import Model
from pinjoint.components.rod import has_struts
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.spans import Curves, Kinks, Stretches, extremes, groups

AXIAL, MOMENT, SHEAR = DIAGRAMS
FLAT = 0.25  # pixels by which a curve may differ from the lines that are drawn of it
_MOST_PIECES = 32  # of a drawn rod
_LARGEST = 1e6  # pieces that a rod would have to be cut into; such are left out
_STEEP, _STEEPEST = 0.05, 2.5  # rad, slopes from which on tangents are drawn truly, and up to which


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

    start, end, left: (n, 2). bow: the present deflection × displacement scale. drift: likewise by how
    much their points move along the chords, which lets strongly bent rods leave joints in the right direction; None: not.
    """

    start: Array
    end: Array
    left: Array
    bow: Curves
    drift: Curves | None = None

    @classmethod
    def of(cls, model: Model, rows: Rows, scale: float | None = None) -> Axes:
        """The axes of some rods, as they are drawn, or with displacements to another scale.

        Cubics by the slopes of their ends, and what acts between them adds, as if they were clamped. In small displacements
        both together are exact.
        """
        (state, _), known = _states(model), model.bent[2]
        scale = drawn_scale(model) if scale is None else scale
        if scale not in known:
            particles, ends = model.particles, model.rods.between.astype(np.intp).T
            drift = _drift(state) if scale else None
            with np.errstate(invalid="ignore"):  # see there
                start, end = (particles.position + particles.displacement * scale)[ends]
                drift = None if drift is None else drift.times(scale)
                bow = state.bow.times(scale) if scale else Curves.plain(np.zeros((len(start), 1)))
                known[scale] = cls(start, end, state.left, bow, drift)
        every: Axes = known[scale]
        return every.some(rows)

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
        return cls(places[ends[:, 0]], places[ends[:, 1]], left, Curves.plain(cubic(*slopes.T)))

    def some(self, which: Rows | NDArray[np.bool_]) -> Axes:
        """Those of some of the rods."""
        drift = None if self.drift is None else self.drift.some(which)
        return Axes(self.start[which], self.end[which], self.left[which], self.bow.some(which), drift)

    def points(self, shares: Array) -> Array:
        """Points at shares (k,) or (n, k), shape (n, k, 2)."""
        along = shares[..., None]
        chord = self.start[:, None] * (1.0 - along) + self.end[:, None] * along
        return chord + self._away(self.bow, self.drift, shares)

    def tangents(self, shares: Array) -> Array:
        """Their directions at shares (k,) or (n, k), not of unit length, shape (n, k, 2)."""
        drift = None if self.drift is None else self.drift.derivative
        return (self.end - self.start)[:, None] + self._away(self.bow.derivative, drift, shares)

    def _away(self, bow: Curves, drift: Curves | None, shares: Array) -> Array:
        found: Array = bow.at(shares)[..., None] * self.left[:, None]
        if drift is not None:
            ahead = self.left[:, None, ::-1] * [1.0, -1.0]
            found = found + drift.at(shares)[..., None] * ahead
        return found

    @property
    def curvature(self) -> Array:
        """Into how many pieces each would have to be cut to be straight within a metre, (n,); a root of a length."""
        second = self.bow.derivative.derivative.most
        if self.drift is not None:
            second = second + self.drift.derivative.derivative.most
        return np.sqrt(second / 8.0)

    def pieces(self, rows: Rows, fineness: float) -> Lines | None:
        """These axes, of the rods in `rows`, cut into pieces flat within `fineness` (m); None where all look straight."""
        wanted = self.curvature / np.sqrt(fineness)
        curved = np.flatnonzero((wanted > 1.0) & (wanted < _LARGEST))
        if not len(curved):
            return None
        least = np.array([2, 4, 8, 16, _MOST_PIECES])
        count = least[np.minimum(np.searchsorted(least, wanted[curved]), len(least) - 1)]
        of, number = groups(np.zeros_like(count), count + 1)
        points = self.some(curved[of]).points((number / count[of])[:, None])[:, 0]
        first = np.flatnonzero(of[:-1] == of[1:])
        return Lines(points[first], points[first + 1], rows[curved[of[first]]])


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
    slopes = state.bow.derivative.at(shares)[0]
    return state.bow.at(shares).T * state.left, slopes / max(float(state.length[0]), 1e-300)


def deflections(model: Model, rows: Rows) -> Curves:
    """How far the axes of some rods are from their chords now (m), to the left."""
    return _state(model, rows).bow


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
        forces = {name: float(inner_forces(model, rows, name).at(at)[0, 0]) for name in DIAGRAMS}
        start, end = model.particles.displacement[rods.between[row]]
        aside, slope = deflected(model, row, at)
        moved = start + at[0] * (end - start) + aside[0]
        rotation = chord_rotation(model)[row] + slope[0]
        return cls(float(at[0]) * length, forces, moved, float(rotation))


def farthest(model: Model, rows: Rows) -> tuple[Array, Array]:
    """The largest displacement (m) along each of some rods, and the share where it is, (n,) each."""
    if not rows.size:  # for the state of all rods, of which nothing is asked: half of a picture of 100 000
        return np.zeros(0), np.zeros(0)
    state, (start, end) = _state(model, rows), model.particles.displacement[model.rods.between[rows].T]
    row, low, high, bow = state.bow.stretches
    moved = state.left[row, :, None] * bow[:, None]
    moved[..., 0] += start[row]
    moved[..., 1] += (end - start)[row]
    terms = moved.shape[2]
    squares = np.zeros((len(row), 2 * terms - 1))
    for power in range(terms):
        squares[:, power : power + terms] += (moved[..., power, None] * moved).sum(axis=1)
    found, shares = extremes(Stretches(row, low, high, squares))
    return np.sqrt(found[:, 1]), shares[:, 1]


def _drift(state: _State) -> Curves | None:
    """How far points move along the chords, so that ends with slopes φ lie at angles φ to them, not arctan φ."""
    length = state.length
    slopes = state.slopes / np.where(length > 0.0, length, 1.0)[:, None]
    steep = np.clip(np.abs(slopes), 0.0, _STEEPEST)
    if not (steep > _STEEP).any():
        return None
    shorter = np.where(steep > _STEEP, steep / np.tan(np.maximum(steep, _STEEP)) - 1.0, -(steep**2) / 3.0)
    return Curves.plain(length[:, None] * cubic(*shorter.T))


class _State(NamedTuple):
    """Of some rods: length, unit vector to the left, slopes of the ends × length (n, 2), and deflections."""

    length: Array
    left: Array
    slopes: Array
    bow: Curves


def _state(model: Model, rows: Rows) -> _State:
    length, left, slopes, bow = _states(model)[0]
    return _State(length[rows], left[rows], slopes[rows], bow.some(rows))


def _states(model: Model) -> tuple[_State, Kinks]:
    """Those of all rods, and what acts between their ends."""
    found: tuple[_State, Kinks]
    revision, found, _ = model.bent
    if revision != model.revision:  # a picture asks nine times
        with np.errstate(invalid="ignore"):  # of rods whose ends are nowhere, which are not drawn
            found = _found(model)
        model.bent = model.revision, found, {}
    return found


def _found(model: Model) -> tuple[_State, Kinks]:
    rods, particles = model.rods, model.particles
    first, second = rods.between.astype(np.intp).T
    present = rods.difference
    if not model.first_order:
        present = present + particles.displacement[second] - particles.displacement[first]
    length = np.hypot(present[:, 0], present[:, 1])
    along = present / np.where(length > 0.0, length, 1.0)[:, None]
    left = np.stack([-along[:, 1], along[:, 0]], axis=1)
    between = Kinks.of(model, model.share)
    rigid = rigid_slopes(rods, particles.rotation[rods.between], chord_rotation(model))
    slopes = all_slopes(rods, rigid, on_axis(between.on_clamped(rods.rest_length), along)[1])
    slopes = np.where((rods.bending_stiffness > 0.0)[:, None], length[:, None] * slopes, 0.0)
    bow = between.sags(left, rods.rest_length, rods.bending_stiffness).plus(cubic(*slopes.T))
    if has_struts(model):
        bow = bow.plus(np.outer(rods.lateral_deflection, HALF_SINE))
    return _State(length, left, slopes, bow), between


def inner_forces(model: Model, rows: Rows, quantity: str) -> Curves:
    """N, V (kN) or M (kN·m) along some rods; at their ends the computed columns.

    M as in `moments_along`, with what acts between the ends, N × the half sine of struts and, but for first-order theory,
    N × the cubic deflection v.
    """
    rods, (state, between) = model.rods, _states(model)
    name = {AXIAL: "end_axial_force", SHEAR: "shear", MOMENT: "bending_moment"}[quantity]
    ends = getattr(rods, name)
    if quantity == MOMENT:
        thrust = 0.0 if model.first_order else rods.axial_force[:, None]
        by_thrust = thrust * cubic(*state.slopes.T)
        of_struts = rods.axial_force * rods.lateral_deflection if has_struts(model) else None
        return moments_along(ends, between, state.left, state.length, by_thrust, of_struts).some(rows)
    x, y = state.left.T
    direction = state.left if quantity == SHEAR else np.stack([-y, x], axis=1)
    return forces_along(ends[:, 0], between, direction).some(rows)


def forces_along(start: Array, between: Kinks, direction: Array) -> Curves:
    """V or N (kN) of all rods by their values at the starts; direction: to the left of the chords, or back along them."""
    size = (between.size[:, :2] * direction[between.row]).sum(axis=1)
    return between.integrated(1, size, len(start), 3).plus(start[:, None])


def largest_sag(model: Model) -> float:
    """The largest deflection of a rod from the straight line between its ends (m), about."""
    if not is_frame(model):
        return 0.0
    middle = deflections(model, np.flatnonzero(model.rods.bending_stiffness > 0.0)).at(np.array([0.5]))
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


def borne_between(model: Model, acting: Acting | None = None) -> Array:
    """What of the force (kN) on each particle acts between the ends of rods, (particles, 2).

    acting: combinations, whole, of which these follow one another; None: as much as acts in what the model shows.
    """
    rods = model.rods
    count = 1 if acting is None else len(acting.permanent)
    between = Kinks.of(model, model.share if acting is None else 1.0, acting)
    found = np.zeros((count, model.particles.count, 2))
    if len(between.row):
        on_ends = between.on_ends(count * rods.count).reshape(count, -1, 2)
        np.add.at(found.swapaxes(0, 1), rods.between.ravel(), on_ends.swapaxes(0, 1))
    return found.reshape(-1, 2)
