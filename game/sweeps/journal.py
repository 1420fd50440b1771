"""Journal: what is finished of a sweep, on disk, so that it goes on after a kill."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

import msgspec

from game.sweeps.plan import Outcome, Plan
from game.sweeps.variation import SweepError


class Journal:
    """A file beside the output: one line says which sweep it is of, each other line what some variants came to.

    Lines are only ever added, each in one write; what a kill left of a line is dropped when it is read.
    Without an output it is kept in memory only.
    """

    def __init__(self, output: Path | None, plan: Plan) -> None:
        self.path = None if output is None else output.with_name(output.name + ".journal")
        self._plan = plan
        self.finished: dict[int, list[Any]] = {}  # records by number of variant

    def open(self) -> None:
        """Read what is finished already; begin the file if there is none. Raises SweepError, OSError."""
        if self.path is None:
            return
        title = msgspec.json.encode({"pinjoint sweep": self._plan.fingerprint()})
        with open(self.path, "a+b") as file:
            file.seek(0)
            lines = file.read().split(b"\n")[:-1]  # what follows the last line end is part of a line
            if len(lines) <= 1:
                file.truncate(0)
                _append(file, title)
                return
            if lines[0] != title:
                raise SweepError(
                    f"{self.path} keeps an unfinished sweep of another model, variation, seed or version."
                    " Repeat its command to finish it, or delete that file, or choose another --output."
                )
            file.truncate(sum(len(line) + 1 for line in lines))
        for line in lines[1:]:
            self.finished.update((number, records) for number, records in msgspec.json.decode(line))

    def add(self, outcomes: Sequence[Outcome]) -> None:
        """Keep what some variants came to; it survives a kill from now on."""
        if self.path is not None:
            with open(self.path, "ab") as file:
                _append(file, msgspec.json.encode(outcomes))
        self.finished.update(outcomes)

    def remove(self) -> None:
        """The results are written; nothing is left to keep."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)


def _append(file: BinaryIO, line: bytes) -> None:
    file.write(line + b"\n")
    file.flush()
    os.fsync(file.fileno())
