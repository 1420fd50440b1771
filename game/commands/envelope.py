"""`pinjoint run --static --envelope`: the least and the most in combinations of load cases, and in which they are."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from pinjoint.commands.analysis import Analysis
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED
from pinjoint.commands.output import Row, aligned, write_result
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.particle import AXES, supported
from pinjoint.components.settings import DIAGRAMS
from pinjoint.streams import tell

_BOUNDS = ("least", "most")
_UNITS = {"N": "kN", "V": "kN", "M": "kN·m"}
_PARTS = {"reaction": ("kN", "kN", "kN·m"), "displacement": ("m", "m", "rad")}


def answer(options: Namespace, model: Model, analysis: Analysis) -> int:
    """Write the envelope of a model; returns the exit status, 1 where a combination has no solution."""
    from pinjoint.systems.statics.envelope import Bounds, Envelope
    from pinjoint.systems.statics.events import NoEquilibrium
    from pinjoint.systems.statics.state import Start

    factors, permanent = analysis.load_factors or (1.0,), Start.present(model).permanent
    try:
        found = Envelope.of(model, (), analysis.theory, factors, permanent, options.path or ())
    except NoEquilibrium as reason:
        tell(str(reason))
        return NOT_ANSWERED

    def of_bounds(bounds: Bounds, at: Any) -> dict[str, Any]:
        made = {}
        for side, bound in enumerate(_BOUNDS):
            made[bound] = bounds.values[side][at]
            names = map(found.named, bounds.governing[side][at].tolist())
            made[f"{bound}_in"] = [name or None for name in names]
        return made

    def along(row: int, letter: str) -> dict[str, Any]:
        return {"distance": found.shares[letter][row] * found.length[row]} | of_bounds(
            found.forces[letter], row
        )

    rods, particles = (list(enumerate(table.names)) for table in (model.rods, model.particles))
    data = {
        "model": options.model,
        "theory": analysis.theory,
        "combinations": list(found.combinations),
        "without": dict(found.without),
        "extremes": {
            name: {letter: [one._asdict() for one in found.extremes(letter, row)] for letter in DIAGRAMS}
            for row, name in rods
        },
        "rods": {name: {letter: along(row, letter) for letter in DIAGRAMS} for row, name in rods},
        "particles": {
            name: {part: of_bounds(getattr(found, part), row) for part in _PARTS} for row, name in particles
        },
    }
    held = np.flatnonzero(supported(model).any(axis=1)).tolist()
    shown = [model.particles.names[row] for row in held]
    write_result(options, data, _rows, lambda data: _lines(data, shown, found.said))
    return NOT_ANSWERED if found.without else ANSWERED


def _rows(data: Mapping[str, Any]) -> Iterator[Row]:
    """Tidy rows, one number each; distance: from the start of the rod, m."""
    yield "element", "name", "quantity", "distance", "bound", "value", "unit", "combination"
    for name, forces in data["rods"].items():
        for letter, found in forces.items():
            for bound in _BOUNDS:
                places = zip(found["distance"], found[bound], found[f"{bound}_in"], strict=True)
                for distance, value, combination in places:
                    yield "rod", name, letter, distance, bound, value, _UNITS[letter], combination or ""
    for name, parts in data["particles"].items():
        for part, units in _PARTS.items():
            for bound in _BOUNDS:
                of_part = parts[part][bound], parts[part][f"{bound}_in"]
                for axis, unit, value, combination in zip(AXES, units, *of_part, strict=True):
                    yield "particle", name, f"{part}_{axis}", "", bound, value, unit, combination or ""


def _lines(data: Mapping[str, Any], supports: list[str], said: str) -> Iterator[str]:
    """The extremes of forces along rods, and of reactions, to read."""
    yield f"{data['model']}: {said}"
    for name, reason in data["without"].items():
        yield tr("{combination} has no solution: {reason}", combination=name, reason=reason)
    yield ""
    table: list[Row] = [("", "", tr("least"), "m", tr("in"), tr("most"), "m", tr("in"))]
    for name, forces in data["extremes"].items():
        for letter, (low, high) in forces.items():
            table.append((name, f"{letter} {_UNITS[letter]}", *low.values(), *high.values()))
    yield from aligned(table)
    yield ""
    table = [("", "", tr("least"), tr("in"), tr("most"), tr("in"))]
    for name in supports:
        for axis, unit, *cells in zip(
            AXES, _PARTS["reaction"], *data["particles"][name]["reaction"].values(), strict=True
        ):
            if cells[0] or cells[2]:
                table.append((name, f"{axis} {unit}", *("" if cell is None else cell for cell in cells)))
    yield from aligned(table)
