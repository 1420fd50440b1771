"""`pinjoint verify`: simulation, linear and exact theory side by side; influence lines."""

from __future__ import annotations

from collections.abc import Sequence

from pinjoint.commands import comparison, influence
from pinjoint.commands.arguments import Parser, UsageError, flag, option, positive
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED, add_model, add_steps, headless_of
from pinjoint.commands.output import add_output, write_result
from pinjoint.systems.statics.events import NoEquilibrium


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "verify",
        "Run the simulation to rest, and compare it with linear theory and with exact theory (large displacements).",
    )
    add_model(parser)
    option(
        parser,
        "--influence NAME",
        "print influence lines instead: of the axial force of rod AB; of its moments, AB.start and AB.end, or its"
        " shear force, AB.shear; of a force within it, AB.M@1.5 (m from its start; N and V, too, and 50%); of a"
        " reaction, A.y or A.rotation; or of a displacement, B.y (unit-load method)",
        nargs="+",
    )
    option(
        parser,
        "--path ROD",
        "with --influence: the rods along which the force moves; else all",
        nargs="+",
        beside="--influence",
    )
    flag(parser, "--theory-only", "leave out the simulation", apart=("--influence",))
    add_steps(parser, "--influence", "--theory-only")
    option(
        parser,
        "--limit SECONDS",
        "simulate until at rest, at most for this time; without it, a simulation that would take long is left out",
        positive,
        apart=("--influence", "--theory-only"),
    )
    add_output(parser)
    options = parser.parse_args(words)
    session = headless_of(options)
    try:
        if options.influence:
            lines = influence.influence(session.model, options.influence, options.path or ())
            write_result(options, lines, influence.rows, influence.lines)
            return ANSWERED
        found = comparison.compare(session, options.model, options.limit, simulate=not options.theory_only)
    except NoEquilibrium as error:
        raise UsageError(str(error), NOT_ANSWERED) from None
    write_result(options, found, comparison.rows, comparison.lines)
    return NOT_ANSWERED if found["status"] == comparison.NOT_VERIFIED else ANSWERED
