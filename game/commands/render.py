"""`pinjoint render`: pictures of models for screens and reports, and their runs as GIFs."""

from __future__ import annotations

import argparse
import io
import math
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from pinjoint import pictures
from pinjoint.commands.analysis import FOUND
from pinjoint.commands.arguments import Parser, UsageError, flag, option, positive
from pinjoint.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    add_envelope,
    add_model,
    add_steps,
    add_theory,
    path_of,
    session_of,
)
from pinjoint.commands.output import writable, writing
from pinjoint.components.bent import MOMENT
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.view import drawn_places
from pinjoint.documents.models import replace
from pinjoint.documents.shapes import numbered
from pinjoint.editor.view_model import exaggerate
from pinjoint.session import Session
from pinjoint.streams import tell
from pinjoint.systems.base import DEFAULT_LIMIT
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.render.labels.placing import Placed
from pinjoint.systems.render.theme import load_theme, theme_names

_PICTURES = (".png", ".svg", ".pdf", ".gif", ".jpg", ".bmp")
_CLEAR = (".png", ".svg", ".pdf")  # those that may be without a background
FRAME = 0.05  # s for which each picture is shown; viewers of GIFs slow down quicker ones
LONGEST = 12.0  # s shown; a longer run to a time is shown faster, one until rest in part and at its end
HELD = 1.5  # s for which the last picture stays
_COLOURS = 128


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    options = _parser().parse_args(words)
    width, height = _size(options.size)
    if Path(options.output).suffix.lower() not in _PICTURES:
        raise UsageError(
            "{file}: choose a file that ends with one of {endings}.",
            file=f"--output {options.output}",
            endings=", ".join(_PICTURES),
        )
    _check_background(options)
    animated = options.output.lower().endswith(".gif")
    if options.static and animated:
        raise UsageError(
            "{option} and {other} exclude each other; leave out one of the two.",
            option="--static",
            other=".gif",
        )
    session = session_of(options)
    session.view.all_diagrams = options.diagrams or options.diagrams_of is not None
    session.view.quantity = options.diagrams_of or session.view.quantity
    session.view.utilisation = options.utilisation
    if options.plain:
        session.view.has_scale = False
        session.model.delete(list(session.model.grids))
    draw = _animate if animated else _draw
    with writing(options.output):
        status = draw(session, options, (width, height))
    if status in FOUND:
        return ANSWERED
    tell(session.document.statics.message if options.static else session.simulation.message)
    return NOT_ANSWERED


def _parser() -> Parser:
    parser = Parser("render", "Draw a model, or its run as a GIF, to a file.")
    add_model(parser)
    option(
        parser,
        "--output FILE",
        "the file to write: .png, .svg or .pdf, or .gif to show the run",
        writable,
        required=True,
    )
    option(
        parser,
        "--size WIDTHxHEIGHT",
        "the size in pixels; default 1280x800; type grows with it",
        default="1280x800",
    )
    flag(parser, "--until-rest", "run until at rest first (the default of a .gif)", apart=("--static",))
    option(parser, "--at T", "run to this time (s) first", positive, apart=("--static", "--until-rest"))
    add_steps(parser, "--static")
    flag(
        parser,
        "--static",
        "draw the static equilibrium, from the undeformed beginning, by the theory of the model or --theory",
    )
    add_theory(parser, None)
    undeformed = parser.add_mutually_exclusive_group()
    option(
        undeformed,
        "--undeformed",
        "with --static: draw the undeformed structure, and its deflected shape thin (the usual way)",
        action="store_true",
        default=None,
        beside="--static",
    )
    option(
        undeformed,
        "--deformed",
        "with --static: draw the deformed structure, with its diagrams",
        action="store_false",
        dest="undeformed",
        default=None,
        beside="--static",
    )
    flag(parser, "--diagrams", "draw all force diagrams")
    option(
        parser,
        "--diagrams-of",
        "draw all diagrams of one quantity: the axial force N, or where rods bend the bending moment M or the shear"
        " force V",
        choices=DIAGRAMS,
    )
    flag(parser, "--utilisation", "colour rods by utilisation: force over strength")
    shape = parser.add_mutually_exclusive_group()
    option(shape, "--mechanism N", "also draw the Nth mechanism: a motion that stretches no rod", int)
    option(
        shape,
        "--mode N",
        "also draw the Nth natural mode, 1 the lowest; of the loaded structure if it is at rest",
        int,
    )
    flag(shape, "--collapse", "also draw the mechanism of collapse by limit analysis")
    option(shape, "--buckling-mode N", "also draw the Nth buckling mode, 1 the lowest", int)
    option(
        shape,
        "--influence NAME",
        "also draw an influence line: of AB, AB.start, AB.end, AB.shear, AB.M@1.5 (also N, V; 50 %), A.y or B.rotation",
    )
    add_envelope(parser, "--static")
    option(parser, "--theme", "the colours; default light", choices=theme_names(), default="light")
    option(
        parser,
        "--background",
        "the background, for pictures in reports; default theme",
        choices=("theme", "white", "transparent"),
        default="theme",
    )
    flag(parser, "--plain", "leave out the grid, the scale and what is said of scales")
    parser.add_argument("--limit", type=positive, default=DEFAULT_LIMIT, help=argparse.SUPPRESS)
    return parser


def _check_background(options: argparse.Namespace) -> None:
    """Raise UsageError where a background does not go with a format or a theme."""
    background, suffix = options.background, Path(options.output).suffix.lower()
    if background != "theme" and suffix == ".gif":
        raise UsageError(
            "--background {background}: a .gif always has the background of its theme; leave out --background.",
            background=background,
        )
    if background == "transparent" and suffix not in _CLEAR:
        raise UsageError(
            "--background transparent: a {ending} cannot be transparent; choose one of {endings}.",
            ending=suffix,
            endings=", ".join(_CLEAR),
        )
    if background == "white" and max(load_theme(options.theme).background[:3]) < 128:  # of 255
        raise UsageError(
            "--background white: the theme {theme} has light text, which cannot be read on white; choose a light theme.",
            theme=options.theme,
        )


def _solve(session: Session, options: argparse.Namespace) -> str:
    """Show the static equilibrium in place of the state; returns its status."""
    if options.theory is not None:
        session.model.settings.theory = options.theory
    if options.undeformed is not None:
        session.model.settings.original_diagrams = options.undeformed
    session.scenes.request("statics")
    session.scenes.apply(session)
    settlement = session.document.statics.settlement
    return settlement.status if settlement is not None else "limit reached"


def _show_shape(session: Session, options: argparse.Namespace) -> None:
    """Draw the mechanism or mode that the options ask for. Raises NoShape if there is none with that number."""
    for kind in ("mechanism", "mode", "buckling mode"):
        if (number := getattr(options, kind.replace(" ", "_"))) is not None:
            session.document.shapes.show(numbered(session.model, kind, number))
    if options.collapse:
        session.document.shapes.show(numbered(session.model, "collapse", 1))
    if options.influence is not None:
        from pinjoint.documents.influence import Influence  # it imports scipy

        session.document.shapes.show(Influence.of(session.model, options.influence)[0].shape(session.model))


def _draw(session: Session, options: argparse.Namespace, size: tuple[int, int]) -> str:
    status = "time reached"
    if options.static:
        status = _solve(session, options)
        path = path_of(options, session.model)
        session.view.envelope = path is not None
        session.view.path = tuple(session.rods[name] for name in path or ())
        if session.view.envelope and options.diagrams_of is None:
            session.view.quantity = MOMENT
    elif options.until_rest:
        status = session.run(until="rest", limit=options.limit)
    elif options.at is not None:
        status = session.run(time=options.at)
    _show_shape(session, options)
    pictures.render(session, options.output, size, options.theme, options.background)
    return status


def _animate(session: Session, options: argparse.Namespace, size: tuple[int, int]) -> str:
    """Write a run as a GIF, at the pace at which a window shows it; returns its status."""
    from PIL import Image

    _show_shape(session, options)
    until = None if options.until_rest or options.at is None else session.time + options.at
    status, moments = _run(session, until, options.limit)
    exaggerate(session)
    places = []
    for moment in moments:
        moment.restore(session.model)
        places.append(drawn_places(session.model))
    around, images = np.concatenate(places), []
    placed: Placed = {}
    for moment in moments:
        moment.restore(session.model)
        image = Image.fromarray(pictures.frame(session, size, options.theme, around, placed))
        images.append(image.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE))
    durations = [round(1000 * FRAME)] * (len(images) - 1) + [round(1000 * HELD)]
    made = io.BytesIO()
    images[0].save(made, "GIF", save_all=True, append_images=images[1:], duration=durations, loop=0)
    replace(options.output, made.getvalue())
    return status


def _run(session: Session, until: float | None, limit: float) -> tuple[str, list[Snapshot]]:
    """The status at the end of the run, and the states of the pictures."""
    moments = [Snapshot.take(session.model)]
    status = "time reached"
    for begin, end in pairwise(_times(session, until, limit)):
        status = session.run(time=end - begin)
        moments.append(Snapshot.take(session.model))
        if status != "time reached":
            return status, moments
    if until is None:  # the rest of a run that takes longer than is shown
        status = session.run(until="rest", limit=limit)
        moments.append(Snapshot.take(session.model))
    return status, moments


def _times(session: Session, until: float | None, limit: float) -> Iterator[float]:
    """The simulated times of the pictures (s)."""
    begin, most = session.time, math.floor(LONGEST / FRAME)
    step = FRAME * natural_pace(session.model)
    if until is None:
        count = min(most, math.ceil(limit / step))
    else:
        count = max(min(most, math.ceil((until - begin) / step)), 1)
        step = (until - begin) / count
    yield from (begin + number * step for number in range(count + 1))


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch("([0-9]{2,5})x([0-9]{2,5})", text)
    width, height = map(int, found.groups()) if found else (0, 0)
    if width not in pictures.SIDES or height not in pictures.SIDES:
        raise UsageError(
            "--size {size}: write width x height in pixels, such as 1280x800, each from 16 to 16384.", size=text
        )
    return width, height
