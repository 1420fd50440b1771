"""`pinjoint force-method`: hyperstatic forces by the force method."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from components.model import Model
from game.commands.arguments import Parser, UsageError
from game.commands.options import ANSWERED, NOT_ANSWERED, session_of
from game.commands.output import Row, add_output, write_result
from game.streams import tell


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(prog="pinjoint force-method", description="Hyperstatic forces by the force method.")
    parser.add_argument("model", help="a model file, or the name of a bundled model")
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--release", metavar="AC", help="a rod, or a constraint such as A.y")
    which.add_argument("--all", action="store_true", help="release unknowns until the structure is isostatic")
    parser.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", help="change the model first"
    )
    add_output(parser, default="json")
    options = parser.parse_args(words)
    session = session_of(options)
    from systems.statics.unknowns import ForceMethodError

    try:
        found = _solved(session.model, None if options.all else options.release)
    except ForceMethodError as error:
        raise UsageError(str(error)) from None
    laws = session.schedule.left_out_of_statics(session.model)
    write_result(options, found | {"left_out": laws}, _rows)
    if laws:
        tell(f"The force method leaves out the laws of mods: {', '.join(laws)}.")
    return NOT_ANSWERED if laws else ANSWERED


def _solved(model: Model, release: str | None) -> dict[str, Any]:
    """Displacements (m, m/kN), hyperstatic forces and their exact values (kN).

    release: "AC" or "A.y"; None: unknowns whose release leaves an isostatic structure, in lists and a matrix.
    Raises ForceMethodError.
    """
    from game.force_method.guide import exact_forces
    from systems.statics.force_method import solve
    from systems.statics.unknowns import find_unknown, redundants

    unknowns = redundants(model) if release is None else [find_unknown(model, release)]
    solution = solve(model, unknowns)
    exact = exact_forces(model, unknowns)
    found: dict[str, Any] = {
        "released": [unknown.name for unknown in unknowns],
        "delta_real": solution.delta_real,
        "delta_base": solution.delta_base,
        "delta_unit": solution.delta_unit,
        "force": solution.force,
        "exact_force": exact,
    }
    if release is None:
        return found
    first = {key: None if values is None else values[0] for key, values in found.items()}
    return first | {"delta_unit": solution.delta_unit[0, 0]}


def _rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """The result as rows, one per unknown, headings first."""
    if not isinstance(found["released"], list):
        found = {key: [value] for key, value in found.items()} | {"delta_unit": [[found["delta_unit"]]]}
    names = found["released"]
    exact = found["exact_force"] or [None] * len(names)
    unit = [f"delta_unit {name} (m/kN)" for name in names]
    yield "released", "delta_real (m)", "delta_base (m)", *unit, "force (kN)", "exact_force (kN)"
    parts = (names, found["delta_real"], found["delta_base"], found["delta_unit"], found["force"], exact)
    for name, real, base, row, force, exactly in zip(*parts, strict=True):
        yield name, real, base, *row, force, exactly
