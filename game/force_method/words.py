"""Texts of the force method: messages, captions, equations and the final table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from components import written
from components.field import CM
from components.view import BETWEEN
from game.force_method import PARTS

if TYPE_CHECKING:  # they import scipy
    from game.force_method.guide import Guide
    from systems.statics.force_method import Solution
    from systems.statics.unknowns import Unknown

Caption = tuple[str, ...]

NAMES = ("Set 1: real structure", "Set 2: released, under load", "Set 3: the unknown alone")
TO_COME = ("", "follows in part 3", "follows in part 5")


# --- messages and hints ------------------------------------------------------------------------------


def message(guide: Guide) -> str:
    """The line of red text: the present part, or the reason of a refusal."""
    if guide.refusal:
        return guide.refusal
    if guide.part == 2:
        return (
            "Which direction of the support?" if guide.axis_wanted else "Choose a rod or a support to release"
        )
    return {
        1: "Real structure under the real load",
        3: f"Primary structure: {_released(guide)} {'are' if len(guide.released) > 1 else 'is'} released",
        4: "How far the released place moved",
        5: f"Primary structure under {_unit_words(guide.unknown)} alone",
        6: "How far the unit force moves it",
        7: "Set 2 + set 3 = set 1",
    }[guide.part]


def hint(guide: Guide) -> str:
    """The next possible step."""
    steps = ["I forces", "Esc back to pause"]
    if guide.part == 2 and guide.axis_wanted:
        steps = ["X horizontal", "Y vertical", "Esc back to pause"]
    elif guide.part == 2:
        steps = ["click a rod or a support in set 1", "Esc back to pause"]
    elif guide.can_release_another:
        steps = ["K finish", "N release another", *steps]
    else:
        steps = ["K finish" if guide.part == PARTS else "K next part", *steps]
    return BETWEEN.join(steps)


def _released(guide: Guide) -> str:
    names = [unknown.name for unknown in guide.released]
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _unit_words(unknown: Unknown | None) -> str:
    return "a pair of unit forces" if unknown is not None and unknown.axis is None else "a unit force"


# --- captions ----------------------------------------------------------------------------------------


def captions(guide: Guide) -> list[Caption]:
    """The captions of the three sets: name, load, and displacements once they are measured."""
    if guide.mechanism is not None:
        return [(NAMES[0],), ("A mechanism: nothing resists this motion",), ("",)]
    there = len(guide.sets)
    shown: list[Caption] = [(name, *(() if i < there else (TO_COME[i],))) for i, name in enumerate(NAMES)]
    solution = guide.solution
    if solution is None or guide.part == 2:
        return shown
    third = f"{_unit_words(guide.unknown)} at {guide.released[-1].name}"
    if guide.part == PARTS:
        several = len(guide.released) > 1
        third = "the forces p below" if several else f"p = {written.force(solution.force[0])}"
    for i, load in enumerate(("the real load", "the real load", third)[:there]):
        shown[i] = (*shown[i], load)
    if guide.part >= 4:
        shown[0] = (*shown[0], *_each(guide, "", solution.delta_real))
        shown[1] = (*shown[1], *_each(guide, "₀", solution.delta_base))
    if guide.part == 6 or (guide.part == PARTS and len(guide.released) == 1):
        shown[2] = (*shown[2], *_each(guide, "₁", solution.delta_unit[:, -1], " per kN"))
    return shown


def _each(guide: Guide, index: str, metres: object, unit: str = "") -> Caption:
    """The displacement of every unknown: Δ, the change of distance of a rod, or u, that of a support."""
    several = len(guide.released) > 1
    return tuple(
        f"{'Δ' if unknown.axis is None else 'u'}{index}{f' {unknown.name}' * several} = {_cm(value)} cm{unit}"
        for unknown, value in zip(guide.released, metres, strict=True)  # type: ignore[call-overload]
    )


# --- the working -------------------------------------------------------------------------------------


def working(guide: Guide) -> tuple[str, ...]:
    """The compatibility equations with their numbers, and their solution (part 7)."""
    solution = guide.solution
    if guide.part == 1:
        formula = f"{guide.count.formula} = {guide.count.numbers}"
        return (
            formula,
            _degree(guide.degree),
            "Yielding is switched off: superposition needs linear behaviour.",
        )
    if solution is None or guide.part < PARTS:
        return ()
    lines = _one_equation(solution) if len(solution.unknowns) == 1 else _equations(solution)
    if guide.exact is None:
        return lines
    return (*lines, f"Exact geometry gives {', '.join(map(written.force, guide.exact))}.")


def _degree(degree: int) -> str:
    if degree == 0:
        return "The structure is statically determinate: nothing in it can be released."
    return f"The structure is statically indeterminate: {degree} unknown{'s' * (degree > 1)} to release."


def _one_equation(solution: Solution) -> tuple[str, ...]:
    real, base, unit = solution.delta_real[0], solution.delta_base[0], solution.delta_unit[0, 0]
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
    solution = guide.solution
    return Superposition(guide.model.rods.names, solution) if solution and guide.part == PARTS else ()


class Superposition(Sequence[tuple[str, ...]]):
    """The rows of the final table, each written on demand: a large structure has more rows than fit a page."""

    def __init__(self, names: list[str], solution: Solution) -> None:
        total = solution.superposed.axial_force
        real, base = solution.real.axial_force, solution.base.axial_force
        self._names, self._forces, self._residual = names, (real, base, total - base), total - real
        self._rounding = written.ROUNDING * float(abs(real).max(initial=0.0))

    def __len__(self) -> int:
        return 1 + len(self._names)

    @overload
    def __getitem__(self, index: int) -> tuple[str, ...]: ...
    @overload
    def __getitem__(self, index: slice) -> list[tuple[str, ...]]: ...
    def __getitem__(self, index: int | slice) -> tuple[str, ...] | list[tuple[str, ...]]:
        places = range(len(self))[index]
        return self._row(places) if isinstance(places, int) else [self._row(place) for place in places]

    def _row(self, place: int) -> tuple[str, ...]:
        if place == 0:
            return ("kN", "set 1", "= set 2", "+ set 3", "residual")
        rod = place - 1
        forces = (written.number(float(column[rod]), nothing=self._rounding) for column in self._forces)
        return (
            self._names[rod],
            *forces,
            written.number(float(self._residual[rod]), 1, nothing=self._rounding),
        )


def _cm(metres: float, *, bracket: bool = False) -> str:
    """Metres as centimetres; a negative number in brackets, if it stands behind a sign."""
    text = written.number(CM[1] * metres)
    return f"({text})" if bracket and text.startswith("−") else text
