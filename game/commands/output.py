"""Output of commands: the options --format and --output, and the formats table, json and csv."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pinjoint.commands.arguments import UsageError, option
from pinjoint.components import written
from pinjoint.components.language import ENGLISH, Said, decimals, english, spoken, tr
from pinjoint.components.mistake import Mistake, reason_of
from pinjoint.components.wording import printable
from pinjoint.documents.models import laid_out, replace
from pinjoint.streams import encodable_json, put

Format = Literal["table", "json", "csv"]
FORMATS: tuple[Format, ...] = ("table", "json", "csv")
Row = Sequence[Any]  # of a table or of CSV
Rows = Callable[[Any], Iterable[Row]]


class ResultError(Mistake, ValueError):
    """A result that is not a finite number; the message names the element."""


# --- options -------------------------------------------------------------------------------------------


def writable(text: str) -> str:
    """The name of a file that can be written, checked before the computation."""
    path = Path(text)
    if path.is_dir():
        refusal = tr("{file} cannot be written, it is a folder; choose another file", file=text)
    elif not path.parent.is_dir():
        refusal = tr(
            "{file} cannot be written, there is no folder {folder}; choose another file",
            file=text,
            folder=path.parent,
        )
    elif not os.access(path if path.exists() else path.parent, os.W_OK):
        refusal = tr("{file} cannot be written, you have no permission; choose another file", file=text)
    else:
        return text
    raise argparse.ArgumentTypeError(refusal)


def add_format(parser: argparse.ArgumentParser, default: Format = "table") -> None:
    """Add the option --format alone, to commands whose --output is not a file."""
    option(
        parser,
        "--format",
        tr("the format of the output; default {format}", format=default),
        choices=FORMATS,
        default=default,
    )


def add_output(parser: argparse.ArgumentParser, default: Format = "table") -> None:
    """Add the options --format and --output of `write_result`."""
    add_format(parser, default)
    option(parser, "--output FILE", "write the output to this file instead of the terminal", writable)


# --- writing -------------------------------------------------------------------------------------------


def write_result(
    options: argparse.Namespace, data: Any, rows: Rows, lines: Callable[[Any], Iterable[str]] | None = None
) -> None:
    """Write a result to the file and in the format of `add_output`. Raises UsageError, ResultError.

    data: the result, written as JSON. rows: makes rows of values of plain data, headings first, for CSV. lines: makes
    lines of a text of plain data, for a table; None: the rows in columns.
    """
    text = formatted(options.format, data, rows, lines)
    in_json = options.format == "json" and options.output is None
    write(encodable_json(text) if in_json else text, options.output)


def formatted(
    chosen: Format, data: Any, rows: Rows, lines: Callable[[Any], Iterable[str]] | None = None
) -> str:
    """The text of a result in a format; see `write_result`. Raises ResultError.

    Tables are for people, in their language; JSON and CSV are the same in all.
    """
    if chosen != "table":
        with spoken(ENGLISH):
            data = plain(data, "result")
            return laid_out(data, depth=4) + "\n" if chosen == "json" else written.as_csv(rows(data))
    data = plain(data, "result", as_said=True)
    if lines is not None:
        return "".join(f"{line}\n" for line in lines(data))
    titles, *others = rows(data)
    return "".join(f"{line}\n" for line in aligned([list(map(tr, titles)), *others]))


def write(content: str | bytes, path: str | None) -> None:
    """Write to a file, whole or not at all, or to standard output if None. Raises UsageError."""
    with writing(path or tr("Standard output")):
        if path is None:
            put(str(content))
        else:
            replace(path, content if isinstance(content, bytes) else content.encode())


@contextmanager
def writing(place: object) -> Iterator[None]:
    """Turn an OSError of writing to a place into a UsageError that asks for another one."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise UsageError(
            "{file} cannot be written: {reason}. Choose another file.", file=place, reason=reason_of(error)
        ) from None


# --- values as text ------------------------------------------------------------------------------------


def aligned(rows: Iterable[Row]) -> Iterator[str]:
    """Rows of values in columns, the first to the left and the others to the right."""
    cells = [[printable(as_written(value)) for value in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for name, *numbers in cells:
        placed = [name.ljust(widths[0]), *(n.rjust(w) for n, w in zip(numbers, widths[1:], strict=True))]
        yield "  ".join(placed).rstrip()


def as_written(value: Any) -> str:
    """A value as tables show it: numbers with 7 digits, "–" for none."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return tr("yes") if value else tr("no")
    return value if isinstance(value, str) else decimals(f"{value + 0.0:.7g}")  # + 0.0: no minus before a zero


def plain(value: Any, where: str, *, as_said: bool = False) -> Any:
    """A value as JSON has them, numpy's included, every number finite. Raises ResultError, which names `where`.

    as_said: sentences stay in their language; else they are English.
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, float) and not math.isfinite(value):
        raise ResultError(
            "{where} is {value}, not a finite number; report an earlier state.", where=where, value=str(value)
        )
    if isinstance(value, Said):
        return value if as_said else english(value)
    if isinstance(value, str):
        return value.encode("utf-8", "replace").decode()  # names of files need not be UTF-8
    if isinstance(value, Mapping):
        return {str(key): plain(item, f"{where}.{key}", as_said=as_said) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item, f"{where}[{index}]", as_said=as_said) for index, item in enumerate(value)]
    return value
