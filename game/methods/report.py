"""Report: the whole solution by the force method on paper, as a teacher hands it out: on one page, if it fits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar

import numpy as np
from reportlab.platypus import Flowable, KeepTogether

from pinjoint.components import written
from pinjoint.components.bent import AXIAL, MOMENT
from pinjoint.components.language import listed, marked, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import supported
from pinjoint.components.rod import nodes, rigid_joints
from pinjoint.components.units import USUAL, shown_in
from pinjoint.components.view import THESIS, Cut
from pinjoint.figures import diagram_titles, figure, in_a_row, printed, signs
from pinjoint.methods import displacement_words, index, words
from pinjoint.methods.copies import base_structure, held, loaded, still, unloaded
from pinjoint.methods.displacements import DisplacementTables
from pinjoint.methods.tables import PRODUCTS, ForceTables, Tables
from pinjoint.methods.words import EXACT
from pinjoint.systems.render.backends.paper import (
    GUTTER,
    LAYOUTS,
    WIDTH,
    Block,
    Layout,
    as_paper,
    in_rows,
    matrices,
)
from pinjoint.systems.statics import displacement_method
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.force_method import Solution
from pinjoint.systems.statics.superposition import SetState
from pinjoint.systems.statics.unknowns import Unknown
from pinjoint.tables import Table

_NOTHING = 1e-9  # kN: of axial forces, which beams have none of
_SHOWN = 2  # unknowns of a frame up to which each has a column of superposition
_MOST, _WIDEST = 6, 9  # unknowns with figures and sums of entries, with K
_BESIDE = 26  # rows of a table that stands beside others
_APART = ",\u2003"  # between formulas in a line


@shown_in(USUAL)
def report(solved: Tables, convention: str) -> bytes:
    """The report of a solution as the contents of a PDF file."""
    title = _title(solved.model)
    return as_paper(title, partial(contents, solved, convention), f"Pinjoint · {title}")


def _title(model: Model) -> str:
    return tr(model.title) if model.title else tr("Statically indeterminate structure")


def contents(solved: Tables, convention: str, layout: Layout = LAYOUTS[0]) -> list[Flowable]:
    """What the report of a solution consists of, from the top to the bottom."""
    page = _ForcePage(solved, layout) if isinstance(solved, ForceTables) else _DisplacementPage(solved, layout)
    return [
        layout.text(_title(solved.model), "title"),
        *(layout.text(line, "subtitle") for line in (tr(page.theory), signs(solved.model))),
        *page.structure(),
        *(page.of_thesis() if convention == THESIS and isinstance(page, _ForcePage) else page.working()),
        *page.forces(),
        *page.checks(),
    ]


# --- figures -----------------------------------------------------------------------------------------


def _cuts(
    model: Model, released: Model, unknowns: Sequence[Unknown], acting: int | None = None
) -> Iterator[Cut]:
    """The released rods, with the pair of unit forces or moments of one of the unknowns."""
    rigid = rigid_joints(released)
    for i, unknown in enumerate(unknowns):
        label = f"X{index(i + 1)} = 1" if i == acting else ""
        if unknown.of_support:
            continue
        start, end = (model.particles.names[row] for row in model.rods.between[unknown.element.row].tolist())
        held = False
        if unknown.axis is not None:
            joint = model.particles[(start, end)[unknown.axis]]
            held = joint.fixed_rotation and not rigid[joint.row]
        yield Cut((start, end), unknown.axis, label, held)


def _flowing(heading: Sequence[Flowable], blocks: Sequence[Block], rows: int) -> list[Flowable]:
    """Blocks under a heading, side by side; below each other where tables have many rows, which pages may part."""
    if rows > _BESIDE:
        return [*heading, *(part for _, parts in blocks for part in parts)]
    first, *others = in_rows(blocks)
    return [KeepTogether([*heading, first]), *others]


# --- sections ----------------------------------------------------------------------------------------


class _Page:
    """The sections of a report in a layout that all methods have. same: that statics gives the same forces; and moments."""

    theory: ClassVar[str]
    same: ClassVar[tuple[str, str]]

    def __init__(self, solved: Tables, layout: Layout) -> None:
        self.solved, self.layout = solved, layout
        self.model, self.solution = solved.model, solved.solution
        self._every = range(len(solved.solution.unknowns))
        self._rows = solved.model.rods.count
        states = (solved.solution.real, solved.solution.base, *solved.solution.units)
        self._pulls = any(largest(state.axial_force) > _NOTHING for state in states)  # not so in beams

    def _text(self, words: str, style: str = "text") -> Flowable:
        return self.layout.text(words, style)

    @property
    def _quantity(self) -> str:
        """That which figures of states show."""
        return MOMENT if self.solved.bends else AXIAL

    def _by_unit(self, i: int) -> str:
        """What it is called by a unit of an unknown."""
        return f"{self._quantity.lower()}{index(i + 1)}"

    def _under_load(self, solved: Model, caption: str, cuts: Sequence[Cut] = ()) -> list[Block]:
        """The real structure, and that of which states are solved, under the load."""
        nothing = SetState.superposed([self.solution.real], [0.0])
        real = still(base_structure(self.model, []), self.model, nothing)
        state = still(solved, self.model, self.solution.base)
        said = tr(caption, force=f"{self._quantity}₀", unit="kN·m" if self.solved.bends else "kN")
        return [
            figure(self.layout, real, tr("The structure, its supports and its loads")),
            figure(self.layout, state, said, diagrams=self._quantity, cuts=cuts),
        ]

    def structure(self) -> list[Flowable]:
        """The structures in figures, and what the unknowns are."""
        raise NotImplementedError

    def working(self) -> list[Flowable]:
        """The equations and how they come about."""
        raise NotImplementedError

    def _closing(self) -> list[Flowable]:
        """How the equations hold with the unknowns."""
        raise NotImplementedError

    def forces(self) -> list[Flowable]:
        """Superposition, and the forces in the real structure."""
        model, solved = self.model, self.solved
        figures = []
        for quantity, title in diagram_titles().items():
            if self._pulls if quantity == AXIAL else solved.bends:
                copy = still(base_structure(model, []), model, self.solution.superposed)
                figures.append(figure(self.layout, copy, title, diagrams=quantity))
        heading = [self._text(tr("4  Forces in the structure"), "heading")]
        most = _SHOWN if solved.bends else PRODUCTS
        kinds = [solved.moments(most)] if solved.bends else []
        kinds += [solved.axial_forces(most)] if self._pulls else []
        kinds.append(solved.reactions(most))
        tables = [block for table in kinds for block in printed(self.layout, table, without_last=True)]
        beside = tables[1:] if solved.bends else [*tables[1:], *figures]
        if self._rows <= _BESIDE and sum(width for width, _ in (tables[0], *beside)) > WIDTH - 2 * GUTTER:
            below = (max(width for width, _ in beside), [part for _, parts in beside for part in parts])
            tables, figures = [tables[0], below], figures if solved.bends else []
        return _flowing(heading, [*tables, *figures], max(len(table.names) for table in kinds))

    def checks(self) -> list[Flowable]:
        """Equilibrium of the whole, the equations, and the difference from linear theory."""
        solution = self.solution
        whole, real = solution.superposed, solution.real
        balance = [self._text(tr("Equilibrium of the whole structure (kN, kN·m):"))]
        for name, terms in _balance(self.model, whole):
            balance.append(self._text(f"{name} = {written.total(terms)}", "equation"))
        gaps = self._closing()
        size = largest(real.axial_force)
        off = written.force(largest(whole.axial_force - real.axial_force), nothing=_same(size))
        said = tr(self.same[0], force=off)
        if self.solved.bends:
            moment = largest(real.end_moment)
            turned = written.moment(largest(whole.end_moment - real.end_moment), nothing=_same(moment))
            said = tr(self.same[1], force=off, moment=turned)
        gaps.append(self._text(said))
        heading = self._text(tr("5  Checks"), "heading")
        return [KeepTogether([heading, *in_rows([(0.0, balance), (0.0, gaps)])])]


class _ForcePage(_Page):
    """Of the force method."""

    solved: ForceTables
    solution: Solution
    theory = marked(
        "Force method, by first-order theory: linear elastic, equilibrium about the original shape."
    )
    same = (
        marked("The displacement method gives the same axial forces: largest difference {force}."),
        marked(
            "The displacement method gives the same forces and moments: largest differences {force}, {moment}."
        ),
    )

    def structure(self) -> list[Flowable]:
        """The real structure, the released one under the load and each unknown, and how often it is indeterminate."""
        unknowns = list(self.solution.unknowns)
        released = base_structure(self.model, unknowns)
        caption = marked("Released structure under the load: {force} ({unit})")
        blocks = self._under_load(released, caption, list(_cuts(self.model, released, unknowns)))
        blocks += map(self._under_unit, self._every)
        heading = self._text(tr("1  Structure and released structure"), "heading")
        return _flowing([heading], [*blocks, *self._said()], 0)

    def _under_unit(self, i: int) -> Block:
        model, unknowns, state = self.model, list(self.solution.unknowns), self.solution.units[i]
        alone = [float(i == j) for j in self._every]
        unknown = unknowns[i]
        copy = loaded(model, unknowns, alone) if unknown.of_support else unloaded(model, unknowns)
        cuts = list(_cuts(model, copy, unknowns, i))
        if unknown.of_end and any(cut.label and cut.held for cut in cuts):  # the support bears no moment
            state = replace(state, reaction=state.reaction * [1.0, 1.0, 0.0])
        told = {"unknown": f"X{index(i + 1)}", "force": self._by_unit(i)}
        said, copy = tr("Released structure under {unknown} = 1: {force}", **told), still(copy, model, state)
        return figure(self.layout, copy, said, diagrams=self._quantity, cuts=cuts, has_units=False)

    def _said(self) -> list[Block]:
        """The degree of static indeterminacy, and the unknowns."""
        count, unknowns = Count.of(self.model), self.solution.unknowns
        degree = [
            self._text(tr("Degree of static indeterminacy")),
            self._text(f"{count.formula} = {count.numbers}", "equation"),
            self._text(_counted(self.solved)),
            self._text(words.degree_of(count.degree)),
        ]
        if 0 < len(unknowns) < count.degree:
            names = listed([unknown.said for unknown in unknowns])
            degree.append(self._text(tr("Released here: {names}; the others stay.", names=names)))
        found = [self._text(tr("Unknowns"))]
        for i, unknown in enumerate(unknowns):
            found.append(self._text(f"X{index(i + 1)}:  {words.meaning(unknown)}", "equation"))
        full = (2 + len(unknowns)) % in_a_row(self.layout, self.model) == 0  # else beside the last figures
        return [(0.0, degree), (0.0, found)] if full else [(0.0, [*degree, *found])]

    def working(self) -> list[Flowable]:
        """Gaps and flexibilities as sums, rod by rod, and the equations that follow."""
        solved, every = self.solved, self._every
        heading = [
            self._text(tr("2  Displacements by virtual work"), "heading"),
            self._text(_APART.join(_formulas(solved, pulls=self._pulls)), "equation"),
        ]
        blocks: list[Block] = []
        if len(every) > PRODUCTS:
            note = tr(
                "With more than {count} unknowns the products are not printed; only their sums are given below.",
                count=PRODUCTS,
            )
            heading.append(self._text(note, "caption"))
            blocks += printed(self.layout, solved.forces(every))
        elif solved.bends:
            ends = tr("M and M′ are the moments at both ends of a rod; qL²/8 is how far M bulges between them.")
            heading.append(self._text(ends, "caption"))
            blocks += printed(self.layout, solved.bending(every))
            warm = solved.solution.work.axial.of_free.any()
            axial = solved.virtual_work(every) if warm else solved.forces(every)
            blocks += printed(self.layout, axial) if self._pulls else []
        else:
            blocks += printed(self.layout, solved.virtual_work(every))
        settlements = solved.settlements()
        if settlements is not None:
            blocks += printed(self.layout, settlements)
        if solved.bends and len(every) <= PRODUCTS and (self._pulls or settlements is not None):
            space = " " if len(every) == 1 else "\u00a0"  # the lines of several are parted between sums
            sums = _APART.join(line.replace(" ", space) for line in solved.all_sums())
            sums = tr("Bending and axial forces ({units}):  {sums}", units=solved.units, sums=sums)
            blocks.append((WIDTH if len(every) > 1 else 0.0, [self._text(sums)]))
        compatibility = self._compatibility()
        if len(every) == 1 and self._rows <= _BESIDE:
            return _flowing(heading, [*blocks, (0.0, compatibility)], self._rows)
        return [*_flowing(heading, blocks, self._rows), KeepTogether([*compatibility])]

    def _compatibility(self) -> list[Flowable]:
        """The equations with their numbers, and the unknowns."""
        solution = self.solution
        count = len(solution.unknowns)
        heading = self._text(tr("3  Compatibility"), "heading")
        said = tr("The unknowns close the gaps ({units}):", units=self.solved.units)
        found = [f"X{index(i + 1)} = {words.amount(solution, i)}" for i in range(count)]
        if count == 1:
            symbols, numbers = words.equation(self.solved, 0)
            return [
                heading,
                self._text(said),
                self._text(symbols, "equation"),
                self._text(numbers.replace(" = ", "\u00a0=\u00a0"), "equation"),
                self._text(found[0], "result"),
            ]
        every, held = self._every, solution.prescribed
        number = np.vectorize(lambda value: written.number(self.solved.factor * value, EXACT), otypes=[object])
        forms: list[Any] = [(number(solution.flexibility), number(solution.gap), number(held))]
        if count <= PRODUCTS:
            matrix = [[f"δ{index(i + 1, j + 1)}" for j in every] for i in every]
            gap = [f"δ{index(i + 1, 0)}" for i in every]
            forms.insert(0, (matrix, gap, [f"c{index(i + 1)}" if held[i] else "0" for i in every]))
        unknowns = [[f"X{index(i + 1)}"] for i in every]
        lines = [
            matrices([matrix, unknowns, "+", [[x] for x in gap], "=", [[x] for x in right]], self.layout)
            for matrix, gap, right in forms
        ]
        symmetric = tr("The matrix is symmetric: δ₁₂ = δ₂₁ (Maxwell).")
        rows = in_rows(lines)
        result = self._text(_APART.join(found), "result")
        return [heading, self._text(f"{symmetric} {said}"), *rows, result]

    def of_thesis(self) -> list[Flowable]:
        """The same in the thesis' convention."""
        lines = words.in_thesis(self.solution)
        heading = self._text(tr("2  Unknowns"), "heading")
        return [KeepTogether([heading, *(self._text(line, "equation") for line in lines)])]

    def _closing(self) -> list[Flowable]:
        solution = self.solution
        gaps = [self._text(tr("The compatibility equations hold ({units}):", units=self.solved.units))]
        for i in self._every[:PRODUCTS]:
            terms = [solution.gap[i], *(solution.flexibility[i] * solution.force), -solution.prescribed[i]]
            gaps.append(
                self._text(written.total(self.solved.factor * float(term) for term in terms), "equation")
            )
        return gaps


class _DisplacementPage(_Page):
    """Of the displacement method."""

    solved: DisplacementTables
    solution: displacement_method.Solution
    theory = marked(
        "Displacement method, by first-order theory: linear elastic, equilibrium about the original shape."
    )
    same = (
        marked("Statics gives the same axial forces: largest difference {force}."),
        marked("Statics gives the same forces and moments: largest differences {force}, {moment}."),
    )

    def structure(self) -> list[Flowable]:
        model, solution, count = self.model, self.solution, len(self._every)
        fast = held(base_structure(model, []), solution)
        blocks = self._under_load(fast, marked("All unknowns held, under the load: {force} ({unit})"))
        for i in self._every if count <= _MOST else ():
            copy = still(held(unloaded(model, []), solution), model, solution.units[i], moved=True)
            said = tr("{unknown} = 1 alone: {force}", unknown=f"Δ{index(i + 1)}", force=self._by_unit(i))
            blocks.append(figure(self.layout, copy, said, diagrams=self._quantity, has_units=False, moved=True))
        degree = Count.of(model)
        unknowns = ",  ".join(displacement_words.unknown(self.solved, i) for i in self._every)
        lines = [self._text(line) for line in (*displacement_words.degree_of(count, degree), unknowns)]
        blocks.append((WIDTH if count > 1 else 0.0, lines))
        return _flowing([self._text(tr("1  Structure and unknowns"), "heading")], blocks, 0)

    def working(self) -> list[Flowable]:
        solved, layout, rods, every = self.solved, self.layout, self.model.rods, self._every
        members = printed(layout, solved.coefficients())
        for row in range(rods.count) if rods.count <= PRODUCTS else ():
            members += printed(layout, solved.member(row))
        found = _flowing([self._text(tr("2  Stiffness of the members"), "heading")], members, rods.count)
        if not every:
            return found
        heading = [self._text(tr("3  Equilibrium of the joints"), "heading")]
        blocks: list[Block] = []
        if len(every) <= _MOST:
            pairs = [(i, j) for i in every for j in every if i <= j and solved.terms(i, j)]
            names, added, sums = zip(*(displacement_words.entry(solved, i, j) for i, j in pairs), strict=True)
            texts = {tr("members"): added, tr("sum"): sums}
            blocks = printed(layout, solved.column(len(every)))
            blocks += printed(layout, Table("K", names, []), texts=texts)
        return [*found, *_flowing(heading, blocks, len(every) ** 2), *self._system()]

    def _system(self) -> list[Flowable]:
        """K Δ = F with its numbers, and Δ."""
        solution, every = self.solution, self._every
        number = np.vectorize(lambda value: written.number(value, EXACT), otypes=[object])
        amounts = _APART.join(displacement_words.amount(self.solved, i).replace(" ", "\u00a0") for i in every)
        result = self._text(amounts, "result")
        if len(every) > _WIDEST:
            return [
                self._text(tr("With more than {count} unknowns K is not printed.", count=_WIDEST), "caption"),
                result,
            ]
        symbols = [[f"Δ{index(i + 1)}"] for i in every]
        line = matrices(
            [number(solution.stiffness), symbols, "=", [[x] for x in number(solution.load)]], self.layout
        )
        said = tr(
            "K Δ = F ({units}); K is symmetric (Maxwell):",
            units="m, rad, kN, kN·m" if self.solved.bends else "m, kN",
        )
        return [KeepTogether([self._text(said), *in_rows([line]), result])]

    def _closing(self) -> list[Flowable]:
        left = written.number(self.solved.unbalanced)
        return [
            self._text(tr("Equilibrium of all joints: what is left to hold them is {force} kN.", force=left))
        ]


def _same(size: float) -> float:
    """Differences that are rounding, of numbers so large."""
    return written.ROUNDING * max(size, 1e-300)


def _counted(solved: Tables) -> str:
    """What the letters of the formula count."""
    count = Count.of(solved.model)
    said = marked("m = {rods} rods, r = {constraints} reactions, n = {nodes} joints, h = {hinges} hinges")
    if count.hinges is None:
        said = marked("m = {rods} rods, r = {constraints} reactions, n = {nodes} joints")
    return tr(said, **vars(count))


def _formulas(solved: ForceTables, *, pulls: bool) -> Iterator[str]:
    """What the sums are, for every pair of unknowns alike; pulls: there are axial forces."""
    work, bends = solved.solution.work, solved.bends
    more = ["Σ n₁ ΔL"] * bool(work.axial.of_free.any()) + ["∫ m₁ κ dx"] * bool(work.bending.of_free.any())
    more += ["(− Σ r₁ c)"] * bool(len(work.settled))
    springs = bool(work.supports.softness.any())
    yield from words.formulas(bends, index(1), pulls=pulls, more=more, springs=springs)
    if len(solved.solution.unknowns) > 1:
        both = words.sums(bends, "m₁ m₂", "n₁ n₂", pulls=pulls, more=["Σ r₁ r₂/k"] * springs)
        yield f"δ₁₂ = δ₂₁ = {both}"


def _balance(model: Model, state: SetState) -> Iterator[tuple[str, list[float]]]:
    """Sums of loads and reactions, of moments about the first support; each force is a term where they are few."""
    load, (x, y) = External.of(model).at(1.0), model.particles.position.T
    used = nodes(model)
    held = np.flatnonzero(used & supported(model)[:, :2].any(axis=1))
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
            terms += parts.tolist() if len(parts) <= 6 else [float(parts.sum())]
        size = largest(state.reaction)
        terms = [term for term in terms if abs(term) > written.ROUNDING * size]
        yield name, terms
