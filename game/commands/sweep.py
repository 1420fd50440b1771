"""`pinjoint sweep`: many variants of a model."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from pinjoint.commands.analysis import FOUND
from pinjoint.commands.arguments import Parser, UsageError, option
from pinjoint.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    STOPPED,
    add_analysis,
    add_model,
    analysis_of,
    changes,
)
from pinjoint.components.language import tr
from pinjoint.components.mistake import reason_of
from pinjoint.streams import tell
from pinjoint.sweeps import sweep
from pinjoint.sweeps.variation import FORMS


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    options = _parser().parse_args(words)
    from pinjoint.sweeps.results import check_output
    from pinjoint.sweeps.run import ProgressBar

    if options.plot is not None:
        check_output(Path(options.plot), [".png"])
    try:
        results = sweep(
            options.model,
            options.vary,
            options.measure,
            analysis_of(options),
            overrides=changes(options),
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
        tell(tr("Interrupted. Use the same command again to go on from here."))
        return STOPPED
    except OSError as error:
        raise UsageError(
            "{file} cannot be written: {reason}. Choose another file.",
            file=error.filename or options.output,
            reason=reason_of(error),
        ) from None
    counts = results.counts()
    told = {
        "file": options.output,
        "counts": ", ".join(f"{count} {tr(status)}" for status, count in counts.items()),
    }
    if set(counts) <= set(FOUND):
        print(tr("{file}: {counts}", **told))
    else:
        print(tr("{file}: {counts}; its column 'message' says why", **told))
    return ANSWERED if any(status in FOUND for status in counts) else NOT_ANSWERED


def _parser() -> Parser:
    parser = Parser(
        "sweep",
        "Compute many variants of a model, and write one line of results for each; a variant that fails is recorded"
        " with the reason.",
    )
    add_model(parser)
    add_analysis(parser)
    option(parser, "--vary PATH=…", FORMS, action="append", required=True)
    option(
        parser,
        "--measure PATH,…",
        "what to write of each variant, such as rods.CD.plastic_strain",
        action="append",
        required=True,
    )
    option(
        parser, "--output FILE", "the file of results, such as results.csv or results.parquet", required=True
    )
    option(parser, "--plot FILE.png", "also draw the results over the first varied value")
    option(parser, "--samples N", "how many variants to draw from distributions (~)", int)
    option(parser, "--seed N", "the seed of the random numbers; default 0", int, default=0)
    where = parser.add_mutually_exclusive_group()
    option(
        where, "--workers N", "how many processes to use on this machine; chosen automatically by default", int
    )
    option(where, "--scheduler tcp://…", "compute on a running Dask cluster")
    return parser
