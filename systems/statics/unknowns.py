"""Static unknowns of the force method: forces and moments that may be released, by name, and which ones to choose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import qr

from pinjoint.components.arrays import Array
from pinjoint.components.field import ENDS
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.particle import AXES, Particle, in_support_axes, spring_stiffness, supported
from pinjoint.components.rod import Rod, bends, rigid_joints
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.wording import missing
from pinjoint.systems.statics.equations import Structure

_KEPT = 1e6  # weight of supports against rods when redundants are chosen: rods are released first
_NEVER = 1e8  # of axial forces in rods that bend, which are not released
_FIRST = 1e-3  # of bending moments, which are released before bars
_RANK = 1e-9  # relative size below which a pivot is zero


class MethodError(Mistake, ValueError):
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
    def said(self) -> str:
        """The same as it is read."""
        what = self.name.removeprefix(self.element.name)[1:]
        return joined([self.element.said, *[tr(what)] * bool(what)], ".")

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

    def spring(self, model: Model) -> float:
        """The stiffness of an elastic support whose reaction it is; else 0."""
        return float(spring_stiffness(model)[self.place]) if self.of_support else 0.0

    @property
    def is_moment(self) -> bool:
        """True of a bending moment and of the moment of a clamp."""
        return self.of_end or self.axis == 2

    @property
    def unit(self) -> str:
        """Of the unknown itself."""
        return "kN·m" if self.is_moment else "kN"

    @classmethod
    def named(cls, model: Model, name: str) -> Unknown:
        """The unknown called "AC" (a rod), "AB.start" (its bending moment there), "A.y" or "A.rotation" (a support).

        Raises MethodError.
        """
        if name in model.rods:
            return cls(model.rods[name])
        place, _, what = name.rpartition(".")
        if place in model.rods and what in ENDS:
            return cls(model.rods[place], ENDS.index(what))._checked(model)
        if place in model.particles and what in AXES:
            return cls(model.particles[place], AXES.index(what))._checked(model)
        if name in model.particles:
            raise MethodError(
                "'{name}' is a particle; say which of its supports, such as {name}.x or {name}.y.", name=name
            )
        held = np.argwhere(supported(model) & [True, True, bends(model)]).tolist()
        supports = [cls(model.particles[row], axis) for row, axis in held]
        choices = [*model.rods.names, *(unknown.name for unknown in (*supports, *_of_ends(model)))]
        raise MethodError(missing(marked("rods and supports"), name, choices))

    def _checked(self, model: Model) -> Unknown:
        """The same. Raises MethodError where there is no such force."""
        row, axis, place = self.element.row, self.axis, self.element.name
        if self.of_end and not model.rods.turning_shares[row, axis]:
            raise MethodError(
                "There is no moment to release at {name}: {rod} is hinged there, or does not bend.",
                name=self.name,
                rod=place,
            )
        if axis == 2 and not supported(model)[row, axis]:
            raise MethodError(
                "{particle} is not clamped, so there is no moment to release there.", particle=place
            )
        if self.of_support and axis in (0, 1) and not supported(model)[row, axis]:
            raise MethodError(
                "{particle} is free along {axis}, so there is no reaction to release there.",
                particle=place,
                axis=AXES[axis],
            )
        return self

    def check_suits(self, model: Model) -> None:
        """Raise MethodError where no other part of the structure shares the force."""
        row = self.element.row
        if self.of_bar and (model.rods.turning_shares[row] > 0.0).any():
            raise MethodError(
                "{rod} bends. Release the moment at one of its ends instead: {rod}.start or {rod}.end.",
                rod=self.name,
            )
        if self.of_support and not (model.rods.between == row).any():
            raise MethodError(
                "{name} is not a static unknown: no rod ends at {particle}, so its reaction only balances what acts"
                " on it there. Choose a rod, or a support of the structure.",
                name=self.name,
                particle=self.element.name,
            )
        if self.axis == 2 and self.of_support and not rigid_joints(model)[row]:
            raise MethodError(
                "{name} is not a static unknown: no rod that bends is joined rigidly at {particle}.",
                name=self.name,
                particle=self.element.name,
            )

    def unit_load(self, model: Model) -> tuple[Array, Array]:
        """What a unit of it does to the particles, (n, 3), and to released ends of rods, counter-clockwise, (rods, 2).

        1 kN along a released constraint, or 1 kN·m; a pair of 1 kN that pulls a released bar's ends together; 1 kN·m on the
        end of a rod, which hands its opposite on to the joint.
        """
        force, couple = np.zeros((model.particles.count, 3)), np.zeros((model.rods.count, 2))
        if self.of_bar:
            row = self.element.row
            axis = model.rods.difference[row] / model.rods.original_length[row]
            force[model.rods.between[row], :2] = axis, -axis
        elif self.of_support:
            force[self.place] = 1.0
            force = in_support_axes(model, force, back=True)
        else:
            couple[self.place] = (-1.0, 1.0)[self.axis or 0]
        return force, couple


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
    held = Structure.of(model, FIRST_ORDER)
    free = replace(held, sparse=False).unsupported()
    rigid = np.zeros(free.ends.shape, dtype=bool) if free.bending is None else free.bending.rigid
    weights = np.concatenate([np.where(rigid.any(axis=1), _NEVER, 1.0), np.full(int(rigid.sum()), _FIRST)])
    of_rods = free.scaled_compatibility * weights[:, None]
    place = {int(coordinate): at for at, coordinate in enumerate(free.index.tolist())}
    supports = [at for at in np.argwhere(held.supported).tolist() if at[0] * held.width + at[1] in place]
    of_supports = np.zeros((len(supports), free.size))
    for number, (row, axis) in enumerate(supports):
        of_supports[number, place[row * held.width + axis]] = _KEPT
    reactions = [Unknown(model.particles[row], axis) for row, axis in supports]
    return np.vstack([of_rods, of_supports]).T, [*map(Unknown, model.rods), *_of_ends(model), *reactions]
