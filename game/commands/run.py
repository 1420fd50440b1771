"""`pinjoint run`: compute a model without a window and print what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pinjoint.commands.arguments import Parser
from pinjoint.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    STOPPED,
    add_analysis,
    add_model,
    analysis_of,
    headless_of,
    model_of,
)
from pinjoint.commands.output import add_output, writable, write, write_result
from pinjoint.commands.reports.report import FOUND, INTERRUPTED
from pinjoint.commands.reports.results import run_lines, run_rows
from pinjoint.components.language import tr
from pinjoint.systems.collision.impacts import Impacts


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint run", description=tr("Compute a model without a window, and print the result.")
    )
    add_model(parser)
    add_analysis(parser)
    add_output(parser)
    parser.add_argument(
        "--events", type=writable, metavar="FILE", help=tr("write all impacts to this file, as CSV")
    )
    parser.add_argument(
        "--measure-error",
        action="store_true",
        help=tr("measure the error by a second run with finer steps, even if that takes long"),
    )
    options = parser.parse_args(words)
    analysis = replace(analysis_of(options), measures_error=options.measure_error)
    if analysis.load_factors is not None:
        model = model_of(options)
        run, impacts = analysis.settled_in(model, options.model), Impacts(model)
    else:
        session = headless_of(options)
        run, impacts = analysis.run_in(session, options.model), session.impacts
    write_result(options, run, run_rows, run_lines)
    if options.events is not None:
        write(impacts.as_csv(), options.events)
    if run["status"] == INTERRUPTED:
        return STOPPED
    return ANSWERED if run["status"] in FOUND else NOT_ANSWERED
