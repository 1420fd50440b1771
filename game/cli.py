"""The command line: `pinjoint [MODEL]` opens the window; subcommands work without one."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from components.field import FieldError
from components.model import Model
from components.settings import INTEGRATORS
from components.spelling import nearest
from game import __version__, bench, models
from game.arguments import (
    BAD_INPUT,
    Parser,
    UsageError,
    count,
    finite,
    numbers,
    positive,
    times,
    writable,
    write,
)
from game.desk import ModelFile, file_of
from game.mods import ModError, command
from game.mods.command import load_as_asked
from game.mods.safety import in_use
from game.overrides import OverrideError, apply_override
from game.registry import COMMANDS
from game.reports.curve import as_csv as as_curve
from game.reports.report import FOUND, Analysis, AnalysisError
from game.reports.results import ResultError, as_csv, as_json, as_table
from game.saved import library
from game.scripts import script
from game.session import DEFAULT_LIMIT, Session
from game.shapes import NoShape, numbered
from game.sweeps import SweepError, sweep
from game.sweeps.variation import FORMS
from systems.render.theme import theme_names

ANSWERED, NOT_ANSWERED, NO_DISPLAY = 0, 1, 3

_PICTURES = (".png", ".gif", ".jpg", ".bmp")
_FORMATS = {"table": as_table, "json": as_json, "csv": as_csv}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # standard output is for results
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        words = load_as_asked(words)
        command = words[0] if words and words[0] in COMMANDS else "open"
        status = COMMANDS[command](words[1:] if command in words[:1] else words)
        write("", None)  # what is still on its way there
        return status
    except (
        UsageError,
        models.ModelError,
        OverrideError,
        FieldError,
        script.ScriptError,
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


# --- opening the window ----------------------------------------------------------------------------------


def _refuse_misspelt(word: str) -> None:
    """Refuse a word that is no model but nearly a command. Raises UsageError."""
    near = nearest(word, COMMANDS, cutoff=0.75)
    if near and word not in models.bundled() and not Path(word).exists():
        raise UsageError(f"There is no command '{word}'; did you mean '{near}'?")


def _open(words: Sequence[str]) -> int:
    if words:
        _refuse_misspelt(words[0])
    parser = Parser(
        prog="pinjoint",
        description="A laboratory for particles and pin-jointed structures.",
        epilog=f"commands: {', '.join(sorted(COMMANDS))} (each with --help). Every command takes --mods DIR, for mods"
        " in a folder, and --no-mods, to leave yours out. Bundled models: " + ", ".join(models.bundled()),
    )
    parser.add_argument("model", nargs="?", help="a model file, or the name of a bundled model")
    parser.add_argument(
        "--record", type=writable, metavar="FILE", help="write what you do to a script for: pinjoint play"
    )
    parser.add_argument("--theme", choices=theme_names(), help="colours; default: those that were used last")
    parser.add_argument("--version", action="version", version=f"pinjoint {__version__}")
    options = parser.parse_args(words)
    source = options.model or script.EMPTY
    model, file = models.load(source), file_of(source)
    try:
        _in_window(model, file, options.theme, record=(options.record, source))
    except OSError as error:
        raise UsageError(
            f"{options.record} cannot be written: {error.strerror}. Choose another --record."
        ) from None
    return ANSWERED


def _in_window(model: Model, file: ModelFile, theme: str | None = None, **further: Any) -> list[script.Failure]:
    """Show a model until the window is closed; returns what a script that was played expected in vain."""
    try:
        from game.app import NoDisplay, open_window
    except ImportError as error:
        raise UsageError(
            f"The window needs pygame-ce, which cannot be imported: {error}.", NO_DISPLAY
        ) from None
    try:
        with in_use():
            return open_window(model, file, theme, **further)
    except NoDisplay as error:
        raise UsageError(
            f"No window can be opened: {error}. Without a display, use: pinjoint run MODEL,"
            " or pinjoint play SCRIPT without --window.",
            NO_DISPLAY,
        ) from None


# --- running without a window ------------------------------------------------------------------------------


def _run(words: Sequence[str]) -> int:
    parser = Parser(
        prog="pinjoint run", description="Compute a model without a window and print what came of it."
    )
    _add_model(parser)
    _add_analysis(parser)
    parser.add_argument("--format", choices=tuple(_FORMATS), default="table")
    _add_output(parser)
    parser.add_argument("--events", type=writable, metavar="FILE", help="write all impacts to a file, as CSV")
    parser.add_argument(
        "--measure-error",
        action="store_true",
        help="measure the error by a run with finer steps, even if that takes long",
    )
    options = parser.parse_args(words)
    session = _session(options)
    run = replace(_analysis(options), measures_error=options.measure_error).run_in(session, options.model)
    write(_FORMATS[options.format](run), options.output)
    if options.events is not None:
        write(session.impacts.as_csv(), options.events)
    return ANSWERED if run["status"] in FOUND else NOT_ANSWERED


def _add_analysis(parser: argparse.ArgumentParser) -> None:
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


def _analysis(options: argparse.Namespace) -> Analysis:
    factors = numbers("--load-factors", options.load_factors) if options.load_factors is not None else None
    if factors is not None and not options.static:
        raise UsageError("--load-factors goes with --static; add it.")
    return Analysis(
        load_factors=(factors or (1.0,)) if options.static else None,
        times=times(options.at) if options.at is not None else None,
        limit=options.limit,
    )


def _add_model(parser: argparse.ArgumentParser) -> None:
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


def _add_output(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--output", type=writable, metavar="FILE", help="write to a file instead of standard output"
    )


def _session(options: argparse.Namespace) -> Session:
    session = Session.open(options.model)
    for override in options.set:
        apply_override(session.model, override)
    if options.integrator is not None:
        session.settings.integrator = options.integrator
    if options.time_step is not None:
        session.settings.time_step = options.time_step
    return session


# --- theory beside the simulation --------------------------------------------------------------------------


def _verify(words: Sequence[str]) -> int:
    parser = Parser(
        prog="pinjoint verify",
        description="Simulation run to rest, linear theory and exact theory side by side, with their differences.",
    )
    _add_model(parser)
    parser.add_argument(
        "--influence",
        nargs="+",
        metavar="NAME",
        help="influence lines instead: of a rod AB, a reaction A.y, or a displacement B.y (unit-load method)",
    )
    parser.add_argument("--theory-only", action="store_true", help="without the simulation")
    parser.add_argument(
        "--limit", type=positive, default=DEFAULT_LIMIT, metavar="SECONDS", help="simulated time for rest"
    )
    parser.add_argument("--format", choices=("table", "json"), default="table")
    _add_output(parser)
    options = parser.parse_args(words)
    session = _session(options)
    from game.reports import verify
    from systems.statics.events import NoEquilibrium
    from systems.statics.force_method import ForceMethodError

    try:
        if options.influence:
            found = verify.influence(session.model, options.influence)
        else:
            found = verify.verify(session, options.model, options.limit, simulate=not options.theory_only)
    except (ForceMethodError, NoEquilibrium) as error:
        raise UsageError(str(error), NOT_ANSWERED if isinstance(error, NoEquilibrium) else BAD_INPUT) from None
    write(as_json(found) if options.format == "json" else verify.as_table(found), options.output)
    return ANSWERED if found.get("status") != verify.NOT_VERIFIED else NOT_ANSWERED


# --- sweeps ------------------------------------------------------------------------------------------------


def _sweep(words: Sequence[str]) -> int:
    parser = Parser(
        prog="pinjoint sweep",
        description="Compute many variants of a model; one that fails is recorded with its reason.",
    )
    _add_model(parser)
    _add_analysis(parser)
    add = parser.add_argument
    add("--vary", action="append", required=True, metavar="PATH=…", help=FORMS)
    add("--measure", action="append", required=True, metavar="PATH,…", help="such as rods.CD.plastic_strain")
    add("--output", required=True, metavar="FILE", help="results.csv or results.parquet")
    add("--plot", metavar="FILE.png", help="draw the measures against what is varied first")
    add("--samples", type=int, metavar="N", help="how many are drawn from distributions (~)")
    add("--seed", type=int, default=0, metavar="N", help="of what is drawn; default 0")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", type=int, metavar="N", help="processes on this machine; default: as many as suit"
    )
    where.add_argument("--scheduler", metavar="tcp://…", help="compute on a running Dask cluster")
    options = parser.parse_args(words)
    from game.sweeps.progress import ProgressBar
    from game.sweeps.results import check_output

    if options.plot is not None:
        check_output(Path(options.plot), [".png"])
    overrides = [*options.set]
    if options.integrator is not None:
        overrides.append(f"settings.integrator={options.integrator}")
    if options.time_step is not None:
        overrides.append(f"settings.time_step={options.time_step}")
    try:
        results = sweep(
            options.model,
            options.vary,
            options.measure,
            _analysis(options),
            overrides=overrides,
            samples=options.samples,
            seed=options.seed,
            output=options.output,
            workers=options.workers,
            scheduler=options.scheduler,
            progress=ProgressBar(sys.stderr),
        )
        if options.plot is not None:
            results.plot(options.plot)
    except KeyboardInterrupt:
        print("\nInterrupted; the same command goes on with what is finished.", file=sys.stderr)
        raise
    except OSError as error:
        raise UsageError(
            f"{error.filename or options.output} cannot be written: {error.strerror}. Choose another file."
        ) from None
    counts = results.counts()
    why = "" if set(counts) <= set(FOUND) else "; its column 'message' says why"
    print(f"{options.output}: {', '.join(f'{count} {status}' for status, count in counts.items())}{why}")
    return ANSWERED if any(status in FOUND for status in counts) else NOT_ANSWERED


# --- load–displacement curves --------------------------------------------------------------------------------


def _curve(words: Sequence[str]) -> int:
    parser = Parser(
        prog="pinjoint curve",
        description="Load–displacement curve as CSV: equilibria while the load grows, and falls where it must.",
    )
    _add_model(parser)
    goal = parser.add_mutually_exclusive_group()
    goal.add_argument(
        "--factor", type=finite, default=1.0, help="end where the load factor first reaches this; default 1"
    )
    goal.add_argument(
        "--until", metavar="B.y=-2.5", help="end where a particle first has this displacement (m)"
    )
    parser.add_argument("--points", type=count, default=500, metavar="N", help="at most so many equilibria")
    _add_output(parser)
    options = parser.parse_args(words)
    session = _session(options)
    try:
        found = session.load_path(options.factor, until=options.until, points=options.points)
    except ValueError as error:
        raise UsageError(str(error)) from None
    write(as_curve(session.model, found), options.output)
    if not found.complete:
        print(f"pinjoint: The curve ends at the load factor {found.load_factor[-1]:.6g}.", file=sys.stderr)
    return ANSWERED if found.complete else NOT_ANSWERED


# --- force method ------------------------------------------------------------------------------------------


def _force_method(words: Sequence[str]) -> int:
    parser = Parser(prog="pinjoint force-method", description="Hyperstatic forces by the force method.")
    parser.add_argument("model", help="a model file, or the name of a bundled model")
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--release", metavar="AC", help="a rod, or a constraint such as A.y")
    which.add_argument("--all", action="store_true", help="release unknowns until the structure is isostatic")
    parser.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", help="change the model first"
    )
    _add_output(parser)
    options = parser.parse_args(words)
    model = models.load(options.model)
    for override in options.set:
        apply_override(model, override)
    from game.force_method.report import force_method
    from systems.statics.force_method import ForceMethodError

    try:
        found = force_method(model, None if options.all else options.release)
    except ForceMethodError as error:
        raise UsageError(str(error)) from None
    write(json.dumps(found, indent=2, ensure_ascii=False) + "\n", options.output)
    return ANSWERED


# --- scripted sessions -------------------------------------------------------------------------------------


def _play(words: Sequence[str]) -> int:
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
        help="where it saves and loads: without a window in an empty folder that is gone afterwards, else in yours",
    )
    options = parser.parse_args(words)
    loaded = script.Script(options.script)
    with ExitStack() as kept:
        if options.data is not None:
            kept.enter_context(library.data_in(options.data))
        if options.window:
            failures = _in_window(models.load(loaded.source), file_of(loaded.source), lesson=loaded)
        else:
            session = loaded.open()
            if options.data is None:  # so that it ends alike however often it is played
                kept.enter_context(library.data_in(Path(kept.enter_context(TemporaryDirectory()))))
            failures = loaded.play(session)
    for failure in failures:
        print(f"{options.script} {failure}", file=sys.stderr)
    failed = f"{len(failures)} expectation{'s' if len(failures) > 1 else ''} failed"
    found = failed if failures else "all as expected"
    print(f"{options.script}: {len(loaded.lines) - 1} lines, {found}")
    return NOT_ANSWERED if failures else ANSWERED


# --- pictures ----------------------------------------------------------------------------------------------


def _render(words: Sequence[str]) -> int:
    parser = Parser(
        prog="pinjoint render",
        description="Draw a model, or its run as a GIF, without a display.",
    )
    _add_model(parser)
    parser.add_argument(
        "--output", type=writable, required=True, metavar="FILE", help="a .png, or a .gif that shows the run"
    )
    parser.add_argument("--size", default="1280x800", metavar="WIDTHxHEIGHT", help="pixels")
    parser.add_argument("--until-rest", action="store_true", help="run until at rest first (a GIF's default)")
    parser.add_argument("--at", type=positive, metavar="T", help="run to this time (s) first")
    parser.add_argument("--diagrams", action="store_true", help="show all force diagrams")
    shape = parser.add_mutually_exclusive_group()
    shape.add_argument("--mechanism", type=int, metavar="N", help="draw a motion that elongates no rod over it")
    shape.add_argument("--mode", type=int, metavar="N", help="draw a natural mode over it, 1 the lowest")
    parser.add_argument("--theme", choices=theme_names(), default="light", help="colours")
    parser.add_argument("--limit", type=positive, default=DEFAULT_LIMIT, help=argparse.SUPPRESS)
    options = parser.parse_args(words)
    width, height = _size(options.size)
    if Path(options.output).suffix.lower() not in _PICTURES:
        raise UsageError(f"--output {options.output}: write a file that ends with {' or '.join(_PICTURES)}.")
    session = _session(options)
    session.view.all_diagrams = options.diagrams
    _show_shape(session, options)
    try:
        if options.output.lower().endswith(".gif"):
            status = _animate(session, options, (width, height))
        else:
            status = _draw(session, options, (width, height))
    except OSError as error:
        raise UsageError(
            f"{options.output} cannot be written: {error.strerror or error}. Choose another --output."
        ) from None
    return ANSWERED if status in FOUND else NOT_ANSWERED


def _show_shape(session: Session, options: argparse.Namespace) -> None:
    """Raises NoShape if there is none with that number."""
    for kind in ("mechanism", "mode"):
        if (number := getattr(options, kind)) is not None:
            session.desk.shapes.show(numbered(session.model, kind, number))


def _draw(session: Session, options: argparse.Namespace, size: tuple[int, int]) -> str:
    from game.app import render_png

    status = "time reached"
    if options.until_rest:
        status = session.run(until="rest", limit=options.limit)
    elif options.at is not None:
        status = session.run(time=options.at)
    render_png(session, options.output, size, options.theme)
    return status


def _animate(session: Session, options: argparse.Namespace, size: tuple[int, int]) -> str:
    from game.animation import render_gif

    until = None if options.until_rest or options.at is None else session.time + options.at
    return render_gif(session, options.output, size, options.theme, until=until, limit=options.limit)


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and 16 <= int(width) <= 16384 and 16 <= int(height) <= 16384):
        raise UsageError(f"--size {text}: write it like 1280x800, each from 16 to 16384 pixels.")
    return int(width), int(height)


# --- benchmarks --------------------------------------------------------------------------------------------


def _bench(words: Sequence[str]) -> int:
    parser = Parser(prog="pinjoint bench", description="Measure, against peers in the same run.")
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"any of {', '.join(bench.NAMES)}; default all"
    )
    parser.add_argument("--quick", action="store_true", help="smaller sizes; ends within a minute")
    parser.add_argument("--output", metavar="DIR", help="also write CSV files and pictures there")
    options = parser.parse_args(words)
    for name in options.names:
        if name not in bench.NAMES:
            raise UsageError(f"There is no benchmark '{name}'; choose from {', '.join(bench.NAMES)}.")
    for name in options.names or bench.NAMES:
        try:
            tables = bench.run(name, quick=options.quick)
        except bench.NoBenchmarks as error:
            raise UsageError(str(error)) from None
        print(f"== {name} ==\n{bench.as_text(tables)}")
        if options.output:
            try:
                bench.write(name, tables, Path(options.output))
            except OSError as error:
                raise UsageError(f"{options.output} cannot be written: {error.strerror}.") from None
    return ANSWERED


# --- mods --------------------------------------------------------------------------------------------------


def _mods(words: Sequence[str]) -> int:
    parser = Parser(prog="pinjoint mods", description="Extensions of the program; see assets/mods/README.md.")
    return command.run(words, parser, __version__)


COMMANDS |= {
    "open": _open,
    "run": _run,
    "render": _render,
    "bench": _bench,
    "play": _play,
    "verify": _verify,
    "curve": _curve,
    "force-method": _force_method,
    "mods": _mods,
    "sweep": _sweep,
}
