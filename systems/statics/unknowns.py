"""Static unknowns of the force method: forces and moments that may be released, by name, and which ones to choose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import qr

from pinjoint.components.field import ENDS
from pinjoint.components.language import marked
from pinjoint.components.mistake import Explained
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bends
from pinjoint.components.wording import missing
from pinjoint.systems.statics.equations import AXES, Array, Structure

_KEPT = 1e6  # weight of supports against rods when redundants are chosen: rods are released first
_NEVER = 1e8  # of axial forces in rods that bend, which are not released
_FIRST = 1e-3  # of bending moments, which are released before bars
_RANK = 1e-9  # relative size below which a pivot is zero


class ForceMethodError(Explained, ValueError):
    """A static unknown that cannot be used; the message names it, the reason and the remedy.

    motion: of the mechanism that its release would leave, (n, 2 or 3), the largest 1; None for other reasons.
    """

    def __init__(self, message: str, motion: Array | None = None, /, **values: Any) -> None:
        super().__init__(message, **values)
        self.motion = motion


@dataclass(frozen=True)
class Unknown:
    """A static unknown: the axial force of a bar (axis None), the bending moment at an end of a rod (0: start, 1: end), or
    the reaction of a support in one direction (0: x, 1: y, 2: the moment of a clamp)."""

    element: Rod | Particle
    axis: int | None = None

    @property
    def name(self) -> str:
        """As on the command line: "AC", "AB.start", "A.y" or "A.rotation"."""
        if self.axis is None:
            return self.element.name
        return f"{self.element.name}.{(ENDS if isinstance(self.element, Rod) else AXES)[self.axis]}"

    @property
    def place(self) -> int | tuple[int, int]:
        """Its row, and its axis if it has one: where it stands in a column."""
        return self.element.row if self.axis is None else (self.element.row, self.axis)

    @property
    def of_bar(self) -> bool:
        """True of the axial force of a bar."""
        return self.axis is None

    @property
    def of_end(self) -> bool:
        """True of the bending moment at an end of a rod."""
        return self.axis is not None and isinstance(self.element, Rod)

    @property
    def of_support(self) -> bool:
        """True of a reaction."""
        return isinstance(self.element, Particle)

    @property
    def is_moment(self) -> bool:
        """True of a bending moment and of the moment of a clamp."""
        return self.of_end or self.axis == 2

    @property
    def unit(self) -> str:
        """Of the unknown itself."""
        return "kN·m" if self.is_moment else "kN"


def find_unknown(model: Model, name: str) -> Unknown:
    """The unknown called "AC" (a rod), "AB.start" (its bending moment there), "A.y" or "A.rotation" (a support).

    Raises ForceMethodError.
    """
    if name in model.rods:
        return Unknown(model.rods[name])
    place, _, what = name.rpartition(".")
    if place in model.rods and what in ENDS:
        return _found(model, Unknown(model.rods[place], ENDS.index(what)))
    if place in model.particles and what in AXES:
        return _found(model, Unknown(model.particles[place], AXES.index(what)))
    if name in model.particles:
        raise ForceMethodError(
            "'{name}' is a particle; say which of its supports, such as {name}.x or {name}.y.", name=name
        )
    particles = model.particles
    fixed = np.column_stack([particles.fixed, particles.fixed_rotation & bends(model)])
    supports = [Unknown(particles[row], axis) for row, axis in np.argwhere(fixed).tolist()]
    choices = [*model.rods.names, *(unknown.name for unknown in (*supports, *_of_ends(model)))]
    raise ForceMethodError(missing(marked("rods and supports"), name, choices))


def _found(model: Model, unknown: Unknown) -> Unknown:
    """The same unknown. Raises ForceMethodError where there is no such force."""
    row, axis, place = unknown.element.row, unknown.axis, unknown.element.name
    if unknown.of_end and not model.rods.turning_shares[row, axis]:
        raise ForceMethodError(
            "There is no moment to release at {name}: {rod} is hinged there, or does not bend.",
            name=unknown.name,
            rod=place,
        )
    if axis == 2 and not model.particles.fixed_rotation[row]:
        raise ForceMethodError(
            "{particle} is not clamped, so there is no moment to release there.", particle=place
        )
    if unknown.of_support and axis in (0, 1) and not model.particles.fixed[row, axis]:
        raise ForceMethodError(
            "{particle} is free along {axis}, so there is no reaction to release there.",
            particle=place,
            axis=AXES[axis],
        )
    return unknown


def refuse_unsuited(model: Model, unknowns: Sequence[Unknown]) -> None:
    """Raise ForceMethodError for an unknown whose force no other part of the structure shares."""
    for unknown in unknowns:
        row = unknown.element.row
        if unknown.of_bar and (model.rods.turning_shares[row] > 0.0).any():
            raise ForceMethodError(
                "{rod} bends. Release the moment at one of its ends instead: {rod}.start or {rod}.end.",
                rod=unknown.name,
            )
        if unknown.of_support and not (model.rods.between == row).any():
            raise ForceMethodError(
                "{name} is not a static unknown: no rod ends at {particle}, so its reaction only balances what acts"
                " on it there. Choose a rod, or a support of the structure.",
                name=unknown.name,
                particle=unknown.element.name,
            )
        if unknown.axis == 2 and unknown.of_support and not is_turned(model, row):
            raise ForceMethodError(
                "{name} is not a static unknown: no rod that bends is joined rigidly at {particle}.",
                name=unknown.name,
                particle=unknown.element.name,
            )


def is_turned(model: Model, particle: int) -> bool:
    """True if a rod that bends is joined rigidly to a particle, so that its rotation counts."""
    return bool(((model.rods.between == particle) & (model.rods.turning_shares > 0.0)).any())


def _of_ends(model: Model) -> list[Unknown]:
    """All bending moments at rigid ends."""
    return [Unknown(model.rods[row], end) for row, end in np.argwhere(model.rods.turning_shares > 0.0).tolist()]


def redundants(model: Model) -> list[Unknown]:
    """Unknowns whose release leaves an isostatic structure, by pivoted QR of the equilibrium matrix.

    Bending moments before bars, bars before supports. As many as the degree of static indeterminacy; none if isostatic.
    """
    columns, unknowns = _equilibrium(model)
    factor, order = qr(columns, mode="r", pivoting=True)
    sizes = np.abs(np.diag(factor))
    rank = int((sizes > _RANK * sizes.max(initial=0.0) / _KEPT).sum())
    return [unknowns[column] for column in sorted(order[rank:].tolist())]


def _equilibrium(model: Model) -> tuple[Array, list[Unknown]]:
    """Columns of the equilibrium matrix and their unknowns: rods, moments at rigid ends (by a mean length), supports."""
    held = Structure.of(model, "linear")
    free = replace(held, fixed=np.zeros_like(held.fixed), sparse=False).with_translations()
    rigid = np.zeros(free.ends.shape, dtype=bool) if free.bending is None else free.bending.rigid
    weights = np.concatenate([np.where(rigid.any(axis=1), _NEVER, 1.0), np.full(int(rigid.sum()), _FIRST)])
    of_rods = free.scaled_compatibility * weights[:, None]
    place = {int(coordinate): at for at, coordinate in enumerate(free.index.tolist())}
    supports = [at for at in np.argwhere(held.fixed).tolist() if at[0] * held.width + at[1] in place]
    of_supports = np.zeros((len(supports), free.size))
    for number, (row, axis) in enumerate(supports):
        of_supports[number, place[row * held.width + axis]] = _KEPT
    reactions = [Unknown(model.particles[row], axis) for row, axis in supports]
    return np.vstack([of_rods, of_supports]).T, [*map(Unknown, model.rods), *_of_ends(model), *reactions]
