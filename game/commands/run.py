"""`pinjoint run`: compute a model without a window and print what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from game.commands.arguments import Parser, writable, write
from game.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    add_analysis,
    add_model,
    add_output,
    analysis_of,
    session_of,
)
from game.commands.reports.report import FOUND
from game.commands.reports.results import as_csv, as_json, as_table

_FORMATS = {"table": as_table, "json": as_json, "csv": as_csv}


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint run", description="Compute a model without a window and print what came of it."
    )
    add_model(parser)
    add_analysis(parser)
    parser.add_argument("--format", choices=tuple(_FORMATS), default="table")
    add_output(parser)
    parser.add_argument("--events", type=writable, metavar="FILE", help="write all impacts to a file, as CSV")
    parser.add_argument(
        "--measure-error",
        action="store_true",
        help="measure the error by a run with finer steps, even if that takes long",
    )
    options = parser.parse_args(words)
    session = session_of(options)
    run = replace(analysis_of(options), measures_error=options.measure_error).run_in(session, options.model)
    write(_FORMATS[options.format](run), options.output)
    if options.events is not None:
        write(session.impacts.as_csv(), options.events)
    return ANSWERED if run["status"] in FOUND else NOT_ANSWERED
