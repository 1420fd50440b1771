"""Texts of the force method: messages, captions, equations and tables, in the textbook's words or the thesis'."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pinjoint.components import written
from pinjoint.components.bent import AXIAL
from pinjoint.components.field import CM
from pinjoint.components.language import listed, marked, plural, tr
from pinjoint.components.view import BETWEEN
from pinjoint.methods import PARTS, index

if TYPE_CHECKING:  # they import scipy
    from pinjoint.methods.guide import ForceGuide, Guide
    from pinjoint.methods.tables import ForceTables
    from pinjoint.systems.statics.force_method import Solution
    from pinjoint.systems.statics.unknowns import Unknown

Caption = tuple[str, ...]

NAMES = (
    marked("Set 1: real structure"),
    marked("Set 2: released, under load"),
    marked("Set 3: the unknown alone"),
)
EXACT = 5  # significant digits of gaps and flexibilities, from which unknowns follow to 4


# --- messages and hints ------------------------------------------------------------------------------


def message(guide: ForceGuide) -> str:
    """The line of red text: the present part, or the reason of a refusal."""
    if guide.refusal:
        return guide.refusal
    if guide.part == 1:
        return tr("Real structure under the real load")
    if guide.part == 2:
        if guide.axis_wanted is not None:
            return tr("Which direction of the support?")
        if guide.count.degree > 1:
            place = {"number": len(guide.released) + 1, "degree": guide.count.degree}
            return tr("Choose a rod or a support to release: number {number} of {degree}", **place)
        return tr("Choose a rod or a support to release")
    names, last = listed([unknown.said for unknown in guide.released]), index(guide.acting + 1)
    if guide.in_thesis:
        return {
            3: tr("Primary structure: {names} is released", names=names)
            if len(guide.released) == 1
            else tr("Primary structure: {names} are released", names=names),
            4: tr("How far the released place moved"),
            5: tr("Primary structure under a pair of unit forces alone")
            if guide.released[guide.acting].of_bar
            else tr("Primary structure under a unit force alone"),
            6: tr("How far the unit force moves it"),
            7: tr("Set 2 + set 3 = set 1"),
        }[guide.part]
    return {
        3: tr("Released structure under the load: without {names}", names=names),
        4: tr("The gap that the load opens at the release"),
        5: tr("Released structure under {unknown} = 1 alone", unknown=f"X{last}"),
        6: tr("The gap that {unknown} = 1 opens: virtual work, rod by rod", unknown=f"X{last}"),
        7: tr("Compatibility closes the gap: set 2 + set 3 = set 1"),
    }[guide.part]


def hint(guide: ForceGuide) -> str:
    """The next possible step."""
    steps = [tr("I next of M, V, N") if guide.is_frame else tr("I forces"), tr("Esc back"), tr("C convention")]
    if guide.part == 2 and guide.axis_wanted is not None:
        steps = [tr("X horizontal"), tr("Y vertical")]
        if guide.clamp_wanted:
            steps.append(tr("M moment"))
        steps.append(tr("Esc back"))
    elif guide.part == 2:
        known = [tr("K go on with these")] if guide.released else []
        steps = [tr("click a rod or a support in set 1"), *known, tr("Esc back")]
    elif guide.part == PARTS:
        another = [tr("N release another")] if guide.can_release_another else []
        steps = [tr("K finish"), tr("P report as PDF"), *another, *steps]
    else:
        steps = [tr("K next part"), *steps]
    return BETWEEN.join(steps)


# --- captions ----------------------------------------------------------------------------------------


def captions(guide: ForceGuide) -> list[Caption]:
    """The captions of the three sets: name, load, and displacements once they are measured."""
    if guide.mechanism is not None:
        return [(tr(NAMES[0]),), (tr("A mechanism: nothing resists this motion"),), ("",)]
    to_come = "", marked("follows in part 3"), marked("follows in part 5")
    there, shown = len(guide.sets), begun_captions(guide, NAMES, to_come)
    solution = guide.solution
    if solution is None or guide.part == 2:
        return shown
    third, *measured = (_of_thesis if guide.in_thesis else _of_textbook)(guide, solution)
    for i, load in enumerate(((tr("the real load"),), (tr("the real load"),), third)[:there]):
        opened = (
            (i < 2 and guide.part >= 4) or guide.part == 6 or (guide.part == PARTS and len(guide.released) == 1)
        )
        shown[i] = (*shown[i], *load, *(measured[i] if opened else ()))
    return shown


def begun_captions(guide: Guide, names: Sequence[str], to_come: Sequence[str]) -> list[Caption]:
    """The names of the three sets of a method, and in which part those follow that are not there yet."""
    there = len(guide.sets)
    return [
        (tr(name),) if i < there else (tr(name), tr(follows))
        for i, (name, follows) in enumerate(zip(names, to_come, strict=True))
    ]


def _of_textbook(guide: ForceGuide, solution: Solution) -> tuple[Caption, ...]:
    """What loads set 3, and the gaps in each set."""
    count, tables = len(guide.released), guide.tables
    third = f"X{index(guide.acting + 1)} = 1"
    if guide.part == PARTS:
        third = tr("the unknowns below") if count > 1 else f"X₁ = {amount(solution, 0)}"
    gaps = [
        f"δ{index(i + 1, 0)} = {written.number(tables.factor * gap)} {tables.gap_unit(i)}"
        for i, gap in enumerate(solution.gap.tolist())
    ]
    flexibilities = [
        f"δ{index(i + 1, guide.acting + 1)} = {written.number(tables.factor * value)}"
        f" {tables.flexibility_unit(i, guide.acting)}"
        for i, value in enumerate(solution.flexibility[:, guide.acting].tolist())
    ]
    return (third,), (), tuple(gaps), tuple(flexibilities)


def _of_thesis(guide: ForceGuide, solution: Solution) -> tuple[Caption, ...]:
    """What loads set 3, and the displacement of every unknown: Δ, the change of distance of a rod, or u, of a support."""
    last, several = guide.released[guide.acting], len(guide.released) > 1
    third = tr("a unit force at {name}", name=last.said)
    if last.of_bar:
        third = tr("a pair of unit forces at {name}", name=last.said)
    if guide.part == PARTS:
        third = tr("the forces p below") if several else f"p = {written.force(solution.force[0])}"

    def each(number: str, values: Sequence[float], per: str = "") -> Caption:
        return tuple(
            f"{'Δ' if unknown.of_bar else 'u'}{number}{f' {unknown.said}' * several}"
            f" = {f'{written.number(value)} rad' if unknown.is_moment else f'{_cm(value)} cm'}{per}"
            for unknown, value in zip(guide.released, values, strict=True)
        )

    deltas = solution.delta_real, solution.delta_base, solution.delta_unit[:, guide.acting]
    return (third,), *map(each, ("", "₀", "₁"), (delta.tolist() for delta in deltas), ("", "", "/kN"))


def amount(solution: Solution, which: int) -> str:
    """An unknown that was solved for, with its unit."""
    value, moment = float(solution.force[which]), solution.unknowns[which].is_moment
    return written.moment(value) if moment else written.force(value)


# --- the working -------------------------------------------------------------------------------------


def working(guide: ForceGuide) -> tuple[str, ...]:
    """The degree of indeterminacy (part 1), what the unknowns are, and the compatibility equations with their numbers."""
    solution = guide.solution
    if guide.part == 1:
        return (
            f"{guide.count.formula} = {guide.count.numbers}",
            degree_of(guide.count.degree),
            tr("Yielding is switched off: superposition needs linear behaviour."),
        )
    if solution is None:
        return ()
    if guide.part < PARTS:
        return () if guide.in_thesis else explained(guide)
    lines = in_thesis(solution) if guide.in_thesis else equations(guide.tables)
    if guide.exact is None:
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


def explained(guide: ForceGuide) -> tuple[str, ...]:
    """What the present part of the textbook's solution is about, with its formulas (parts 2 to 6)."""
    assert guide.solution is not None
    number, tables = guide.acting + 1, guide.tables
    if guide.part in (2, 3):
        return tuple(
            f"X{index(i + 1)}: {meaning(unknown)}" for i, unknown in enumerate(guide.solution.unknowns)
        )
    if guide.part == 4:
        return tuple(
            gap_of(unknown, index(i + 1, 0), index(i + 1)) for i, unknown in enumerate(guide.solution.unknowns)
        )
    if guide.part == 5:
        return (tr("The forces that {unknown} = 1 causes are the factors n.", unknown=f"X{index(number)}"),)
    mixed = [
        f"δ{index(j, number)} = {sums(tables.bends, f'm{index(j)} m{index(number)}', f'n{index(j)} n{index(number)}')}"
        for j in range(1, number)
    ]
    return (",  ".join([*formulas(tables.bends, index(number)), *mixed]), *tables.sums(number - 1))


def formulas(
    bends: bool, i: str, *, pulls: bool = True, more: Sequence[str] = (), springs: bool = False
) -> tuple[str, str]:
    """The sums of virtual work for one unknown, its index below; see `sums`. springs: some supports are elastic."""
    gap = sums(bends, f"M₀ m{i}", f"N₀ n{i}", pulls=pulls, more=more)
    own = sums(bends, f"m{i}²", f"n{i}²", pulls=pulls, more=[f"Σ r{i}²/k"] * springs)
    return f"δ{i}₀ = {gap}", f"δ{i}{i} = {own} > 0"


def sums(bends: bool, moments: str, forces: str, *, pulls: bool = True, more: Sequence[str] = ()) -> str:
    """Sums of virtual work of products of bending moments and of axial forces, if there are some, and what is more."""
    both = [f"∫ {moments} dx/EI"] * bends + [f"Σ {forces} L/EA"] * pulls
    return " + ".join([*both, *more])


def meaning(unknown: Unknown) -> str:
    """What an unknown is, and in which direction it is positive."""
    name, described = unknown.element.said, unknown.element.world.describe(unknown.element)
    if unknown.of_bar:
        return tr("{rod}: axial force, positive in tension", rod=described)
    if unknown.of_end and unknown.axis == 0:
        return tr("{rod}: bending moment at its start", rod=described)
    if unknown.of_end:
        return tr("{rod}: bending moment at its end", rod=described)
    if unknown.is_moment:
        return tr("moment of the clamp at {particle}, positive counter-clockwise", particle=name)
    if unknown.axis == 0:
        return tr("reaction of the support at {particle}, positive to the right", particle=name)
    return tr("reaction of the support at {particle}, positive upwards", particle=name)


def gap_of(unknown: Unknown, gap: str, number: str) -> str:
    """What the gap at a release is."""
    what = {"gap": f"δ{gap}", "unknown": f"X{number}", "name": unknown.element.said}
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


def equation(tables: ForceTables, row: int) -> tuple[str, str]:
    """δ₀ + Σ δ X = c of an unknown in symbols, and with its numbers."""
    solution, factor, symbols, numbers = tables.solution, tables.factor, "", ""
    for j, value in enumerate(solution.flexibility[row].tolist()):
        text, unknown = written.number(factor * value, EXACT), f"X{index(j + 1)}"
        symbols += f" + δ{index(row + 1, j + 1)} {unknown}"
        numbers += f" {'−' if text.startswith('−') else '+'} {text.removeprefix('−')} {unknown}"
    held, gap = (factor * float(values[row]) for values in (solution.prescribed, solution.gap))
    return (
        f"δ{index(row + 1, 0)}{symbols} = {f'c{index(row + 1)}' if held else '0'}",
        f"{written.number(gap, EXACT)}{numbers} = {written.number(held, EXACT)}",
    )


def equations(tables: ForceTables) -> tuple[str, ...]:
    """A line for every unknown, and the solution X."""
    count = len(tables.solution.unknowns)
    lines = [f"{':  '.join(equation(tables, i))}  ({tables.units})" for i in range(count)]
    found = ",  ".join(f"X{index(i + 1)} = {amount(tables.solution, i)}" for i in range(count))
    return (f"{lines[0]},  {found}",) if count == 1 else (*lines, found)


def in_thesis(solution: Solution) -> tuple[str, ...]:
    """p = (Δ − Δ₀) / Δ₁ of the only unknown; of several Δ = Δ₀ + Σ Δ₁ p, a line for every one, and the solution p."""
    names = [unknown.said for unknown in solution.unknowns]
    if len(names) > 1:
        lines = []
        for row, name in enumerate(names):
            terms = (
                f" + {_cm(unit, bracket=True)} p({other})"
                for unit, other in zip(solution.delta_unit[row], names, strict=True)
            )
            lines.append(
                f"{name}: Δ = Δ₀ + Σ Δ₁ p:  {_cm(solution.delta_real[row])} ="
                f" {_cm(solution.delta_base[row])}{''.join(terms)}  (cm, kN)"
            )
        found = (
            f"p({name}) = {written.force(p)}" for name, p in zip(names, solution.force.tolist(), strict=True)
        )
        return (*lines, ",  ".join(found))
    real, base, unit = solution.delta_real[0], solution.delta_base[0], solution.delta_unit[0, 0]
    filled = f"({_cm(real)} − {_cm(base, bracket=True)}) cm / ({_cm(unit)} cm/kN)"
    if solution.unknowns[0].is_moment:
        filled = "({} − ({})) rad / ({} rad/kN·m)".format(*map(written.number, (real, base, unit)))
    return (f"p = (Δ − Δ₀) / Δ₁ = {filled} = {amount(solution, 0)}",)


def _cm(metres: float, *, bracket: bool = False) -> str:
    """Metres as centimetres; a negative number in brackets, if it stands behind a sign."""
    text = written.number(CM[1] * metres)
    return f"({text})" if bracket and text.startswith("−") else text


def table(guide: ForceGuide) -> Sequence[tuple[str, ...]]:
    """Virtual work, rod by rod (part 6), and superposition (part 7)."""
    if guide.solution is None or guide.part < 6:
        return ()
    from pinjoint.methods.tables import PRODUCTS  # it imports scipy

    tables, last = guide.tables, guide.acting
    if guide.in_thesis:
        return tables.sets() if guide.part == PARTS else ()
    if guide.part == 6:
        which = range(last + 1) if last < PRODUCTS else [last]
        return tables.bending(which, last) if tables.bends else tables.virtual_work(which, last)
    return tables.moments() if tables.bends and guide.quantity != AXIAL else tables.axial_forces()
