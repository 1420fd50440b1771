"""Sheet: a structure and its static solution on paper: drawing, diagrams, deflected shape, and tables of all results."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from reportlab.platypus import Flowable, KeepTogether

from pinjoint.components.bent import AXIAL
from pinjoint.components.language import joined, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.figures import diagram_titles, figure, printed, shape, signs
from pinjoint.force_method.copies import base_structure, still
from pinjoint.results import Results
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.render.backends.paper import LAYOUTS, Block, Layout, as_paper, in_rows
from pinjoint.systems.statics.force_method import SetState
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import Start
from pinjoint.tables import Column, Table

_FLAT = 1.6  # times as wide as high: of such structures each figure has a row of its own
_BESIDE = 20  # rods up to which their table stands beside figures
_LARGER = 1.2  # type in figures, that of reports being 1
_MOVED = ("displacement", "rotation", "deflection")  # what begins so is told of the deformed structure


class NoSheet(Mistake, ValueError):
    """A structure without a static solution; the message gives the reason."""


def sheet(model: Model, theory: str = FIRST_ORDER) -> bytes:
    """The sheet of a model, solved from its undeformed beginning, as a PDF file. Raises NoSheet, FieldError."""
    with model.own_state():  # the mode of statics shows another solution, from which none begins
        solved = Solved(model, theory)
        return as_paper(solved.title, partial(contents, solved), f"Pinjoint · {solved.title}", LAYOUTS[:2])


class Solved:
    """A model, its static solution, and copies that show it: `straight` on the original shape, `moved` on the deformed."""

    def __init__(self, model: Model, theory: str) -> None:
        self.model, self.first_order = model, theory == FIRST_ORDER
        self.title = tr(model.title) if model.title else tr("Structure")
        if not model.rods.count:
            raise NoSheet("The model has no rods, so there is no structure to solve.")
        rods = model.rods
        strain = rods.plastic_strain if model.clock.time == 0.0 else np.zeros(rods.count)
        settlement = settle(model, theory=theory, start=Start.undeformed(model, strain))
        final = settlement.final
        if not final.balanced:
            raise NoSheet("There is no sheet without an equilibrium. {reason}", reason=settlement.message)
        _, note = settlement.beside(left_out_of_statics(model))
        self.said = joined([settlement.message, note])
        self.state = SetState(
            final.displacement,
            final.rotation,
            final.axial_force,
            final.diagrams["bending_moment"] * np.array([-1.0, 1.0]),
            np.column_stack([final.reaction, final.reaction_moment]),
        ).without_rounding(rods.rest_length)
        self.results = self._results()

    def copy(self, *, moved: bool = False) -> Model:
        """A copy that shows the solution."""
        return still(base_structure(self.model, []), self.model, self.state, moved=moved)

    def _results(self) -> Results:
        """The tables; in first-order theory those of forces are of the original shape."""
        moved = Results.of(self.copy(moved=True), first_order=self.first_order)
        if not self.first_order:
            return moved
        straight = Results.of(self.copy(), first_order=True)
        return replace(
            straight,
            rods=_merged(straight.rods, moved.rods),
            particles=_merged(straight.particles, moved.particles),
        )


def _merged(straight: Table, moved: Table) -> Table:
    """A table with the columns of displacements from another one."""
    columns = [
        other if other.key.startswith(_MOVED) else own
        for own, other in zip(straight.columns, moved.columns, strict=True)
    ]
    return Table(straight.corner, straight.names, columns)


def contents(solved: Solved, layout: Layout) -> list[Flowable]:
    """What the sheet consists of, from the top to the bottom."""
    model, results = solved.model, solved.results
    wide, high = shape(model)
    draw = partial(figure, layout, row=1 if wide > _FLAT * high else 2, unit=_LARGER)
    theory = tr("Statics by first-order theory: equilibrium about the original shape.")
    if not solved.first_order:
        theory = tr("Statics in exact geometry: equilibrium of the deformed shape.")
    figures = [draw(solved.copy(), tr("Dimensions (m), supports and loads"), measured=True)]
    for quantity, title in diagram_titles().items():
        if bends(model) or quantity == AXIAL:
            figures.append(draw(solved.copy(), title, diagrams=quantity))
    figures.append(draw(solved.copy(moved=True), tr("Deflected shape"), moved=True))
    tables = {
        tr("Rods"): _members(layout, model),
        tr("Forces in rods"): printed(layout, results.rods),
        tr("Joints"): printed(layout, results.particles),
        tr("Sums"): printed(layout, results.sums),
    }
    below = [(layout.text(title, "heading"), blocks) for title, blocks in tables.items()]
    if model.rods.count <= _BESIDE:
        title, [(width, parts), *_] = below.pop(0)
        figures.append((width, [title, *parts]))
    return [
        layout.text(solved.title, "title"),
        layout.text(f"{theory} {signs(model)}", "subtitle"),
        *([layout.text(solved.said)] if solved.said else []),
        *in_rows(figures),
        *(part for title, blocks in below for part in _under(title, blocks)),
    ]


def _under(heading: Flowable, blocks: list[Block]) -> list[Flowable]:
    """Tables below each other under a heading; short ones are not parted by pages."""
    parts = [part for _, some in blocks for part in some]
    return [KeepTogether([heading, *parts])] if len(blocks) == 1 else [heading, *parts]


def _members(layout: Layout, model: Model) -> list[Block]:
    """What the rods are: their ends, sections, lengths and stiffnesses."""
    rods, names = model.rods, model.particles.names
    stiff = np.where(rods.bending_stiffness > 0.0, rods.bending_stiffness, np.nan)
    columns = [("L", "m", rods.rest_length), ("EA", "kN", rods.stiffness), ("EI", "kN·m²", stiff)]
    numbers = Table(
        tr("rod"), rods.names, [Column(*column, alike=False) for column in columns[: 2 + bends(model)]]
    )
    between = [" – ".join(names[row] for row in both) for both in rods.between.tolist()]
    sections = [
        joined([section, material], ", ") for section, material in zip(rods.section, rods.material, strict=True)
    ]
    texts = {tr("ends"): between} | ({tr("section"): sections} if any(sections) else {})
    return printed(layout, numbers, texts=texts)
