"""Report: the whole solution by the force method on paper, as a teacher hands it out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from reportlab.platypus import Flowable

from components import written
from components.bent import AXIAL, MOMENT, SHEAR, is_frame
from components.camera import Camera, Viewport
from components.language import tr
from components.model import Model
from components.round_numbers import round_down
from components.tags import DiagramShown
from components.view import THESIS, View
from game.documents import models
from game.force_method import thesis, words
from game.force_method.copies import base_structure, loaded, still
from game.force_method.tables import PRODUCTS, Table, Tables
from game.force_method.words import EXACT, index
from systems.render.paper import (
    HALF,
    PIXEL,
    WIDTH,
    Figure,
    Matrices,
    as_paper,
    beside,
    gap,
    tables,
    text,
    together,
)
from systems.render.picture import compose
from systems.render.theme import load_theme
from systems.statics.counting import counted
from systems.statics.equations import largest
from systems.statics.external import external_forces
from systems.statics.released import SetState

_FULL, _HALF = int(WIDTH / PIXEL), int(HALF / PIXEL)  # pixels of figures
_LOW, _HIGH = 230, 400  # pixels, of their heights
_AROUND = 78.0  # pixels around a structure, for supports, loads and diagrams
_DIAGRAM = 34.0  # pixels of the largest axial force
_ROWS = 120  # of a table that are printed
_TERMS = 6  # of a sum that are written one by one
_BESIDE = 14  # rows of a table that stands beside a figure


def write_report(solved: Tables, path: str | Path, convention: str) -> None:
    """Write the report of a solution to a PDF file, as a whole or not at all. Raises OSError."""
    models.replace(Path(path), report(solved, convention))


def report(solved: Tables, convention: str) -> bytes:
    """The report of a solution as the contents of a PDF file."""
    title = _title(solved.model)
    return as_paper(title, contents(solved, convention), f"Pinjoint · {title}")


def _title(model: Model) -> str:
    return tr(model.title) if model.title else tr("Statically indeterminate structure")


def contents(solved: Tables, convention: str) -> list[Flowable]:
    """What the report of a solution consists of, from the top to the bottom."""
    return [
        text(_title(solved.model), "title"),
        text(
            tr("Force method, by first-order theory: linear elastic, equilibrium about the original shape."),
            "subtitle",
        ),
        *_structure(solved),
        *_released(solved),
        *(_of_thesis(solved) if convention == THESIS else [*_virtual_work(solved), *_compatibility(solved)]),
        *_forces(solved),
        *_checks(solved),
    ]


# --- figures -----------------------------------------------------------------------------------------


def _figure(model: Model, caption: str, width: int, *, diagrams: str | None = None) -> Figure:
    """A picture of a model, with the diagrams of a quantity."""
    model.delete(list(model.grids))
    box = np.ptp(model.particles.position, axis=0) if model.particles.count else np.ones(2)
    inner = width - 2 * _AROUND
    high = int(np.clip(inner * box[1] / max(box[0], 1e-12) + 2 * _AROUND, _LOW, _HIGH))
    view = View(legend=False, has_scale=False, all_diagrams=diagrams is not None, quantity=diagrams or AXIAL)
    view.camera = Camera(viewport=Viewport(0, 0, width, high))
    view.camera.fit(model.particles.position, _AROUND, view.camera.viewport, 1.0)
    pulled = 0.0 if is_frame(model) else largest(model.rods.axial_force)
    model.settings.diagram_scale = round_down(_DIAGRAM / pulled) if pulled > 0.0 else 1.0
    loaded_ones = [p for p in model.particles if any(p.force) or p.moment] + [
        one.particle for one in model.loads
    ]
    model.tag_only(loaded_ones, DiagramShown)
    theme = replace(load_theme("light"), background=(255, 255, 255, 255))
    return Figure(compose(model, view, theme), caption)


def _rows_of(figures: Sequence[Figure]) -> Iterator[Flowable]:
    """Two figures in a row."""
    for at in range(0, len(figures), 2):
        yield beside(figures[at : at + 1], figures[at + 1 : at + 2])


# --- sections ----------------------------------------------------------------------------------------


def _structure(solved: Tables) -> list[Flowable]:
    """The real structure and how often it is indeterminate."""
    model, count = solved.model, counted(solved.model)
    degree = f"{count.formula} = {count.numbers}"
    copy = base_structure(model, [])
    real = still(copy, model, _without_forces(solved.solution.real))
    figure = _figure(real, tr("The structure, its supports and its loads"), _HALF)
    said = [
        text(tr("Degree of static indeterminacy"), "text"),
        text(degree, "equation"),
        text(_counted(solved), "text"),
        text(words.degree_of(count.degree), "text"),
        gap(2),
        text(tr("Unknowns"), "text"),
        *(
            text(f"X{index(i + 1)}:  {words.meaning(unknown)}", "equation")
            for i, unknown in enumerate(solved.solution.unknowns)
        ),
    ]
    return [together(text(tr("1  Structure and unknowns"), "heading"), beside([figure], said))]


def _counted(solved: Tables) -> str:
    """What the letters of the formula count."""
    count = counted(solved.model)
    if count.hinges is None:
        return tr(
            "m = {rods} rods, r = {constraints} reactions, n = {nodes} joints",
            rods=count.rods,
            constraints=count.constraints,
            nodes=count.nodes,
        )
    return tr(
        "m = {rods} rods, r = {constraints} reactions, n = {nodes} joints, h = {hinges} hinges",
        rods=count.rods,
        constraints=count.constraints,
        nodes=count.nodes,
        hinges=count.hinges,
    )


def _without_forces(state: SetState) -> SetState:
    return replace(state, **{name: 0.0 * part for name, part in vars(state).items()})


def _released(solved: Tables) -> list[Flowable]:
    """The unknowns, and the released structure under the load and under each unknown."""
    solution, model = solved.solution, solved.model
    quantity, unit = (MOMENT, "kN·m") if solved.bends else (AXIAL, "kN")
    symbol = "M" if solved.bends else "N"
    unknowns = list(solution.unknowns)
    under_load = still(base_structure(model, unknowns), model, solution.base)
    figures = [
        _figure(
            under_load,
            tr("Released structure under the load: {force} ({unit})", force=f"{symbol}₀", unit=unit),
            _HALF,
            diagrams=quantity,
        )
    ]
    for i, state in enumerate(solution.units):
        alone = [float(i == j) for j in range(len(unknowns))]
        small = f"{symbol.lower()}{index(i + 1)}"
        figures.append(
            _figure(
                still(loaded(model, unknowns, alone), model, state),
                tr("Released structure under {unknown} = 1: {force}", unknown=f"X{index(i + 1)}", force=small),
                _HALF,
                diagrams=quantity,
            )
        )
    first, *others = _rows_of(figures)
    return [together(text(tr("2  Released structure"), "heading"), first), *others]


def _printed(table: Table, heading: Sequence[Flowable] = (), width: float = WIDTH) -> list[Flowable]:
    """A table on paper, with a note where it is longer than is printed."""
    head = [table.corner, *(f"{column.title}\n{column.unit}" for column in table.columns)]
    rows = table[1 : 1 + min(len(table.names), _ROWS)]
    if table.summed:
        rows.append(table[len(table) - 1])
    made = tables(head, rows, summed=table.summed, width=width)
    left_out = len(table.names) - _ROWS
    note = (
        [text(tr("{count} more rows are not printed; sums are of all.", count=left_out), "caption")]
        if left_out > 0
        else []
    )
    if width == WIDTH and len(rows) < 30:
        return [together(*heading, made[0]), *made[1:], *note]
    return [*heading, *made, *note]


def _virtual_work(solved: Tables) -> list[Flowable]:
    """Gaps and flexibilities as sums, rod by rod."""
    every = range(len(solved.solution.unknowns))
    formulas = [text(tr("3  Displacements by virtual work"), "heading")]
    formulas += [text(line, "equation") for line in _formulas(solved)]
    if len(every) > PRODUCTS:
        note = tr(
            "With more than {count} unknowns the products are not printed; only their sums are given below.",
            count=PRODUCTS,
        )
        return [*_printed(solved.forces(every), formulas), text(note, "caption")]
    found: list[Flowable] = []
    if solved.bends:
        found += _printed(solved.bending(every), [*formulas, text(tr("Bending moments"), "text")])
        ends = tr("M and M′ are the moments at both ends of a rod; qL²/8 is how far M bulges between them.")
        found.append(text(ends, "caption"))
        formulas = [text(tr("Axial forces"), "text")]
    found += _printed(solved.virtual_work(every), formulas)
    settlements = solved.settlements()
    if settlements is not None:
        found += _printed(settlements, [text(tr("Supports that have moved by c"), "text")])
    if solved.bends:
        found += [text(line, "equation") for i in every for line in solved.sums(i)]
    return found


def _formulas(solved: Tables) -> Iterator[str]:
    """What the sums are, for every pair of unknowns alike."""
    work, several = solved.work, len(solved.solution.unknowns) > 1
    n, m = "N₀ n₁ L/EA", "∫ M₀ m₁ dx/EI"
    gap = [m] * solved.bends + [f"Σ {n}"]
    if work.free.any():
        gap.append("Σ n₁ ΔL")
    if work.curvature.any():
        gap.append("∫ m₁ κ dx")
    if len(work.settled):
        gap.append("(− Σ r₁ c)")
    yield f"δ₁₀ = {' + '.join(gap)}"
    yield f"δ₁₁ = {'∫ m₁² dx/EI + ' if solved.bends else ''}Σ n₁² L/EA > 0"
    if several:
        yield f"δ₁₂ = δ₂₁ = {'∫ m₁ m₂ dx/EI + ' if solved.bends else ''}Σ n₁ n₂ L/EA"


def _compatibility(solved: Tables) -> list[Flowable]:
    """The equations with their numbers, and the unknowns."""
    solution, units = solved.solution, solved.units
    count = len(solution.unknowns)
    heading = text(tr("4  Compatibility"), "heading")
    said = text(tr("The unknowns close the gaps ({units}):", units=units.all), "text")
    results = [text(f"X{index(i + 1)} = {words.amount(solution, i)}", "result") for i in range(count)]
    if count == 1:
        [line] = words.equations(solution, units.all, units.factor)
        symbols, _, numbers = line.partition(":")
        equation, _, _ = numbers.rpartition("  (")
        return [
            together(heading, said, text(symbols, "equation"), text(equation.strip(), "equation"), *results)
        ]
    number = [
        [written.number(units.factor * value, EXACT) for value in row] for row in solution.flexibility.tolist()
    ]
    gaps = [[written.number(units.factor * value, EXACT)] for value in solution.gap.tolist()]
    held = [[written.number(units.factor * value, EXACT)] for value in solution.prescribed.tolist()]
    symbols_of = [[f"δ{index(i + 1, j + 1)}" for j in range(count)] for i in range(count)]
    unknowns = [[f"X{index(i + 1)}"] for i in range(count)]
    zeros = [[f"δ{index(i + 1, 0)}"] for i in range(count)]
    right = [[f"c{index(i + 1)}" if c else "0"] for i, c in enumerate(solution.prescribed.tolist())]
    lines: list[Flowable] = [Matrices([number, unknowns, "+", gaps, "=", held])]
    if count <= PRODUCTS:
        lines.insert(0, Matrices([symbols_of, unknowns, "+", zeros, "=", right]))
    symmetric = text(tr("The matrix is symmetric: δ₁₂ = δ₂₁ (Maxwell)."), "text")
    return [together(heading, said, *lines, symmetric, *results)]


def _of_thesis(solved: Tables) -> list[Flowable]:
    """The same in the thesis' convention."""
    lines = thesis.solved_lines(solved.solution)
    return [together(text(tr("3  Unknowns"), "heading"), *(text(line, "equation") for line in lines))]


def _forces(solved: Tables) -> list[Flowable]:
    """Superposition, and the forces in the real structure."""
    model, solution = solved.model, solved.solution
    quantities = (MOMENT, SHEAR, AXIAL) if solved.bends else (AXIAL,)
    titles = {
        AXIAL: tr("Axial forces N (kN)"),
        MOMENT: tr("Bending moments M (kN·m), on the side in tension"),
        SHEAR: tr("Shear forces V (kN)"),
    }
    figures = [
        _figure(
            still(base_structure(model, []), model, solution.superposed),
            titles[quantity],
            _HALF,
            diagrams=quantity,
        )
        for quantity in quantities
    ]
    heading = text(tr("5  Forces in the structure"), "heading")
    first, second = (solved.moments(), [solved.axial_forces()]) if solved.bends else (solved.axial_forces(), [])
    others = [*second, solved.reactions()]
    if len(first.names) > _BESIDE or len(solution.unknowns) > PRODUCTS:
        whole = [part for table in (first, *others) for part in _printed(table)]
        return [heading, *whole, *_rows_of(figures)]
    half = [part for table in others for part in _printed(table, width=HALF)]
    if solved.bends:
        return [together(heading, beside(_printed(first, width=HALF), half)), *_rows_of(figures)]
    return [together(heading, beside([*_printed(first, width=HALF), *half], figures))]


def _checks(solved: Tables) -> list[Flowable]:
    """Equilibrium of the whole, the gaps left, and the difference from linear theory."""
    solution, model = solved.solution, solved.model
    whole = solution.superposed
    lines = [f"{name} = {written.total(terms)}" for name, terms in _balance(model, whole)]
    left = solution.gap + solution.flexibility @ solution.force - solution.prescribed
    size = np.abs(solution.gap) + np.abs(solution.flexibility) @ np.abs(solution.force)
    share = float(np.divide(np.abs(left), size, out=np.zeros_like(left), where=size > 0.0).max(initial=0.0))
    off = largest(whole.axial_force - solution.real.axial_force)
    relative = off / max(largest(solution.real.axial_force), 1e-300)
    return [
        together(
            text(tr("6  Checks"), "heading"),
            text(tr("Loads and reactions of the whole structure are in equilibrium (kN, kN·m):"), "text"),
            *(text(line, "equation") for line in lines),
            text(
                tr("The compatibility equations hold to {share} of their largest terms.", share=_tiny(share)),
                "text",
            ),
            text(
                tr(
                    "The displacement method gives the same axial forces, to {share} of the largest.",
                    share=_tiny(relative),
                ),
                "text",
            ),
        )
    ]


def _tiny(value: float) -> str:
    return written.number(max(value, 1e-16), 1)


def _balance(model: Model, state: SetState) -> Iterator[tuple[str, list[float]]]:
    """Sums of loads and reactions, of moments about the first support; each force is a term where they are few."""
    load, (x, y) = external_forces(model).at(1.0), model.particles.position.T
    used = np.zeros(model.particles.count, dtype=bool)
    used[model.rods.between] = True
    held = np.flatnonzero(used & model.particles.fixed.any(axis=1))
    about = int(held[0]) if len(held) else 0
    for axis, name in enumerate(("ΣH", "ΣV", f"ΣM({model.particles.names[about]})")):
        terms: list[float] = []
        for forces in (load, state.reaction):
            if axis < 2:
                parts = forces[:, axis]
            else:
                parts = (x - x[about]) * forces[:, 1] - (y - y[about]) * forces[:, 0]
                parts = parts + forces[:, 2] if forces.shape[1] > 2 else parts
            parts = parts[used & (np.abs(parts) > written.ROUNDING * largest(parts))]
            terms += parts.tolist() if len(parts) <= _TERMS else [float(parts.sum())]
        size = largest(state.reaction)
        terms = [term for term in terms if abs(term) > written.ROUNDING * size]
        yield name, terms
