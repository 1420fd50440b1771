"""Texts of the force method in the thesis' convention: p = (Δ − Δ₀) / Δ₁ from the displacements of three sets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import CM
from pinjoint.components.language import listed, tr
from pinjoint.force_method import PARTS

if TYPE_CHECKING:  # they import scipy
    from pinjoint.force_method.guide import Guide
    from pinjoint.systems.statics.force_method import Solution
    from pinjoint.systems.statics.unknowns import Unknown


def message(guide: Guide) -> str:
    """The line of red text from part 3 on."""
    names, one = listed([unknown.name for unknown in guide.released]), len(guide.released) == 1
    return {
        3: tr("Primary structure: {names} is released", names=names)
        if one
        else tr("Primary structure: {names} are released", names=names),
        4: tr("How far the released place moved"),
        5: tr("Primary structure under a pair of unit forces alone")
        if _is_pair(guide.unknown)
        else tr("Primary structure under a unit force alone"),
        6: tr("How far the unit force moves it"),
        7: tr("Set 2 + set 3 = set 1"),
    }[guide.part]


def _is_pair(unknown: Unknown | None) -> bool:
    return unknown is not None and unknown.of_bar


def captions(guide: Guide, shown: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """The captions of the three sets, with loads, and displacements once they are measured."""
    solution = guide.solution
    assert solution is not None
    name = guide.released[-1].name
    third = tr("a unit force at {name}", name=name)
    if _is_pair(guide.unknown):
        third = tr("a pair of unit forces at {name}", name=name)
    if guide.part == PARTS:
        several = len(guide.released) > 1
        third = tr("the forces p below") if several else f"p = {written.force(solution.force[0])}"
    for i, load in enumerate((tr("the real load"), tr("the real load"), third)[: len(guide.sets)]):
        shown[i] = (*shown[i], load)
    if guide.part >= 4:
        shown[0] = (*shown[0], *_each(guide, "", solution.delta_real.tolist()))
        shown[1] = (*shown[1], *_each(guide, "₀", solution.delta_base.tolist()))
    if guide.part == 6 or (guide.part == PARTS and len(guide.released) == 1):
        shown[2] = (*shown[2], *_each(guide, "₁", solution.delta_unit[:, -1].tolist(), "/kN"))
    return shown


def _each(guide: Guide, index: str, metres: Sequence[float], per: str = "") -> tuple[str, ...]:
    """The displacement of every unknown: Δ, the change of distance of a rod, or u, that of a support."""
    several = len(guide.released) > 1
    return tuple(
        f"{'Δ' if unknown.of_bar else 'u'}{index}{f' {unknown.name}' * several} = {_written(unknown, value)}{per}"
        for unknown, value in zip(guide.released, metres, strict=True)
    )


def _written(unknown: Unknown, value: float) -> str:
    return f"{written.number(value)} rad" if unknown.is_moment else f"{_cm(value)} cm"


def working(guide: Guide) -> tuple[str, ...]:
    """The compatibility equations with their numbers, and their solution (part 7)."""
    solution = guide.solution
    if solution is None or guide.part < PARTS:
        return ()
    return solved_lines(solution)


def solved_lines(solution: Solution) -> tuple[str, ...]:
    """The equations with their numbers, and the unknowns p."""
    return _one_equation(solution) if len(solution.unknowns) == 1 else _equations(solution)


def _one_equation(solution: Solution) -> tuple[str, ...]:
    real, base, unit = solution.delta_real[0], solution.delta_base[0], solution.delta_unit[0, 0]
    if solution.unknowns[0].is_moment:
        numbers = (written.number(value) for value in (real, base, unit))
        filled = "({} − ({})) rad / ({} rad/kN·m)".format(*numbers)
        return (f"p = (Δ − Δ₀) / Δ₁ = {filled} = {written.moment(solution.force[0])}",)
    return (
        f"p = (Δ − Δ₀) / Δ₁ = ({_cm(real)} − {_cm(base, bracket=True)}) cm / ({_cm(unit)} cm/kN)"
        f" = {written.force(solution.force[0])}",
    )


def _equations(solution: Solution) -> tuple[str, ...]:
    """Δ = Δ₀ + Σ Δ₁ p, a line for every unknown, and the solution p."""
    names = [unknown.name for unknown in solution.unknowns]
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
    forces = (f"p({name}) = {written.force(p)}" for name, p in zip(names, solution.force.tolist(), strict=True))
    return (*lines, ",  ".join(forces))


def table(guide: Guide) -> Sequence[tuple[str, ...]]:
    """Axial forces (kN) of set 1 = set 2 + set 3 for every rod (part 7)."""
    from pinjoint.force_method.tables import Column, Table  # it imports scipy

    solution = guide.solution
    if solution is None or guide.part < PARTS:
        return ()
    total, real, base = (state.axial_force for state in (solution.superposed, solution.real, solution.base))
    largest = float(np.abs(real).max(initial=0.0))
    off = np.where(np.abs(total - real) <= written.ROUNDING * largest, 0.0, total - real)
    titles = (tr("set 1"), tr("= set 2"), tr("+ set 3"))
    columns = [
        Column(title, "", values, digits=5)
        for title, values in zip(titles, (real, base, total - base), strict=True)
    ]
    return Table("kN", guide.model.rods.names, [*columns, Column(tr("residual"), "", off, digits=1)])


def _cm(metres: float, *, bracket: bool = False) -> str:
    """Metres as centimetres; a negative number in brackets, if it stands behind a sign."""
    text = written.number(CM[1] * metres)
    return f"({text})" if bracket and text.startswith("−") else text
