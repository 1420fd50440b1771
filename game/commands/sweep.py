"""`pinjoint sweep`: many variants of a model."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from pinjoint.commands.arguments import Parser, UsageError
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED, STOPPED, add_analysis, add_model, analysis_of
from pinjoint.commands.report import FOUND
from pinjoint.components.language import tr
from pinjoint.streams import tell
from pinjoint.sweeps import sweep
from pinjoint.sweeps.variation import FORMS

_WIDTH = 30  # characters of the bar
_EVERY = 0.2  # s


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    options = _parser().parse_args(words)
    from pinjoint.sweeps.results import check_output

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
            progress=_ProgressBar(sys.stderr),
        )
        if options.plot is not None:
            results.plot(options.plot)
    except KeyboardInterrupt:
        tell(tr("Interrupted. Use the same command again to go on from here."))
        return STOPPED
    except OSError as error:
        file, reason = error.filename or options.output, error.strerror
        message = tr("{file} cannot be written: {reason}. Choose another file.", file=file, reason=reason)
        raise UsageError(message) from None
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
        prog="pinjoint sweep",
        description=tr(
            "Compute many variants of a model, and write one line of results for each; a variant that fails is recorded"
            " with the reason."
        ),
    )
    add_model(parser)
    add_analysis(parser)
    add = parser.add_argument
    add("--vary", action="append", required=True, metavar="PATH=…", help=tr(FORMS))
    add(
        "--measure",
        action="append",
        required=True,
        metavar="PATH,…",
        help=tr("what to write of each variant, such as rods.CD.plastic_strain"),
    )
    add(
        "--output",
        required=True,
        metavar="FILE",
        help=tr("the file of results, such as results.csv or results.parquet"),
    )
    add("--plot", metavar="FILE.png", help=tr("also draw the results over the first varied value"))
    add("--samples", type=int, metavar="N", help=tr("how many variants to draw from distributions (~)"))
    add("--seed", type=int, default=0, metavar="N", help=tr("the seed of the random numbers; default 0"))
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help=tr("how many processes to use on this machine; chosen automatically by default"),
    )
    where.add_argument("--scheduler", metavar="tcp://…", help=tr("compute on a running Dask cluster"))
    return parser


class _ProgressBar:
    """A bar on a terminal; elsewhere, such as in the log of a cluster, a line for every tenth."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._began: tuple[float, int] | None = None
        self._shown = 0.0
        self._tenths = 0

    def __call__(self, done: int, total: int, failed: int) -> None:
        """Show that so many variants are done, of which so many failed."""
        now = time.monotonic()
        began, first = self._began = self._began or (now, done)
        left = (now - began) / (done - first) * (total - done) if done > first else None
        parts = [tr("{done}/{total} variants", done=done, total=total)]
        if failed:
            parts.append(tr("{failed} failed", failed=failed))
        if left is not None and done < total:
            parts.append(tr("{time} left", time=_duration(left)))
        text = ", ".join(parts)
        if self._stream.isatty():
            if now - self._shown >= _EVERY or done == total:
                self._shown = now
                filled = "█" * (_WIDTH * done // total)
                self._stream.write(f"\r\x1b[K{filled:░<{_WIDTH}} {text}" + ("\n" if done == total else ""))
        elif 10 * done // total > self._tenths:
            self._tenths = 10 * done // total
            self._stream.write(text + "\n")
        self._stream.flush()


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours:d} h {minutes:02d} min"
    return f"{minutes:d} min {seconds:d} s" if minutes else f"{seconds:d} s"
