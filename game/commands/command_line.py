"""The command line: `pinjoint [MODEL]` opens the window; subcommands, each in a module here, work without one."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from components.field import FieldError
from game.commands import bench, curve, force_method, plan, play, render, run, sweep, verify, window
from game.commands.arguments import BAD_INPUT, Parser, UsageError, write
from game.commands.options import NOT_ANSWERED, use_cores_as_asked
from game.commands.reports.report import AnalysisError
from game.commands.reports.results import ResultError
from game.documents.document import ModelError
from game.editor.shapes import NoShape
from game.mods import ModError
from game.mods.command import load_as_asked
from game.mods.command import run as run_mods
from game.paths.overrides import OverrideError
from game.registry import ABOUT, COMMANDS
from game.scripts.script import ScriptError
from game.sweeps import SweepError
from game.version import __version__


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # standard output is for results
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        words = load_as_asked(use_cores_as_asked(words))
        command = words[0] if words and words[0] in COMMANDS else "open"
        status = COMMANDS[command](words[1:] if command in words[:1] else words)
        write("", None)  # what is still on its way there
        return status
    except (
        UsageError,
        ModelError,
        OverrideError,
        FieldError,
        ScriptError,
        ModError,
        SweepError,
        NoShape,
        AnalysisError,
        ResultError,
    ) as error:
        print(f"pinjoint: {error}", file=sys.stderr)
        return getattr(error, "status", BAD_INPUT)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # whoever reads has seen enough, such as `head`
        _drop_output()
        return NOT_ANSWERED
    except OSError as error:
        if error.filename is None:  # and not tried again on leaving
            _drop_output()
        place = error.filename or "Standard output"
        print(f"pinjoint: {place} cannot be used: {error.strerror or error}.", file=sys.stderr)
        return BAD_INPUT


def _drop_output() -> None:
    """Let what is still on its way to standard output go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _mods(words: Sequence[str]) -> int:
    """`pinjoint mods`, which game.mods answers."""
    parser = Parser(prog="pinjoint mods", description="Extensions of the program; see assets/mods/README.md.")
    return run_mods(words, parser, __version__)


COMMANDS |= {
    "open": window.command,
    "run": run.command,
    "render": render.command,
    "bench": bench.command,
    "play": play.command,
    "verify": verify.command,
    "curve": curve.command,
    "force-method": force_method.command,
    "plan": plan.command,
    "mods": _mods,
    "sweep": sweep.command,
}

ABOUT |= {
    "open": "show a model in the window, as without a command",
    "run": "compute a model without a window, and print what came of it",
    "verify": "simulation beside linear and exact theory; influence lines",
    "curve": "load–displacement curve, through limit points",
    "force-method": "hyperstatic forces by the force method",
    "sweep": "compute many variants of a model",
    "plan": "which systems run in a scene with a model, and why others do not",
    "render": "draw a model, or its run, without a display",
    "play": "play a scripted session or a lesson",
    "mods": "list, check and begin extensions",
    "bench": "measure speed and accuracy",
}
