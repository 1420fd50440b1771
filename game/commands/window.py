"""`pinjoint [MODEL]`: the window."""

from __future__ import annotations

import textwrap
from argparse import RawDescriptionHelpFormatter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pinjoint.commands.arguments import Parser, UsageError, option
from pinjoint.commands.language import asked_units
from pinjoint.commands.options import ANSWERED, NO_DISPLAY
from pinjoint.commands.output import writable, writing
from pinjoint.commands.with_mods import in_use
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import LANGUAGES, tr
from pinjoint.components.model import Model
from pinjoint.components.units import PRESETS, show_in
from pinjoint.components.wording import nearest
from pinjoint.documents import models
from pinjoint.documents.open_documents import ModelFile, file_of
from pinjoint.documents.preferences import preferred
from pinjoint.scripts import script
from pinjoint.scripts.lines import Failure
from pinjoint.systems.render.theme import theme_names
from pinjoint.version import __version__


def _epilog() -> str:
    """The commands, the options that all have, and the bundled models."""
    width = max(map(len, EXTENSIONS.commands))
    paragraphs = [
        tr(
            "Every command also takes --mods DIR, to load the mods in a folder; --no-mods, to leave out your mods;"
            " --cores N, to use at most N processor cores; --language {languages}; and --units UNITS, for numbers on screen:"
            " {presets}, or a list such as “m, N, mm displacement, 5 digits”.",
            languages="|".join(LANGUAGES),
            presets=", ".join(map(repr, PRESETS)),
        ),
        tr("Bundled models: {names}", names=", ".join(models.bundled())),
    ]
    return "\n".join(
        [
            tr("commands (each with --help):"),
            *(
                f"  {name.ljust(width)}  {tr(EXTENSIONS.commands[name].about)}".rstrip()
                for name in sorted(EXTENSIONS.commands)
            ),
            *(f"\n{textwrap.fill(paragraph, 78)}" for paragraph in paragraphs),
        ]
    )


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    for word in words[:1]:
        near = nearest(word, EXTENSIONS.commands, cutoff=0.75)
        if near and word not in models.bundled() and not Path(word).exists():
            raise UsageError("There is no command '{word}'; did you mean '{near}'?", word=word, near=near)
    parser = Parser(
        "",
        "A laboratory for particles, trusses and frames.",
        epilog=_epilog(),
        formatter_class=RawDescriptionHelpFormatter,
    )
    option(parser, "model", "a model file, or the name of a bundled model", nargs="?")
    option(parser, "--record FILE", "record the session to this file, for: pinjoint play FILE", writable)
    option(parser, "--theme", "the colours; default: those used last", choices=theme_names())
    option(
        parser,
        "--version",
        "show program's version number and exit",
        action="version",
        version=f"pinjoint {__version__}",
    )
    options = parser.parse_args(words)
    source = options.model or script.NEW
    model, file = models.load(source), file_of(source)
    with writing(options.record):
        in_window(model, file, options.theme, record=(options.record, source))
    return ANSWERED


def in_window(model: Model, file: ModelFile, theme: str | None = None, **further: Any) -> list[Failure]:
    """Show a model until the window is closed; returns the failed expectations of the script that was played."""
    try:
        from pinjoint.app import NoDisplay, open_window
    except ImportError as error:
        message = tr("The window needs pygame-ce, which cannot be imported: {error}. Install it.", error=error)
        raise UsageError(message, NO_DISPLAY) from None
    try:
        if not asked_units():
            show_in(preferred("units"))
        with in_use():
            return open_window(model, file, theme, **further)
    except NoDisplay as error:
        raise UsageError(
            "No window can be opened: {error}. Without a display, use: pinjoint run MODEL,"
            " or pinjoint play SCRIPT without --window.",
            NO_DISPLAY,
            error=error,
        ) from None
