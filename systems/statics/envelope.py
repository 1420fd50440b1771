"""Envelopes: the least and the most of forces, reactions and displacements in combinations of load cases, and in which.

By first-order theory K is factored once, and all combinations are right-hand sides that are solved side by side: fields and
rods of combinations then follow one another, as those of one large structure. That holds while no rod yields, slackens or
buckles; other combinations, and all in exact geometry, are solved one by one. 50 combinations of a frame of 475 members
take 0.1 s, half of which bends rods and integrates loads along them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import ROUND_OFF, Array, Flags, Rows
from pinjoint.components.bent import AXIAL, MOMENT, SHEAR, forces_along, inner_forces
from pinjoint.components.cases import Acting, choose, settled
from pinjoint.components.derived import initial_slopes, moments_along, on_joints, unforced
from pinjoint.components.field import FieldError
from pinjoint.components.language import listed, tr
from pinjoint.components.load import SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.spans import Curves, Kinks, extremes
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.wording import as_said, brief, missing
from pinjoint.components.world import Shown
from pinjoint.systems.statics.equations import Structure, largest
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.response import of_rods
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import Start
from pinjoint.systems.statics.theory import FirstOrder

_REFINEMENTS = 10  # of solutions, at most
_KNOWN = ROUND_OFF**0.5  # of a solution: after a refinement by less, what is left is round-off
_STATIONS = np.linspace(0.0, 1.0, 21)  # along each rod, besides those where something jumps or is largest
# Along each rod of a path, beside its start: forces largest between them are told up to 0.1 % less.
_POSITIONS = 40
_BESIDE = 1e-9  # of the length of a rod, from its ends: there shear forces beside supports are largest
_ROUNDING = 1e-12  # of the largest value: by less, no other combination governs

Combinations = Mapping[str, Mapping[str, float] | None]


class States(NamedTuple):
    """Equilibria of k combinations: displacements and rotations, and reactions, (k, n, 3), in m, rad, kN, kN·m; curves of N,
    V, M along all rods of the first, the second, … by their letters."""

    displacement: Array
    reaction: Array
    forces: Mapping[str, Curves]

    @classmethod
    def superposed(cls, model: Model, chosen: Combinations, factor: float) -> tuple[States, Flags]:
        """All by one factored K, and which of them (k,) are true: no rod leaves the straight line of its law."""
        structure, count = Structure.of(model, FIRST_ORDER), len(chosen)
        acting, rods = Acting.of(model, *chosen.values()), model.rods
        between = Kinks.of(model, factor, acting)
        length, fixity = np.tile(rods.rest_length, count), np.tile(rods.fixity, (count, 1))
        free = unforced(model, rods.original_length, rods.rest_length, acting)
        whole = replace(_repeated(structure, count), misfit=free["misfit"].ravel())
        if whole.bending is not None:
            slopes = initial_slopes(free["free_curvature"].ravel(), length, fixity)
            loaded = on_joints(between.on_clamped(length), fixity)
            bending = replace(whole.bending, initial_slopes=slopes, span_load=loaded)
            whole = replace(whole, bending=bending)
        load = External.of(model, FIRST_ORDER, acting).at(factor)
        places = settled(model, acting)
        moved = _solved(model, structure, whole, load, whole.field(places[:, :2], places[:, 2]))
        response = whole.respond(moved, np.zeros(len(length)), 1.0)
        ends, left = whole.end_moments(response) * [-1.0, 1.0], response.axis[:, ::-1] * [-1.0, 1.0]
        soft = of_rods(response.soft)
        on_starts = between.on_ends(len(length))[:, 0]
        shear = response.bent.shear if response.bent is not None else 0.0
        across = shear - (on_starts * left).sum(axis=1)
        along = response.axial_force + (on_starts * response.axis).sum(axis=1)
        straight = moments_along(ends, between, left, response.length, np.zeros((len(length), 4)))
        curves = {AXIAL: forces_along(along, between, -response.axis)}
        curves |= {SHEAR: forces_along(across, between, left), MOMENT: straight}
        reaction = whole.reactions(response, load)
        moved, held = (
            np.pad(field, ((0, 0), (0, 3 - whole.width))).reshape(count, -1, 3) for field in (moved, reaction)
        )
        true = ~np.asarray(soft.reshape(count, -1).any(axis=1))
        return cls(moved, held, {name: curves[name] for name in DIAGRAMS}), true

    @classmethod
    def alone(cls, model: Model, theory: str, factors: Sequence[float], permanent: Array) -> States:
        """The one of what acts in a model, which shows it then. Raises ValueError, NoEquilibrium where there is none."""
        model.show(None)
        found = settle(model, factors, theory, Start.undeformed(model, permanent)).equilibrium
        shown = Shown(found.columns, model.next_revision(), theory == FIRST_ORDER, found.load_factor)
        model.show(shown)
        every = np.arange(model.rods.count)
        moved = np.column_stack([found.displacement, found.rotation])
        held = np.column_stack([found.reaction, found.reaction_moment])
        return cls(moved[None], held[None], {name: inner_forces(model, every, name) for name in DIAGRAMS})

    def some(self, which: Sequence[int]) -> States:
        """Those of some combinations."""
        rods = len(self.forces[AXIAL]) // len(self.displacement)
        rows = (np.array(which, dtype=np.intp)[:, None] * rods + np.arange(rods)).ravel()
        curves = {name: found.some(rows) for name, found in self.forces.items()}
        return States(self.displacement[which], self.reaction[which], curves)

    @classmethod
    def together(cls, every: Sequence[States]) -> States:
        """Those of several, one after the other."""
        curves = {name: Curves.together([one.forces[name] for one in every]) for name in DIAGRAMS}
        moved, held = (np.concatenate([one[part] for one in every]) for part in (0, 1))
        return cls(moved, held, curves)


def _repeated(structure: Structure, count: int) -> Structure:
    """So many of a structure, one after the other, as one."""

    def tiled(part: Any) -> dict[str, Any]:
        found = {field.name: getattr(part, field.name) for field in fields(part)}
        arrays = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
        return {name: np.tile(value, (count, *[1] * (value.ndim - 1))) for name, value in arrays.items()}

    bending = structure.bending
    bending = None if bending is None else replace(bending, **tiled(bending))
    further = np.repeat(np.arange(count), len(structure.ends))[:, None] * len(structure.position)
    made = tiled(structure)
    return replace(structure, **made | {"ends": made["ends"] + further}, bending=bending)


def _lasting(structure: Structure) -> Structure:
    """A structure of which no rod leaves the line of its law."""
    return replace(structure.unyielding, sense=np.zeros_like(structure.sense))


def _solved(model: Model, structure: Structure, whole: Structure, load: Array, supports: Array) -> Array:
    """Displacements of a repeated structure under loads and displacements of rigid supports, (combinations × n, …)."""
    structure, whole = (_lasting(one) for one in (structure, whole))
    theory, index = FirstOrder(model, structure), structure.index
    count = len(load) // len(structure.position)
    supports = whole.of_supports(supports)

    def unknowns(field: Array) -> Array:
        return whole.along_supports(field).reshape(count, -1)[:, index].T

    def spread(solution: Array) -> Array:
        found = np.zeros((count, structure.unknown.size))
        found[:, index] = solution.T
        return whole.along_axes(found.reshape(load.shape))

    held = whole.internal(whole.respond(supports, np.zeros(len(whole.ends)), 1.0))
    right = unknowns(load - held)
    solution = theory.solve(right)
    for _ in range(_REFINEMENTS):
        step = theory.solve(right - unknowns(whole.resistance(spread(solution))))
        solution, size = solution + step, np.abs(step).max(axis=0, initial=0.0)
        if (size <= _KNOWN * np.abs(solution).max(axis=0, initial=0.0)).all():
            break
    return supports + spread(solution)


def _superposes(model: Model, permanent: Array) -> bool:
    """True if first-order theory of a model is linear as long as no rod leaves the line of its law."""
    structure = Structure.of(model, FIRST_ORDER)
    if len(structure.inextensible) or permanent.any():
        return False
    if (structure.with_translations().unknown != structure.unknown).any() or not len(structure.ends):
        return False
    return FirstOrder(model, _lasting(structure)).held


@dataclass(frozen=True)
class Bounds:
    """The least and the most, (2, …), and the number of the combination in which each is, −1 where all are alike, (2, …)."""

    values: Array
    governing: Rows

    @classmethod
    def of(cls, values: Array, size: Array | float) -> Bounds:
        """Of values (k, …) in k combinations. size: beside which a value or a difference is nothing."""
        nothing = np.asarray(_ROUNDING * size)
        values = np.where(np.abs(values) <= nothing, 0.0, values)
        bounds = np.stack([values.min(axis=0), values.max(axis=0)])
        first = [(values <= bounds[0] + nothing).argmax(axis=0), (values >= bounds[1] - nothing).argmax(axis=0)]
        return cls(bounds, np.where(bounds[1] - bounds[0] <= nothing, -1, np.stack(first)))


class Extreme(NamedTuple):
    """The least or the most of a force along a rod: its value, how far from the start (m), and in which combination."""

    value: float
    distance: float
    combination: str


@dataclass(frozen=True, repr=False)
class Envelope:
    """Bounds of what k combinations do, those that are in equilibrium; without: of the others, why not. length: of rods, m.

    shares: by letter N, V, M, of the lengths of rods, stations along each, ascending, the last perhaps several times,
    (rods, s); forces: bounds there, (2, rods, s). reaction, displacement: with rotations as third part, (2, n, 3). curves:
    of forces along all rods in the first combination, the second, … path: the rods along which a force
    (kN, downwards) moves, whose positions are the combinations; () of load cases.
    """

    __repr__ = brief

    combinations: tuple[str, ...]
    without: Mapping[str, str]
    length: Array
    shares: Mapping[str, Array]
    forces: Mapping[str, Bounds]
    reaction: Bounds
    displacement: Bounds
    curves: Mapping[str, Curves]
    path: tuple[str, ...] = ()
    force: float = 1.0

    @classmethod
    def of(
        cls,
        model: Model,
        names: Iterable[str],
        theory: str,
        factors: Sequence[float],
        permanent: Array,
        path: Sequence[str] = (),
    ) -> Envelope:
        """That of some combinations of a model, all if none are named, by a theory, through load factors, of which the last
        counts; or of a force along a path of rods. permanent: plastic strains and rotations at the beginning, (rods, 3).
        Raises ValueError, LookupError of rods, and NoEquilibrium where none has a solution.
        """
        if path:
            return cls._under_moving_force(model, path)
        known = model.settings.combinations
        for name in names:
            if name not in known:
                raise FieldError(missing(tr("combinations"), name, known))
        chosen = {name: known[name] for name in list(names) or known}
        if not model.rods.count:
            raise FieldError("The model has no rods, along which an envelope would be; draw some.")
        if not chosen:
            raise FieldError("The model has no combinations; give it some in settings.combinations.")
        parts: dict[str, States] = {}
        if theory == FIRST_ORDER and _superposes(model, permanent):
            found, true = States.superposed(model, chosen, factors[-1])
            parts = (
                {name: found.some([k]) for k, name in enumerate(chosen) if true[k]} if not true.all() else {}
            )
        else:
            found, true = None, np.zeros(len(chosen), dtype=bool)
        without: dict[str, str] = {}
        if not true.all():
            copy = model.undeformed_copy()
            for name in [name for name in chosen if name not in parts]:
                copy.show(None)
                choose(copy, None, name)
                try:
                    parts[name] = States.alone(copy, theory, factors, permanent)
                except NoEquilibrium as reason:
                    without[name] = str(reason)
            if not parts:
                raise NoEquilibrium("limit reached", next(iter(without.values())))
            found = States.together([parts[name] for name in chosen if name in parts])
        assert found is not None
        length = model.rods.original_length
        stations = {name: _stations(curves, len(length)) for name, curves in found.forces.items()}
        count = len(found.displacement)
        along = {
            name: curves.at(np.tile(stations[name], (count, 1))).reshape(count, len(length), -1)
            for name, curves in found.forces.items()
        }
        pull = max(largest(found.reaction[..., :2]), largest(along[AXIAL]), largest(along[SHEAR]))
        turn = max(largest(along[MOMENT]), pull * float(length.max(initial=0.0)))
        forces = {name: Bounds.of(values, turn if name == MOMENT else pull) for name, values in along.items()}
        moved, turned = largest(found.displacement[..., :2]), largest(found.displacement[..., 2])
        reaction = Bounds.of(found.reaction, np.array([pull, pull, turn]))
        displacement = Bounds.of(found.displacement, np.array([moved, moved, turned]))
        solved = tuple(name for name in chosen if name not in without)
        return cls(solved, without, length, stations, forces, reaction, displacement, found.forces)

    @classmethod
    def _under_moving_force(cls, model: Model, path: Sequence[str]) -> Envelope:
        """That of the model's moving force along these rods, alone and by first-order theory; "combinations" are where it
        stands."""
        copy, rows = model.undeformed_copy(), [model.rods[name].row for name in path]
        copy.delete([*copy.loads, *copy.span_loads])
        length, shares = model.rods.original_length[rows], np.linspace(0.0, 1.0, _POSITIONS + 1)
        places = np.outer(length, np.clip(shares, _BESIDE, 1.0 - _BESIDE)).ravel()
        cases, on = [str(number) for number in range(len(places))], np.repeat(rows, len(shares))
        force = 0.0, -float(model.settings.moving_force)
        copy.create(SpanLoad, len(places), rod=on, start=places, force=force, case=cases)
        copy.settings.combinations = {case: {case: 1.0} for case in cases}
        found = cls.of(copy, (), FIRST_ORDER, (1.0,), np.zeros((model.rods.count, 3)))
        told = [
            f"{as_said(Rod.noun, rod)}, {written.length(x)}"
            for rod, size in zip(path, length, strict=True)
            for x in size * shares
        ]
        stands = tuple(told[int(case)] for case in found.combinations)
        return replace(found, combinations=stands, path=tuple(path), force=-force[1])

    @property
    def said(self) -> str:
        """Of what it is."""
        if self.path:
            return tr(
                "envelope of {force} downwards that moves along {rods}",
                force=written.stated(self.force, "kN"),
                rods=listed([as_said(Rod.noun, name) for name in self.path]),
            )
        return tr("envelope of {names}", names=listed(self.combinations))

    def extremes(self, quantity: str, row: int) -> tuple[Extreme, Extreme]:
        """The least and the most of "N", "V" or "M" along a rod."""
        if quantity not in self.forces:
            raise FieldError(missing(tr("diagrams"), quantity, self.forces))
        bounds, shares = self.forces[quantity], self.shares[quantity][row]
        length, found = float(self.length[row]), []
        for side, at in enumerate((bounds.values[0, row].argmin(), bounds.values[1, row].argmax())):
            name = self.named(bounds.governing[side, row, at])
            found.append(Extreme(float(bounds.values[side, row, at]), float(shares[at]) * length, name))
        return found[0], found[1]

    def at(self, quantity: str, row: int, distance: float) -> list[tuple[float, str]]:
        """The least and the most of "N", "V" or "M" so far from the start of a rod (m), and in which combinations."""
        share = np.array([min(distance / max(float(self.length[row]), 1e-300), 1.0)])
        values = (
            self.curves[quantity].some(np.arange(row, len(self.curves[quantity]), len(self.length))).at(share)
        )
        found = Bounds.of(values[:, 0], largest(self.forces[quantity].values))
        return [
            (float(value), self.named(number))
            for value, number in zip(found.values, found.governing, strict=True)
        ]

    def named(self, number: int) -> str:
        """The name of a combination by its number; "" where all are alike."""
        return self.combinations[number] if number >= 0 else ""


def _stations(curves: Curves, rods: int) -> Array:
    """Shares along each rod where some of the curves of combinations begin, jump or are largest, and between, (rods, s)."""
    shares = extremes(curves.stretches)[1].reshape(-1, rods, 2)
    inner = np.moveaxis(shares, 0, 1).reshape(rods, -1)
    place = np.zeros((rods, 0))
    if len(curves.row):
        row, at = np.unique(np.column_stack([curves.row % rods, curves.place]), axis=0).T
        number = np.arange(len(row)) - np.searchsorted(row, row)
        place = np.ones((rods, 2 * (int(number.max()) + 1)))
        place[row.astype(np.intp), 2 * number] = np.nextafter(at, 0.0)
        place[row.astype(np.intp), 2 * number + 1] = at
    every = np.sort(
        np.concatenate([np.broadcast_to(_STATIONS, (rods, len(_STATIONS))), inner, place], axis=1), axis=1
    )
    every[:, 1:][every[:, 1:] == every[:, :-1]] = 1.0
    every.sort(axis=1)
    most = int((every < 1.0).sum(axis=1).max(initial=0)) + 1
    return every[:, :most]
