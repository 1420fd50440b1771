"""Counting: the degree of indeterminacy by hand, with its numbers, and what the rank says.

Of trusses by Maxwell's rule, g = m + r − 2n; where members bend, by g = 3m + r − 3n − h.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinjoint.components.language import joined, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import supported
from pinjoint.components.rod import bends, nodes, rigid_joints


@dataclass(frozen=True)
class Count:
    """What is counted by hand: m rods, r constraints of their nodes, n nodes, and where members bend h hinges.

    g is the number of states of self-stress less that of mechanisms: the degree of static indeterminacy where there
    are no mechanisms, which only the rank of the compatibility matrix tells.

    hinges: releases. A joint of which all rod ends are hinged counts as one of them less: one may be thought rigid. None
    in a truss, all joints of which are such, so that the formula is shorter.
    """

    rods: int
    constraints: int
    nodes: int
    hinges: int | None = None

    @classmethod
    def of(cls, model: Model) -> Count:
        """The rods, constraints and nodes of a model, and its hinges if it bends; particles without rods are no nodes."""
        rods, used, held = model.rods, nodes(model), supported(model)
        constraints = int(held[used, :2].sum())
        if not bends(model):
            return cls(rods.count, constraints, int(used.sum()))
        rigid = rods.turning_shares > 0.0
        turns = rigid_joints(model)
        hinges = int(np.count_nonzero(~rigid)) - int((used & ~turns).sum())
        return cls(rods.count, constraints + int(held[turns, 2].sum()), int(used.sum()), hinges)

    @property
    def formula(self) -> str:
        """The rule in symbols."""
        return "g = m + r − 2n" if self.hinges is None else "g = 3m + r − 3n − h"

    @property
    def degree(self) -> int:
        """g."""
        if self.hinges is None:
            return self.rods + self.constraints - 2 * self.nodes
        return 3 * self.rods + self.constraints - 3 * self.nodes - self.hinges

    @property
    def numbers(self) -> str:
        """The right side of the formula with the numbers filled in, and its value."""
        if self.hinges is None:
            filled = f"{self.rods} + {self.constraints} − 2·{self.nodes}"
        else:
            filled = f"3·{self.rods} + {self.constraints} − 3·{self.nodes} − {self.hinges}"
        return f"{filled} = {self.degree}".replace("-", "−")

    def by_rank(self, static: int, mechanisms: int) -> str:
        """What the rank says beside it, "" where the rule tells it all: there are no mechanisms."""
        if not mechanisms:
            return ""
        stressed = plural("one state of self-stress", "{count} states of self-stress", static)
        if not static:
            stressed = tr("no state of self-stress")
        return joined([stressed, plural("one mechanism", "{count} mechanisms", mechanisms)], ", ")
