"""Second order: by how much, and where, exact theory differs from first order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Array
from pinjoint.components.bent import farthest
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, nodes
from pinjoint.components.wording import as_said, cut
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.state import StaticState

LEAST = 0.005  # of the largest value of a kind: a smaller difference is not worth a word


@dataclass(frozen=True)
class SecondOrder:
    """The largest difference, as a share of the largest first-order value of its kind (forces, moments, displacements).

    share: > 0 where the exact value is larger. quantity: a column. place: the name of a joint, or of the rod it is in.
    """

    share: float
    quantity: str
    place: str

    @classmethod
    def of(cls, model: Model, first: StaticState, exact: StaticState) -> SecondOrder | None:
        """That of two equilibria under the same load, one of which the model shows; None where it is less than LEAST."""
        by_theory = first.diagrams, exact.diagrams
        force = max(largest(first.diagrams[name]) for name in ("end_axial_force", "shear"))
        moved = [np.hypot(*state.displacement.T) * nodes(model) for state in (first, exact)]
        along = farthest(model, np.flatnonzero(model.rods.bending_stiffness > 0.0))[0]
        inside = [np.abs(of["largest_moment"][:, 0]) for of in by_theory]
        compared: dict[str, tuple[list[Array], float]] = {
            "displacement": (moved, max(largest(moved[0]), largest(along))),
            "end_axial_force": ([of["end_axial_force"] for of in by_theory], force),
            "shear": ([of["shear"] for of in by_theory], force),
            "bending_moment": ([of["bending_moment"] for of in by_theory], largest(inside[0])),
            "largest_moment": (inside, largest(inside[0])),
        }
        found = None
        for quantity, ((before, after), scale) in compared.items():
            size = np.abs(after - before) / (scale or np.inf)
            if not size.size or size.max() <= (abs(found.share) if found else LEAST):
                continue
            place = np.unravel_index(int(size.argmax()), size.shape)
            share = float(np.copysign(size[place], abs(after[place]) - abs(before[place])))
            found = cls(share, quantity, _name(model, quantity, *map(int, place)))
        return found

    @property
    def said(self) -> str:
        """In words, as "second order: +16 % at B"."""
        percent = written.number(100.0 * abs(self.share), 2 if abs(self.share) < 1.0 else 3)
        return tr(
            "second order: {percent} % at {place}",
            percent=("+" if self.share > 0.0 else "−") + percent,
            place=cut(self.place),
        )


def _name(model: Model, quantity: str, row: int, end: int | None = None) -> str:
    if quantity == "largest_moment":
        return as_said(Rod.noun, model.rods.names[row])
    return as_said(
        Particle.noun, model.particles.names[row if end is None else int(model.rods.between[row, end])]
    )
