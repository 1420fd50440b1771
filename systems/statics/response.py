"""How the rods of a structure respond to displacements, and the pieces of their laws that they are on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.systems.statics.bending import Bent

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Response:
    """The state of the rods at given displacements, by return mapping from a given plastic strain; (rods,).

    elastic_force: the trial force, before yielding. plastic_strain: after yielding. axis: unit vectors from
    first to second end, (rods, 2). flowing: rods that yield now. slack: one-sided rods without force.
    round_off: what rounding alone makes of elastic_force (kN). elongation: of the axis, which may bow. bent: how
    members bend; None where none do. share: of the distributed forces that acts.
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

    @property
    def soft(self) -> Flags:
        """Rods whose force does not change when their length does a little."""
        return self.flowing | self.slack

    @property
    def reach(self) -> Array:
        """What motions are measured by (m): the length, of slack cables that at which they tighten.

        A slack cable may shrink to a point and turn over without anything changing.
        """
        tightens: Array = np.where(self.slack, self.length - self.elongation, 0.0)
        return np.maximum(self.length, tightens)


@dataclass(frozen=True)
class Branches:
    """The linear piece of its law that each rod is on; shape (rods,).

    force: elastic of slack rods, else axial (kN). low, high: the forces at which the piece ends. outward: the
    sense of elongation, 1 or −1, in which a rod at an end of its piece leaves it; 0 elsewhere. verge:
    one-sided rods that are about to tighten or slacken. slack: the other one-sided rods without force.
    """

    force: Array
    low: Array
    high: Array
    outward: Array
    slack: Flags
    verge: Flags
