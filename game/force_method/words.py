"""Texts of the force method: messages, captions, equations and tables, in the textbook's words or the thesis'."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pinjoint.components import written
from pinjoint.components.bent import AXIAL
from pinjoint.components.language import listed, marked, plural, tr
from pinjoint.components.view import BETWEEN
from pinjoint.force_method import PARTS, thesis

if TYPE_CHECKING:  # they import scipy
    from pinjoint.force_method.guide import Guide
    from pinjoint.systems.statics.force_method import Solution
    from pinjoint.systems.statics.unknowns import Unknown

Caption = tuple[str, ...]

NAMES = (
    marked("Set 1: real structure"),
    marked("Set 2: released, under load"),
    marked("Set 3: the unknown alone"),
)
TO_COME = ("", marked("follows in part 3"), marked("follows in part 5"))
EXACT = 5  # significant digits of gaps and flexibilities, from which unknowns follow to 4


# --- messages and hints ------------------------------------------------------------------------------


def message(guide: Guide) -> str:
    """The line of red text: the present part, or the reason of a refusal."""
    if guide.refusal:
        return guide.refusal
    if guide.part == 1:
        return tr("Real structure under the real load")
    if guide.part == 2:
        if guide.axis_wanted is not None:
            return tr("Which direction of the support?")
        return tr("Choose a rod or a support to release")
    if guide.in_thesis:
        return thesis.message(guide)
    last = index(len(guide.released))
    names = listed([unknown.name for unknown in guide.released])
    return {
        3: tr("Released structure under the load: without {names}", names=names),
        4: tr("The gap that the load opens at the release"),
        5: tr("Released structure under {unknown} = 1 alone", unknown=f"X{last}"),
        6: tr("The gap that {unknown} = 1 opens: virtual work, rod by rod", unknown=f"X{last}"),
        7: tr("Compatibility closes the gap: set 2 + set 3 = set 1"),
    }[guide.part]


def hint(guide: Guide) -> str:
    """The next possible step."""
    steps = [
        tr("I next of M, V, N") if guide.is_frame else tr("I forces"),
        tr("Esc back to pause"),
        tr("C convention"),
    ]
    if guide.part == 2 and guide.axis_wanted is not None:
        steps = [tr("X horizontal"), tr("Y vertical")]
        if guide.clamp_wanted:
            steps.append(tr("M moment"))
        steps.append(tr("Esc back to pause"))
    elif guide.part == 2:
        steps = [tr("click a rod or a support in set 1"), tr("Esc back to pause")]
    elif guide.part == PARTS:
        another = [tr("N release another")] if guide.can_release_another else []
        steps = [tr("K finish"), tr("P report as PDF"), *another, *steps]
    else:
        steps = [tr("K next part"), *steps]
    return BETWEEN.join(steps)


# --- captions ----------------------------------------------------------------------------------------


def captions(guide: Guide) -> list[Caption]:
    """The captions of the three sets: name, load, and displacements once they are measured."""
    if guide.mechanism is not None:
        return [(tr(NAMES[0]),), (tr("A mechanism: nothing resists this motion"),), ("",)]
    there = len(guide.sets)
    shown: list[Caption] = [
        (tr(name), *(() if i < there else (tr(TO_COME[i]) if TO_COME[i] else "",)))
        for i, name in enumerate(NAMES)
    ]
    solution = guide.solution
    if solution is None or guide.part == 2:
        return shown
    if guide.in_thesis:
        return thesis.captions(guide, shown)
    count = len(guide.released)
    third = f"X{index(count)} = 1"
    if guide.part == PARTS:
        third = tr("the unknowns below") if count > 1 else f"X₁ = {amount(solution, 0)}"
    for i, load in enumerate((tr("the real load"), tr("the real load"), third)[:there]):
        shown[i] = (*shown[i], load)
    units = guide.tables.units
    if guide.part >= 4:
        gaps = [
            f"δ{index(i + 1, 0)} = {_of(units.factor * gap, units.gap(i))}"
            for i, gap in enumerate(solution.gap.tolist())
        ]
        shown[1] = (*shown[1], *gaps)
    if guide.part >= 6:
        last = count - 1
        flexibilities = [
            f"δ{index(i + 1, count)} = {_of(units.factor * value, units.flexibility(i, last))}"
            for i, value in enumerate(solution.flexibility[:, last].tolist())
        ]
        shown[2] = (*shown[2], *flexibilities) if guide.part == 6 or count == 1 else shown[2]
    return shown


def index(*numbers: int) -> str:
    """Indices as they stand below: "₁₀"; apart from each other if one has two digits."""
    from pinjoint.force_method.tables import index as below  # it imports scipy

    return below(*numbers)


def amount(solution: Solution, which: int) -> str:
    """An unknown that was solved for, with its unit."""
    value, moment = float(solution.force[which]), solution.unknowns[which].is_moment
    return written.moment(value) if moment else written.force(value)


def _of(value: float, unit: str) -> str:
    return f"{written.number(value)} {unit}"


# --- the working -------------------------------------------------------------------------------------


def working(guide: Guide) -> tuple[str, ...]:
    """The degree of indeterminacy (part 1), what the unknowns are, and the compatibility equations with their numbers."""
    solution = guide.solution
    if guide.part == 1:
        return (
            f"{guide.count.formula} = {guide.count.numbers}",
            degree_of(guide.degree),
            tr("Yielding is switched off: superposition needs linear behaviour."),
        )
    if solution is None or guide.part < 3:
        return ()
    if guide.in_thesis:
        lines = thesis.working(guide)
    elif guide.part == PARTS:
        lines = equations(solution, guide.tables.units.all, guide.tables.units.factor)
    else:
        lines = explained(guide)
    if guide.exact is None or guide.part < PARTS:
        return lines
    forces = ", ".join(
        f"{written.moment(x) if unknown.is_moment else written.force(x)}"
        for x, unknown in zip(guide.exact, guide.released, strict=True)
    )
    return (*lines, tr("Exact geometry gives {forces}.", forces=forces))


def degree_of(degree: int) -> str:
    """What the degree of static indeterminacy says."""
    if degree == 0:
        return tr("The structure is statically determinate: nothing in it can be released.")
    return plural(
        "The structure is statically indeterminate: 1 unknown to release.",
        "The structure is statically indeterminate: {count} unknowns to release.",
        degree,
    )


def explained(guide: Guide) -> tuple[str, ...]:
    """What the present part of the textbook's solution is about, with its formulas (parts 3 to 6)."""
    assert guide.solution is not None
    number = len(guide.released)
    if guide.part == 3:
        return tuple(
            f"X{index(i + 1)}: {meaning(unknown)}" for i, unknown in enumerate(guide.solution.unknowns)
        )
    if guide.part == 4:
        return (gap_of(guide.solution.unknowns[-1], index(number, 0), index(number)),)
    if guide.part == 5:
        return (tr("The forces that {unknown} = 1 causes are the factors n.", unknown=f"X{index(number)}"),)
    return (*formulas(guide.tables.bends, index(number)), *guide.tables.sums(number - 1))


def formulas(bends: bool, number: str) -> tuple[str, ...]:
    """The sums of virtual work for one unknown."""
    first, zero = f"δ{number}₀", "₀"
    if bends:
        return (
            f"{first} = ∫ M{zero} m{number} dx/EI + Σ N{zero} n{number} L/EA,"
            f"  δ{number}{number} = ∫ m{number}² dx/EI + Σ n{number}² L/EA > 0",
        )
    return (f"{first} = Σ N{zero} n{number} L/EA,  δ{number}{number} = Σ n{number}² L/EA > 0",)


def meaning(unknown: Unknown) -> str:
    """What an unknown is, and in which direction it is positive."""
    name = unknown.element.name
    if unknown.of_bar:
        return tr("axial force of rod {rod}, positive in tension", rod=name)
    if unknown.of_end and unknown.axis == 0:
        return tr("bending moment at the start of rod {rod}", rod=name)
    if unknown.of_end:
        return tr("bending moment at the end of rod {rod}", rod=name)
    if unknown.is_moment:
        return tr("moment of the clamp at {particle}, positive counter-clockwise", particle=name)
    if unknown.axis == 0:
        return tr("reaction of the support at {particle}, positive to the right", particle=name)
    return tr("reaction of the support at {particle}, positive upwards", particle=name)


def gap_of(unknown: Unknown, gap: str, number: str) -> str:
    """What the gap at a release is."""
    what = {"gap": f"δ{gap}", "unknown": f"X{number}", "name": unknown.element.name}
    if unknown.of_bar:
        return tr(
            "{gap}: how far the load moves the two faces of the cut in {name}; positive in the direction of {unknown}.",
            **what,
        )
    if unknown.of_end:
        return tr(
            "{gap}: the angle by which the load opens the hinge in {name}; positive in the direction of {unknown}.",
            **what,
        )
    if unknown.is_moment:
        return tr("{gap}: how far the load turns {name}; positive in the direction of {unknown}.", **what)
    return tr("{gap}: how far the load moves {name}; positive in the direction of {unknown}.", **what)


def equations(solution: Solution, units: str, factor: float) -> tuple[str, ...]:
    """δ₀ + Σ δ X = c, a line for every unknown with its numbers, and the solution X."""
    count, lines = len(solution.unknowns), []
    for i in range(count):
        symbols = "".join(f" + δ{index(i + 1, j + 1)} X{index(j + 1)}" for j in range(count))
        terms = "".join(
            f" {_signed(factor * value)} X{index(j + 1)}"
            for j, value in enumerate(solution.flexibility[i].tolist())
        )
        held = float(solution.prescribed[i])
        right = f"c{index(i + 1)}" if held else "0"
        number = written.number(factor * held, EXACT)
        gap = written.number(factor * float(solution.gap[i]), EXACT)
        lines.append(f"δ{index(i + 1, 0)}{symbols} = {right}:  {gap}{terms} = {number}  ({units})")
    found = ",  ".join(f"X{index(i + 1)} = {amount(solution, i)}" for i in range(count))
    if count == 1:
        return (f"{lines[0]},  {found}",)
    return (*lines, found)


def _signed(value: float) -> str:
    text = written.number(value, EXACT)
    return f"− {text.removeprefix('−')}" if text.startswith("−") else f"+ {text}"


def table(guide: Guide) -> Sequence[tuple[str, ...]]:
    """Virtual work, rod by rod (part 6), and superposition (part 7)."""
    if guide.solution is None or guide.part < 6:
        return ()
    if guide.in_thesis:
        return thesis.table(guide)
    tables, last = guide.tables, [len(guide.released) - 1]
    if guide.part == 6:
        return tables.bending(last) if tables.bends else tables.virtual_work(last)
    return tables.moments() if tables.bends and guide.quantity != AXIAL else tables.axial_forces()
