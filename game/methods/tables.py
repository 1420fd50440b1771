"""Tables of methods: superposition, and virtual work rod by rod; their numbers are written as they are read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Array, Rows
from pinjoint.components.field import CM, ENDS
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import AXES, in_support_axes, supported
from pinjoint.components.rod import bends, nodes
from pinjoint.methods import index
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.force_method import Solution, Terms, bulge
from pinjoint.systems.statics.superposition import SetState, Superposition
from pinjoint.tables import Column, Table

_FINER = 5  # significant digits of forces that are added
PRODUCTS = 4  # unknowns up to which all products of virtual work are listed
_SHOWN = 3  # unknowns up to which each has a column of superposition


@dataclass(frozen=True)
class Tables:
    """The tables of a solution that every method has: superposition, N₀ + Σ X n. letter: of its unknowns."""

    model: Model
    solution: Superposition
    letter = "X"

    @property
    def bends(self) -> bool:
        """True if members bend."""
        return bends(self.model)

    @property
    def rods(self) -> list[str]:
        """Names of all rods, as they are read."""
        return [rod.said for rod in self.model.rods]

    def _names(self, rows: Rows) -> list[str]:
        names = self.rods
        return [names[row] for row in rows.tolist()]

    def axial_forces(self, most: int = _SHOWN) -> Table:
        """N = N₀ + Σ X n of all rods, and by how much linear theory of the real structure differs.

        most: unknowns up to which each has a column.
        """
        return self._superposed("N", "kN", tr("rod"), self.rods, lambda state: state.axial_force, most)

    def moments(self, most: int = _SHOWN) -> Table:
        """Likewise M = M₀ + Σ X m at both ends of the rods that bend."""
        rows = np.flatnonzero((self.model.rods.turning_shares > 0.0).any(axis=1))
        names = [joined([rod, tr(end)], ".") for rod in self._names(rows) for end in ENDS]
        return self._superposed(
            "M", "kN·m", tr("rod"), names, lambda state: state.bending_moment[rows].ravel(), most
        )

    def reactions(self, most: int = _SHOWN) -> Table:
        """Likewise R = R₀ + Σ X r of all supports; those released have their unknown."""
        held = supported(self.model) & [True, True, self.bends]
        places = np.argwhere(held & nodes(self.model)[:, None])
        names, unit = self.directions(places.tolist()), "kN, kN·m" if self.bends else "kN"

        def of(state: SetState) -> Array:
            return in_support_axes(self.model, state.reaction)[tuple(places.T)]

        return self._superposed("R", unit, tr("support"), names, of, most)

    def directions(self, places: Iterable[Sequence[int]]) -> list[str]:
        """Names of directions of particles, by row and axis."""
        particles = self.model.particles
        return [joined([particles[row].said, tr(AXES[axis])], ".") for row, axis in places]

    def _superposed(
        self,
        symbol: str,
        unit: str,
        corner: str,
        names: Sequence[str],
        of: Callable[[SetState], Array],
        most: int,
    ) -> Table:
        solution, small = self.solution, symbol.lower()
        parts = [x * of(state) for x, state in zip(solution.amounts.tolist(), solution.units, strict=True)]
        real, base = of(solution.real), of(solution.base)
        added = sum(parts, np.zeros_like(base))
        terms = [(f"+ {self.letter}{index(i + 1)}{small}{index(i + 1)}", part) for i, part in enumerate(parts)]
        size = max(map(largest, (real, base, *parts)))
        off = np.where(np.abs(base + added - real) <= written.ROUNDING * size, 0.0, base + added - real)
        terms = terms if len(terms) <= most else [(f"+ Σ{self.letter}{small}", added)]
        shown = [(symbol, unit, base + added), (f"= {symbol}₀", "", base)]
        shown += [(title, "", part) for title, part in terms]
        columns = [Column(*column, digits=_FINER, size=size) for column in shown]
        return Table(corner, names, [*columns, Column(tr("difference"), "", off, digits=1)])


@dataclass(frozen=True)
class ForceTables(Tables):
    """Those of the force method, with virtual work.

    Gaps and flexibilities are written in cm and kN; where moments are unknown, in m, rad, kN and kN·m, in which these are
    symmetric.
    """

    solution: Solution

    @property
    def _metric(self) -> bool:
        """True if lengths are in m, not in cm."""
        return any(unknown.is_moment for unknown in self.solution.unknowns)

    @property
    def factor(self) -> float:
        """What gaps and flexibilities in SI units are multiplied by."""
        return 1.0 if self._metric else CM[1]

    @property
    def _length(self) -> str:
        return "m" if self._metric else "cm"

    def gap_unit(self, i: int) -> str:
        """Of δᵢ₀."""
        return "rad" if self.solution.unknowns[i].is_moment else self._length

    def flexibility_unit(self, i: int, j: int) -> str:
        """Of δᵢⱼ."""
        moments = self.solution.unknowns[i].is_moment + self.solution.unknowns[j].is_moment
        return (f"{self._length}/kN", "1/kN", "rad/kN·m")[moments]

    @property
    def units(self) -> str:
        """Of an equation."""
        if not self._metric:
            return "cm, kN"
        return "rad, kN·m" if all(one.is_moment for one in self.solution.unknowns) else "m, rad, kN, kN·m"

    @property
    def _carrying(self) -> Rows:
        """Rods with an axial force that counts: all of a truss, those with one in a frame."""
        pulls = np.abs(self.solution.work.axial.unit[:, :, 0])
        least = written.ROUNDING * pulls.max(axis=1, initial=0.0, keepdims=True)
        return np.flatnonzero((pulls > least).any(axis=0) | (not self.bends))

    def forces(self, which: Sequence[int]) -> Table:
        """What the sums of axial forces are made of: L, EA, N₀, and n of some unknowns."""
        solution, rods, rows = self.solution, self.model.rods, self._carrying
        columns = [
            Column("L", self._length, self.factor * rods.rest_length[rows]),
            Column("EA", "kN", rods.stiffness[rows]),
            Column("N₀", "kN", solution.base.axial_force[rows], least=largest(solution.real.axial_force)),
        ]
        for i in which:
            force, per = solution.units[i].axial_force, "1/m" if solution.unknowns[i].is_moment else ""
            columns.append(Column(f"n{index(i + 1)}", per, force[rows], digits=_FINER, least=largest(force)))
        return Table(tr("rod"), self._names(rows), columns)

    def _products(
        self, which: Sequence[int], rows: Rows, terms: Terms, other: Terms, heads: str, last: int | None
    ) -> list[Column]:
        """The terms of some rods for some unknowns: of the load, without force, and of units; last: those of one alone.

        other: terms of the same sums, next to which they may be rounding. heads: what is summed, such as "∫ M₀ m /EI κ".
        """
        whole, large, small, per, free = heads.split(" ")
        found = []

        def add(title: str, unit: str, values: Array, least: float = 0.0) -> None:
            least = self.factor * max(largest(values), least)
            found.append(Column(f"{whole}{title}", unit, self.factor * values[rows], summed=True, least=least))

        of = which if last is None else [last]
        for i in of:
            least = largest(other.of_load[i])
            add(f"{large}{small}{index(i + 1)}{per}", self.gap_unit(i), terms.of_load[i], least)
        for i in of if terms.of_free.any() else ():
            add(f"{small}{index(i + 1)}{free}", self.gap_unit(i), terms.of_free[i])
        for i, j in ((i, j) for i in which for j in of if i <= j):
            both = f"{index(i + 1)}²" if i == j else f"{index(i + 1)}{small}{index(j + 1)}"
            least = math.sqrt(terms.of_units(i, i).sum() * terms.of_units(j, j).sum())
            add(f"{small}{both}{per}", self.flexibility_unit(i, j), terms.of_units(i, j), least)
        return found

    def virtual_work(self, which: Sequence[int], last: int | None = None) -> Table:
        """The sums over axial forces, with everything that is multiplied, for some unknowns; last: the sums of one alone."""
        forces, work = self.forces(which), self.solution.work
        products = self._products(which, self._carrying, work.axial, work.bending, " N₀ n L/EA ΔL", last)
        return Table(forces.corner, forces.names, [*forces.columns, *products])

    def bending(self, which: Sequence[int], last: int | None = None) -> Table:
        """The same over bending moments, at the starts and ends of the rods; what M₀ is between beside a line."""
        solution, rods, work = self.solution, self.model.rods, self.solution.work
        rows = np.flatnonzero((work.bending.unit != 0.0).any(axis=(0, 2)))
        columns = [
            Column("L", "m", rods.rest_length[rows]),
            Column("EI", "kN·m²", rods.bending_stiffness[rows]),
            *_at_ends("M₀", "kN·m", solution.base.bending_moment, rows, largest(solution.real.end_moment)),
        ]
        bulges = bulge(self.model)[rows]
        if self.model.span_loads.count and bulges.any():
            columns += _at_ends("∫ M₀ − line", "kN·m", bulges, rows, largest(solution.real.end_moment))
        elif bulges.any():
            columns.append(Column("qL²/8", "kN·m", -1.5 * bulges.sum(axis=1)))
        for i in which:
            unit, moment = "" if solution.unknowns[i].is_moment else "m", work.bending.unit[i]
            columns += _at_ends(f"m{index(i + 1)}", unit, moment, rows, largest(moment))
        columns += self._products(which, rows, work.bending, work.axial, "∫ M₀ m /EI κ", last)
        return Table(tr("rod"), self._names(rows), columns)

    def settlements(self) -> Table | None:
        """What moved and elastic supports add to gaps and flexibilities; None if there are none."""
        work = self.solution.work
        settled, terms, soft = work.settled, work.supports, work.supports.softness
        if not len(settled):
            return None
        columns = [Column("c", "m, rad", work.moved)]
        if soft.any():
            columns.append(Column("1/k", "m/kN, rad/kN·m", soft))
        for i in range(len(self.solution.units)):
            columns.append(Column(f"r{index(i + 1)}", "", terms.unit[i, :, 0]))
            values = self.factor * terms.of_load[i]
            columns.append(Column(f"−r{index(i + 1)}c", self.gap_unit(i), values, summed=True))
        for i, j in _pairs(range(len(self.solution.units))) if soft.any() else ():
            both = f"r{index(i + 1)}²/k" if i == j else f"r{index(i + 1)}r{index(j + 1)}/k"
            values = self.factor * terms.of_units(i, j)
            columns.append(Column(both, self.flexibility_unit(i, j), values, summed=True))
        return Table(tr("support"), self.directions(settled.tolist()), columns)

    def sums(self, i: int) -> tuple[str, ...]:
        """What δᵢ₀, δᵢᵢ and δⱼᵢ, j < i, of a frame are sums of."""
        if not self.bends:
            return ()
        return (
            f"{self._sum_of_gap(i)},  {self._sum_of_units(i, i)}",
            *(self._sum_of_units(j, i) for j in range(i)),
        )

    def all_sums(self) -> list[str]:
        """What every δ of a frame is a sum of, without units: bending, axial forces, and what acts without force."""
        every = range(len(self.solution.unknowns))
        sums = [*map(self._sum_of_gap, every), *(self._sum_of_units(i, j) for i, j in _pairs(every))]
        return [text.rpartition(" ")[0] for text in sums]

    def _sum_of_gap(self, i: int) -> str:
        work = self.solution.work
        parts = [work.bending.of_load, work.axial.of_load, work.axial.of_free + work.bending.of_free]
        found = _sum(self.factor * float(part[i].sum()) for part in (*parts, work.supports.of_load))
        return f"δ{index(i + 1, 0)} = {found} {self.gap_unit(i)}"

    def _sum_of_units(self, i: int, j: int) -> str:
        work = self.solution.work
        parts = (terms.of_units(i, j) for terms in (work.bending, work.axial, work.supports))
        found = _sum(self.factor * float(part.sum()) for part in parts)
        same = "" if i == j else f" = δ{index(j + 1, i + 1)}"
        return f"δ{index(i + 1, j + 1)}{same} = {found} {self.flexibility_unit(i, j)}"

    def sets(self) -> Table:
        """Axial forces of set 1 = set 2 + set 3 for every rod, in the thesis' convention."""
        solution = self.solution
        total, real, base = (state.axial_force for state in (solution.superposed, solution.real, solution.base))
        off = np.where(np.abs(total - real) <= written.ROUNDING * largest(real), 0.0, total - real)
        titles = (tr("set 1"), tr("= set 2"), tr("+ set 3"))
        values = (real, base, total - base)
        columns = [Column(title, "", of, digits=_FINER) for title, of in zip(titles, values, strict=True)]
        return Table("kN", self.rods, [*columns, Column(tr("residual"), "", off, digits=1)])


def _at_ends(title: str, unit: str, moments: Array, rows: Rows, least: float) -> list[Column]:
    """Moments (rods, 2) at the starts and ends of some rods."""
    return [
        Column(f"{title}{end}", unit, moments[rows, side], least=least) for side, end in enumerate(("", "′"))
    ]


def _sum(terms: Iterable[float]) -> str:
    """A sum with its numbers, or the only one of them."""
    text = written.total(terms)
    return text.rpartition(" ")[2] if text.count(" ") == 2 else text


def _pairs(which: Iterable[int]) -> list[tuple[int, int]]:
    return [(i, j) for i in which for j in which if i <= j]
