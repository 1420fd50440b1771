"""`pinjoint curve`: a load–displacement curve."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from game.commands.arguments import Parser, UsageError, count, finite
from game.commands.options import ANSWERED, NOT_ANSWERED, add_model, session_of
from game.commands.output import add_output, write_result
from game.commands.reports.curve import curve_data, curve_rows, why_nothing_follows


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint curve",
        description="Load–displacement curve: the equilibria while the load grows, and falls behind limit points.",
    )
    add_model(parser)
    goal = parser.add_mutually_exclusive_group()
    goal.add_argument(
        "--factor", type=finite, default=1.0, help="end where the load factor first reaches this; default 1"
    )
    goal.add_argument(
        "--until", metavar="B.y=-2.5", help="end where a particle first has this displacement (m)"
    )
    parser.add_argument("--points", type=count, default=500, metavar="N", help="at most so many equilibria")
    add_output(parser, default="csv")
    options = parser.parse_args(words)
    session = session_of(options)
    try:
        found = session.load_path(options.factor, until=options.until, points=options.points)
    except ValueError as error:
        raise UsageError(str(error)) from None
    write_result(options, curve_data(session.model, found), curve_rows)
    if not found.complete:
        print(
            f"pinjoint: The curve ends at the load factor {found.load_factor[-1]:.6g}."
            f"{why_nothing_follows(session.model) if len(found.load_factor) == 1 else ''}",
            file=sys.stderr,
        )
    return ANSWERED if found.complete else NOT_ANSWERED
