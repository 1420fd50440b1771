"""Influence lines by linear theory, which `pinjoint verify --influence` prints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pinjoint.commands.output import Row, aligned, as_written
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.documents.influence import Influence
from pinjoint.systems.statics.verify import QUANTITIES

NOTHING = 1e-12  # of the largest value beside it: round-off


def influence(model: Model, names: Sequence[str], path: Sequence[str] = ()) -> dict[str, Any]:
    """Influence lines by linear theory: the effect of 1 kN along x and y on each particle in turn.

    names: a rod "AB" (its axial force), where it bends "AB.start", "AB.end" (bending moments) or "AB.shear", and within it
    "AB.M@1.5" or "AB.V@50%"; a constraint "A.y" or "A.rotation" (its reaction, kN per kN), or a free direction (its
    displacement, m per kN, by the unit-load method). downwards: the least and the most that one force down does, wherever
    on a rod of the path it stands, x from its
    start (m). Raises MethodError for other names, and NoEquilibrium for a mechanism.
    """
    found = {}
    for line in Influence.of(model, *names):
        field = line.field[:, :2]
        cleared = np.where(np.abs(field) > NOTHING * np.abs(field).max(), field, 0.0)
        found[line.name] = {
            "quantity": line.quantity,
            "unit": line.unit,
            "of": dict(zip(model.particles.names, cleared.tolist(), strict=True)),
            "downwards": {
                key: dict(zip(("value", "rod", "x"), of, strict=True)) for key, of in line.extremes(model, path)
            },
        }
    return {"influence": found}


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
        for of in line["downwards"].values():
            yield tr(
                "{value} where 1 kN acts downwards on {rod} at x = {x} m",
                **{k: as_written(v) for k, v in of.items()},
            )
        yield ""
