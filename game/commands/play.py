"""`pinjoint play`: scripted sessions and lessons."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from game.commands.arguments import Parser
from game.commands.options import ANSWERED, NOT_ANSWERED
from game.commands.window import in_window
from game.documents import library, models
from game.documents.open_documents import file_of
from game.scripts import script


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint play",
        description="Play a recorded or written session, or a lesson, in the real program.",
        epilog=f"lessons: {', '.join(script.lessons())}",
    )
    parser.add_argument("script", metavar="SCRIPT", help="a file of JSON lines, or the name of a lesson")
    parser.add_argument(
        "--window", action="store_true", help="show it in a window, at a pace to follow, and go on from there"
    )
    parser.add_argument(
        "--data",
        type=Path,
        metavar="FOLDER",
        help="where it saves and loads; left out, in an empty folder that is gone afterwards",
    )
    options = parser.parse_args(words)
    loaded = script.Script(options.script)
    with ExitStack() as kept:
        if options.data is not None:
            kept.enter_context(library.data_in(options.data))
            loaded.has_data = True
        if options.window:
            failures = in_window(models.load(loaded.source), file_of(loaded.source), lesson=loaded)
        else:
            session = loaded.open()
            if not loaded.has_data:  # so that it ends alike however often it is played
                kept.enter_context(library.data_apart())
            failures = loaded.play(session)
    for failure in failures:
        print(f"{options.script} {failure}", file=sys.stderr)
    failed = f"{len(failures)} expectation{'s' if len(failures) > 1 else ''} failed"
    found = failed if failures else "all as expected"
    print(f"{options.script}: {len(loaded.lines) - 1} lines, {found}")
    return NOT_ANSWERED if failures else ANSWERED
