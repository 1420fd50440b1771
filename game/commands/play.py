"""`pinjoint play`: scripted sessions and lessons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from pinjoint.commands.arguments import Parser, flag, option
from pinjoint.commands.language import asked_language
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED
from pinjoint.commands.output import Row, add_output, write_result
from pinjoint.commands.progress import follow
from pinjoint.commands.window import in_window
from pinjoint.components.language import ENGLISH, plural, spoken, tr
from pinjoint.documents import library, models
from pinjoint.documents.open_documents import file_of
from pinjoint.lessons import progress
from pinjoint.lessons.checking import check_lesson
from pinjoint.scripts import playing, script
from pinjoint.scripts.script import EMPTY
from pinjoint.streams import tell


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "play",
        "Play a recorded or written session, or a lesson, in the real program. Of a lesson with tasks, all"
        " solutions and wrong answers are checked.",
        epilog=tr("Lessons: {names}", names=", ".join([*script.lessons(script.TO_DO), *script.lessons()])),
    )
    option(parser, "script SCRIPT", "a file of JSON lines, or the name of a lesson")
    flag(parser, "--window", "show it in a window, slowly enough to follow; then go on by hand")
    option(
        parser,
        "--data FOLDER",
        "where the session saves and opens files; default: an empty folder that is deleted afterwards",
        Path,
    )
    add_output(parser)
    options = parser.parse_args(words)
    loaded = script.Script(options.script)
    parser.keep({**vars(options), "model": loaded.source})
    with ExitStack() as kept:
        if options.data is not None:
            kept.enter_context(library.data_in(options.data))
            loaded.has_data = True
        if options.window:
            tell(playing.check_mods(loaded))
            source = EMPTY if loaded.task_count else loaded.source  # tasks open their models themselves
            failures = in_window(models.load(source), file_of(source), lesson=loaded)
        elif loaded.task_count:
            playing.check_mods(loaded)
            kept.enter_context(library.data_in())
            failures = check_lesson(loaded)
        else:
            session = playing.session_of(loaded)
            follow(session.simulation.progress)
            tell(session.notice)
            if not loaded.has_data:  # so that it ends alike however often it is played
                kept.enter_context(library.data_in())
            with progress.not_kept(), spoken(loaded.language or asked_language() or ENGLISH):
                failures = playing.play(loaded, session)
    found = {
        "script": options.script,
        "lines": len(loaded.lines) - 1,
        "failures": [{**vars(failure), "got": str(failure.got)} for failure in failures],
    }
    for failure in failures:
        tell(f"{options.script} {failure}")
    write_result(options, found, _rows, _lines)
    return NOT_ANSWERED if failures else ANSWERED


def _rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """The expectations that failed."""
    yield "script", "line", "expected", "got"
    yield from ((found["script"], *failure.values()) for failure in found["failures"])


def _lines(found: Mapping[str, Any]) -> Iterator[str]:
    played = {"script": found["script"], "lines": found["lines"]}
    if not found["failures"]:
        yield tr("{script}: {lines} lines, all as expected", **played)
        return
    yield plural(
        "{script}: {lines} lines, one expectation failed",
        "{script}: {lines} lines, {count} expectations failed",
        len(found["failures"]),
        **played,
    )
