"""`pinjoint sweep`: many variants of a model."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from game.commands.arguments import Parser, UsageError
from game.commands.options import ANSWERED, NOT_ANSWERED, STOPPED, add_analysis, add_model, analysis_of
from game.commands.reports.report import FOUND
from game.streams import tell
from game.sweeps import sweep
from game.sweeps.variation import FORMS


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    options = _parser().parse_args(words)
    from game.sweeps.results import check_output
    from game.sweeps.run import ProgressBar

    if options.plot is not None:
        check_output(Path(options.plot), [".png"])
    try:
        results = sweep(
            options.model,
            options.vary,
            options.measure,
            analysis_of(options),
            overrides=options.set,
            samples=options.samples,
            seed=options.seed,
            output=options.output,
            workers=options.workers,
            scheduler=options.scheduler,
            progress=ProgressBar(sys.stderr),
        )
        if options.plot is not None:
            results.plot(options.plot)
    except KeyboardInterrupt:
        tell("Interrupted; the same command goes on with what is finished.")
        return STOPPED
    except OSError as error:
        raise UsageError(
            f"{error.filename or options.output} cannot be written: {error.strerror}. Choose another file."
        ) from None
    for fault, count in results.faults.items():
        print(
            f"{count} variants were computed one by one, which takes longer, since together it failed: {fault}",
            file=sys.stderr,
        )
    counts = results.counts()
    why = "" if set(counts) <= set(FOUND) else "; its column 'message' says why"
    print(f"{options.output}: {', '.join(f'{count} {status}' for status, count in counts.items())}{why}")
    return ANSWERED if any(status in FOUND for status in counts) else NOT_ANSWERED


def _parser() -> Parser:
    parser = Parser(
        prog="pinjoint sweep",
        description="Compute many variants of a model; one that fails is recorded with its reason.",
    )
    add_model(parser)
    add_analysis(parser)
    add = parser.add_argument
    add("--vary", action="append", required=True, metavar="PATH=…", help=FORMS)
    add("--measure", action="append", required=True, metavar="PATH,…", help="such as rods.CD.plastic_strain")
    add("--output", required=True, metavar="FILE", help="results.csv or results.parquet")
    add("--plot", metavar="FILE.png", help="draw the measures against what is varied first")
    add("--samples", type=int, metavar="N", help="how many are drawn from distributions (~)")
    add("--seed", type=int, default=0, metavar="N", help="of what is drawn; default 0")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", type=int, metavar="N", help="processes on this machine; default: as many as suit"
    )
    where.add_argument("--scheduler", metavar="tcp://…", help="compute on a running Dask cluster")
    return parser
