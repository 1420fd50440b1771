"""What the force method and the displacement method have in common: a state under the load, one under a unit of each
unknown, and their sum, by first-order theory about original positions, in which superposition is exact.

Both solve as many symmetric equations as there are unknowns, and both show the real structure beside the sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from pinjoint.components.arrays import Array
from pinjoint.components.cases import settled
from pinjoint.components.model import Model
from pinjoint.components.wording import brief
from pinjoint.systems.statics.equations import Structure, largest
from pinjoint.systems.statics.theory import FirstOrder
from pinjoint.systems.statics.unknowns import Unknown

# Of the largest force, or of the geometric mean of their diagonal: smaller flexibilities are 0.
ROUNDING = 1e-12


def without_rounding(matrix: Array) -> Array:
    """A symmetric matrix (m, m), in which what is nothing beside its diagonal is 0."""
    size = np.sqrt(np.abs(np.diag(matrix)))
    return np.where(np.abs(matrix) > ROUNDING * np.outer(size, size), matrix, 0.0)


@dataclass(frozen=True, repr=False)
class SetState:
    """A set by first-order theory: displacement (n, 2) in m, rotation (n,) in rad, axial forces (rods,) in kN.

    end_moment: counter-clockwise on the ends of the rods, kN·m, (rods, 2). reaction: kN and, of clamps, kN·m, (n, 3). Of a
    unit force they include that force itself, in the cut bar or at the released support.
    """

    __repr__ = brief

    displacement: Array
    rotation: Array
    axial_force: Array
    end_moment: Array
    reaction: Array

    @property
    def bending_moment(self) -> Array:
        """At the ends of the rods, positive where the side on their right is in tension, (rods, 2)."""
        return self.end_moment * np.array([-1.0, 1.0])

    def without_rounding(self, length: Array) -> SetState:
        """The same, in which what is nothing beside the largest force is 0; length: of the rods, as levers (rods,)."""
        lever = length.max(initial=0.0)
        moments = self.end_moment / length[:, None]
        forces = (self.axial_force, self.reaction[:, :2], moments, self.reaction[:, 2:] / max(lever, 1e-300))
        least = ROUNDING * max(map(largest, forces))

        def kept(values: Array, least: Array | float) -> Array:
            return np.where(np.abs(values) > least, values, 0.0)

        return replace(
            self,
            axial_force=kept(self.axial_force, least),
            end_moment=kept(self.end_moment, least * length[:, None]),
            reaction=kept(self.reaction, least * np.array([1.0, 1.0, lever])),
        )

    @classmethod
    def solved(
        cls, theory: FirstOrder, load: Array, supports: Array, share: float, moment: Array | float = 0.0
    ) -> SetState:
        """That of a structure under a load (n, …), whose supports are displaced so, and a share of what acts without one.

        moment: on the ends of rods besides, (rods, 2). Raises NoEquilibrium.
        """
        model, rods = theory.model, theory.structure.grown(share)
        strain = share * model.rods.plastic_strain
        moved, response = theory.equilibrium(load, supports, strain, share, rods)
        reaction = np.zeros((len(moved), 3))
        reaction[:, : rods.width] = rods.reactions(response, load)
        end_moment = rods.end_moments(response) + moment
        state = cls(moved[:, :2], rods.rotation(moved), response.axial_force, end_moment, reaction)
        return state.without_rounding(model.rods.rest_length)

    @classmethod
    def superposed(cls, states: Sequence[SetState], amounts: Sequence[float]) -> SetState:
        """The sum of so much of each of some states."""
        return cls(
            *(
                sum(amount * getattr(state, part.name) for state, amount in zip(states, amounts, strict=True))
                for part in fields(cls)
            )
        )


def settled_supports(model: Model, structure: Structure) -> Array:
    """How far rigid supports are moved and turned, in directions that a structure holds, (n, …)."""
    places = settled(model)
    return structure.of_supports(structure.field(places[:, :2], places[:, 2]))


@dataclass(frozen=True)
class Superposition:
    """A structure as a state under the load and so much, `amounts`, of states under units of its unknowns.

    real: the state of the structure itself, solved at once, which the sum equals.
    """

    unknowns: tuple[Unknown, ...]
    real: SetState
    base: SetState
    units: tuple[SetState, ...]

    @property
    def amounts(self) -> Array:
        """How much of each unknown there is (m,), in m, rad, kN, kN·m."""
        raise NotImplementedError

    @property
    def superposed(self) -> SetState:
        """The sum, set 2 + Σ x × set 3, which equals set 1."""
        return SetState.superposed((self.base, *self.units), (1.0, *self.amounts.tolist()))
