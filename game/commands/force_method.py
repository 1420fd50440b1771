"""`pinjoint force-method`: static unknowns by the force method, with the table of virtual work and a report."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from pinjoint.commands.arguments import Parser, UsageError, flag, option
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED, model_of
from pinjoint.commands.output import Row, Rows, add_output, aligned, writable, write, write_result
from pinjoint.components.language import marked, tr
from pinjoint.components.view import CONVENTIONS, TEXTBOOK, THESIS
from pinjoint.methods import index, words
from pinjoint.methods.copies import exact_forces
from pinjoint.methods.tables import PRODUCTS, ForceTables, Tables
from pinjoint.streams import tell
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.unknowns import Unknown, redundants

MOST_SETS = 100  # unknowns; what each does to each, and to all rods, takes 100 MB for a thousand of them


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser("force-method", "Statically indeterminate structures by the force method, as in textbooks.")
    option(parser, "model", "a model file, or the name of a bundled model")
    which = parser.add_mutually_exclusive_group(required=True)
    option(
        which,
        "--release AC",
        "a bar, a reaction such as A.y or A.rotation, a moment such as AB.start; may be given several times",
        action="append",
    )
    flag(which, "--all", "release unknowns until the structure is statically determinate")
    option(
        parser,
        "--convention",
        "sign convention of the text; textbook: δ₁₀ + δ₁₁ X₁ = 0; thesis: p = (Δ − Δ₀) / Δ₁",
        choices=CONVENTIONS,
        default=CONVENTIONS[0],
    )
    flag(
        parser,
        "--sets",
        tr(
            "write what each unknown alone does, too, where there are more than {count} unknowns",
            count=MOST_SETS,
        ),
    )
    options = parsed(parser, words)
    model, names = model_of(options), dict.fromkeys(options.release or ())
    solution = solve(model, [Unknown.named(model, one) for one in names] if names else redundants(model))
    if options.report is not None and not solution.unknowns:
        raise UsageError(
            "{model} is statically determinate: there is nothing to release, and nothing to report. Equilibrium alone"
            " gives its forces: pinjoint run {model} --static.",
            model=options.model,
        )
    tables = ForceTables(model, solution)
    single, sets = options.release is not None and len(options.release) == 1, options.sets
    found = _data(tables, single=single, sets=sets or len(solution.unknowns) <= MOST_SETS)
    left_out = marked("The force method leaves out the laws of mods: {laws}.")
    return answer(options, tables, found, _rows, partial(_lines, tables, options.convention), left_out)


def parsed(parser: Parser, words: Sequence[str]) -> Namespace:
    """What the words ask for, with the options that methods have in common. Raises UsageError."""
    option(parser, "--report FILE.pdf", "write the whole solution to a PDF as well", writable)
    option(parser, "--set PATH=VALUE", "change the model first", action="append", default=[])
    add_output(parser, default="json")
    options: Namespace = parser.parse_args(words)
    if options.report is not None and not options.report.lower().endswith(".pdf"):
        raise UsageError("--report {file}: write a file that ends with .pdf.", file=options.report)
    return options


def answer(
    options: Namespace,
    tables: Tables,
    found: Mapping[str, Any],
    rows: Rows,
    lines: Callable[[Any], Iterable[str]],
    left_out: str,
) -> int:
    """Write a solution, and its report; returns the exit status. left_out: the sentence about laws that it leaves out."""
    laws = left_out_of_statics(tables.model)
    write_result(options, {**found, "left_out": laws}, rows, lines)
    if options.report is not None:
        from pinjoint.methods.report import report

        write(report(tables, getattr(options, "convention", TEXTBOOK)), options.report)
    if laws:
        tell(tr(left_out, laws=", ".join(laws)))
    return NOT_ANSWERED if laws else ANSWERED


def _data(tables: ForceTables, *, single: bool, sets: bool) -> dict[str, Any]:
    """The solution as plain data, in m, rad, kN, kN·m: displacements and unknowns in lists and matrices.

    single: there is one unknown, so that its numbers stand alone. virtual_work: of every rod, in the order of the sums.
    sets: with what each unknown alone does; else there are no matrices, and no virtual work.
    """
    solution = tables.solution
    found: dict[str, Any] = {
        "released": [unknown.name for unknown in solution.unknowns],
        "unit": [unknown.unit for unknown in solution.unknowns],
        "delta_real": solution.delta_real,
        "delta_base": solution.delta_base,
        "delta_unit": solution.delta_unit if sets else None,
        "force": solution.force,
        "exact_force": exact_forces(tables.model, solution.unknowns),
        "gap": solution.gap,
        "flexibility": solution.flexibility if sets else None,
        "prescribed": solution.prescribed,
    }
    if single:
        found = {key: None if values is None else values[0] for key, values in found.items()}
        found |= {"delta_unit": solution.delta_unit[0, 0], "flexibility": solution.flexibility[0, 0]}
    forces = solution.superposed.axial_force.tolist()
    return found | {
        "virtual_work": _work(tables) if sets else {},
        "axial_force": dict(zip(tables.model.rods.names, forces, strict=True)),
    }


def _work(tables: ForceTables) -> dict[str, Any]:
    """By rod: what the sums of virtual work are made of; n, m and terms of each unknown in the order of `released`."""
    axial, bending = tables.solution.work.axial, tables.solution.work.bending
    found = dict[str, Any]()
    count = len(tables.solution.unknowns)
    rods = tables.model.rods
    base = tables.solution.base
    for row, name in enumerate(rods.names):
        found[name] = {
            "length": rods.rest_length[row],
            "stiffness": rods.stiffness[row],
            "N0": base.axial_force[row],
            "n": axial.unit[:, row, 0],
            "N0 n L/EA": axial.of_load[:, row],
            "without force": axial.of_free[:, row] + bending.of_free[:, row],
        }
        if tables.bends:
            found[name] |= {
                "bending_stiffness": rods.bending_stiffness[row],
                "M0": base.bending_moment[row],
                "m": bending.unit[:, row],
                "M0 m/EI": bending.of_load[:, row],
            }
    if 0 < count <= PRODUCTS:
        for title, sums in (("n n L/EA", axial), ("m m/EI", bending))[: 1 + tables.bends]:
            terms = np.array([[sums.of_units(i, j) for j in range(count)] for i in range(count)])
            for row, of_rod in enumerate(found.values()):
                of_rod[title] = terms[:, :, row]
    return found


def _rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """The result as rows, one per unknown, headings first."""
    if not isinstance(found["released"], list):
        found = {key: [value] for key, value in found.items()} | {"delta_unit": [[found["delta_unit"]]]}
    names = found["released"]
    exact = found["exact_force"] or [None] * len(names)
    moments = "kN·m" in found["unit"]
    length, force = ("m, rad", "kN, kN·m") if moments else ("m", "kN")
    rows = found["delta_unit"] or [[]] * len(names)  # none were asked for
    per = f"{length}/{'(kN, kN·m)' if moments else 'kN'}"
    unit = [f"delta_unit {name} ({per})" for name in names if found["delta_unit"]]
    yield (
        "released",
        f"delta_real ({length})",
        f"delta_base ({length})",
        *unit,
        f"force ({force})",
        f"exact_force ({force})",
    )
    parts = (names, found["delta_real"], found["delta_base"], rows, found["force"], exact)
    for name, real, base, row, force, exactly in zip(*parts, strict=True):
        yield name, real, base, *row, force, exactly


def _lines(tables: ForceTables, convention: str, found: Mapping[str, Any]) -> Iterator[str]:
    """The solution to read: in the textbook's convention with its tables, in the thesis' with its displacements."""
    solution = tables.solution
    yield from aligned(_rows(found))
    if not solution.unknowns or convention == THESIS:
        return
    if not found["virtual_work"]:
        yield ""
        yield tr("What each unknown alone does is left out, for there are many; --sets writes it.")
        yield from forces(tables)
        return
    yield ""
    for i, unknown in enumerate(solution.unknowns):
        yield f"X{index(i + 1)}: {words.meaning(unknown)}"
    every = range(len(solution.unknowns))
    works = [tables.bending(every)] if tables.bends else []
    works.append(tables.virtual_work(every))
    parts = [*(works if len(every) <= PRODUCTS else [tables.forces(every)]), tables.settlements()]
    yield ""
    yield ",  ".join(words.formulas(tables.bends, "₁" if len(every) == 1 else "ᵢ"))
    for table in parts:
        if table:
            yield ""
            yield from aligned(table[:])
    yield ""
    yield from words.equations(tables)
    yield from forces(tables)


def forces(tables: Tables) -> Iterator[str]:
    """The forces and reactions of the structure, N₀ + Σ X n."""
    for table in (tables.axial_forces(), tables.moments() if tables.bends else None, tables.reactions()):
        if table:
            yield ""
            yield from aligned(table[:])
