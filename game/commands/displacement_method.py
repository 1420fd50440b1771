"""`pinjoint displacement-method`: displacements of joints by the displacement method, K Δ = F, entry by entry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from pinjoint.commands.arguments import Parser, option
from pinjoint.commands.force_method import answer, forces, parsed
from pinjoint.commands.options import model_of
from pinjoint.commands.output import aligned
from pinjoint.components.language import marked, tr
from pinjoint.components.particle import AXES
from pinjoint.methods import displacement_words
from pinjoint.methods.displacements import DisplacementTables
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.displacement_method import solve


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser("displacement-method", "Trusses and frames by the displacement method, as in textbooks.")
    option(parser, "model", "a model file, or the name of a bundled model")
    options = parsed(parser, words)
    model = model_of(options)
    tables = DisplacementTables(model, solve(model))
    left_out = marked("The displacement method leaves out the laws of mods: {laws}.")
    return answer(
        options, tables, _data(tables), lambda _: tables.system().rows(), partial(_lines, tables), left_out
    )


def _data(tables: DisplacementTables) -> dict[str, Any]:
    """The solution as plain data, in m, rad, kN, kN·m.

    members: by rod, over the directions of both its ends, its stiffness and the fixed-end forces on it. force_method: the
    number of that method's equations.
    """
    solution, rods = tables.solution, tables.model.rods
    particles, width = tables.model.particles.names, solution.members.shape[1] // 2
    return {
        "unknowns": [unknown.name for unknown in solution.unknowns],
        "unit": ["rad" if unknown.is_moment else "m" for unknown in solution.unknowns],
        "stiffness": solution.stiffness,
        "load": solution.load,
        "displacement": solution.displacement,
        "unbalanced": tables.unbalanced,
        "force_method": Count.of(tables.model).degree,
        "members": {
            name: {
                "directions": [f"{particles[end]}.{axis}" for end in ends for axis in AXES[:width]],
                "stiffness": matrix,
                "fixed_end_forces": fast,
            }
            for name, ends, matrix, fast in zip(
                rods.names, rods.between.tolist(), solution.members, tables.fixed_end_forces, strict=True
            )
        },
        "axial_force": dict(zip(rods.names, solution.superposed.axial_force.tolist(), strict=True)),
        "bending_moment": dict(zip(rods.names, solution.superposed.bending_moment.tolist(), strict=True)),
    }


def _lines(tables: DisplacementTables, found: Mapping[str, Any]) -> Iterator[str]:
    """The solution to read: the unknowns, the stiffness of members, F and K member by member, and the forces."""
    every = range(len(found["unknowns"]))
    yield from displacement_words.degree_of(len(every), Count.of(tables.model))
    for table in (tables.coefficients(), *map(tables.column, (len(every), *every)), tables.system()):
        yield ""
        yield from aligned(table[:])
    yield ""
    yield tr(
        "Equilibrium of all joints: what is left to hold them is {force} kN.", force=str(found["unbalanced"])
    )
    yield from forces(tables)
