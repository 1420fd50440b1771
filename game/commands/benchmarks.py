"""`pinjoint bench`: runs the benchmarks of a source checkout and writes their tables."""

from __future__ import annotations

import csv
import importlib
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

CHECKOUT = Path(__file__).resolve().parent.parent
NAMES = ("speed", "accuracy", "stability", "drawing", "editing", "mods", "collisions", "sweeps", "start")

Row = Mapping[str, Any]


class NoBenchmarks(RuntimeError):
    """The benchmarks are not at hand; the message says why and what to do."""


def run(name: str, *, quick: bool) -> dict[str, list[Row]]:
    """The tables of one benchmark. Raises NoBenchmarks outside a source checkout."""
    if not (CHECKOUT / "tests" / "benchmarks").is_dir():
        raise NoBenchmarks(
            "The benchmarks live in the source tree, not in the installed package; clone it and"
            ' install it with: pip install -e ".[bench]"'
        )
    if str(CHECKOUT) not in sys.path:
        sys.path.insert(0, str(CHECKOUT))
    try:
        module = importlib.import_module(f"tests.benchmarks.{name}")
        tables: dict[str, list[Row]] = module.report(quick=quick)
    except ImportError as error:
        raise NoBenchmarks(f'{error}; install the peers with: pip install -e ".[bench]"') from None
    return tables


def as_text(tables: Mapping[str, Sequence[Row]]) -> str:
    """All tables, aligned, to read."""
    return "\n".join(_table(title, rows) for title, rows in tables.items())


def _table(title: str, rows: Sequence[Row]) -> str:
    heads = list(rows[0])
    body = [[_shown(row[head]) for head in heads] for row in rows]
    widths = [max(len(cell) for cell in column) for column in zip(heads, *body, strict=True)]
    lines = [title, *("  ".join(c.rjust(w) for c, w in zip(r, widths, strict=True)) for r in [heads, *body])]
    return "\n".join(lines) + "\n"


def _shown(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write(name: str, tables: Mapping[str, Sequence[Row]], folder: Path) -> None:
    """One CSV file per table, and a picture where the benchmark has one."""
    folder.mkdir(parents=True, exist_ok=True)
    for title, rows in tables.items():
        with open(folder / f"{name}_{title}.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
    module = importlib.import_module(f"tests.benchmarks.{name}")
    if hasattr(module, "draw"):
        module.draw(tables, folder / f"{name}.png")
