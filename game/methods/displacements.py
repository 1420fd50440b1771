"""The displacement method: the guide through its six parts, and its tables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Array
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.particle import in_support_axes, spring_stiffness, turned, turned_supports
from pinjoint.components.rod import Rod
from pinjoint.components.tags import Selected
from pinjoint.components.view import View
from pinjoint.methods import index
from pinjoint.methods.copies import base_structure, held, still, unloaded
from pinjoint.methods.guide import Guide, Set
from pinjoint.methods.tables import Tables
from pinjoint.methods.words import EXACT
from pinjoint.systems.schedule import Schedule
from pinjoint.systems.statics.displacement_method import Solution, solve
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.superposition import SetState
from pinjoint.tables import Column, Table


@dataclass(frozen=True)
class DisplacementTables(Tables):
    """Those of the displacement method; in m, rad, kN, kN·m."""

    solution: Solution
    letter = "Δ"

    @property
    def names(self) -> list[str]:
        """Of the unknowns, such as "B.x"."""
        return self.directions([(one.element.row, one.axis or 0) for one in self.solution.unknowns])

    def unit(self, i: int, j: int | None = None) -> str:
        """Of an entry of K, or of F."""
        turns = [one.is_moment for one in self.solution.unknowns]
        if j is None:
            return "kN·m" if turns[i] else "kN"
        return ("kN/m", "kN", "kN·m")[turns[i] + turns[j]]

    def coefficients(self) -> Table:
        """Forces at the ends of the members by unit displacements in their own axes: N, V by δ, M₁ and M₂ by φ₁ and φ₂."""
        rods, length = self.model.rods, self.model.rods.rest_length
        stretching = np.where(rods.inextensible, np.nan, rods.stiffness / length)
        columns = [Column("L", "m", length), Column("N/δ", "kN/m", stretching)]
        if self.bends:
            first, mixed, second = rods.end_stiffness.T
            shown = [("M₁/φ₁", "kN·m", first), ("M₁/φ₂ = M₂/φ₁", "kN·m", mixed), ("M₂/φ₂", "kN·m", second)]
            shown += [("V/φ₁", "kN", (first + mixed) / length), ("V/φ₂", "kN", (mixed + second) / length)]
            shown.append(("V/δ", "kN/m", (first + 2.0 * mixed + second) / length**2))
            columns += [Column(*column) for column in shown]
        return Table(tr("rod"), self.rods, columns)

    def member(self, row: int) -> Table:
        """k of a rod over the directions of both its ends, along the axes of supports there."""
        matrix, width = self.solution.members[row], self.solution.members.shape[1] // 2
        felt = np.flatnonzero(matrix.any(axis=0)).tolist()
        ends = self.model.rods.between[row].tolist()
        names = self.directions([(ends[at // width], at % width) for at in felt])
        columns = [
            Column(name, "", matrix[felt, at], alike=False, digits=EXACT)
            for name, at in zip(names, felt, strict=True)
        ]
        return Table(f"k {self.rods[row]}", names, columns)

    @cached_property
    def fixed_end_forces(self) -> Array:
        """On the ends of all rods while the unknowns are held, under the load, as `members` (rods, 2 × width)."""
        rods, solution = self.model.rods, self.solution
        copy = still(held(base_structure(self.model, []), solution), self.model, solution.base)
        axis = rods.difference / rods.original_length[:, None]
        left = np.column_stack([-axis[:, 1], axis[:, 0]])
        forces = np.zeros((rods.count, 2, solution.members.shape[1] // 2))
        for end, sign in enumerate((-1.0, 1.0)):
            pull, shear = sign * copy.rods.end_axial_force[:, end], -sign * copy.rods.shear[:, end]
            forces[:, end, :2] = pull[:, None] * axis + shear[:, None] * left
        if forces.shape[2] > 2:
            forces[:, :, 2] = solution.base.end_moment
        angle = np.where(turned_supports(self.model), self.model.particles.support_angle, 0.0)
        for end in (0, 1):
            forces[:, end] = turned(forces[:, end], angle[rods.between[:, end]])
        return forces.reshape(solution.members.shape[:2])

    def shares(self, i: int, j: int) -> Array:
        """What every rod adds to an entry of K, or behind its last column to F (rods,)."""
        if j < len(self.solution.unknowns):
            return self.solution.shares(i, j)
        found: Array = -(self.fixed_end_forces * self.solution.ways[:, :, i]).sum(axis=1)
        return found

    def terms(self, i: int, j: int) -> list[tuple[Rod, float]]:
        """The same by those that add something."""
        shares = self.shares(i, j)
        least = written.ROUNDING * max(largest(shares), largest(self.solution.load) * (j == len(self.names)))
        pairs = zip(self.model.rods, shares.tolist(), strict=True)
        return [(rod, value) for rod, value in pairs if abs(value) > least]

    def column(self, j: int) -> Table:
        """Column j of K, or behind the last F, member by member; elastic supports or loads on joints have the rest."""
        total = np.column_stack([self.solution.stiffness, self.solution.load])[:, j]
        of_load, which = j == len(total), [i for i, value in enumerate(total) if value or j == len(total)]
        shares = np.array([self.shares(i, j) for i in which]).reshape(len(which), self.model.rods.count)
        least = max(largest(shares), largest(total))
        shares = np.column_stack([shares, total[which] - shares.sum(axis=1)])
        rows = np.flatnonzero((np.abs(shares) > written.ROUNDING * least).any(axis=0))
        every = [*self.rods, tr("joints") if of_load else tr("supports")]
        names, shares = [every[row] for row in rows.tolist()], shares[:, rows]
        columns = []
        for i, values in zip(which, shares, strict=True):
            title = f"F{index(i + 1)}" if of_load else f"k{index(i + 1, j + 1)}"
            unit = self.unit(i, None if of_load else j)
            columns.append(Column(title, unit, values, summed=True, least=least))
        return Table(tr("rod"), names, columns)

    def system(self) -> Table:
        """K Δ = F: a row for every unknown, with what it is found to be."""
        solution = self.solution
        names = [f"Δ{index(i + 1)} {name}" for i, name in enumerate(self.names)]
        shown = [(f"Δ{index(j + 1)}", "", column) for j, column in enumerate(solution.stiffness.T)]
        shown.append(("F", "kN, kN·m" if self.bends else "kN", solution.load))
        columns = [Column(*column, alike=False, digits=EXACT) for column in shown]
        found = Column("Δ", "m, rad" if self.bends else "m", solution.displacement, alike=False)
        return Table("K", names, [*columns, found])

    @property
    def unbalanced(self) -> float:
        """The largest force (kN, kN·m) that would still hold a joint after superposition, 0 but for rounding."""
        whole, solution = self.solution.superposed, self.solution
        springs = spring_stiffness(self.model)
        pairs = zip(solution.unknowns, solution.displacement, strict=True)
        reaction = in_support_axes(self.model, whole.reaction)
        left = [reaction[one.place] + springs[one.place] * moved for one, moved in pairs]
        size = max(map(largest, (solution.base.reaction, solution.real.end_moment, solution.real.axial_force)))
        most = largest(np.array(left))
        return most if most > written.ROUNDING * size else 0.0


class DisplacementGuide(Guide):
    """Of the displacement method, of which part 4 is gone through for every unknown.

    member: the rod of which k is shown. pointed: row and column of an entry of K (or F, behind the last) that is explained.
    """

    parts, whole = 6, True
    solution: Solution

    def __init__(self, model: Model, schedule: Schedule, view: View) -> None:
        super().__init__(model, schedule, view)
        self.solution = solve(model)
        self.tables = DisplacementTables(model, self.solution)
        self.member: Rod | None = None
        self.pointed: tuple[int, int] | None = None
        self._show()

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return len(self.solution.unknowns)

    @property
    def shown_now(self) -> tuple[object, ...]:
        return (*super().shown_now, self.member)

    def next(self) -> bool:
        if self.part == 4 and self.acting < self.size - 1:
            self.acting += 1
        elif self.part < self.parts:
            self.part += 1 if self.part != 3 or self.size else 3
        else:
            return False
        self._show()
        return True

    def back(self) -> None:
        if self.part == 4 and self.acting:
            self.acting -= 1
        else:
            self.part = max(self.part - (1 if self.part != 6 or self.size else 3), 1)
        self._show()

    @property
    def can_skip(self) -> bool:
        """True if there are other unknowns of part 4 to leave out."""
        return self.part == 4 and self.acting < self.size - 1

    def to_equations(self) -> None:
        """Leave out the other unknowns of part 4."""
        self.part, self.acting = 5, self.size - 1
        self._show()

    def pick(self, hit: Handle | None, near: Vector = (0.0, 0.0)) -> None:
        self.member = self.model.rods[hit.name] if isinstance(hit, Rod) else None

    def point(self, cell: tuple[int, int] | None) -> None:
        """Explain the entry in a cell (row, column) of the table of K."""
        inside = cell is not None and self.part == 5 and self.member is None and 0 < cell[1] <= self.size + 1
        pointed = (cell[0] - 1, cell[1] - 1) if inside and cell is not None and cell[0] else None
        if pointed == self.pointed:
            return
        self.pointed = pointed
        first = self.sets[0].model
        terms = self.tables.terms(*pointed) if pointed is not None else []
        first.tag_only([first.rods[rod.name] for rod, _ in terms], Selected)

    def _show(self) -> None:
        """The sets of the present part."""
        self.member = self.pointed = None
        model, solution = self.model, self.solution
        self.sets = self.sets[:1] or [self._moved(base_structure(model, []), solution.real)]
        first = self.sets[0]
        first.model.tag_only([], Selected)
        if self.part < 3:
            return
        fast = held(base_structure(model, []), solution)
        self.sets = [first, self._still(fast, solution.base)]
        if self.part < 4:
            return
        alone = [float(number == self.acting) for number in range(self.size)]
        if self.part < 6:
            copy = held(unloaded(model, []), solution)
            third = self._moved(copy, SetState.superposed(solution.units, alone), alone=True)
        else:
            state = SetState.superposed((*solution.units, solution.base), [*solution.amounts.tolist(), 0.0])
            third = self._moved(unloaded(model, []), state)
        self.sets.append(third)

    def _moved(self, copy: Model, state: SetState, *, alone: bool = False) -> Set:
        """A set that shows a state with its displacements; alone: per unit of an unknown."""
        made = self._still(copy, state, moved=True)
        made.view.has_units = not alone
        made.scale_to(state)
        made.model.writable("settings.automatic_displacement_scale")[0] = made.suited
        return made
