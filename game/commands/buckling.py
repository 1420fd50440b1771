"""`pinjoint buckling`: critical load factors, the modes in which a structure gives way, and effective lengths."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from pinjoint.commands.arguments import Parser, UsageError, count, option
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED, add_model, add_theory, model_of
from pinjoint.commands.output import Row, add_output, aligned, write_result
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.theory import EXACT, FIRST_ORDER
from pinjoint.streams import tell
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.settle import settle


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "buckling",
        "The load factors at which the structure buckles, and how it moves then: by linear buckling, or from the exact"
        " equilibrium on.",
    )
    add_model(parser)
    option(parser, "--modes N", "find at most N modes; default 5", partial(count, least=1), default=5)
    add_theory(parser, FIRST_ORDER)
    add_output(parser)
    options = parser.parse_args(words)
    model = model_of(options)
    try:
        exact = options.theory == EXACT
        about = settle(model, model.settings.load_steps, EXACT).equilibrium if exact else None
        found = Buckling.of(model, options.modes, about)
    except NoEquilibrium as error:
        raise UsageError(str(error), NOT_ANSWERED) from None
    laws = left_out_of_statics(model)
    write_result(options, _data(model, found) | {"left_out": laws}, _rows, _lines)
    if laws:
        tell(tr("Buckling leaves out the laws of mods: {laws}.", laws=", ".join(laws)))
    if options.format != "table":
        tell(joined([found.message, *found.notes]))
    return ANSWERED if len(found.factors) and not found.coarse and not laws else NOT_ANSWERED


def _data(model: Model, found: Buckling) -> dict[str, Any]:
    """Buckling as plain data.

    factors: none where rods are too coarse for an answer; upper_bounds has what was found then, of the same modes.
    modes: {particle: [x, y, rotation]} of each factor. effective_length: {rod: m} of compressed rods that can bend, and
    effective_length_factor over the lengths of their members.
    axial_force: {rod: {"steady": kN, "factor 1": kN, "critical": kN}}, about an equilibrium along a line from there.
    """
    names, rods = model.particles.names, model.rods.names
    modes = np.zeros((len(found.modes), model.particles.count, 3))
    modes[:, :, : found.modes.shape[-1]] = found.modes
    lowest = found.factors[0] if len(found.factors) else 1.0
    forces = zip(found.dead.tolist(), found.live.tolist(), strict=True)
    lengths = {
        name: length
        for name, length in zip(rods, found.effective_length, strict=True)
        if length == length and not found.coarse
    }
    own = dict(zip(rods, found.member_length, strict=True))
    return {
        "factors": found.factors[:0] if found.coarse else found.factors,
        "upper_bounds": found.factors if found.coarse else found.factors[:0],
        "modes": [dict(zip(names, mode.tolist(), strict=True)) for mode in modes],
        "leading": [
            {"rod": rods[row], "effective_length": length if length == length and not found.coarse else None}
            for row, length in zip(found.leading, found.leading_length, strict=True)
        ],
        "effective_length": lengths,
        "effective_length_factor": {name: length / own[name] for name, length in lengths.items()},
        "axial_force": {
            name: {"steady": dead, "factor 1": live, "critical": dead + lowest * live}
            for name, (dead, live) in zip(rods, forces, strict=True)
        },
        "message": found.message,
        "notes": found.notes,
    }


def _rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """The modes as rows, one for every particle of each, headings first."""
    bounds = found["upper_bounds"]
    yield "mode", "upper_bound" if bounds else "factor", "particle", "x", "y", "rotation"
    for number, (factor, mode) in enumerate(
        zip(bounds or found["factors"], found["modes"], strict=True), start=1
    ):
        yield from ((number, factor, name, *motion) for name, motion in mode.items())


def _lines(found: Mapping[str, Any]) -> Iterator[str]:
    """Factors, with who moves most, and the compressed members at the lowest, to read."""
    factors = found["upper_bounds"] or found["factors"]
    if not factors:
        yield found["message"]
        return
    if found["upper_bounds"]:
        yield tr("These load factors are no answers but upper bounds, which may be far too high.")
    factor = tr("load factor, at most") if found["upper_bounds"] else tr("load factor")
    titles = [tr("buckling mode"), factor, tr("divided by the lowest"), tr("moves most")]
    rows: list[Row] = [[*titles, tr("most compressed"), tr("effective length, m")]]
    for number, (value, mode, by) in enumerate(
        zip(factors, found["modes"], found["leading"], strict=True), start=1
    ):
        most = max(mode, key=lambda name: max(map(abs, mode[name])))
        title, whose = tr("mode {number}", number=number), (by["rod"], by["effective_length"])
        rows.append([title, value, value / factors[0], most, *whose])
    yield from aligned(rows)
    pressed = {name: of for name, of in found["axial_force"].items() if of["critical"] < 0.0}
    if pressed:
        yield ""
        table: list[Row] = [
            [
                tr("axial force, kN"),
                tr("at load factor 1"),
                tr("at the lowest factor"),
                tr("effective length, m"),
                tr("divided by its own length"),
            ]
        ]
        for name, of in pressed.items():
            lengths = [found[key].get(name) for key in ("effective_length", "effective_length_factor")]
            table.append([name, of["steady"] + of["factor 1"], of["critical"], *lengths])
        yield from aligned(table)
    for note in found["notes"]:
        yield ""
        yield note
