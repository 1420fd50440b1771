"""Progress: which tasks of which lessons a person did, and the best scores, kept in a file of their own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from pinjoint.documents import choices
from pinjoint.documents.preferences import settings_path

FILE = "lessons.json"


class Done(NamedTuple):
    """What a person did of a lesson. tasks: numbers of tasks, from 1. best: scores, by the number of the task."""

    tasks: frozenset[int] = frozenset()
    best: Mapping[int, float] = {}


_KEPT = [True]


@contextmanager
def not_kept() -> Iterator[None]:
    """As long as this lasts, nothing is noted."""
    _KEPT.append(False)
    try:
        yield
    finally:
        _KEPT.pop()


def path() -> Path:
    """The file; it need not exist yet."""
    return settings_path().with_name(FILE)


def done(lesson: str) -> Done:
    """What was done of a lesson; nothing where that cannot be read."""
    entry = choices.read(path()).get(lesson)
    if not isinstance(entry, dict):
        return Done()
    tasks, best = entry.get("tasks"), entry.get("best")
    known = {number for number in tasks if type(number) is int} if isinstance(tasks, list) else set()
    scores = best.items() if isinstance(best, dict) else ()
    return Done(
        frozenset(known),
        {int(n): float(score) for n, score in scores if n.isdecimal() and isinstance(score, int | float)},
    )


def keep(lesson: str, task: int, score: float | None = None) -> None:
    """Note that a task was done, and its score if it is less than before.

    Where nothing can be written, it is not kept; see `choices.keep`.
    """
    if not _KEPT[-1]:
        return
    before = done(lesson)
    best = dict(before.best)
    if score is not None:
        best[task] = min(score, best.get(task, score))
    entry = {"tasks": sorted(before.tasks | {task})} | (
        {"best": {str(number): best[number] for number in sorted(best)}} if best else {}
    )
    choices.keep(path(), lesson, entry)
