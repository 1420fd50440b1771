"""Influence lines: what one force that moves over a structure does to a force or a displacement, and their picture.

By Müller-Breslau the line of a force is how the structure deflects when it is cut where the force is, and both faces are
moved apart by 1: along the force, or against each other by a unit angle. Between joints members bend by cubics, so that the
line is exact there, too, wherever on a member the moving force stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pinjoint.components import written
from pinjoint.components.bent import Axes, Parts
from pinjoint.components.field import ENDS, Column
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import supported
from pinjoint.components.rod import Rod, bends
from pinjoint.components.spans import Curves, extremes
from pinjoint.components.view import Shape
from pinjoint.documents.shapes import NoShape, drawn_share
from pinjoint.systems.statics.equations import AXES
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.theory import Indeterminacy, influence_line, mechanisms
from pinjoint.systems.statics.unknowns import MethodError, Unknown
from pinjoint.systems.statics.verify import QUANTITIES


@dataclass(frozen=True)
class Influence:
    """The line of a quantity of a row, by axis or end. field: what a unit force on each particle does, (n, 2 or 3).

    The shear force is that at the end of the rod.
    """

    name: str
    quantity: str
    row: int
    axis: int
    field: Column

    @classmethod
    def of(cls, model: Model, name: str) -> Influence:
        """That of what a name means; see `pinjoint verify --influence`. Raises MethodError; NoEquilibrium for mechanisms."""
        if Indeterminacy.of(model).mechanisms:
            moving = describe_motion(model, mechanisms(model))
            raise NoEquilibrium(
                "mechanism",
                tr(
                    "A mechanism has no influence lines: {moving} can move. Add rods or supports there.",
                    moving=moving,
                ),
            )
        if not model.rods.count:
            raise MethodError("There are no rods, over which a force could move; draw some.")
        quantity, row, axis = _influenced(model, name)
        return cls(name, quantity, row, axis, influence_line(model, quantity, row, axis))

    @property
    def unit(self) -> str:
        """Of its values, for a moving force."""
        return f"{QUANTITIES[self.quantity][1]}/kN"

    def _moved(self, model: Model) -> tuple[Parts, Column]:
        """The rods, and how far their ends move (m) and turn (rad), (n, 3); where a rod is cut, one has left its joint."""
        parts, field = Parts.of(model), self.field
        if field.shape[1] < 3:
            field = np.column_stack([field, np.zeros(len(field))])
        if self.quantity not in ("axial_force", "shear", "bending_moment"):
            return parts, field
        end = self.axis if self.quantity == "bending_moment" else 1
        axis = model.rods.difference[self.row] / model.rods.original_length[self.row]
        apart = {
            "axial_force": [-axis[0], -axis[1], 0.0],
            "shear": [-axis[1], axis[0], 0.0],
            "bending_moment": [0.0, 0.0, (1.0, -1.0)[end]],
        }
        joint, between = parts.between[self.row, end], parts.between.copy()
        between[self.row, end] = len(field)
        position = np.vstack([parts.position, parts.position[joint]])
        return Parts(position, between, parts.fixity), np.vstack([field, field[joint] + apart[self.quantity]])

    def along(self, model: Model) -> Column:
        """What a unit force downwards does on every rod, as polynomials of the share of its length, (rods, 5)."""
        parts, moved = self._moved(model)
        axes = Axes.moved(parts, parts.position + moved[:, :2], moved[:, :2], moved[:, 2])
        lines = -axes.left[:, 1:] * axes.bow.polynomials
        start, end = moved[parts.between, 1].T
        lines[:, 0] -= start
        lines[:, 1] -= end - start
        return lines

    def extremes(
        self, model: Model, path: Sequence[str] = ()
    ) -> Iterator[tuple[str, tuple[float, str, float]]]:
        """The least and the most that one unit force downwards does on a path of rods, by their names, or on all.

        Each is a value, the rod where it is, and how far from its start (m).
        """
        rows = np.array([model.rods[name].row for name in path] or range(model.rods.count), dtype=np.intp)
        found, shares = extremes(Curves.plain(self.along(model)[rows]).stretches)
        found = np.where(np.abs(found) > written.ROUNDING * np.abs(found).max(), found, 0.0)
        for key, which, row in (
            ("least", 0, int(found[:, 0].argmin())),
            ("most", 1, int(found[:, 1].argmax())),
        ):
            x = float(shares[row, which] * model.rods.original_length[rows[row]])
            yield key, (float(found[row, which]), model.rods.names[rows[row]], x)

    def shape(self, model: Model) -> Shape:
        """The line drawn over the model, below it where a force downwards makes the quantity greater."""
        parts, moved = self._moved(model)
        least, most = (
            f"{written.number(value)} ({rod}, x = {written.number(x)} m)"
            for _, (value, rod, x) in self.extremes(model)
        )
        title = tr(
            "Influence line: {quantity} for 1 kN downwards, from {least} to {most} {unit}",
            quantity=self._said(model),
            least=least,
            most=most,
            unit=QUANTITIES[self.quantity][1],
        )
        drawn = drawn_share(model) / max(float(np.abs(moved[:, :2]).max()), 1e-300) * moved
        return Shape(title, drawn[:, :2], None, drawn[:, 2] if bends(model) else None, "", parts, swings=False)

    def _said(self, model: Model) -> str:
        """The quantity as a person calls it: "bending moment at the start of AB", "reaction y of A"."""
        table, _, title = QUANTITIES[self.quantity]
        of = model.tables[table].names[self.row]
        if self.quantity == "bending_moment":
            return tr("{quantity} at the {end} of {rod}", quantity=tr(title), end=tr(ENDS[self.axis]), rod=of)
        along = self.quantity in ("reaction", "displacement")
        quantity = joined([tr(title), AXES[self.axis] if along else ""])
        return tr("{quantity} of {element}", quantity=quantity, element=of)


def lines_of(model: Model, element: Handle) -> list[Shape]:
    """The lines of all quantities of a rod or particle, without those that are nothing everywhere. Raises NoShape."""
    if isinstance(element, Rod):
        rigid = (model.rods.turning_shares[element.row] > 0.0).tolist()
        names = [f"{element.name}.{end}" for end, stiff in zip(ENDS, rigid, strict=True) if stiff]
        names += [*[f"{element.name}.shear"] * any(rigid), element.name]
    else:
        name = model.particles.names[element.row]
        turns = bends(model) and model.particles.inertia[element.row] > 0.0
        names = [f"{name}.{axis}" for axis in AXES[: 2 + turns]]
    try:
        lines = [Influence.of(model, name) for name in names]
        some = [line for line in lines if np.abs(line.along(model)).max() > written.ROUNDING]
        return [line.shape(model) for line in some or lines]
    except (MethodError, NoEquilibrium) as reason:
        raise NoShape(str(reason)) from None


def _influenced(model: Model, name: str) -> tuple[str, int, int]:
    """The quantity, row and axis (or end of a rod) that a name means. Raises MethodError."""
    place, _, what = name.rpartition(".")
    if name in model.rods:
        return "axial_force", model.rods[name].row, 0
    if place in model.rods and what in (*ENDS, "shear"):
        row = model.rods[place].row
        rigid = (model.rods.turning_shares[row] > 0.0).tolist()
        if not any(rigid):
            raise MethodError(
                "{rod} does not bend, so it has no bending moments and no shear force.", rod=place
            )
        if what == "shear":
            return "shear", row, 0
        if not rigid[ENDS.index(what)]:
            raise MethodError("{end} is hinged, so there is no bending moment.", end=name)
        return "bending_moment", row, ENDS.index(what)
    if place in model.particles and what in AXES:
        row, axis = model.particles[place].row, AXES.index(what)
        if axis == 2 and model.particles.inertia[row] == 0.0:
            raise MethodError(
                "{particle} has no rotation, because no rod that bends is rigidly joined to it; choose another one.",
                particle=place,
            )
        held = supported(model)[row, axis]
        kinds = ("reaction", "reaction_moment") if held else ("displacement", "rotation")
        return kinds[axis == 2], row, axis
    return "axial_force", Unknown.named(model, name).element.row, 0
