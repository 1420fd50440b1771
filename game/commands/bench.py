"""`pinjoint bench`: the benchmarks of a source checkout."""

from __future__ import annotations

import importlib
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pinjoint.commands.arguments import Parser, UsageError, flag, option
from pinjoint.commands.options import ANSWERED
from pinjoint.commands.output import Row, add_format, aligned, formatted, write, writing
from pinjoint.components import written
from pinjoint.components.language import tr

CHECKOUT = Path(__file__).resolve().parents[2]
NAMES = (
    *("speed", "accuracy", "stability", "drawing", "editing"),
    *("mods", "collisions", "sweeps", "start", "differential"),
)
_NUMBERED = "differential"  # the one whose models have numbers

Tables = Mapping[str, Sequence[Mapping[str, Any]]]  # rows by the title of their table


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "bench", "Measure speed and accuracy, and compare them with other programs in the same run."
    )
    option(
        parser,
        "names NAME",
        tr("the benchmarks to run, of {names}; default: all", names=", ".join(NAMES)),
        nargs="*",
    )
    flag(parser, "--quick", "use smaller models, to end within a minute")
    option(parser, "--seed N", "with differential: only the model with this number, in full", int)
    add_format(parser)
    option(parser, "--output DIR", "also write CSV files and pictures into this folder")
    options = parser.parse_args(words)
    for name in options.names:
        if name not in NAMES:
            raise UsageError(
                "There is no benchmark '{name}'; choose from {names}.", name=name, names=", ".join(NAMES)
            )
    if options.seed is not None and (options.names != [_NUMBERED] or options.seed < 0):
        raise UsageError(
            "--seed takes a whole number of at least 0 and works with one benchmark only: {name}.",
            name=_NUMBERED,
        )
    chosen = {"quick": options.quick} | ({} if options.seed is None else {"seed": options.seed})
    measured: dict[str, Tables] = {}
    for name in options.names or NAMES:
        tables = run(name, **chosen)
        if options.format == "table":  # at once: the next one may take minutes
            print(f"== {name} ==\n{as_text(tables)}")
        measured[name] = tables
        if options.output:
            with writing(options.output):
                write_files(name, tables, Path(options.output))
    if options.format != "table":
        write(formatted(options.format, _finite(measured), _rows), None)
    return ANSWERED


def run(name: str, **options: Any) -> Tables:
    """The tables of one benchmark, whose report takes the options. Raises UsageError outside a source checkout."""
    if not (CHECKOUT / "tests" / "benchmarks").is_dir():
        raise UsageError(
            "The benchmarks are part of the source code, not of the installed package. Clone the repository and"
            ' install it with: pip install -e ".[bench]"'
        )
    if str(CHECKOUT) not in sys.path:
        sys.path.insert(0, str(CHECKOUT))
    try:
        tables: Tables = importlib.import_module(f"tests.benchmarks.{name}").report(**options)
    except ImportError as error:
        message = tr('{error}. Install the programs to compare with: pip install -e ".[bench]"', error=error)
        raise UsageError(message) from None
    return tables


def as_text(tables: Tables) -> str:
    """All tables of a benchmark, aligned, to read."""
    lines: list[str] = []
    for title, rows in tables.items():
        cells = [[f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values()] for row in rows]
        lines += [title, *aligned([list(rows[0]), *cells]), ""]
    return "\n".join(lines)


def _finite(value: Any) -> Any:
    """A value with None for every number that is not finite: JSON has none of these."""
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _rows(measured: Mapping[str, Tables]) -> Iterator[Row]:
    """One value a line: tables have different columns."""
    yield "benchmark", "table", "row", "quantity", "value"
    for name, tables in measured.items():
        for title, rows in tables.items():
            for number, row in enumerate(rows, 1):
                yield from ((name, title, number, *entry) for entry in row.items())


def write_files(name: str, tables: Tables, folder: Path) -> None:
    """One CSV file per table, and a picture where the benchmark has one."""
    folder.mkdir(parents=True, exist_ok=True)
    for title, rows in tables.items():
        table = written.as_csv([rows[0], *(row.values() for row in rows)])
        (folder / f"{name}_{title}.csv").write_text(table, encoding="utf-8")
    module = importlib.import_module(f"tests.benchmarks.{name}")
    if hasattr(module, "draw"):
        module.draw(tables, folder / f"{name}.png")
