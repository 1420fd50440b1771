"""Influence lines: what one force that moves over a structure does to a force or a displacement, and their picture.

By Müller-Breslau the line of a force is how the structure deflects when it is cut where the force is, and both faces are
moved apart by 1: along the force, or against each other by a unit angle. Between joints members bend by cubics, so that the
line is exact there, too, wherever on a member the moving force stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import DecimalException

import numpy as np

from pinjoint.components import written
from pinjoint.components.bent import Axes, Parts
from pinjoint.components.field import ENDS, Column, FieldError
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import AXES, supported
from pinjoint.components.rod import Rod, bends
from pinjoint.components.spans import Curves, extremes
from pinjoint.components.units import inside
from pinjoint.components.view import Shape
from pinjoint.components.wording import quoted
from pinjoint.documents.shapes import NoShape, drawn_share
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.theory import FirstOrder, Indeterminacy, influence_line, mechanisms
from pinjoint.systems.statics.unknowns import MethodError, Unknown
from pinjoint.systems.statics.verify import QUANTITIES

# In rods, and how names of places in them call these.
FORCES = {"axial_force": "N", "bending_moment": "M", "shear": "V"}
MOST = 60  # values along a line


@dataclass(frozen=True)
class Influence:
    """The line of a quantity of a row, by axis. field: what a unit force on each particle does, (n, 2 or 3).

    share: of a force in a rod, where that is, of its length from its start.
    """

    name: str
    quantity: str
    row: int
    axis: int
    share: float
    field: Column

    @classmethod
    def of(cls, model: Model, *names: str) -> list[Influence]:
        """Those of what names mean; see `pinjoint verify --influence`. Raises MethodError; NoEquilibrium for mechanisms."""
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
        theory, wanted = FirstOrder.of(model), [_influenced(model, name) for name in names]
        return [cls(name, *of, influence_line(theory, *of)) for name, of in zip(names, wanted, strict=True)]

    @property
    def unit(self) -> str:
        """Of its values, for a moving force."""
        return f"{QUANTITIES[self.quantity][1]}/kN"

    def _cut(self, model: Model) -> tuple[Parts, Column, Column]:
        """The rods, and how far their ends move (m) and turn (rad), (n + 2, 3).

        Two of a rod that is cut have left its joints. Also by how much both faces of the cut are moved apart, (2,).
        """
        parts, field = Parts.of(model), self.field
        if field.shape[1] < 3:
            field = np.column_stack([field, np.zeros(len(field))])
        if self.quantity not in FORCES:
            return parts, field, np.zeros(2)
        x, y = model.rods.difference[self.row] / model.rods.original_length[self.row]
        apart = np.array(
            {"axial_force": (-x, -y), "shear": (-y, x), "bending_moment": (0.0, 0.0)}[self.quantity]
        )
        turned = (1.0 - self.share, -self.share) if self.quantity == "bending_moment" else (0.0, 0.0)
        joints, between = parts.between[self.row], parts.between.copy()
        between[self.row] = len(field) + np.arange(2)
        more = field[joints] + np.array([[0.0, 0.0, turned[0]], [*apart, turned[1]]])
        position = np.vstack([parts.position, parts.position[joints]])
        return Parts(position, between, parts.fixity), np.vstack([field, more]), apart

    def along(self, model: Model) -> Curves:
        """What a unit force downwards does on every rod, by shares of its length.

        The line of a rod that is cut at its end has a jump or a kink where it is cut; beside it that of a simple beam.
        """
        parts, moved, apart = self._cut(model)
        lines = _downwards(parts, moved)[1]
        if self.quantity not in FORCES:
            return Curves.plain(lines)
        power, size = 0, float(apart[1])
        if self.quantity == "bending_moment":
            power, size = 1, -float(model.rods.difference[self.row, 0])
            lines[self.row, 1] -= size * (1.0 - self.share)
        kink = (np.array([value]) for value in (self.row, self.share, power, size))
        return Curves(lines, *kink)

    def extremes(
        self, model: Model, path: Sequence[str] = ()
    ) -> Iterator[tuple[str, tuple[float, str, float]]]:
        """The least and the most that one unit force downwards does on a path of rods, by their names, or on all.

        Each is a value, the rod where it is, and how far from its start (m).
        """
        rows = np.array([model.rods[name].row for name in path] or range(model.rods.count), dtype=np.intp)
        found, shares = extremes(self.along(model).some(rows).stretches)
        found = np.where(np.abs(found) > written.ROUNDING * np.abs(found).max(), found, 0.0)
        for key, which, row in (
            ("least", 0, int(found[:, 0].argmin())),
            ("most", 1, int(found[:, 1].argmax())),
        ):
            x = float(shares[row, which] * model.rods.original_length[rows[row]])
            yield key, (float(found[row, which]), model.rods.names[rows[row]], x)

    def shape(self, model: Model) -> Shape:
        """The line drawn over the model, below it where a force downwards makes the quantity greater, with its values."""
        least, most = (
            f"{written.number(value)} ({model.rods[rod].said}, x = {written.length(x, written.DIGITS)})"
            for _, (value, rod, x) in self.extremes(model)
        )
        title = tr(
            "Influence line: {quantity} for 1 kN downwards, from {least} to {most} {unit}",
            quantity=self._said(model),
            least=least,
            most=most,
            unit=QUANTITIES[self.quantity][1],
        )
        parts, moved = self._drawn(model)
        drawn = _enlarged(model, moved) * moved
        turned = drawn[:, 2] if bends(model) else None
        return Shape(title, drawn[:, :2], None, turned, "", parts, False, _told(model, parts, moved))

    def _drawn(self, model: Model) -> tuple[Parts, Column]:
        """The rods, of which one that is cut inside is two, and how far their ends move and turn."""
        parts, moved, apart = self._cut(model)
        if self.quantity not in FORCES or not 0.0 < self.share < 1.0:
            return parts, moved
        axes, share = Axes.moved(parts, parts.position + moved[:, :2], moved[:, :2], moved[:, 2]), self.share
        length, left = model.rods.original_length[self.row], axes.left[self.row]
        bent = self.quantity == "bending_moment"
        bow = axes.bow.some(np.array([self.row]))
        first, second = moved[parts.between[self.row]]
        turned = float((second - first)[:2] @ left) / length + bow.derivative.at([0.0, share, 1.0])[0] / length
        kink = np.array([share - 1.0, share]) if bent else np.zeros(2)  # how much its parts turn
        middle = first + share * (second - first)
        middle[:2] += (float(bow.at([share])[0, 0]) + length * share * kink[0]) * left
        faces = [[*middle[:2], turned[1] + kink[0]], [*middle[:2] - apart, turned[1] + kink[1]]]
        ends = [[*first[:2], turned[0] + kink[0]], [*(second[:2] - apart), turned[2] + kink[1]]]
        moved[parts.between[self.row]] = ends
        at = parts.position[parts.between[self.row]]
        position = np.vstack([parts.position, np.repeat([at[0] + share * (at[1] - at[0])], 2, axis=0)])
        count, (start, end) = len(moved), parts.between[self.row]
        between = np.vstack([parts.between, [count + 1, end]])
        between[self.row] = start, count
        fixity = np.vstack([parts.fixity, [1.0, 1.0]])
        fixity[self.row] = 1.0
        return Parts(position, between, fixity), np.vstack([moved, faces])

    def _said(self, model: Model) -> str:
        """The quantity as a person calls it: "bending moment at the start of AB", "reaction y of A"."""
        table, _, title = QUANTITIES[self.quantity]
        of = model.tables[table][self.row].said
        if self.quantity in FORCES and 0.0 < self.share < 1.0:
            x = written.length(self.share * model.rods.original_length[self.row], written.DIGITS)
            return tr("{quantity} of {rod} at {place} from its start", quantity=tr(title), rod=of, place=x)
        if self.quantity == "bending_moment":
            return tr(
                "{quantity} at the {end} of {rod}", quantity=tr(title), end=tr(ENDS[round(self.share)]), rod=of
            )
        along = self.quantity in ("reaction", "displacement")
        quantity = joined([tr(title), AXES[self.axis] if along else ""])
        return tr("{quantity} of {element}", quantity=quantity, element=of)


def _enlarged(model: Model, moved: Column) -> float:
    """By how much displacements are drawn larger."""
    return drawn_share(model) / max(float(np.abs(moved[:, :2]).max()), 1e-300)


def _downwards(parts: Parts, moved: Column) -> tuple[Axes, Column]:
    """The axes of rods whose ends move and turn so far, (n, 3), and how far they move down, as polynomials (rods, 4)."""
    axes = Axes.moved(parts, parts.position + moved[:, :2], moved[:, :2], moved[:, 2])
    lines = -axes.left[:, 1:] * axes.bow.polynomials
    start, end = moved[parts.between, 1].T
    lines[:, 0] -= start
    lines[:, 1] -= end - start
    return axes, lines


def _told(model: Model, parts: Parts, moved: Column) -> tuple[tuple[str, Column, Column], ...]:
    """Values of a line, each with its place (m) and how far it is drawn from there (m): at joints, cuts and extremes."""
    axes, lines = _downwards(parts, moved)
    found, shares = extremes(Curves.plain(lines).stretches)
    rods, share = np.repeat(np.arange(len(found)), 2), shares.reshape(-1, 1)
    start, end = parts.position[parts.between[rods].T]
    nodes = np.unique(parts.between)
    places = np.concatenate([start + share * (end - start), parts.position[nodes]])
    away = (
        np.concatenate([axes.some(rods).points(share)[:, 0], (parts.position + moved[:, :2])[nodes]]) - places
    )
    least = written.ROUNDING * float(np.abs(away[:, 1]).max())
    _, first = np.unique(np.round(np.column_stack([places, away[:, 1]]), 9), axis=0, return_index=True)
    some = [k for k in first[np.argsort(-np.abs(away[first, 1]))][:MOST].tolist() if abs(away[k, 1]) > least]
    scale = _enlarged(model, moved)
    return tuple((written.number(-away[k, 1]), places[k], scale * away[k]) for k in some)


def lines_of(model: Model, element: Handle, place: float | None = None) -> list[Shape]:
    """The lines of all quantities of a rod or particle, without those that are nothing everywhere. Raises NoShape.

    place: of forces so far from the start of a rod (m); None: at its ends and, of moments, in its middle.
    """
    name = model.tables[element.table].names[element.row]
    if isinstance(element, Rod):
        rigid = (model.rods.turning_shares[element.row] > 0.0).tolist()
        names = [f"{name}.{end}" for end, stiff in zip(ENDS, rigid, strict=True) if stiff]
        names = [*[f"{name}.M@50%"] * any(rigid), *names, *[f"{name}.shear"] * any(rigid), name]
        if place is not None:
            names = [f"{name}.{letter}@{place!r}" for letter in ("M", "V", "N")[0 if any(rigid) else 2 :]]
    else:
        turns = bends(model) and model.particles.inertia[element.row] > 0.0
        names = [f"{name}.{axis}" for axis in AXES[: 2 + turns]]
    try:
        lines = Influence.of(model, *names)
        some = [line for line in lines if line.along(model).most.max() > written.ROUNDING]
        return [line.shape(model) for line in some or lines]
    except (MethodError, NoEquilibrium) as reason:
        raise NoShape(str(reason)) from None


def _influenced(model: Model, name: str) -> tuple[str, int, int, float]:
    """The quantity, row, axis of a particle and share of a rod that a name means. Raises MethodError."""
    place, _, what = name.rpartition(".")
    if name in model.rods:
        return "axial_force", model.rods[name].row, 0, 1.0
    cut, _, where = name.rpartition("@")
    rod, _, letter = cut.rpartition(".")
    if rod in model.rods and letter in FORCES.values():
        [quantity] = [quantity for quantity, of in FORCES.items() if of == letter]
        place, share = rod, _share(model, rod, where)
    elif place in model.rods and what in (*ENDS, "shear"):
        quantity = "shear" if what == "shear" else "bending_moment"
        share = float(what != ENDS[0])
    else:
        return *_of_particle(model, name, place, what), 0.0
    row = model.rods[place].row
    rigid = (model.rods.turning_shares[row] > 0.0).tolist()
    if quantity != "axial_force" and not any(rigid):
        raise MethodError("{rod} does not bend, so it has no bending moments and no shear force.", rod=place)
    if quantity == "bending_moment" and share in (0.0, 1.0) and not rigid[round(share)]:
        raise MethodError("{end} is hinged, so there is no bending moment.", end=name)
    return quantity, row, 0, share


def _share(model: Model, rod: str, text: str) -> float:
    """The share of the length of a rod that a place means: metres from its start, another length, or per cent."""
    length = float(model.rods[rod].original_length)
    try:
        share = float(inside(text, "1")) if text.endswith("%") else float(inside(text, "m")) / length
    except (DecimalException, FieldError):
        share = -1.0
    if not 0.0 <= share <= 1.0:
        raise MethodError(
            "{place} is no place on {rod}, which is {length} m long; write metres from its start, or per cent: {rod}.M@50%.",
            place=quoted(text),
            rod=rod,
            length=written.given(length),
        )
    return share


def _of_particle(model: Model, name: str, place: str, what: str) -> tuple[str, int, int]:
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
