"""Progress: the lessons with tasks that a person can begin, which tasks they did, and their best scores, kept in a file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.documents import preferences
from pinjoint.documents.library import data_folder
from pinjoint.scripts.script import TO_DO, Script, ScriptError, lessons

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
    return preferences.settings_path().with_name(FILE)


def done(lesson: str) -> Done:
    """What was done of a lesson; nothing where that cannot be read."""
    entry = preferences.read(path()).get(lesson)
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

    Where nothing can be written, it is not kept; see `preferences.keep`.
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
    preferences.keep(path(), lesson, entry)


def shelf() -> list[Script]:
    """Ours, those of mods, then the person's own; what cannot be read is left out, and says why when it is opened."""
    found = [Script(name) for name in lessons(TO_DO)]
    of_mods = [mod.folder for mod in EXTENSIONS.mods if mod.folder and mod.loaded and not mod.off]
    for path in (path for folder in (*of_mods, data_folder()) for path in lessons_in(folder)):
        with suppress(ScriptError):
            found += [script] if (script := Script(path)).task_count else []
    return found


def lessons_in(folder: Path) -> list[Path]:
    """The files of lessons that a mod's folder, or that of a person's data, has."""
    with suppress(OSError):
        return sorted((folder / "lessons").glob("[!.]*.jsonl"))
    return []


def is_done(script: Script) -> bool:
    """True if all its tasks were done."""
    return done(script.name).tasks >= set(range(1, script.task_count + 1))


def after(script: Script) -> Script | None:
    """The lesson that follows one; None after the last."""
    all_of_them = shelf()
    names = [known.name for known in all_of_them]
    at = names.index(script.name) + 1 if script.name in names else len(names)
    return all_of_them[at] if at < len(names) else None
