"""Displacement method: the displacements and rotations of joints from the equilibrium of what holds them, by first-order
theory about original positions.

The kinematically determinate structure has all its unknowns Δ held. Under the load its holds need forces R₀, those at the
ends of the members that a table of fixed-end forces has; a unit of one unknown alone takes forces k at all of them. Without
holds these are none: K Δ = F, with F = −R₀. K is the sum of what the members add, as statics assembles it,
and of springs of supports.

Ends of members that are hinged need no unknown of their own: what holds them is 0 however they turn, and k is without them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pinjoint.components.model import Model
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.systems.statics.equations import Array, Rows, Structure
from pinjoint.systems.statics.explain import rod_names
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.force_method import real_structure
from pinjoint.systems.statics.superposition import SetState, Superposition
from pinjoint.systems.statics.theory import elastic
from pinjoint.systems.statics.unknowns import MethodError, Unknown

MOST = 300  # unknowns, each of which has a state of its own


@dataclass(frozen=True)
class Solution(Superposition):
    """K Δ = F of n unknowns, in m, rad, kN, kN·m; they are free directions of particles.

    stiffness: K (n, n). load: F (n,). displacement: Δ (n,). members: k of every rod over the coordinates of both its ends,
    along the axes of supports, (rods, 2 × width, 2 × width). places: the number of the unknown that each of these is, −1
    where it is held, (rods, 2 × width).
    """

    stiffness: Array
    load: Array
    displacement: Array
    members: Array
    places: Rows

    @property
    def amounts(self) -> Array:
        """Δ."""
        return self.displacement

    @cached_property
    def _rounding(self) -> Array:
        """What of an entry of K is nothing, (n, n)."""
        size = np.sqrt(np.diag(self.stiffness))
        return 1e-12 * np.outer(size, size)

    def shares(self, i: int, j: int) -> Array:
        """What every rod adds to an entry of K (rods,), 0 but for rounding where it adds nothing."""
        both = (self.places == i)[:, :, None] & (self.places == j)[:, None, :]
        added = (self.members * both).sum(axis=(1, 2))
        return np.where(np.abs(added) > self._rounding[i, j], added, 0.0)


def solve(model: Model) -> Solution:
    """The displacement method for all free directions of joints. Raises MethodError."""
    whole = replace(Structure.of(model, FIRST_ORDER), sparse=False)
    count, width = whole.size, whole.width
    if count > MOST:
        raise MethodError(
            "The structure has {count} unknown displacements. The displacement method is shown up to {most}; statics"
            " solves it as it is.",
            count=count,
            most=MOST,
        )
    if len(firm := whole.inextensible):
        raise MethodError(
            "Unknown displacements are shown with the EA of all rods, but {rods} counts as inextensible. Let it have its EA;"
            " statics solves the structure as it is.",
            rods=rod_names(model, firm[:1]),
        )
    released, real = real_structure(model)
    held = replace(whole, fixed=whole.fixed | whole.unknown, unknown=np.zeros_like(whole.unknown))
    moved = whole.field(model.particles.displacement, model.particles.rotation)
    supports, nothing = whole.of_supports(moved), np.zeros(moved.shape)
    base = _state(model, held, External.of(model).at(1.0), supports, 1.0)
    number = np.full(moved.size, -1, dtype=np.intp)
    number[whole.index] = np.arange(count)
    load = whole.gather(-base.reaction[:, :width]) + 0.0
    return Solution(
        tuple(Unknown(model.particles[row], axis) for row, axis in np.argwhere(whole.unknown).tolist()),
        real,
        base,
        tuple(_state(model, held, nothing, whole.spread(unit), 0.0) for unit in np.eye(count)),
        stiffness=np.asarray(whole.initial_tangent),
        load=load,
        displacement=whole.gather(released.theory.deflection(whole.spread(load))),
        members=whole.stiffnesses,
        places=number.reshape(-1, width)[whole.ends].reshape(-1, 2 * width),
    )


def _state(model: Model, held: Structure, load: Array, moved: Array, share: float) -> SetState:
    """That of the held structure displaced so (n, …), under a load (n, …) and a share of what acts without one."""
    rods = held.grown(share)
    response = elastic(rods, moved, share * model.rods.plastic_strain, share)
    return SetState.of(model, rods, load, moved, response, np.zeros(held.ends.shape))
