"""Influence lines by linear theory, which `pinjoint verify --influence` prints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pinjoint.commands.output import Row, aligned
from pinjoint.components.field import ENDS
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.particle import supported
from pinjoint.systems.statics.equations import AXES
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.theory import Indeterminacy, influence_line, mechanisms
from pinjoint.systems.statics.unknowns import MethodError, Unknown
from pinjoint.systems.statics.verify import QUANTITIES

NOTHING = 1e-12  # of the largest value beside it: round-off


def influence(model: Model, names: Sequence[str]) -> dict[str, Any]:
    """Influence lines by linear theory: the effect of 1 kN along x and y on each particle in turn.

    names: a rod "AB" (its axial force), where it bends "AB.start", "AB.end" (bending moments) or "AB.shear"; a constraint
    "A.y" or "A.rotation" (its reaction, kN per kN), or a free direction (its displacement, m per kN, by the unit-load
    method). Raises MethodError for other names, and NoEquilibrium for a mechanism.
    """
    if Indeterminacy.of(model).mechanisms:
        moving = describe_motion(model, mechanisms(model))
        raise NoEquilibrium(
            "mechanism",
            tr(
                "A mechanism has no influence lines: {moving} can move. Add rods or supports there.",
                moving=moving,
            ),
        )
    found = {}
    for name in names:
        quantity, row, axis = _influenced(model, name)
        field = influence_line(model, quantity, row, axis)[:, :2]
        cleared = np.where(np.abs(field) > NOTHING * np.abs(field).max(), field, 0.0)
        of = dict(zip(model.particles.names, cleared.tolist(), strict=True))
        found[name] = {"quantity": quantity, "unit": f"{QUANTITIES[quantity][1]}/kN", "of": of}
    return {"influence": found}


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


def rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """What `influence` found as rows, headings first: one for every particle of each line."""
    yield "of", "quantity", "unit", "particle", "along x", "along y"
    for name, line in found["influence"].items():
        yield from ((name, line["quantity"], line["unit"], at, *pair) for at, pair in line["of"].items())


def lines(found: Mapping[str, Any]) -> Iterator[str]:
    """The same as aligned tables to read."""
    for name, line in found["influence"].items():
        yield tr(
            "{quantity} of {name} in {unit}, for a force of 1 kN at",
            quantity=tr(QUANTITIES[line["quantity"]][2]),
            name=name,
            unit=line["unit"],
        )
        heads = tr("particle"), tr("along x"), tr("along y")
        yield from aligned([heads, *((particle, *pair) for particle, pair in line["of"].items())])
        yield ""
