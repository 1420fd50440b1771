"""Options that several commands share, and the sessions and analyses made of them."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from pinjoint.commands.analysis import Analysis
from pinjoint.commands.arguments import Parser, UsageError, count, flag, numbers, option, positive, times
from pinjoint.commands.progress import Progress, follow
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import beyond
from pinjoint.components.settings import INTEGRATORS
from pinjoint.components.theory import EXACT, THEORIES
from pinjoint.components.wording import missing
from pinjoint.documents import models
from pinjoint.documents.format import ModelError, missing_mods
from pinjoint.paths import apply_override
from pinjoint.streams import tell
from pinjoint.systems.base import CORES, DEFAULT_LIMIT, System, cores

if TYPE_CHECKING:  # statics needs no session
    from pinjoint.headless import Headless
    from pinjoint.session import Session

ANSWERED, NOT_ANSWERED, NO_DISPLAY, STOPPED = 0, 1, 3, 130  # exit statuses; BAD_INPUT is 2


def use_cores_as_asked(words: Sequence[str]) -> list[str]:
    """Read the option --cores N, which every command has, into the environment; returns the other words. Raises Mistake."""
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("--cores", type=partial(count, least=1), metavar="N")
    options, others = parser.parse_known_args(list(words))
    if options.cores is not None:
        os.environ[CORES] = str(options.cores)  # for this process and those that it starts
    cores()
    return others


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the argument MODEL and the options that change the model before anything is computed."""
    option(parser, "model", "a model file, or the name of a bundled model")
    option(
        parser, "--combination NAME", "let a combination of load cases of its settings act, or one case alone"
    )
    option(
        parser,
        "--set PATH=VALUE",
        "change a value of the model first, such as particles.B.force=120,-160 or rods.*.damping=0;"
        " may be given several times",
        action="append",
        default=[],
    )


def add_steps(parser: argparse.ArgumentParser, *apart: str) -> None:
    """Add the options of how time passes; apart: options with which none does."""
    how = tr("how to step through time: {names}", names=", ".join(INTEGRATORS))
    option(parser, "--integrator NAME", how, apart=apart)
    option(parser, "--time-step S", "use a fixed time step, in seconds", positive, apart=apart)


def changes(options: argparse.Namespace) -> list[str]:
    """What the options change of a model, as overrides."""
    named = {name: getattr(options, name, None) for name in ("integrator", "time_step", "combination")}
    return [*(f"settings.{name}={value}" for name, value in named.items() if value is not None), *options.set]


def session_of(options: argparse.Namespace, systems: Iterable[System] = ()) -> Session:
    """A session with the model of `add_model`, and further systems. Raises ModelError, PathError, FieldError."""
    from pinjoint.session import Session

    session = Session.open(options.model, systems)
    _prepare(session.model, options, session.simulation.progress)
    return session


def headless_of(options: argparse.Namespace) -> Headless:
    """Likewise without scenes, for which only systems of mods may ask."""
    if any(mod.loaded and not mod.included for mod in EXTENSIONS.mods):
        return session_of(options)
    from pinjoint.headless import Headless

    session = Headless.open(options.model)
    _prepare(session.model, options, session.simulation.progress)
    return session


def model_of(options: argparse.Namespace) -> Model:
    """The model of `add_model`, for what no time passes in. Raises ModelError, PathError, FieldError."""
    model = models.load(options.model)
    _prepare(model, options)
    return model


def _prepare(model: Model, options: argparse.Namespace, *progress: Progress) -> None:
    """Tell how far a run of the model is, and change it as the options ask."""
    follow(*progress)
    tell(missing_mods(model))  # which would change the result
    for override in changes(options):
        apply_override(model, override)
    if problem := beyond(model):
        raise ModelError(joined([f"{options.model}:", problem]))


def add_theory(parser: argparse.ArgumentParser, default: str | None = EXACT) -> None:
    """Add the option of the theory of statics; default: None where it says nothing by itself."""
    option(
        parser,
        "--theory",
        tr(
            "the theory of statics: first-order, about the original shape, or exact, about the deformed one; default"
            " {default}",
            default=default or EXACT,
        ),
        choices=THEORIES,
        default=default,
        beside="" if default else "--static",
    )


def add_analysis(parser: argparse.ArgumentParser) -> None:
    """Add the options of the analysis: equilibria, the state at certain times, or the state at rest."""
    how = parser.add_mutually_exclusive_group()
    flag(how, "--until-rest", "run until nothing moves (the default)")
    flag(how, "--static", "find the equilibrium directly, without running through time")
    option(how, "--at T1,T2,…", "report the state at exactly these times (s)")
    option(
        parser,
        "--load-factors F1,F2,…",
        "with --static: find the equilibrium at each of these load factors, one after the other",
        beside="--static",
    )
    add_theory(parser, None)
    add_steps(parser, "--static")
    option(
        parser,
        "--limit SECONDS",
        "stop waiting for rest after this much simulated time",
        positive,
        default=DEFAULT_LIMIT,
        apart=("--static", "--at"),
    )


def add_envelope(parser: argparse.ArgumentParser, beside: str = "") -> None:
    """Add the options of envelopes in statics, of combinations or of a force along a path."""
    flag(
        parser,
        "--envelope",
        "of statics: the least and the most in all combinations of load cases",
        beside=beside,
    )
    option(
        parser,
        "--path ROD",
        "the same while a force, settings.moving_force, moves along these rods",
        nargs="+",
        beside=beside,
    )


def path_of(options: argparse.Namespace, model: Model) -> list[str] | None:
    """The rods along which a force moves, of which the envelope is wanted; []: that of combinations; None: none.

    Raises UsageError for unknown ones.
    """
    if unknown := [name for name in options.path or () if name not in model.rods]:
        raise UsageError(missing(marked("rods"), unknown[0], model.rods.names))
    return options.path or ([] if options.envelope else None)


def analysis_of(options: argparse.Namespace) -> Analysis:
    """The analysis of `add_analysis`. Raises UsageError."""
    factors = numbers("--load-factors", options.load_factors) if options.load_factors is not None else None
    return Analysis(
        load_factors=(factors or (1.0,)) if options.static else None,
        times=times(options.at) if options.at is not None else None,
        limit=options.limit,
        theory=options.theory or EXACT,
    )
