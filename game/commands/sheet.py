"""`pinjoint sheet`: a structure and its static solution on paper."""

from __future__ import annotations

from collections.abc import Sequence

from pinjoint.commands.arguments import Parser, option
from pinjoint.commands.options import ANSWERED, add_model, add_theory, model_of
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
    options = parser.parse_args(words)
    from pinjoint.sheet import sheet  # it imports reportlab and scipy

    write(sheet(model_of(options), options.theory), options.output)
    return ANSWERED
