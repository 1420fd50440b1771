"""Tables of the force method: virtual work rod by rod, and superposition; their numbers are written as they are read."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import CM, ENDS
from pinjoint.components.language import decimals, joined, tr
from pinjoint.components.model import Model
from pinjoint.systems.statics.equations import Array, Rows, largest
from pinjoint.systems.statics.force_method import Solution
from pinjoint.systems.statics.unknowns import AXES, Unknown
from pinjoint.systems.statics.virtual_work import Work, virtual_work

_SMALL = 1e-2  # smaller numbers are written as multiples of a power of 1000
_FINER = 5  # significant digits of forces that are added
PRODUCTS = 4  # unknowns up to which all products of virtual work are listed
_SHOWN = 3  # unknowns up to which each has a column of superposition
_ABOVE = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_BELOW = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def index(*numbers: int) -> str:
    """Indices as they stand below: "₁₀"; apart from each other if one has two digits."""
    return ("" if max(numbers) < 10 else "\u2009").join(str(number).translate(_BELOW) for number in numbers)


class Column:
    """Numbers of one kind below each other: with equal decimals, and a power of ten in the head if all are small.

    summed: there is a sum at the foot; decimals are then such that what is written adds up, if two more are enough.
    size: of the largest number of its kind; None: that in the column. least: of what is no rounding.
    """

    def __init__(
        self,
        title: str,
        unit: str,
        values: Array,
        *,
        summed: bool = False,
        digits: int = written.DIGITS,
        size: float | None = None,
        least: float = 0.0,
    ) -> None:
        self.summed = summed
        values = np.where(np.abs(values) <= written.ROUNDING * least, 0.0, values)
        total = float(values.sum())
        greatest = max(float(np.abs(values).max(initial=0.0)), abs(total) if summed else 0.0)
        greatest = greatest if size is None else size
        power = math.floor(math.log10(greatest)) if greatest > 0.0 else 0
        self.power = 0 if greatest >= _SMALL or not greatest else 3 * math.floor(power / 3)
        self._scaled, self._total = values / 10.0**self.power, total / 10.0**self.power
        self._decimals = max(digits - 1 - (power - self.power), 0)
        self._nothing = written.ROUNDING * greatest / 10.0**self.power
        if summed:
            self._decimals = self._adding_up()
        ten = f"10{str(self.power).translate(_ABOVE)} " if self.power else ""
        self.title, self.unit = title, f"{ten}{unit}".strip()

    def _adding_up(self) -> int:
        for places in range(self._decimals, self._decimals + written.MORE_DIGITS + 1):
            rounded = float(np.round(self._scaled, places).sum())
            if abs(rounded - round(self._total, places)) < 0.5 * 10.0**-places:
                return places
        return self._decimals

    @property
    def head(self) -> str:
        """Title and unit."""
        return f"{self.title} ({self.unit})" if self.unit else self.title

    def text(self, row: int) -> str:
        """The number in a row; below the last one their sum, "" where there is none."""
        if row == len(self._scaled):
            return self._text(self._total) if self.summed else ""
        return self._text(float(self._scaled[row]))

    def _text(self, value: float) -> str:
        if abs(value) <= self._nothing:
            return "0"
        return decimals(f"{round(value, self._decimals) + 0.0:.{self._decimals}f}".replace("-", "−"))


class Table(Sequence[tuple[str, ...]]):
    """Columns beside the names of what their rows belong to, below a head; each row is written on demand, since a large
    structure has more than fit a page."""

    def __init__(self, corner: str, names: Sequence[str], columns: Sequence[Column]) -> None:
        self.corner, self.names, self.columns = corner, names, columns
        self.summed = any(column.summed for column in columns)

    def __len__(self) -> int:
        return 1 + len(self.names) + self.summed

    @overload
    def __getitem__(self, index: int) -> tuple[str, ...]: ...
    @overload
    def __getitem__(self, index: slice) -> list[tuple[str, ...]]: ...
    def __getitem__(self, index: int | slice) -> tuple[str, ...] | list[tuple[str, ...]]:
        places = range(len(self))[index]
        return self._row(places) if isinstance(places, int) else [self._row(place) for place in places]

    def _row(self, place: int) -> tuple[str, ...]:
        if place == 0:
            return (self.corner, *(column.head for column in self.columns))
        name = "Σ" if place > len(self.names) else self.names[place - 1]
        return (name, *(column.text(place - 1) for column in self.columns))


@dataclass(frozen=True)
class Units:
    """In what gaps and flexibilities are written: cm and kN; where moments are unknown, m, rad, kN and kN·m, in which
    flexibilities are symmetric."""

    unknowns: Sequence[Unknown]

    @property
    def metric(self) -> bool:
        """True if lengths are in m, not in cm."""
        return any(unknown.is_moment for unknown in self.unknowns)

    @property
    def factor(self) -> float:
        """What gaps and flexibilities in SI units are multiplied by."""
        return 1.0 if self.metric else CM[1]

    @property
    def length(self) -> str:
        """Of lengths."""
        return "m" if self.metric else "cm"

    def gap(self, i: int) -> str:
        """Of δᵢ₀."""
        return "rad" if self.unknowns[i].is_moment else self.length

    def flexibility(self, i: int, j: int) -> str:
        """Of δᵢⱼ."""
        moments = self.unknowns[i].is_moment + self.unknowns[j].is_moment
        return (f"{self.length}/kN", "1/kN", "rad/kN·m")[moments]

    @property
    def all(self) -> str:
        """Of an equation."""
        if not self.metric:
            return "cm, kN"
        return "rad, kN·m" if all(unknown.is_moment for unknown in self.unknowns) else "m, rad, kN, kN·m"


@dataclass(frozen=True)
class Tables:
    """The tables of a solution."""

    model: Model
    solution: Solution
    work: Work

    @classmethod
    def of(cls, model: Model, solution: Solution) -> Tables:
        """Those of a solution."""
        return cls(model, solution, virtual_work(model, solution))

    @property
    def units(self) -> Units:
        """Of the sums at the foot."""
        return Units(self.solution.unknowns)

    @property
    def bends(self) -> bool:
        """True if members bend."""
        return len(self.solution.real.end_moment) > 0

    @property
    def _carrying(self) -> Rows:
        """Rods with an axial force that counts: all of a truss, those with one in a frame."""
        work = self.work
        least = written.ROUNDING * np.abs(work.unit_axial).max(axis=1, initial=0.0, keepdims=True)
        pulled = (
            (np.abs(work.unit_axial) > least).any(axis=0)
            if self.bends
            else np.ones(len(work.length), dtype=bool)
        )
        return np.flatnonzero(pulled)

    @property
    def _bending(self) -> Rows:
        return np.flatnonzero((self.work.unit_moment != 0.0).any(axis=(0, 2)))

    def forces(self, which: Sequence[int]) -> Table:
        """What the sums of axial forces are made of: L, EA, N₀, and n of some unknowns."""
        work, rows = self.work, self._carrying
        columns = [
            Column("L", self.units.length, self.units.factor * work.length[rows]),
            Column("EA", "kN", work.stiffness[rows]),
            Column("N₀", "kN", work.base_axial[rows], least=largest(self.solution.real.axial_force)),
            *(self._unit_forces(i) for i in which),
        ]
        return Table(tr("rod"), self._names(rows), columns)

    def _unit_forces(self, i: int) -> Column:
        force = self.work.unit_axial[i]
        return Column(
            f"n{index(i + 1)}", self._per(i), force[self._carrying], digits=_FINER, least=largest(force)
        )

    def _per(self, unknown: int) -> str:
        return "1/m" if self.solution.unknowns[unknown].is_moment else ""

    def _names(self, rows: Rows) -> list[str]:
        names = self.model.rods.names
        return [names[row] for row in rows.tolist()]

    def products(self, which: Sequence[int], *, base: bool = True) -> list[Column]:
        """N₀ n L/EA of some unknowns, what elongations without force add, and n n' L/EA."""
        work, rows, units = self.work, self._carrying, self.units
        found = []
        for i in which if base else ():
            title = f"N₀n{index(i + 1)}L/EA"
            found.append(self._terms(title, units.gap(i), work.of_base[i], rows, work.of_bending[i]))
        if base and work.free.any():
            for i in which:
                values = units.factor * (work.unit_axial[i] * work.free)[rows]
                found.append(Column(f"n{index(i + 1)}ΔL", units.gap(i), values, summed=True))
        for i, j in _pairs(which):
            title = f"n{index(i + 1)}²L/EA" if i == j else f"n{index(i + 1)}n{index(j + 1)}L/EA"
            least = math.sqrt(work.of_units(i, i).sum() * work.of_units(j, j).sum())
            found.append(self._terms(title, units.flexibility(i, j), work.of_units(i, j), rows, least))
        return found

    def _terms(self, title: str, unit: str, terms: Array, rows: Rows, beside: Array | float) -> Column:
        """Terms of a sum of some rods; beside: others of the same sum, next to which they may be rounding."""
        factor = self.units.factor
        least = factor * max(largest(terms), largest(np.asarray(beside)))
        return Column(title, unit, factor * terms[rows], summed=True, least=least)

    def virtual_work(self, which: Sequence[int]) -> Table:
        """The sums over axial forces, with everything that is multiplied, for some unknowns."""
        forces = self.forces(which)
        return Table(forces.corner, forces.names, [*forces.columns, *self.products(which)])

    def bending(self, which: Sequence[int]) -> Table:
        """The same over bending moments, at the starts and ends of the rods; q L²/8 by which M₀ bulges between."""
        work, rows, units = self.work, self._bending, self.units
        moment = largest(self.solution.real.end_moment)
        columns = [
            Column("L", "m", work.length[rows]),
            Column("EI", "kN·m²", work.bending_stiffness[rows]),
            *(
                Column(f"M₀{end}", "kN·m", work.base_moment[rows, side], least=moment)
                for side, end in enumerate(("", "′"))
            ),
        ]
        if work.load[rows].any():
            columns.append(Column("qL²/8", "kN·m", -work.load[rows] / 8.0))
        for i in which:
            unit = "" if self.solution.unknowns[i].is_moment else "m"
            columns += [
                Column(
                    f"m{index(i + 1)}{end}",
                    unit,
                    work.unit_moment[i, rows, side],
                    least=largest(work.unit_moment[i]),
                )
                for side, end in enumerate(("", "′"))
            ]
        for i in which:
            title = f"∫M₀m{index(i + 1)}/EI"
            columns.append(self._terms(title, units.gap(i), work.of_bending[i], rows, work.of_base[i]))
        if work.curvature.any():
            for i in which:
                warm = work.length * work.curvature * work.unit_moment[i].mean(axis=1)
                columns.append(
                    Column(f"∫m{index(i + 1)}κ", units.gap(i), units.factor * warm[rows], summed=True)
                )
        for i, j in _pairs(which):
            title = f"∫m{index(i + 1)}²/EI" if i == j else f"∫m{index(i + 1)}m{index(j + 1)}/EI"
            least = math.sqrt(work.of_unit_bending(i, i).sum() * work.of_unit_bending(j, j).sum())
            terms = work.of_unit_bending(i, j)
            columns.append(self._terms(title, units.flexibility(i, j), terms, rows, least))
        return Table(tr("rod"), self._names(rows), columns)

    def settlements(self) -> Table | None:
        """What moved supports add to the gaps; None if none has moved."""
        work, units = self.work, self.units
        if not len(work.settled):
            return None
        particles, names = self.model.particles, self.model.particles.names
        places = np.column_stack([particles.displacement, particles.rotation])[tuple(work.settled.T)]
        columns = [Column("c", "m, rad", places)]
        for i in range(len(self.solution.unknowns)):
            reaction = self.solution.units[i].reaction[tuple(work.settled.T)]
            columns.append(Column(f"r{index(i + 1)}", "", reaction))
            values = units.factor * work.of_supports[i]
            columns.append(Column(f"−r{index(i + 1)}c", units.gap(i), values, summed=True))
        return Table(
            tr("support"),
            [joined([names[row], tr(AXES[axis])], ".") for row, axis in work.settled.tolist()],
            columns,
        )

    def sums(self, i: int) -> tuple[str, ...]:
        """What δᵢ₀ and δᵢᵢ of a frame are sums of."""
        return (f"{self._sum_of_gap(i)},  {self._sum_of_units(i, i)}",) if self.bends else ()

    def all_sums(self) -> list[str]:
        """What every δ of a frame is a sum of, without units: bending, axial forces, and what acts without force."""
        every = range(len(self.solution.unknowns))
        sums = [*map(self._sum_of_gap, every), *(self._sum_of_units(i, j) for i, j in _pairs(every))]
        return [text.rpartition(" ")[0] for text in sums]

    def _sum_of_gap(self, i: int) -> str:
        work, units = self.work, self.units
        ways = (work.of_bending, work.of_base, work.of_free, work.of_supports)
        found = _sum(units.factor * float(way[i].sum()) for way in ways)
        return f"δ{index(i + 1, 0)} = {found} {units.gap(i)}"

    def _sum_of_units(self, i: int, j: int) -> str:
        parts = (self.work.of_unit_bending(i, j), self.work.of_units(i, j))
        found = _sum(self.units.factor * float(part.sum()) for part in parts)
        same = "" if i == j else f" = δ{index(j + 1, i + 1)}"
        return f"δ{index(i + 1, j + 1)}{same} = {found} {self.units.flexibility(i, j)}"

    # --- superposition -----------------------------------------------------------------------------

    def axial_forces(self, most: int = _SHOWN) -> Table:
        """N = N₀ + Σ X n of all rods, and by how much linear theory of the real structure differs.

        most: unknowns up to which each has a column.
        """
        solution = self.solution
        units = self.work.unit_axial
        parts = [x * unit for x, unit in zip(solution.force.tolist(), units, strict=True)]
        return self._superposed(
            "N",
            ["n"] * len(units),
            self.model.rods.names,
            solution.base.axial_force,
            parts,
            solution.real.axial_force,
            "kN",
            most,
        )

    def moments(self, most: int = _SHOWN) -> Table:
        """Likewise M = M₀ + Σ X m at both ends of the rods that bend."""
        solution, rods = self.solution, self.model.rods
        rows = np.flatnonzero((rods.turning_shares > 0.0).any(axis=1))
        names = [joined([rods.names[row], tr(end)], ".") for row in rows.tolist() for end in ENDS]
        units = [unit.bending_moment[rows].ravel() for unit in solution.units]
        parts = [x * unit for x, unit in zip(solution.force.tolist(), units, strict=True)]
        base, real = solution.base.bending_moment[rows].ravel(), solution.real.bending_moment[rows].ravel()
        return self._superposed("M", ["m"] * len(parts), names, base, parts, real, "kN·m", most)

    def reactions(self, most: int = _SHOWN) -> Table:
        """Likewise R = R₀ + Σ X r of all supports; those released have their unknown."""
        solution, particles = self.solution, self.model.particles
        fixed = np.column_stack([particles.fixed, particles.fixed_rotation & self.bends])
        whole = solution.superposed.reaction
        used = np.zeros(particles.count, dtype=bool)
        used[self.model.rods.between] = True
        places = [tuple(place) for place in np.argwhere(fixed & used[:, None]).tolist()]
        places = [place for place in places if place[1] < whole.shape[1]]
        rows = tuple(np.array(places, dtype=np.intp).reshape(-1, 2).T)
        parts = []
        for x, unknown, unit in zip(solution.force.tolist(), solution.unknowns, solution.units, strict=True):
            reaction = unit.reaction.copy()
            if unknown.of_support:
                reaction[unknown.element.row, unknown.axis] = 1.0
            parts.append(x * reaction[rows])
        names = [joined([particles.names[row], tr(AXES[axis])], ".") for row, axis in places]
        base, real = solution.base.reaction[rows], solution.real.reaction[rows]
        return self._superposed(
            "R", ["r"] * len(parts), names, base, parts, real, "kN, kN·m" if self.bends else "kN", most
        )

    def _superposed(
        self,
        symbol: str,
        small: Sequence[str],
        names: Sequence[str],
        base: Array,
        parts: Sequence[Array],
        real: Array,
        unit: str,
        most: int,
    ) -> Table:
        whole = base + sum(parts, np.zeros_like(base))
        if len(parts) <= most:
            terms = [(f"+ X{index(i + 1)}{small[i]}{index(i + 1)}", part) for i, part in enumerate(parts)]
        else:
            terms = [(f"+ ΣX{small[0]}", sum(parts, np.zeros_like(base)))]
        size = max((largest(part) for part in (real, base, *parts)), default=0.0)
        off = np.where(np.abs(whole - real) <= written.ROUNDING * size, 0.0, whole - real)
        shown = [
            (symbol, unit, whole),
            (f"= {symbol}₀", "", base),
            *((title, "", part) for title, part in terms),
        ]
        columns = [
            *(Column(*of, digits=_FINER, size=size) for of in shown),
            Column(tr("difference"), "", off, digits=1),
        ]
        return Table(tr("rod") if symbol != "R" else tr("support"), names, columns)


def _sum(terms: Iterable[float]) -> str:
    """A sum with its numbers, or the only one of them."""
    text = written.total(terms)
    return text.rpartition(" ")[2] if text.count(" ") == 2 else text


def _pairs(which: Sequence[int]) -> list[tuple[int, int]]:
    return [(i, j) for i in which for j in which if i <= j]
