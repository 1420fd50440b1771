"""Sheet: a structure and its static solution on paper: drawing, diagrams, deflected shape, and tables of all results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from reportlab.platypus import CondPageBreak, Flowable, KeepTogether

from pinjoint.collapse_steps import collapse_steps
from pinjoint.components.bent import AXIAL
from pinjoint.components.cases import acting
from pinjoint.components.language import begun, joined, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.view import Shape
from pinjoint.documents.models import document, load
from pinjoint.documents.shapes import collapse_shapes
from pinjoint.documents.statics import Statics
from pinjoint.figures import diagram_titles, figure, printed, shape, signs
from pinjoint.results import Results, envelope_of_reactions, envelope_of_rods
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.render.backends.paper import LAYOUTS, Block, Layout, as_paper, in_rows
from pinjoint.systems.statics.state import Start
from pinjoint.tables import Column, Table

_BESIDE = 20  # rods up to which their table stands beside figures
_SHORT, _BEGUN = 24, 100.0  # rows of tables that pages do not part; points for the beginning of another
BEFORE = 1e-6  # of the collapse load: a sheet of a structure that collapses shows it by so much less


class NoSheet(Mistake, ValueError):
    """A structure without a static solution; the message gives the reason."""


def sheet(
    model: Model, theory: str = FIRST_ORDER, shapes: Sequence[Shape] = (), path: Sequence[str] | None = None
) -> bytes:
    """The sheet of a model, solved from its undeformed beginning, as a PDF file. Raises NoSheet.

    shapes: drawn over it, too, such as modes and influence lines. path: of rods, along which a force moves whose envelope is
    drawn; (): that of all combinations, or ValueError.
    """
    solved = Solved(model, theory, path)
    return as_paper(
        solved.title, partial(contents, solved, shapes=shapes), f"Pinjoint · {solved.title}", LAYOUTS[:2]
    )


class Solved:
    """A copy of a model that shows its static solution, whatever the model shows, with the tables of it."""

    def __init__(self, model: Model, theory: str, path: Sequence[str] | None = None) -> None:
        self.title = tr(model.title) if model.title else tr("Structure")
        if not model.rods.count:
            raise NoSheet("The model has no rods, so there is no structure to solve.")
        self.model = copy = load(document(model))
        copy.settings.theory = theory
        copy.delete(list(copy.grids))
        permanent = Start.present(copy).permanent * (copy.clock.time == 0.0)
        statics = Statics(copy, lambda: permanent)
        settlement = statics.settlement
        collapsed = settlement if settlement is not None and settlement.status == "collapse" else None
        if collapsed is not None:  # what it bears just before is an equilibrium
            steps, factor = copy.settings.load_steps, collapsed.final.load_factor
            copy.settings.load_steps = (*steps[: len(collapsed.states) - 1], (1.0 - BEFORE) * factor)
            settlement = statics.settlement
        if settlement is None or not statics.balanced:
            reason = statics.message
            raise NoSheet("There is no sheet without an equilibrium. {reason}", reason=reason)
        _, note = settlement.beside(left_out_of_statics(copy))
        limit = statics.limit_load
        self.said = joined(
            [(collapsed or settlement).message, note, *([limit.message, limit.divides(copy)] if limit else [])]
        )
        self.collapse = collapse_shapes(copy, limit) if limit else []
        self.steps = collapse_steps(copy, limit) if limit and theory == FIRST_ORDER else None
        copy.show(statics)
        self.results = Results.of(copy)
        self.envelope = None if path is None else statics.envelope(path=path)


def contents(solved: Solved, layout: Layout, shapes: Sequence[Shape] = ()) -> list[Flowable]:
    """What the sheet consists of, from the top to the bottom."""
    model, results = solved.model, solved.results
    wide, high = shape(model)
    draw = partial(figure, layout, model, row=1 if wide > 1.6 * high else 2, unit=1.2, grows=True)
    theory = tr("Statics by first-order theory: equilibrium about the original shape.")
    if not model.first_order:
        theory = tr("Statics in exact geometry: equilibrium of the deformed shape.")
    told = acting(model)
    figures = [draw(tr("Dimensions (m), supports, loads and reactions"), measured=True)]
    for quantity, title in diagram_titles().items():
        if bends(model) or quantity == AXIAL:
            figures.append(draw(title, diagrams=quantity, bare=True))
    figures.append(draw(tr("Deflected shape"), moved=True, bare=True))
    known = {over.title for over in solved.collapse}
    for over in (*solved.collapse, *(over for over in shapes if over.title not in known)):
        figures.append(draw(over.title, bare=True, over=replace(over, title="") if over.swings else over))
    if (envelope := solved.envelope) is not None:
        for quantity, title in diagram_titles().items():
            if bends(model) or quantity == AXIAL:
                caption = f"{begun(envelope.said)}: {title}"
                figures.append(draw(caption, diagrams=quantity, enveloped=envelope))
    large = [block for block in figures if block[1][0].fills_page]
    tables = {
        tr("Rods"): _members(layout, solved),
        tr("Forces in rods"): printed(layout, results.rods),
        tr("Joints"): printed(layout, results.particles),
        tr("Sums"): printed(layout, results.sums),
    }
    if envelope is not None:
        tables[tr("Envelope")] = printed(layout, envelope_of_rods(model, envelope))
        tables[tr("Envelope of reactions")] = printed(layout, envelope_of_reactions(model, envelope))
    if solved.steps is not None:
        tables[tr("Hinge by hinge")] = printed(layout, solved.steps)
    below = [(layout.text(title, "heading"), blocks) for title, blocks in tables.items()]
    if model.rods.count <= _BESIDE:
        title, [(width, parts), *_] = below.pop(0)
        figures.append((width, [title, *parts]))
    return [
        layout.text(solved.title, "title"),
        layout.text(
            joined([theory, signs(model), told and tr("What acts: {acting}.", acting=told)]), "subtitle"
        ),
        *([layout.text(solved.said)] if solved.said else []),
        *in_rows([block for block in figures if block not in large]),
        *(part for title, blocks in below for part in _under(title, blocks)),
        *(part for _, parts in large for part in parts),
    ]


def _under(heading: Flowable, blocks: list[Block]) -> list[Flowable]:
    """Tables below each other under a heading; short ones are not parted by pages."""
    parts = [part for _, some in blocks for part in some]
    if len(blocks) == 1 and len(parts[0]._cellvalues) <= _SHORT:
        return [KeepTogether([heading, *parts])]
    heading.keepWithNext = False  # else what fits on one page is begun on a new one
    return [CondPageBreak(_BEGUN), heading, *parts]


def _members(layout: Layout, solved: Solved) -> list[Block]:
    """What the rods are: their ends, sections, lengths and stiffnesses."""
    rods, names = solved.model.rods, solved.results.particles.names
    stiff = np.where(rods.bending_stiffness > 0.0, rods.bending_stiffness, np.nan)
    columns = [("L", "m", rods.rest_length), ("EA", "kN", rods.stiffness), ("EI", "kN·m²", stiff)]
    shown = [Column(*column, alike=False) for column in columns[: 2 + bends(solved.model)]]
    numbers = Table(tr("rod"), solved.results.rods.names, shown)
    between = [" – ".join(names[row] for row in both) for both in rods.between.tolist()]
    sections = [
        joined([section, material], ", ") for section, material in zip(rods.section, rods.material, strict=True)
    ]
    texts = {tr("ends"): between} | ({tr("section"): sections} if any(sections) else {})
    return printed(layout, numbers, texts=texts)
