"""Displacement method: the displacements and rotations of joints from the equilibrium of what holds them, by first-order
theory about original positions.

The kinematically determinate structure has all its unknowns Δ held. Under the load its holds need forces R₀, those at the
ends of the members that a table of fixed-end forces has; a unit of one unknown alone takes forces k at all of them. Without
holds these are none: K Δ = F, with F = −R₀. K is the sum of what members and springs of supports add, as statics assembles
it. Inextensible rods take some directions along with others, which then are no unknowns; their axial forces follow from
equilibrium in every state, as what statics finds for the held structure.

Ends of members that are hinged need no unknown of their own: what holds them is 0 however they turn, and k is without them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr

from pinjoint.components.arrays import Array, Flags
from pinjoint.components.model import Model
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.wording import brief
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.force_method import real_structure
from pinjoint.systems.statics.superposition import (
    ROUNDING,
    SetState,
    Superposition,
    settled_supports,
    without_rounding,
)
from pinjoint.systems.statics.theory import FirstOrder
from pinjoint.systems.statics.unknowns import MethodError, Unknown

MOST = 300  # unknowns, each of which has a state of its own
_LEAST = 1e-9  # of how a direction changes the length of an inextensible rod; less is rounding
_LATER = 1.01  # times the first direction, the last is preferred as one that is taken along


@dataclass(frozen=True, repr=False)
class Solution(Superposition):
    """K Δ = F of n unknowns, in m, rad, kN, kN·m; they are free directions of particles.

    stiffness: K (n, n). load: F (n,). displacement: Δ (n,). members: k of every rod over the coordinates of both its ends,
    along the axes of supports, (rods, 2 × width, 2 × width). ways: how these move by units of unknowns, (rods, …, n):
    1 where one is that unknown; where inextensible rods take others along, more.
    """

    __repr__ = brief

    stiffness: Array
    load: Array
    displacement: Array
    members: Array
    ways: Array

    @property
    def amounts(self) -> Array:
        """Δ."""
        return self.displacement

    def shares(self, i: int, j: int) -> Array:
        """What every rod adds to an entry of K (rods,), 0 but for rounding where it adds nothing."""
        added = ((self.ways[:, :, i, None] * self.members).sum(axis=1) * self.ways[:, :, j]).sum(axis=1)
        nothing = ROUNDING * np.sqrt(self.stiffness[i, i] * self.stiffness[j, j])
        return np.where(np.abs(added) > nothing, added, 0.0)


def solve(model: Model) -> Solution:
    """The displacement method for all free directions of joints, of those that inextensible rods join as many as needed.

    Raises MethodError.
    """
    whole = replace(Structure.of(model, FIRST_ORDER), sparse=False)
    independent = _independent(whole)
    count, width = int(independent.sum()), whole.width
    if count > MOST:
        raise MethodError(
            "The structure has {count} unknown displacements. The displacement method is shown up to {most}; statics"
            " solves it as it is.",
            count=count,
            most=MOST,
        )
    real_theory, real = real_structure(model)
    held = replace(whole, fixed=whole.fixed | independent, unknown=whole.unknown & ~independent)
    theory = FirstOrder(model, held)
    nothing: Array = np.zeros(whole.fixed.shape)
    at = tuple(np.argwhere(independent).T)
    units = np.zeros((count, *nothing.shape))
    units[(np.arange(count), *at)] = 1.0
    base = SetState.solved(theory, External.of(model).at(1.0), settled_supports(model, whole), 1.0)
    alone = tuple(SetState.solved(theory, nothing, whole.along_axes(unit), 0.0) for unit in units)
    firm = np.isin(np.arange(len(whole.ends)), whole.inextensible)
    members = replace(whole, stiffness=np.where(firm, 0.0, whole.stiffness)).stiffnesses
    fields = np.array([whole.along_supports(whole.field(one.displacement, one.rotation)) for one in alone])
    fields = fields.reshape(count, *nothing.shape)
    ways = np.moveaxis(fields[:, whole.ends].reshape(count, len(whole.ends), 2 * width), 0, 2)
    load = -whole.along_supports(base.reaction[:, :width])[at] + 0.0
    if firm.any():
        stiffness = np.einsum("rai,rab,rbj->ij", ways, members, ways)
        stiffness += np.einsum("ipa,pa,jpa->ij", fields, whole.springs, fields)
        stiffness = without_rounding(stiffness)
        displacement = np.linalg.solve(stiffness, load).astype(np.float64)
    else:
        stiffness = np.asarray(whole.initial_tangent)
        displacement = whole.gather(real_theory.theory.deflection(whole.spread(load)))
    unknowns = tuple(
        Unknown(model.particles[row], axis) for row, axis in zip(*map(np.ndarray.tolist, at), strict=True)
    )
    return Solution(unknowns, real, base, alone, stiffness, load, displacement, members, ways)


def _independent(whole: Structure) -> Flags:
    """The unknowns (n, …) less those that others and inextensible rods take along: of each of these rods one."""
    found = whole.unknown.copy()
    if len(whole.inextensible):
        along = whole.elongations(whole.unmoved, whole.inextensible)
        later = along * np.linspace(1.0, _LATER, whole.size)
        factor, order = qr(later, mode="r", pivoting=True)  # those by which others are told best
        rank = int((np.abs(np.diag(factor)) > _LEAST).sum())
        found.ravel()[whole.index[order[:rank]]] = False
    return found
