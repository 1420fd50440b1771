"""A sweep: many variants of one model, what was measured of each, and a file that keeps it against a kill."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, TextIO

import msgspec

from pinjoint.commands.analysis import Analysis
from pinjoint.components.language import tr
from pinjoint.mods import load_all
from pinjoint.sweeps.execution import compute_all
from pinjoint.sweeps.plan import FAILED, Outcome, Plan, plan_of
from pinjoint.sweeps.results import Results, check_output
from pinjoint.sweeps.variation import SweepError, Value

Progress = Callable[[int, int, int], None]  # done, of how many, failed

_WIDTH = 30


def sweep(
    source: str | Path | Mapping[str, Any],
    vary: Iterable[str] | Mapping[str, Sequence[Value]],
    measure: Iterable[str],
    analysis: Analysis = Analysis(),  # noqa: B008 (it cannot be changed)
    *,
    overrides: Iterable[str] = (),
    samples: int | None = None,
    seed: int = 0,
    output: str | Path | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    mods: Iterable[str | Path] = (),
    progress: Progress = lambda done, total, failed: None,
) -> Results:
    """Compute all variants of a model and keep what is measured of each.

    source: a model file, the name of a bundled model, or a document. vary: texts such as
    "rods.CD.tensile_strength=150:300:31" or "rods.*.stiffness~normal(164640,5%)", or values by path.
    measure: paths such as "rods.CD.plastic_strain"; a vector becomes two columns. analysis: what is asked of
    each. overrides: what is changed in all, as in "rods.*.damping=0". samples, seed: of what is drawn.
    output: a .csv or .parquet file; while it is not complete, a file beside it keeps what is finished, and
    the same sweep goes on from there. workers: processes; 1 is this one, None as many as suit (a script that
    asks for more than 1 guards its main code by `if __name__ == "__main__"`). scheduler: the address of that of
    a running Dask cluster, which computes instead. mods: folders of mods, or names of bundled ones, to load first.
    progress: told how many are done, of how many, and failed.

    Same arguments, same bits, however many workers. Raises SweepError, ModelError,
    PathError, ModError, and OSError if the output cannot be written.
    """
    load_all(mods)
    plan = plan_of(source, vary, measure, analysis, overrides, samples, seed)
    if workers is not None and workers < 1:
        raise SweepError("{workers} workers: use at least 1.", workers=workers)
    path = None if output is None else Path(output)
    if path is not None:
        check_output(path)
    journal = Journal(path, plan)
    failed = sum(map(_is_failure, journal.finished.values()))
    missing = [number for number in range(plan.size) if number not in journal.finished]
    progress(len(journal.finished), plan.size, failed)
    for part in compute_all(plan, missing, workers, scheduler) if missing else ():
        journal.add(part)
        failed += sum(_is_failure(records) for _, records in part)
        progress(len(journal.finished), plan.size, failed)
    results = Results(plan, journal.finished)
    if path is not None:
        results.write(path)
        journal.remove()
    return results


def _is_failure(records: Sequence[Sequence[Any]]) -> bool:
    return bool(records[-1][0] == FAILED)


class Journal:
    """A file beside the output: one line says which sweep it is of, each other line what some variants came to.

    Lines are only ever added, each in one write; what a kill left of a line is dropped when it is read, and a
    line that is damaged counts for nothing.
    Without an output it is kept in memory only.
    """

    def __init__(self, output: Path | None, plan: Plan) -> None:
        """Read what is finished already; begin the file if there is none. Raises SweepError, OSError."""
        self.path = None if output is None else output.with_name(output.name + ".journal")
        self.finished: dict[int, list[Any]] = {}  # records by number of variant
        if self.path is None:
            return
        title = msgspec.json.encode({"pinjoint sweep": plan.fingerprint()})
        with open(self.path, "a+b") as file:
            file.seek(0)
            kept = file.read()
            lines = kept.split(b"\n")[:-1]  # what follows the last line end is part of a line
            if lines[:1] != [title] and not title.startswith(kept):
                raise SweepError(
                    "{path} holds an unfinished sweep with another model, variation, seed or version, or something"
                    " else. Finish that sweep with its own command, delete the file, or choose another --output.",
                    path=self.path,
                )
            file.truncate(sum(len(line) + 1 for line in lines))
            if not lines:
                _append(file, title)
        for line in lines[1:]:
            seal, _, content = line.partition(b" ")
            if seal == _seal(content):  # else it is damaged, and its variants are computed anew
                self.finished.update(msgspec.json.decode(content, type=list[Outcome]))

    def add(self, outcomes: Sequence[Outcome]) -> None:
        """Keep what some variants came to; it survives a kill from now on."""
        if self.path is not None:
            with open(self.path, "ab") as file:
                content = msgspec.json.encode(outcomes)
                _append(file, _seal(content) + b" " + content)
        self.finished.update(outcomes)

    def remove(self) -> None:
        """The results are written; nothing is left to keep."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)


def _seal(content: bytes) -> bytes:
    """Tells whether a line is as it was written: in a damaged one another digit would go unnoticed."""
    return hashlib.sha256(content).hexdigest()[:16].encode()


def _append(file: BinaryIO, line: bytes) -> None:
    file.write(line + b"\n")
    file.flush()
    os.fsync(file.fileno())


class ProgressBar:
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
            if now - self._shown >= 0.2 or done == total:
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
