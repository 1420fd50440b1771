"""`pinjoint sheet`: a structure and its static solution on paper."""

from __future__ import annotations

from collections.abc import Sequence

from pinjoint.commands.arguments import Parser, UsageError, option
from pinjoint.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    add_envelope,
    add_model,
    add_theory,
    model_of,
    path_of,
)
from pinjoint.commands.output import writable, write
from pinjoint.components.theory import FIRST_ORDER


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "sheet", "Write a PDF with a drawing of a structure, its diagrams, its deflected shape, and tables."
    )
    add_model(parser)
    option(parser, "--output FILE", "the PDF to write", writable, required=True)
    add_theory(parser, FIRST_ORDER)
    option(parser, "--influence NAME", "draw influence lines, too: see verify --help", nargs="+", default=())
    add_envelope(parser)
    options = parser.parse_args(words)
    from pinjoint.documents.influence import Influence  # it imports scipy
    from pinjoint.sheet import sheet  # it imports reportlab
    from pinjoint.systems.statics.events import NoEquilibrium

    model = model_of(options)
    try:
        lines = Influence.of(model, *options.influence) if options.influence else []
    except NoEquilibrium as error:
        raise UsageError(str(error), NOT_ANSWERED) from None
    shapes = [line.shape(model) for line in lines]
    write(sheet(model, options.theory, shapes, path_of(options, model)), options.output)
    return ANSWERED
