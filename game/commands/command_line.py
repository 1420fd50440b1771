"""The command line: `pinjoint [MODEL]` opens the window; subcommands, each in a module here, work without one."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

from pinjoint.commands import Command
from pinjoint.commands.arguments import BAD_INPUT
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED, STOPPED, use_cores_as_asked
from pinjoint.commands.output import write
from pinjoint.commands.with_mods import load_as_asked
from pinjoint.completion import complete
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import marked, tr
from pinjoint.components.mistake import Mistake, reason_of, wrong_variable
from pinjoint.documents.library import DATA_VARIABLE
from pinjoint.documents.preferences import CONFIG_VARIABLE
from pinjoint.mods.mod import switched_off
from pinjoint.streams import discard_output, tell


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # standard output is for results
    words = list(sys.argv[1:] if arguments is None else arguments)
    complete()
    try:
        for variable in (DATA_VARIABLE, CONFIG_VARIABLE):
            if Path(os.environ.get(variable, "")).is_file():
                raise wrong_variable(variable, tr("a folder"))
        words = load_as_asked(use_cores_as_asked(words))
        command = words[0] if words and words[0] in COMMANDS else "open"
        status = COMMANDS[command].run(words[1:] if command in words[:1] else words)
        if status == ANSWERED and command != "open" and switched_off():
            status = NOT_ANSWERED  # part of what was asked for was done without a mod, as standard error says
        write("", None)  # flushes standard output, while errors can still be told
        return status
    except Mistake as error:
        tell(str(error))
        return getattr(error, "status", BAD_INPUT)
    except KeyboardInterrupt:
        tell(tr("Interrupted."))
        return STOPPED
    except BrokenPipeError:  # the reader has seen enough, such as `head`
        discard_output()
        return NOT_ANSWERED
    except OSError as error:
        if error.filename is None:
            discard_output()
        place = error.filename or tr("Standard output")
        tell(tr("{file} cannot be read or written: {reason}.", file=place, reason=reason_of(error)))
        return BAD_INPUT


def _of(module: str) -> Callable[[list[str]], int]:
    """What runs a command; its module is imported only for it."""

    def run(words: list[str]) -> int:
        found: int = import_module(f"pinjoint.commands.{module}").command(words)
        return found

    return run


COMMANDS: dict[str, Command] = EXTENSIONS.commands
COMMANDS |= {
    "open": Command(_of("window"), marked("open a model in the window; the word may be left out")),
    "run": Command(_of("run"), marked("compute a model without a window, and print the result")),
    "verify": Command(_of("verify"), marked("compare a run with both theories; influence lines")),
    "curve": Command(_of("curve"), marked("compute a load–displacement curve, through limit points")),
    "buckling": Command(_of("buckling"), marked("find buckling loads, modes and effective lengths")),
    "force-method": Command(
        _of("force_method"), marked("solve an indeterminate structure by the force method")
    ),
    "displacement-method": Command(
        _of("displacement_method"), marked("solve a truss or a frame by the displacement method")
    ),
    "sheet": Command(_of("sheet"), marked("write a PDF with drawing, diagrams and tables")),
    "sweep": Command(_of("sweep"), marked("compute many variants of a model")),
    "plan": Command(_of("plan"), marked("list systems that run in a scene, and why others do not")),
    "render": Command(_of("render"), marked("draw a model, or its run, to a file")),
    "play": Command(_of("play"), marked("play a lesson or a recorded session")),
    "mods": Command(_of("mods"), marked("list and check mods (extensions), and write new ones")),
    "bench": Command(_of("bench"), marked("measure speed and accuracy")),
}
