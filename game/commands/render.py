"""`pinjoint render`: pictures of models for screens and reports, and their runs as GIFs."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

from components.bent import QUANTITIES
from game import pictures
from game.commands.arguments import Parser, UsageError, positive
from game.commands.options import ANSWERED, NOT_ANSWERED, add_model, session_of
from game.commands.output import writable, writing
from game.commands.reports.report import FOUND
from game.documents.shapes import numbered
from game.session import DEFAULT_LIMIT, Session
from systems.render.theme import load_theme, theme_names

_PICTURES = (".png", ".svg", ".pdf", ".gif", ".jpg", ".bmp")
_CLEAR = (".png", ".svg", ".pdf")  # those that may be without a background
_LIGHT = 128  # of 255: themes with a darker background are not made for white paper


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(prog="pinjoint render", description="Draw a model, or its run as a GIF, without a display.")
    add_model(parser)
    parser.add_argument(
        "--output",
        type=writable,
        required=True,
        metavar="FILE",
        help="a .png, .svg or .pdf, or a .gif that shows the run",
    )
    parser.add_argument("--size", default="1280x800", metavar="WIDTHxHEIGHT", help="pixels")
    parser.add_argument("--until-rest", action="store_true", help="run until at rest first (a GIF's default)")
    parser.add_argument("--at", type=positive, metavar="T", help="run to this time (s) first")
    parser.add_argument("--diagrams", action="store_true", help="show all force diagrams")
    parser.add_argument(
        "--diagrams-of",
        choices=QUANTITIES,
        help="show all diagrams, where rods bend of the axial force N, the bending moment M or the shear V",
    )
    parser.add_argument(
        "--utilisation", action="store_true", help="colour rods by the share of their strength that they bear"
    )
    shape = parser.add_mutually_exclusive_group()
    shape.add_argument("--mechanism", type=int, metavar="N", help="draw a motion that elongates no rod over it")
    shape.add_argument(
        "--mode",
        type=int,
        metavar="N",
        help="draw a natural mode over it, 1 the lowest; at rest, that under load",
    )
    shape.add_argument(
        "--buckling-mode", type=int, metavar="N", help="draw a mode in which it gives way over it, 1 the lowest"
    )
    parser.add_argument("--theme", choices=theme_names(), default="light", help="colours")
    parser.add_argument(
        "--background",
        choices=("theme", "white", "transparent"),
        default="theme",
        help="of a picture for a report",
    )
    parser.add_argument("--limit", type=positive, default=DEFAULT_LIMIT, help=argparse.SUPPRESS)
    options = parser.parse_args(words)
    width, height = _size(options.size)
    if Path(options.output).suffix.lower() not in _PICTURES:
        raise UsageError(f"--output {options.output}: write a file that ends with {' or '.join(_PICTURES)}.")
    _check_background(options)
    session = session_of(options)
    session.view.all_diagrams = options.diagrams or options.diagrams_of is not None
    session.view.quantity = options.diagrams_of or session.view.quantity
    session.view.utilisation = options.utilisation
    draw = _animate if options.output.lower().endswith(".gif") else _draw
    with writing(options.output, "--output"):
        status = draw(session, options, (width, height))
    return ANSWERED if status in FOUND else NOT_ANSWERED


def _check_background(options: argparse.Namespace) -> None:
    """Raise UsageError where a background does not go with a format or a theme."""
    background, suffix = options.background, Path(options.output).suffix.lower()
    if background != "theme" and suffix == ".gif":
        raise UsageError(f"--background {background}: the run in a .gif has that of its theme; leave it out.")
    if background == "transparent" and suffix not in _CLEAR:
        raise UsageError(f"--background transparent: a {suffix} has none; write a {' or '.join(_CLEAR)}.")
    if background == "white" and max(load_theme(options.theme).background[:3]) < _LIGHT:
        raise UsageError(
            f"--background white: the texts of the theme {options.theme} are light; choose a theme for light paper."
        )


def _show_shape(session: Session, options: argparse.Namespace) -> None:
    """Draw the mechanism or mode that the options ask for. Raises NoShape if there is none with that number."""
    for kind in ("mechanism", "mode", "buckling mode"):
        if (number := getattr(options, kind.replace(" ", "_"))) is not None:
            session.document.shapes.show(numbered(session.model, kind, number))


def _draw(session: Session, options: argparse.Namespace, size: tuple[int, int]) -> str:
    status = "time reached"
    if options.until_rest:
        status = session.run(until="rest", limit=options.limit)
    elif options.at is not None:
        status = session.run(time=options.at)
    _show_shape(session, options)
    pictures.render(session, options.output, size, options.theme, options.background)
    return status


def _animate(session: Session, options: argparse.Namespace, size: tuple[int, int]) -> str:
    from game.commands.animation import render_gif

    _show_shape(session, options)
    until = None if options.until_rest or options.at is None else session.time + options.at
    return render_gif(session, options.output, size, options.theme, until=until, limit=options.limit)


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch("([0-9]{2,5})x([0-9]{2,5})", text)
    width, height = map(int, found.groups()) if found else (0, 0)
    if not (16 <= width <= 16384 and 16 <= height <= 16384):
        raise UsageError(f"--size {text}: write it like 1280x800, each from 16 to 16384 pixels.")
    return width, height
