"""Limit analysis: the largest load that equilibrium and strengths allow, by linear programming about the original shape.

By the static theorem the collapse load factor is the largest λ for which there are forces in equilibrium with λ × loads +
weight that pass no strength: N of rods, of cables without compression, of struts at most P, moments at the ends of rods and,
where loads act between these, all along. Of the latter those at a few places are constraints: where the moments found are
too large, the place is added, until none is (cutting planes) [J. E. Kelley, 1960]. The dual variables are the mechanism.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from pinjoint.components.arrays import Array
from pinjoint.components.bent import Parts
from pinjoint.components.field import ENDS
from pinjoint.components.language import joined, marked, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import plastic_moments
from pinjoint.components.spans import Curves, Kinks, extremes
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.systems.statics.equations import Structure, largest, normalised
from pinjoint.systems.statics.explain import rod_names
from pinjoint.systems.statics.external import External

TOLERANCE = 1e-10  # of HiGHS, the least that it takes
PASSED = 1e-12  # of a plastic moment, by which one between ends may pass it
ROUNDS = 60  # in which places are added
SAME = 1e-9  # share of a rod within which two places are one
NEAR = 1e-3  # share of a rod within which hinges of the mechanism are one
FLOWS = 1e-7  # of the largest rate of the mechanism: a smaller one is none

NO_LIMIT, COLLAPSE, MECHANISM, OVERLOADED, LOST = (
    marked("no limit"),
    marked("collapse"),
    marked("mechanism"),
    marked("does not bear its weight"),
    marked("limit reached"),
)


class Section(NamedTuple):
    """A place between the ends of a rod: its row, the share of its length, the moment there of λ = 1 on a simple beam."""

    row: int
    share: float
    bulge: float


@dataclass(frozen=True)
class LimitLoad:
    """The collapse load factor of a model in its original shape: infinite if there is no limit, NaN where no factor holds.

    status: "collapse", "no limit", "mechanism", "does not bear its weight" or, where the numbers differ too much, "limit
    reached". axial_force (rods,) and bending_moment (rods, 2) at collapse, one such state of many where some part does not
    collapse. motion: of the collapse, (n, …), the largest 1; at its rate rods yield by lengthening (rods,), hinges at their
    ends turn by turning (rods, 2), and those of `between` by the angles there. bends_freely: members bend, and none has a
    plastic moment.
    """

    factor: float
    status: str
    axial_force: Array
    bending_moment: Array
    motion: Array | None = None
    lengthening: Array = field(default_factory=lambda: np.zeros(0))
    turning: Array = field(default_factory=lambda: np.zeros((0, 2)))
    between: tuple[tuple[Section, float], ...] = ()
    bends_freely: bool = False

    @classmethod
    def of(cls, model: Model) -> LimitLoad:
        """That of a model; its inextensible rods neither yield nor buckle."""
        program = _Program(model)
        free = bool(program.rigid.any() and np.isinf(program.moment[program.rigid.any(axis=1)]).all())
        return replace(program.answer(), bends_freely=free)

    @property
    def message(self) -> str:
        """The result in a sentence."""
        said = {
            NO_LIMIT: marked("Limit analysis: at no load factor it collapses."),
            COLLAPSE: marked("Limit analysis: it collapses at the load factor {factor:.6g}."),
            MECHANISM: marked("Limit analysis: it is a mechanism, which bears no part of the load."),
            OVERLOADED: marked("Limit analysis: even without loads it does not bear its weight."),
            LOST: marked("Limit analysis: no answer was found; its numbers differ too much."),
        }
        free = tr(
            "No member has a plastic moment, so that bending limits nothing in it; give them some, or switch plastic hinges"
            " of sections on."
        )
        return joined([tr(said[self.status], factor=self.factor), free if self.bends_freely else ""])

    def record(self, model: Model) -> dict[str, Any]:
        """It as plain data: factor (None where there is none), status, message, forces and hinges by rod, and the motion."""
        rods, names = model.rods, model.particles.names
        found: dict[str, Any] = {
            "load_factor": self.factor if math.isfinite(self.factor) else None,
            "status": self.status,
            "message": joined([self.message, self.divides(model)]),
        }
        if self.motion is None:
            return found
        moving = np.flatnonzero(np.abs(self.motion).max(axis=1) > FLOWS)
        turning = [
            {"rod": rods.names[row], "end": ENDS[end], "rotation": float(self.turning[row, end])}
            for row, end in np.argwhere(self.turning).tolist()
        ]
        inside = [
            {
                "rod": rods.names[section.row],
                "distance": section.share * float(rods.original_length[section.row]),
                "rotation": turned,
            }
            for section, turned in self.between
        ]
        lengthening = np.flatnonzero(self.lengthening).tolist()
        return found | {
            "axial_force": dict(zip(rods.names, self.axial_force.tolist(), strict=True)),
            "bending_moment": dict(zip(rods.names, self.bending_moment.tolist(), strict=True)),
            "motion": {names[row]: self.motion[row].tolist() for row in moving.tolist()},
            "hinges": [*turning, *inside],
            "lengthening": {rods.names[row]: float(self.lengthening[row]) for row in lengthening},
        }

    def mechanism(self, model: Model) -> tuple[Parts, Array]:
        """The collapse as straight parts of rods between hinges, and the motion of their ends, the largest 1, (n, 3)."""
        assert self.motion is not None
        particles, rods = model.particles, model.rods
        between, positions, motions = rods.between.astype(np.intp).tolist(), [particles.position], list[Array]()
        shifts, axis = self.motion[:, :2], rods.difference / np.maximum(rods.original_length, 1e-300)[:, None]
        for row in sorted({section.row for section, _ in self.between}):
            kinks = sorted((section.share, turned) for section, turned in self.between if section.row == row)
            share, turned = np.array(kinks).T
            a, b = between[row]
            apart = np.minimum(share[:, None], share) * (1.0 - np.maximum(share[:, None], share))
            left = np.array([-axis[row, 1], axis[row, 0]])
            away = -float(rods.original_length[row]) * (apart @ turned)
            first = sum(len(places) for places in positions)
            nodes = [a, *range(first, first + len(share)), b]
            positions.append(particles.position[a] + share[:, None] * rods.difference[row])
            motions.append(shifts[a] + share[:, None] * (shifts[b] - shifts[a]) + away[:, None] * left)
            pairs = [[*pair] for pair in pairwise(nodes)]
            between[row], between[len(between) :] = pairs[0], pairs[1:]
        motion = np.concatenate([shifts, *motions])
        parts = Parts(np.concatenate(positions), np.array(between), np.zeros((len(between), 2)))
        return parts, np.pad(motion / largest(motion), ((0, 0), (0, 1)))

    def divides(self, model: Model) -> str:
        """The sentence about hinges between ends, which load steps do not know; "" if none forms."""
        rows = np.unique([section.row for section, _ in self.between]).astype(np.intp)
        if not len(rows):
            return ""
        return plural(
            "At collapse a plastic hinge forms between the ends of {rods}, and load steps know only hinges at ends, so that"
            " they end at a load that is too high. Divide the rod there.",
            "At collapse plastic hinges form between the ends of {rods}, and load steps know only hinges at ends, so that"
            " they end at a load that is too high. Divide the rods there.",
            len(rows),
            rods=rod_names(model, rows),
        )


class _Program:
    """The linear program of a model: its unknowns are N, the moments on rigid ends, forces of springs, and λ last.

    All are divided by the largest force, moments also by the rest lengths of their rods.
    """

    def __init__(self, model: Model) -> None:
        rods, external = model.rods, External.of(model, FIRST_ORDER)
        structure = self.structure = Structure.of(model, FIRST_ORDER).with_translations()
        bending = structure.bending
        self.rigid = np.zeros((rods.count, 2), dtype=bool) if bending is None else bending.rigid
        live, dead = (
            structure.gather(part) / structure.measure
            for part in (external.scaled - self._couples(), external.steady)
        )
        self.force = max(largest(live), largest(dead)) or 1.0
        self.live, self.dead = live / self.force, dead / self.force
        self.moment = plastic_moments(model)
        if not model.settings.plasticity:
            self.moment[:] = np.inf
        self.unit = self.force * rods.rest_length  # of moments
        ends = np.repeat(self.moment / self.unit, self.rigid.sum(axis=1))
        free = np.full(int(structure.sprung.sum()), np.inf)
        pressed = np.where(structure.struts, structure.buckling_load, structure.compression_limit)
        pressed = np.where((structure.sense > 0.0) & ~structure.struts, 0.0, pressed)
        self.high = np.concatenate([structure.tension_limit / self.force, ends, free])
        self.low = -np.concatenate([pressed / self.force, ends, free])
        self.column = rods.count + np.cumsum(self.rigid).reshape(-1, 2) - 1  # of the moments on ends
        axis, self.length = structure.unmoved.axis, rods.original_length
        bulges = Kinks.of(model).bulges(np.stack([-axis[:, 1], axis[:, 0]], axis=1), self.length)
        self.loaded = np.flatnonzero((bulges.most > 0.0) & np.isfinite(self.moment))
        self.bulges, self.sections = bulges.some(self.loaded), list[Section]()

    def _couples(self) -> Array:
        """What couples between ends make of the forces on particles at λ = 1, besides moments on the ends."""
        structure, rods = self.structure, self.structure.unmoved
        if structure.bending is None:
            return np.zeros(structure.unknown.shape)
        shear = structure.bending.span_load[:, 6] / np.where(rods.length > 0.0, rods.length, np.inf)
        left = np.stack([-rods.axis[:, 1], rods.axis[:, 0]], axis=1)
        return structure.scatter(-shear[:, None] * left, np.zeros((len(left), 2)))

    def answer(self) -> LimitLoad:
        """The answer; places between ends are added until no moment there passes its limit."""
        if self.dead.any() and self._solved(at_most=0.0).status != 0:
            return self._without(math.nan, OVERLOADED)
        self._add(self.bulges, 1.0)
        for _ in range(ROUNDS):
            found = self._solved()
            if found.status != 0:
                return self._without(*((math.inf, NO_LIMIT) if found.status == 3 else (math.nan, LOST)))
            moments = self._end_moments(found.x)[self.loaded]
            straight = np.stack([moments[:, 0], moments[:, 1] - moments[:, 0]], axis=1)
            if not self._add(self.bulges.times(found.x[-1]).plus(straight), found.x[-1], straight):
                break
        return self._read(found)

    def _add(self, curves: Curves, factor: float, straight: Array | None = None) -> bool:
        """Add the places where moments along loaded rods are largest; straight: of those that are too large."""
        if not len(self.loaded):
            return False
        values, shares = extremes(curves.stretches)
        of_ends = 0.0 if straight is None else straight[:, :1] + straight[:, 1:] * shares
        limit = 0.0 if straight is None else self.moment[self.loaded, None] * (1.0 + PASSED)
        new = [
            Section(int(self.loaded[k]), float(shares[k, side]), float((values - of_ends)[k, side] / factor))
            for k, side in np.argwhere(np.abs(values) > limit).tolist()
        ]
        known = {(section.row, round(section.share / SAME)) for section in self.sections}
        new = [section for section in new if (section.row, round(section.share / SAME)) not in known]
        self.sections += new
        return bool(new)

    def _end_moments(self, unknowns: Array) -> Array:
        """The bending moments at the ends of all rods, (rods, 2), as diagrams have them."""
        return np.where(self.rigid, unknowns[self.column], 0.0) * self.unit[:, None] * [-1.0, 1.0]

    def _solved(self, at_most: float | None = None) -> Any:
        """The largest λ between 0 and at_most."""
        from scipy.optimize import linprog  # not at the start of the program
        from scipy.sparse import csr_matrix, diags, hstack

        structure, count = self.structure, len(self.high) + 1
        matrix = (
            diags(structure.reaches)
            @ structure.compatibility(structure.unmoved)
            @ diags(1.0 / structure.measure)
        )
        rows, limits = np.zeros((2 * len(self.sections), count)), np.zeros(2 * len(self.sections))
        for number, (row, share, bulge) in enumerate(self.sections):
            for end, part in enumerate((share - 1.0, share)):
                if self.rigid[row, end]:
                    rows[2 * number, self.column[row, end]] = part
            rows[2 * number, -1], limits[2 * number :][:2] = (
                bulge / self.unit[row],
                self.moment[row] / self.unit[row],
            )
        rows[1::2] = -rows[::2]
        cost = np.zeros(count)
        cost[-1] = -1.0
        return linprog(
            cost,
            A_ub=csr_matrix(rows) if len(rows) else None,
            b_ub=limits if len(rows) else None,
            A_eq=hstack([matrix.T, csr_matrix(-self.live[:, None])]),
            b_eq=self.dead,
            bounds=[*zip(self.low, self.high, strict=True), (0.0, at_most)],
            method="highs",
            options={"primal_feasibility_tolerance": TOLERANCE, "dual_feasibility_tolerance": TOLERANCE},
        )

    def _without(self, factor: float, status: str) -> LimitLoad:
        count = len(self.rigid)
        return LimitLoad(factor, status, np.full(count, np.nan), np.full((count, 2), np.nan))

    def _read(self, found: Any) -> LimitLoad:
        """The answer with its mechanism, from the dual variables."""
        structure, forces, length = self.structure, found.x[: len(self.rigid)], self.structure.rest_length
        rates = -(found.lower.marginals + found.upper.marginals)[:-1]
        rates[np.abs(rates) < FLOWS * largest(rates)] = 0.0
        motion = structure.spread(found.eqlin.marginals / structure.measure)
        moved = normalised(motion) if motion.any() else motion
        pairs = found.ineqlin.marginals.reshape(-1, 2)
        sizes = (largest(moved), largest(motion)) if motion.any() else (1.0, largest(pairs) or 1.0)
        scale = sizes[0] / sizes[1]
        kinks: list[tuple[Section, float]] = []
        for section, (above, below) in sorted(zip(self.sections, pairs.tolist(), strict=True)):
            turned = scale * (below - above) / float(length[section.row])
            if abs(below - above) <= FLOWS * largest(pairs):
                continue
            before, known = kinks[-1] if kinks else (section, 0.0)
            if before.row == section.row and section.share - before.share < NEAR and known * turned > 0.0:
                share = (known * before.share + turned * section.share) / (known + turned)
                section, turned = section._replace(share=share), known + turned
                del kinks[-1]
            kinks.append((section, turned))
        factor = max(0.0, float(found.x[-1]))
        return LimitLoad(
            factor,
            COLLAPSE if factor > 0.0 else MECHANISM,
            forces * self.force,
            self._end_moments(found.x),
            moved,
            scale * rates[: len(forces)],
            scale * np.where(self.rigid, rates[self.column], 0.0) / length[:, None],
            tuple(kinks),
        )
