"""`pinjoint force-method`: hyperstatic forces by the force method."""

from __future__ import annotations

from collections.abc import Sequence

from game.commands.arguments import Parser, UsageError
from game.commands.options import ANSWERED
from game.commands.output import add_output, write_result
from game.documents import models
from game.paths import apply_override


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(prog="pinjoint force-method", description="Hyperstatic forces by the force method.")
    parser.add_argument("model", help="a model file, or the name of a bundled model")
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--release", metavar="AC", help="a rod, or a constraint such as A.y")
    which.add_argument("--all", action="store_true", help="release unknowns until the structure is isostatic")
    parser.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", help="change the model first"
    )
    add_output(parser, default="json")
    options = parser.parse_args(words)
    model = models.load(options.model)
    for override in options.set:
        apply_override(model, override)
    from game.force_method.report import force_method, force_method_rows
    from systems.statics.force_method import ForceMethodError

    try:
        found = force_method(model, None if options.all else options.release)
    except ForceMethodError as error:
        raise UsageError(str(error)) from None
    write_result(options, found, force_method_rows)
    return ANSWERED
