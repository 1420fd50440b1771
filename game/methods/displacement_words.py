"""Texts of the displacement method: messages, captions, working and tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pinjoint.components import written
from pinjoint.components.bent import AXIAL
from pinjoint.components.language import marked, plural, tr
from pinjoint.components.view import BETWEEN
from pinjoint.methods import index
from pinjoint.methods.words import EXACT, Caption, begun_captions

if TYPE_CHECKING:  # they import scipy
    from pinjoint.methods.displacements import DisplacementGuide, DisplacementTables
    from pinjoint.systems.statics.counting import Count

NAMES = (
    marked("Set 1: real structure"),
    marked("Set 2: joints held, under load"),
    marked("Set 3: displacements alone"),
)


def message(guide: DisplacementGuide) -> str:
    """The line of red text: the present part, or the entry that is pointed at."""
    if guide.pointed is not None:
        return " = ".join(filter(None, entry(guide.tables, *guide.pointed)))
    return {
        1: tr("Real structure under the real load"),
        2: tr("Unknowns: the free directions of joints"),
        3: tr("All unknowns held, under the load: fixed-end forces"),
        4: tr("{unknown} = 1 alone: the forces that hold the joints", unknown=f"Δ{index(guide.acting + 1)}"),
        5: tr("Nothing holds the joints: K Δ = F"),
        6: tr("Superposition: set 2 + set 3 = set 1"),
    }[guide.part]


def hint(guide: DisplacementGuide) -> str:
    """The next possible step."""
    steps = [tr("K finish"), tr("P report as PDF")] if guide.part == guide.parts else [tr("K next part")]
    steps += [tr("N to the equations")] if guide.can_skip else []
    steps += [tr("B back a part")] if guide.part > 1 else []
    steps += [tr("click a rod for its k")] if guide.part > 1 else [tr("Ctrl+K force method")]
    quantity = tr("I next of M, V, N") if guide.is_frame else tr("I forces")
    return BETWEEN.join([*steps, quantity, tr("Esc back")])


def captions(guide: DisplacementGuide) -> list[Caption]:
    """The captions of the three sets: name, and load or displacements."""
    to_come = "", marked("follows in part 3"), marked("follows in part 4")
    there, shown = len(guide.sets), begun_captions(guide, NAMES, to_come)
    for i in range(min(there, 2)):
        shown[i] = (*shown[i], tr("the real load"))
    if there > 2:
        whole = guide.part == guide.parts
        alone = tr("the unknowns below") if whole else f"{unknown(guide.tables, guide.acting)} = 1"
        shown[2] = (*shown[2], alone)
    return shown


def unknown(tables: DisplacementTables, i: int) -> str:
    """An unknown and the direction that it is."""
    return f"Δ{index(i + 1)} = {tables.names[i]}"


def amount(tables: DisplacementTables, i: int) -> str:
    """An unknown that was solved for, with its unit."""
    turns = tables.solution.unknowns[i].is_moment
    value = float(tables.solution.displacement[i])
    return f"Δ{index(i + 1)} = {written.number(value)} {'rad' if turns else 'm'}"


def degree_of(size: int, count: Count) -> tuple[str, str]:
    """How many equations this method has here, and how many the force method."""
    return (
        plural(
            "n = 1 direction in which a joint is free: the displacement method has 1 equation here.",
            "n = {count} directions in which joints are free: the displacement method has {count} equations here.",
            size,
        ),
        plural(
            "{formula} = {numbers}: the force method has 1 equation here.",
            "{formula} = {numbers}: the force method has {count} equations here.",
            count.degree,
            formula=count.formula,
            numbers=count.numbers,
        ),
    )


def working(guide: DisplacementGuide) -> tuple[str, ...]:
    """What the present part is about, with its equations and their solution."""
    tables, every = guide.tables, range(guide.size)
    if guide.part == 1:
        return degree_of(guide.size, guide.count)
    if guide.member is not None:
        told = guide.model.describe(guide.member)
        return (tr("k, {rod}: forces at its ends by unit displacements there.", rod=told),)
    if guide.part == 2:
        hinged = tr(
            "Hinged ends turn by themselves: they need no unknown, and resist with 3EI/L in place of 4EI/L."
        )
        listed = ",  ".join(unknown(tables, i) for i in every)
        firm = tr("Inextensible rods take other directions along, which are no unknowns.")
        more = [hinged] * bool(guide.count.hinges) + [firm] * bool(guide.model.rods.inextensible.any())
        return (listed, *more)
    if guide.part == 3:
        return (tr("F: the loads on joints, less the fixed-end forces of the members."),)
    if guide.part == 4:
        return (
            tr("Column {number} of K: each entry is the sum of what members add.", number=guide.acting + 1),
        )
    if guide.part == 5:
        return (
            tr(
                "K is symmetric: k₁₂ = k₂₁ (Maxwell). Point at an entry of K or F to see the members that add to it."
            ),
        )
    found = ",  ".join(amount(tables, i) for i in every)
    left = written.number(tables.unbalanced)
    return (found, tr("Equilibrium of all joints: what is left to hold them is {force} kN.", force=left))


def entry(tables: DisplacementTables, i: int, j: int) -> tuple[str, str, str]:
    """An entry of K, or behind its last column of F: its name, what members and joints add to it, and the sum."""
    of_load, solution = j == len(tables.names), tables.solution
    total = float(solution.load[i] if of_load else solution.stiffness[i, j])
    terms = [(rod.said, value) for rod, value in tables.terms(i, j)]
    rest = total - sum(value for _, value in terms)
    if abs(rest) > written.ROUNDING * max([abs(total), *(abs(value) for _, value in terms)]):
        terms.append((tr("joints") if of_load else tr("supports"), rest))
    added = " + ".join(f"{written.number(value, EXACT)} ({name})" for name, value in terms).replace("+ −", "− ")
    unit = tables.unit(i, None if of_load else j)
    name = f"F{index(i + 1)}" if of_load else f"k{index(i + 1, j + 1)}"
    return name, added, f"{written.number(total, EXACT)} {unit}"


def table(guide: DisplacementGuide) -> Sequence[tuple[str, ...]]:
    """k of members, F and a column of K member by member, the system, and superposition."""
    tables = guide.tables
    if guide.member is not None:
        return tables.member(guide.member.row)
    if guide.part == 6:
        return tables.moments() if tables.bends and guide.quantity != AXIAL else tables.axial_forces()
    if guide.part == 2:
        return tables.coefficients()
    if guide.part == 5:
        return tables.system()
    return tables.column(guide.size if guide.part == 3 else guide.acting) if guide.part > 1 else ()
