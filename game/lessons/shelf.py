"""Shelf: the lessons with tasks that a person can begin, ours and those in a folder of their own."""

from __future__ import annotations

from pathlib import Path

from pinjoint.documents.library import data_folder
from pinjoint.lessons import progress
from pinjoint.scripts.script import Script, ScriptError, lessons_with_tasks


def own_lessons() -> list[Path]:
    """The files in the folder for a person's own lessons, by name; none if it cannot be read."""
    try:
        return sorted((data_folder() / "lessons").glob("[!.]*.jsonl"))
    except OSError:
        return []


def shelf() -> list[Script]:
    """Ours, then the person's own; what cannot be read is left out, and says why when it is opened."""
    found = [Script(name) for name in lessons_with_tasks()]
    for path in own_lessons():
        try:
            script = Script(path)
        except ScriptError:
            continue
        found += [script] if script.has_tasks else []
    return found


def count_of(script: Script) -> int:
    """The number of tasks."""
    return sum("task" in entry for _, entry in script.lines)


def is_done(script: Script) -> bool:
    """True if all its tasks were done."""
    return progress.done(script.name).tasks >= set(range(1, count_of(script) + 1))


def after(script: Script) -> Script | None:
    """The lesson that follows one; None after the last."""
    all_of_them = shelf()
    names = [known.name for known in all_of_them]
    at = names.index(script.name) + 1 if script.name in names else len(names)
    return all_of_them[at] if at < len(names) else None
