"""The command line: `pinjoint [MODEL]` opens the window; subcommands, each in a module here, work without one."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from components.field import FieldError
from game.commands import (
    COMMANDS,
    Command,
    bench,
    curve,
    force_method,
    mods,
    plan,
    play,
    render,
    run,
    sweep,
    verify,
    window,
)
from game.commands.arguments import BAD_INPUT, UsageError
from game.commands.options import ANSWERED, NOT_ANSWERED, STOPPED, use_cores_as_asked
from game.commands.output import ResultError, write
from game.commands.reports.report import AnalysisError
from game.documents.document import ModelError
from game.documents.shapes import NoShape
from game.mods.heeding import switched_off
from game.mods.mod import ModError
from game.paths import PathError
from game.scripts.script import ScriptError
from game.streams import discard_output, tell
from game.sweeps import SweepError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # standard output is for results
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        words = mods.load_as_asked(use_cores_as_asked(words))
        command = words[0] if words and words[0] in COMMANDS else "open"
        status = COMMANDS[command].run(words[1:] if command in words[:1] else words)
        if status == ANSWERED and command != "open" and switched_off():
            status = NOT_ANSWERED  # part of what was asked for was done without a mod, as standard error says
        write("", None)  # flushes standard output, while errors can still be told
        return status
    except (
        UsageError,
        ModelError,
        PathError,
        FieldError,
        ScriptError,
        ModError,
        SweepError,
        NoShape,
        AnalysisError,
        ResultError,
    ) as error:
        tell(str(error))
        return getattr(error, "status", BAD_INPUT)
    except KeyboardInterrupt:
        tell("Interrupted.")
        return STOPPED
    except BrokenPipeError:  # the reader has seen enough, such as `head`
        discard_output()
        return NOT_ANSWERED
    except OSError as error:
        if error.filename is None:
            discard_output()
        place = error.filename or "Standard output"
        tell(f"{place} cannot be used: {error.strerror or error}.")
        return BAD_INPUT


COMMANDS |= {
    "open": Command(window.command, "show a model in the window, as without a command"),
    "run": Command(run.command, "compute a model without a window, and print the result"),
    "verify": Command(verify.command, "simulation beside linear and exact theory; influence lines"),
    "curve": Command(curve.command, "load–displacement curve, through limit points"),
    "force-method": Command(force_method.command, "hyperstatic forces by the force method"),
    "sweep": Command(sweep.command, "compute many variants of a model"),
    "plan": Command(plan.command, "which systems run in a scene with a model, and why others do not"),
    "render": Command(render.command, "draw a model, or its run, without a display"),
    "play": Command(play.command, "play a scripted session or a lesson"),
    "mods": Command(mods.command, "list, check and begin extensions"),
    "bench": Command(bench.command, "measure speed and accuracy"),
}
