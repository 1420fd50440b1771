"""Histories of loads: sine, pulse, table and record; and the loads of a recorded base acceleration.

In statics a sine, a pulse and a record count as 0 (with a note), a table with its last factor.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TextIO

import numpy as np

from pinjoint.components import FieldError, HistoryKind, Load, Model, Vector
from pinjoint.components.language import marked
from pinjoint.components.load import History
from pinjoint.components.mistake import WrongValue, reason_of
from pinjoint.components.wording import quoted
from pinjoint.mods import App

_STANDARD_GRAVITY = 9.80665  # m/s²
DIRECTIONS = {"x": (1.0, 0.0), "y": (0.0, 1.0)}


def _check_positive(parameter: str, unit: str, history: History, where: str) -> None:
    """Raise FieldError unless a parameter is above 0."""
    if not history[parameter] > 0.0:
        raise FieldError(
            "{where}: history {parameter} is {value:g} {unit}; it must be above 0 {unit}.",
            where=where,
            parameter=parameter,
            value=history[parameter],
            unit=unit,
        )


def _check_points(history: History, where: str) -> None:
    """Raise FieldError unless there is one value for each time and times ascend."""
    times, values = (history[name] for name in list(history)[1:])
    if not times or len(times) != len(values):
        raise FieldError(
            "{where}: the history has {times} times and {values} values; give as many of both.",
            where=where,
            times=len(times),
            values=len(values),
        )
    if any(later <= earlier for earlier, later in itertools.pairwise(times)):
        raise FieldError(
            "{where}: history times must ascend; correct or leave out those that do not.", where=where
        )


KERNELS = "pinjoint.systems.loads.kernels"
_SINE = HistoryKind(
    "sine",
    {"frequency": 1.0, "phase": 0.0},
    f"{KERNELS}:sine",
    static=0.0,
    ends=lambda history: math.inf,
    check=partial(_check_positive, "frequency", "Hz"),
)
PULSE = HistoryKind(
    "pulse",
    {"start": 0.0, "duration": 1.0},
    f"{KERNELS}:pulse",
    static=0.0,
    ends=lambda history: float(history["start"] + history["duration"]),
    check=partial(_check_positive, "duration", "s"),
    breaks=lambda history: (history["start"], history["start"] + history["duration"]),
)
TABLE = HistoryKind(
    "table",
    {"times": (0.0, 1.0), "factors": (0.0, 1.0)},
    f"{KERNELS}:interpolated",
    static=lambda history: float(history["factors"][-1]),
    ends=lambda history: float(history["times"][-1]),
    check=_check_points,
    breaks=lambda history: tuple(history["times"]),
)
RECORD = replace(TABLE, name="record", parameters={"times": (0.0,), "accelerations": (0.0,)}, static=0.0)


# --- base acceleration -------------------------------------------------------------------------------


def read_record(path: Path, unit: float = 1.0) -> dict[str, list[float] | str]:
    """The record in a CSV file of times (s) and accelerations (`unit` m/s² each), as a history.

    A line that does not begin with a number is a heading. Raises ValueError, naming the line.
    """
    times: list[float] = []
    values: list[float] = []
    with path.open(newline="", encoding="utf-8-sig") as file:
        for number, row in enumerate(_lines(file, path), start=1):
            try:
                time, value = float(row[0]), float(row[1])
            except (ValueError, IndexError):
                if times and "".join(row).strip():
                    raise WrongValue(
                        "{path}, line {number}: {row} is not a time and an acceleration.",
                        path=path,
                        number=number,
                        row=quoted(row),
                    ) from None
                continue
            times.append(time)
            values.append(value * unit)
    if not times:
        raise WrongValue("{path}: there is no line with a time and an acceleration.", path=path)
    return {"kind": "record", "times": times, "accelerations": values}


def _lines(file: TextIO, path: Path) -> Iterator[list[str]]:
    """The lines of a CSV file in fields. Raises ValueError, naming the file."""
    reader = csv.reader(file)
    try:
        yield from reader
    except (csv.Error, UnicodeDecodeError) as error:
        raise WrongValue(
            "{path}, after line {number}: this is not a CSV file in UTF-8 ({error}).",
            path=path,
            number=reader.line_num,
            error=error,
        ) from None


def shake(model: Model, record: History | dict[str, list[float] | str], direction: Vector = (1.0, 0.0)) -> None:
    """Shake the supports: a load −m a(t) on every particle that can move, displacements being relative to them.

    One step of undo. The masses are the present ones.
    """
    particles = model.particles
    free = np.flatnonzero(~particles.fixed.all(axis=1))
    force = -particles.mass[free, None] * np.array(direction) / 1000.0
    with model.transaction(marked("shake the supports")):
        names = [f"base acceleration of {particles.names[row]}" for row in free.tolist()]
        model.delete([model.loads[name] for name in names if name in model.loads])
        model.create(Load, len(free), name=names, on=free, force=force, history=[record] * len(free))


def run(words: list[str]) -> int:
    """`pinjoint shake MODEL RECORD.csv --output FILE`."""
    from pinjoint.commands.arguments import Parser, UsageError, option
    from pinjoint.commands.output import writable
    from pinjoint.documents import models

    parser = Parser("shake", "Shake the supports of a model by a recorded acceleration.")
    option(parser, "model", "a model file, or the name of a bundled model")
    option(parser, "record RECORD.csv", "lines of time (s), acceleration", Path)
    option(parser, "--unit", "of the accelerations", choices=("m/s2", "g"), default="m/s2")
    parser.add_argument("--direction", choices=tuple(DIRECTIONS), default="x")
    option(parser, "--output FILE", "the model with the loads", writable, required=True)
    options = parser.parse_args(words)
    model = models.load(options.model)
    try:
        record = read_record(options.record, _STANDARD_GRAVITY if options.unit == "g" else 1.0)
        shake(model, record, DIRECTIONS[options.direction])
    except OSError as error:
        raise UsageError(
            "{file} cannot be read: {reason}. Check its path.", file=options.record, reason=reason_of(error)
        ) from None
    except ValueError as error:
        raise UsageError(str(error)) from None
    models.save(model, options.output)
    return 0


def plugin(app: App) -> None:
    """Register the histories and the command."""
    for kind in (_SINE, PULSE, TABLE, RECORD):
        app.history(kind)
    app.command("shake", run, marked("give a model the loads of a recorded base acceleration"))
