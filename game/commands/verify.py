"""`pinjoint verify`: simulation, linear and exact theory side by side; influence lines."""

from __future__ import annotations

from collections.abc import Sequence

from game.commands.arguments import BAD_INPUT, Parser, UsageError, positive
from game.commands.options import ANSWERED, NOT_ANSWERED, add_model, session_of
from game.commands.output import add_output, write_result
from game.session import DEFAULT_LIMIT


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint verify",
        description="Simulation run to rest, linear theory and exact theory side by side, with their differences.",
    )
    add_model(parser)
    parser.add_argument(
        "--influence",
        nargs="+",
        metavar="NAME",
        help="influence lines instead: of a rod AB, its moments AB.start, AB.end and AB.shear, a reaction A.y or"
        " A.rotation, or a displacement B.y (unit-load method)",
    )
    parser.add_argument("--theory-only", action="store_true", help="without the simulation")
    parser.add_argument(
        "--limit", type=positive, default=DEFAULT_LIMIT, metavar="SECONDS", help="simulated time for rest"
    )
    add_output(parser)
    options = parser.parse_args(words)
    session = session_of(options)
    from game.commands.reports import verify
    from systems.statics.events import NoEquilibrium
    from systems.statics.unknowns import ForceMethodError

    try:
        if options.influence:
            found = verify.influence(session.model, options.influence)
        else:
            found = verify.verify(session, options.model, options.limit, simulate=not options.theory_only)
    except (ForceMethodError, NoEquilibrium) as error:
        raise UsageError(str(error), NOT_ANSWERED if isinstance(error, NoEquilibrium) else BAD_INPUT) from None
    write_result(options, found, verify.rows, verify.lines)
    return ANSWERED if found.get("status") != verify.NOT_VERIFIED else NOT_ANSWERED
