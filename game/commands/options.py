"""Options that several commands have, and what they mean."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from functools import partial

from components.settings import INTEGRATORS
from game.commands.arguments import Parser, UsageError, count, numbers, positive, times, writable
from game.commands.reports.report import Analysis
from game.paths.overrides import apply_override
from game.session import DEFAULT_LIMIT, Session
from systems.base import System
from systems.program.cores import VARIABLE

ANSWERED, NOT_ANSWERED, NO_DISPLAY = 0, 1, 3  # exit statuses; BAD_INPUT is 2


def use_cores_as_asked(words: Sequence[str]) -> list[str]:
    """Let the option --cores N, which every command has, say how many cores to use; returns the other words."""
    parser = Parser(prog="pinjoint", add_help=False, allow_abbrev=False)
    parser.add_argument("--cores", type=partial(count, least=1), metavar="N")
    options, others = parser.parse_known_args(list(words))
    if options.cores is not None:
        os.environ[VARIABLE] = str(options.cores)  # for this process and those that it starts
    return others


def add_model(parser: argparse.ArgumentParser) -> None:
    """The model, and what is changed in it first."""
    parser.add_argument("model", help="a model file, or the name of a bundled model")
    parser.add_argument("--integrator", metavar="NAME", help=f"one of {', '.join(INTEGRATORS)}")
    parser.add_argument("--time-step", type=positive, metavar="S", help="fixed time step in seconds")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        help="change the model first, such as particles.B.force=120,-160 or rods.*.damping=0",
    )


def session_of(options: argparse.Namespace, systems: Iterable[System] = ()) -> Session:
    """A session with the model of `add_model`, and further systems. Raises ModelError, OverrideError, FieldError."""
    session = Session.open(options.model, systems)
    if session.notice:  # data of mods that are not loaded, which would change the result
        print(f"pinjoint: {session.notice}", file=sys.stderr)
    for override in options.set:
        apply_override(session.model, override)
    if options.integrator is not None:
        session.settings.integrator = options.integrator
    if options.time_step is not None:
        session.settings.time_step = options.time_step
    return session


def add_analysis(parser: argparse.ArgumentParser) -> None:
    """What is asked of a model: its equilibria, its state at certain times, or its state at rest."""
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--until-rest", action="store_true", help="run until nothing moves (the default)")
    how.add_argument(
        "--static", action="store_true", help="equilibrium by settling, not by running through time"
    )
    how.add_argument("--at", metavar="T1,T2,…", help="report the state at exactly these times (s)")
    parser.add_argument("--load-factors", metavar="F1,F2,…", help="with --static: settle at each in turn")
    parser.add_argument(
        "--limit",
        type=positive,
        default=DEFAULT_LIMIT,
        metavar="SECONDS",
        help="simulated time to wait for rest",
    )


def analysis_of(options: argparse.Namespace) -> Analysis:
    """The analysis of `add_analysis`. Raises UsageError."""
    factors = numbers("--load-factors", options.load_factors) if options.load_factors is not None else None
    if factors is not None and not options.static:
        raise UsageError("--load-factors goes with --static; add it.")
    return Analysis(
        load_factors=(factors or (1.0,)) if options.static else None,
        times=times(options.at) if options.at is not None else None,
        limit=options.limit,
    )


def add_output(parser: argparse.ArgumentParser) -> None:
    """Where the result goes."""
    parser.add_argument(
        "--output", type=writable, metavar="FILE", help="write to a file instead of standard output"
    )
