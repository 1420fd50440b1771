"""What rods answer to displacements: their forces, what yields, flows and is slack, and the pieces of their laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array, Flags
from pinjoint.systems.statics.bending import Bent


def of_axes(values: NDArray[Any]) -> NDArray[Any]:
    """Of what can yield, (rods,) or with both ends (rods, 3), that of the axes, (rods,)."""
    return values if np.ndim(values) < 2 else values[:, 0]


def of_rods(flags: Flags) -> Flags:
    """Of flags of what can yield, rods of which any part has one, (rods,)."""
    return flags if flags.ndim == 1 else flags[:, 0] | flags[:, 1] | flags[:, 2]


@dataclass(frozen=True)
class Response:
    """The state of the rods at given displacements, by return mapping from a given plastic strain; (rods,).

    elastic_force: the trial force, before yielding. plastic_strain: after yielding. axis: unit vectors from
    first to second end, (rods, 2). flowing: rods that yield now. slack: one-sided rods without force, and struts that have
    buckled. round_off: what rounding alone makes of elastic_force (kN). elongation: of the axis, which may bow. bent: how
    members bend; None where none do. share: of the distributed forces that acts. spring_force: what holds particles against
    elastic supports, (n, …).

    Where ends yield, as plastic hinges, these are (rods, 3), of the axis and of both ends: elastic_force (of ends moments,
    kN·m, as if only the other end yielded), plastic_strain (rotations, rad), flowing, slack, round_off, and tied: ends that
    flow, too, but count as if they did not, so that something holds their joints.
    """

    elongation: Array
    strain: Array
    length: Array
    axis: Array
    elastic_force: Array
    axial_force: Array
    plastic_strain: Array
    flowing: Flags
    slack: Flags
    round_off: Array
    bent: Bent | None = None
    share: float = 0.0
    spring_force: Array | float = 0.0
    tied: Flags | bool = False

    @property
    def soft(self) -> Flags:
        """Rods whose force does not change when their length does a little."""
        return self.flowing | self.slack

    @property
    def force(self) -> Array:
        """Of all that can yield: axial forces, and where ends do moments on them (rods, 3)."""
        if self.flowing.ndim == 1 or self.bent is None:
            return self.axial_force
        return np.column_stack([self.axial_force, self.bent.moment])

    @property
    def deformation(self) -> Array:
        """Of the same, yielding included: elongations (m), and where ends yield their slopes, (rods, 3)."""
        if self.flowing.ndim == 1 or self.bent is None:
            return self.elongation
        return np.column_stack([self.elongation, self.bent.slopes + self.plastic_strain[:, 1:]])

    @property
    def reach(self) -> Array:
        """What motions are measured by (m): the length, of slack cables that at which they tighten.

        A slack cable may shrink to a point and turn over without anything changing.
        """
        tightens: Array = np.where(of_axes(self.slack), self.length - self.elongation, 0.0)
        return np.maximum(self.length, tightens)


@dataclass(frozen=True)
class Branches:
    """The linear piece of its law that each rod is on; shape (rods,).

    force: elastic of slack rods, else axial (kN). low, high: the forces at which the piece ends. outward: the
    sense of elongation, 1 or −1, in which a rod at an end of its piece leaves it; 0 elsewhere. verge:
    one-sided rods that are about to tighten or slacken, struts about to buckle. slack: the others beyond that.
    Where ends yield, (rods, 3), as of `Response`.
    """

    force: Array
    low: Array
    high: Array
    outward: Array
    slack: Flags
    verge: Flags


@dataclass(frozen=True)
class Piece:
    """A piece of the laws of all that can yield, (rods,) or (rods, 3): what flows at the force `edge`, and what is slack."""

    flowing: Flags
    slack: Flags
    edge: Array
