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
from pinjoint.components.particle import supported
from pinjoint.components.settings import DIAGRAMS
from pinjoint.streams import tell

_BOUNDS = ("least", "most")
_UNITS = {"N": "kN", "V": "kN", "M": "kN·m"}
_PARTS = {"reaction": ("kN", "kN", "kN·m"), "displacement": ("m", "m", "rad")}
_AXES = ("x", "y", "rotation")


def answer(options: Namespace, model: Model, analysis: Analysis) -> int:
    """Write the envelope of a model; returns the exit status, 1 where a combination has no solution."""
    from pinjoint.systems.statics.envelope import Envelope
    from pinjoint.systems.statics.events import NoEquilibrium
    from pinjoint.systems.statics.state import Start

    factors, permanent = analysis.load_factors or (1.0,), Start.present(model).permanent
    try:
        found = (
            Envelope.under_moving_force(model, options.path)
            if options.path
            else Envelope.of(model, (), analysis.theory, factors, permanent)
        )
    except NoEquilibrium as reason:
        tell(str(reason))
        return NOT_ANSWERED

    def of_bounds(bounds: Any, at: Any) -> dict[str, Any]:
        made = {}
        for side, bound in enumerate(_BOUNDS):
            made[bound] = bounds.values[side][at]
            made[f"{bound}_in"] = [
                found.named(number) or None for number in bounds.governing[side][at].tolist()
            ]
        return made

    rods = {
        name: {
            letter: {
                "distance": found.shares[letter][row] * found.length[row],
                **of_bounds(found.forces[letter], row),
            }
            for letter in DIAGRAMS
        }
        for row, name in enumerate(model.rods.names)
    }
    particles = {
        name: {part: of_bounds(getattr(found, part), row) for part in _PARTS}
        for row, name in enumerate(model.particles.names)
    }
    extremes = {
        name: {letter: [one._asdict() for one in found.extremes(letter, row)] for letter in DIAGRAMS}
        for row, name in enumerate(model.rods.names)
    }
    data = {
        "model": options.model,
        "theory": analysis.theory,
        "combinations": list(found.combinations),
        "without": dict(found.without),
        "extremes": extremes,
        "rods": rods,
        "particles": particles,
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
                for axis, unit, value, combination in zip(
                    _AXES, units, parts[part][bound], parts[part][f"{bound}_in"], strict=True
                ):
                    yield "particle", name, f"{part}_{axis}", "", bound, value, unit, combination or ""


def _lines(data: Mapping[str, Any], supports: list[str], said: str) -> Iterator[str]:
    """The extremes of forces along rods, and of reactions, to read."""
    yield f"{data['model']}: {said}"
    for name, reason in data["without"].items():
        yield tr("{combination} has no solution: {reason}", combination=name, reason=reason)
    heads = [tr("least"), tr("in"), tr("most"), tr("in")]
    yield ""
    table: list[Row] = [("", "", heads[0], "m", heads[1], heads[2], "m", heads[3])]
    for name, forces in data["extremes"].items():
        for letter, (low, high) in forces.items():
            cells = [(one["value"], one["distance"], one["combination"]) for one in (low, high)]
            table.append((name, f"{letter} {_UNITS[letter]}", *cells[0], *cells[1]))
    yield from aligned(table)
    yield ""
    table = [("", "", *heads)]
    for name in supports:
        found = data["particles"][name]["reaction"]
        for place, (axis, unit) in enumerate(zip(_AXES, _PARTS["reaction"], strict=True)):
            if found["least"][place] or found["most"][place]:
                bounds = [
                    cell
                    for bound in _BOUNDS
                    for cell in (found[bound][place], found[f"{bound}_in"][place] or "")
                ]
                table.append((name, f"{axis} {unit}", *bounds))
    yield from aligned(table)
