"""`pinjoint bench`: the benchmarks of a source checkout."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from game.commands import benchmarks as benchmarks
from game.commands.arguments import Parser, UsageError
from game.commands.options import ANSWERED


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(prog="pinjoint bench", description="Measure, against peers in the same run.")
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"any of {', '.join(benchmarks.NAMES)}; default all"
    )
    parser.add_argument("--quick", action="store_true", help="smaller sizes; ends within a minute")
    parser.add_argument("--output", metavar="DIR", help="also write CSV files and pictures there")
    options = parser.parse_args(words)
    for name in options.names:
        if name not in benchmarks.NAMES:
            raise UsageError(f"There is no benchmark '{name}'; choose from {', '.join(benchmarks.NAMES)}.")
    for name in options.names or benchmarks.NAMES:
        try:
            tables = benchmarks.run(name, quick=options.quick)
        except benchmarks.NoBenchmarks as error:
            raise UsageError(str(error)) from None
        print(f"== {name} ==\n{benchmarks.as_text(tables)}")
        if options.output:
            try:
                benchmarks.write(name, tables, Path(options.output))
            except OSError as error:
                raise UsageError(f"{options.output} cannot be written: {error.strerror}.") from None
    return ANSWERED
