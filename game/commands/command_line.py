"""The command line: `pinjoint [MODEL]` opens the window; subcommands, each in a module here, work without one."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from importlib import import_module

from components.mistake import Mistake
from game.commands import COMMANDS, Command
from game.commands.arguments import BAD_INPUT
from game.commands.options import ANSWERED, NOT_ANSWERED, STOPPED, use_cores_as_asked
from game.commands.output import write
from game.commands.with_mods import load_as_asked
from game.mods.heeding import switched_off
from game.streams import discard_output, tell


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # standard output is for results
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
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


def _of(module: str) -> Callable[[list[str]], int]:
    """What runs a command; its module is imported only for it."""

    def run(words: list[str]) -> int:
        status: int = import_module(f"game.commands.{module}").command(words)
        return status

    return run


COMMANDS |= {
    "open": Command(_of("window"), "show a model in the window, as without a command"),
    "run": Command(_of("run"), "compute a model without a window, and print the result"),
    "verify": Command(_of("verify"), "simulation beside linear and exact theory; influence lines"),
    "curve": Command(_of("curve"), "load–displacement curve, through limit points"),
    "buckling": Command(_of("buckling"), "critical load factors, modes and effective lengths"),
    "force-method": Command(_of("force_method"), "hyperstatic forces by the force method"),
    "sweep": Command(_of("sweep"), "compute many variants of a model"),
    "plan": Command(_of("plan"), "which systems run in a scene with a model, and why others do not"),
    "render": Command(_of("render"), "draw a model, or its run, without a display"),
    "play": Command(_of("play"), "play a scripted session or a lesson"),
    "mods": Command(_of("mods"), "list, check and begin extensions"),
    "bench": Command(_of("bench"), "measure speed and accuracy"),
}
