"""Counting: the degree of indeterminacy g = m + r − 2n by Maxwell's rule, with its numbers, and what the rank says."""

from __future__ import annotations

from dataclasses import dataclass

from components.model import Model
from components.rod import nodes

FORMULA = "g = m + r − 2n"


@dataclass(frozen=True)
class Count:
    """What Maxwell's rule counts: m rods, r constraints of their nodes, and n nodes.

    g is the number of states of self-stress less that of mechanisms: the degree of static indeterminacy where there
    are no mechanisms, which only the rank of the compatibility matrix tells.
    """

    rods: int
    constraints: int
    nodes: int

    @property
    def degree(self) -> int:
        """g."""
        return self.rods + self.constraints - 2 * self.nodes

    @property
    def numbers(self) -> str:
        """The right side of the formula with the numbers filled in, and its value."""
        return f"{self.rods} + {self.constraints} − 2·{self.nodes} = {self.degree}".replace("-", "−")

    def by_rank(self, static: int, mechanisms: int) -> str:
        """What the rank says beside it, "" where the rule tells it all: there are no mechanisms."""
        if not mechanisms:
            return ""
        stressed = f"{static or 'no'} self-stress{'es' * (static > 1)}"
        return f"{stressed}, {mechanisms} mechanism{'s' * (mechanisms > 1)}"


def counted(model: Model) -> Count:
    """The rods, constraints and nodes of a model; particles without rods are no nodes."""
    used = nodes(model)
    return Count(model.rods.count, int(model.particles.fixed[used].sum()), int(used.sum()))
