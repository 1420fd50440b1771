"""Force method: static unknowns from the displacements of a released structure, by first-order theory about original
positions.

Set 1 is the real structure under the real load, set 2 the released structure (without the static unknowns) under the real
load, set 3 the released structure under a unit force alone. Superposition is exact in first-order theory. A released bar is
cut, an end of a rod at which the moment is released has a hinge, a support lets go in one direction; masses, loads and the
displacements of the other supports stay.

By how much the releases open is found by virtual work:

    1 · δ = Σ n N L/EA + Σ ∫ m M dx/EI + Σ n ΔL + Σ ∫ m κ dx − Σ r c

n, m and the reactions r are those of a unit force; N, M those of the load; ΔL and κ elongations and curvatures without
force, by warmth and lack of fit; c displacements of supports, −R/k of elastic ones. Springs at the ends of rods add m M/k to
∫ m M dx/EI. Exact: N is constant along a rod or, with what acts along it, counts by its mean; m is linear, and so is M but
for what acts between the ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.arrays import Array, Rows
from pinjoint.components.cases import settled
from pinjoint.components.derived import on_axis
from pinjoint.components.language import begun, tr
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.particle import in_support_axes, spring_stiffness, supported
from pinjoint.components.spans import Kinks
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.wording import brief
from pinjoint.systems.statics.equations import Structure, normalised
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.explain import describe_motion, rod_names
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.superposition import (
    ROUNDING,
    SetState,
    Superposition,
    settled_supports,
    without_rounding,
)
from pinjoint.systems.statics.theory import FirstOrder
from pinjoint.systems.statics.unknowns import MethodError, Unknown


@dataclass(frozen=True)
class Terms:
    """The terms of the sums over axial forces or over bending moments, for m unknowns, in m or rad.

    unit: n, (m, rods, 1), or m at both ends, (m, rods, 2). softness: L₀/EA or L₀/EI, 0 of bars (rods,). form: by which two
    units are multiplied, (rods, 1, 1) or (rods, 2, 2). of_load: n N₀ L/EA or ∫ m M₀ dx/EI; of_free: n ΔL or ∫ m κ dx
    (m, rods).
    """

    unit: Array
    softness: Array
    form: Array
    of_load: Array
    of_free: Array

    def of_units(self, i: int, j: int) -> Array:
        """n n' L/EA or ∫ m m' dx/EI of two unknowns (rods,)."""
        return self.softness * (self.unit[i] * _product(self.form, self.unit[j])).sum(axis=-1)

    @property
    def flexibility(self) -> Array:
        """Sums of these (m, m)."""
        soft = self.softness[:, None] * _product(self.form, self.unit)
        return np.tensordot(soft, self.unit, axes=([1, 2], [1, 2]))


def _product(form: Array, unit: Array) -> Array:
    """Symmetric matrices (rods, …) times vectors (…, rods, …)."""
    return (form @ unit[..., None])[..., 0]


@dataclass(frozen=True)
class Work:
    """The terms of virtual work. supports: those of supports that have moved or are elastic, by their reactions: −r c of the
    load, r r'/k of units. settled: their rows and axes (k, 2). moved: c (k,), −R₀/k of springs.
    """

    axial: Terms
    bending: Terms
    supports: Terms
    settled: Rows
    moved: Array

    @property
    def gap(self) -> Array:
        """δ₀ (m,), 0 where its terms cancel but for rounding."""
        every = self.axial, self.bending, self.supports
        parts = [part for terms in every for part in (terms.of_load, terms.of_free)]
        total: Array = np.sum([part.sum(axis=1) for part in parts], axis=0)
        size = np.sum([np.abs(part).sum(axis=1) for part in parts], axis=0)
        return np.where(np.abs(total) > ROUNDING * size, total, 0.0)


@dataclass(frozen=True, repr=False)
class Solution(Superposition):
    """The force method for m unknowns at once.

    In the textbook's terms: gap δ₀ (m,), by how much the released structure opens or closes under the load where an unknown
    is released, positive in the direction of the unknown; flexibility δ (m, m), likewise per unit of unknown j in column j,
    symmetric with positive diagonal; prescribed c (m,), what the gap must be: the displacement of a moved support, else 0.
    δ₀ + δ X = c gives the unknowns X, `force`.

    In the thesis': delta_real, delta_base (m,), delta_unit (m, m), of which those of a bar are changes of the distance
    between its ends. All in m, rad, kN, kN·m.

    real, base: sets 1 and 2; units: set 3 of each unknown, under its unit force. work: what gap and flexibility are sums of.
    """

    __repr__ = brief

    work: Work
    gap: Array
    flexibility: Array
    prescribed: Array
    force: Array
    delta_real: Array
    delta_base: Array
    delta_unit: Array

    @property
    def amounts(self) -> Array:
        """X."""
        return self.force


def solve(model: Model, unknowns: Sequence[Unknown]) -> Solution:
    """δ₀ + Σ δ X = c, which for one unknown is Δ_real = Δ₀ + Δ₁ p. Raises MethodError.

    Bar: Δ is the change of distance between its ends (apart +), the unit pair pulls them together, X > 0 is tension. The
    gap is that in the bar, which is cut: its own elongation, by which it closes, less Δ. Support: Δ and X along +x or +y or
    counter-clockwise, X acts on the structure; a spring there is cut, and the gap is that in it. End of a rod: X is the
    bending moment, Δ = δ the angle by which the pair of unit moments turns joint and rod against each other.
    """
    for unknown in unknowns:
        unknown.check_suits(model)
    whole, real = real_structure(model)
    try:
        released = Released(model, unknowns) if unknowns else whole
        base, units = released.under_load(), tuple(map(released.under, unknowns))
    except NoEquilibrium as reason:
        raise MethodError(str(reason)) from None
    work = _work(model, unknowns, base, units)
    # Of bars: L₀/EA, ΔL, and Δ; of springs −1/k and Δ; of rigid supports c.
    own, free, stretched, prescribed = np.zeros((4, len(unknowns)))
    for index, unknown in enumerate(unknowns):
        if unknown.of_bar:
            own[index], free[index] = work.axial.softness[unknown.place], _free(model)[unknown.place]
            stretched[index] = own[index] * real.axial_force[unknown.place] + free[index]
        elif spring := unknown.spring(model):
            own[index] = -1.0 / spring
            stretched[index] = own[index] * in_support_axes(model, real.reaction)[unknown.place]
        elif unknown.of_support:
            prescribed[index] = _places(model)[unknown.place]
    gap = work.gap
    flexibility = work.axial.flexibility + work.bending.flexibility + work.supports.flexibility
    force: Array = np.linalg.solve(flexibility, prescribed - gap).astype(np.float64)
    flexibility = without_rounding(flexibility)
    sign = np.array([-1.0 if unknown.of_bar else 1.0 for unknown in unknowns])
    return Solution(
        tuple(unknowns),
        real,
        base,
        units,
        work,
        gap + 0.0,
        flexibility + 0.0,
        prescribed,
        force,
        delta_real=prescribed + stretched,
        delta_base=sign * gap + free,
        delta_unit=(sign[:, None] * flexibility + np.diag(own)).reshape(flexibility.shape),
    )


class Released:
    """A model without some unknowns, but with all masses, loads and moved supports, by first-order theory.

    Raises MethodError, with the motion, if a mechanism is left.
    """

    def __init__(self, model: Model, unknowns: Sequence[Unknown]) -> None:
        self._model, self._whole = model, (whole := Structure.of(model, FIRST_ORDER))
        bars, supports = np.zeros(len(whole.ends), dtype=bool), np.zeros(whole.fixed.shape, dtype=bool)
        self._hinges = np.zeros(whole.ends.shape, dtype=bool)
        for unknown in unknowns:
            (bars if unknown.of_bar else self._hinges if unknown.of_end else supports)[unknown.place] = True
        with_all = replace(whole, fixed=whole.fixed & ~supports, unknown=whole.unknown | supports)
        bending = None if whole.bending is None else whole.bending.hinged(self._hinges)
        released = replace(
            with_all,
            stiffness=np.where(bars, 0.0, whole.stiffness),
            springs=np.where(supports, 0.0, whole.springs),
            inextensible=whole.inextensible[~bars[whole.inextensible]],
            bending=bending,
        )
        self.theory = FirstOrder(model, released, with_all)
        motions = released.fields(self.theory.mechanisms)
        if not len(motions):
            return
        moves = describe_motion(model, motions)
        if unknowns:
            message = tr(
                "Without {names} the structure is a mechanism: {moves} can move."
                " It is not a static unknown; choose a redundant rod or support.",
                names=", ".join(unknown.name for unknown in unknowns),
                moves=moves,
            )
        else:
            message = tr(
                "The structure is a mechanism already ({moves} can move); support or brace it first.",
                moves=moves,
            )
        raise MethodError(message, normalised(motions[0]))

    def under_load(self) -> SetState:
        """The state under the real load, lack of fit, warmth and moved supports."""
        return self._state(External.of(self._model).at(1.0), 1.0, np.zeros(self._hinges.shape))

    def under(self, unknown: Unknown) -> SetState:
        """The state under a unit of an unknown alone."""
        force, couple = unknown.unit_load(self._model)
        if self._whole.bending is not None:
            couple += self._whole.bending.carried_over(couple, self._hinges)
        state = self._state(force[:, : self._whole.width], 0.0, couple)
        if unknown.of_bar:
            state.axial_force[unknown.place] = 1.0
        elif unknown.of_support:
            state.reaction[...] += force
        return state

    def _state(self, load: Array, share: float, moment: Array) -> SetState:
        """The state under a load (n, …), a share of what else acts, and moments on the ends of rods (rods, 2)."""
        structure = self.theory.structure
        if moment.any():
            load = load - structure.held(moment)
        supports = share * settled_supports(self._model, structure)
        return SetState.solved(self.theory, load, supports, share, moment)


def real_structure(model: Model) -> tuple[Released, SetState]:
    """The structure as it is, and its state under the load. Raises MethodError."""
    if problem := incomputable(model):
        raise MethodError(problem)
    if len(rows := np.flatnonzero(model.rods.plastic_rotation.any(axis=1))):
        message = tr(
            "{rods} turned in plastic hinges, and these methods know elastic members only. Begin from the undeformed"
            " structure, or set plastic rotations to 0.",
            rods=begun(rod_names(model, rows)),
        )
        raise MethodError(message)
    try:
        return (whole := Released(model, ())), whole.under_load()
    except NoEquilibrium as reason:
        raise MethodError(str(reason)) from None


def bulge(model: Model) -> Array:
    """∫ (1 − ξ, ξ) M dξ of what acts between the ends of simple beams (kN·m), by which moments bulge, (rods, 2)."""
    rods = model.rods
    axis = rods.difference / rods.original_length[:, None]
    held = on_axis(Kinks.of(model).on_clamped(rods.rest_length), axis)[1]
    return (held / 3.0 - held[:, ::-1] / 6.0) * [-1.0, 1.0]


def _work(model: Model, unknowns: Sequence[Unknown], base: SetState, units: Sequence[SetState]) -> Work:
    rods, count = model.rods, len(units)
    n = np.array([unit.axial_force for unit in units]).reshape(count, rods.count, 1)
    m = np.array([unit.bending_moment for unit in units]).reshape(count, rods.count, 2)
    length, bends = rods.rest_length, rods.bending_stiffness > 0.0
    softness, turning = np.where(rods.inextensible, 0.0, length / rods.stiffness), np.zeros(rods.count)
    np.divide(length, rods.bending_stiffness, out=turning, where=bends)
    curvature = rods.free_curvature * bends
    # ∫ m M dξ by the values at both ends, and what springs there add: EI/(k L₀) m M.
    sprung = np.where(rods.fixity > 0.0, rods.fixity, 1.0)
    linear = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0 + (1.0 / sprung - 1.0)[:, None] / 3.0 * np.eye(2)
    straight = (m * _product(linear, base.bending_moment)).sum(axis=2)
    springs = spring_stiffness(model)
    soft = np.divide(1.0, springs, out=np.zeros_like(springs), where=springs > 0.0)
    moved = -soft * in_support_axes(model, base.reaction)
    moved = np.where(supported(model) & (springs == 0.0), _places(model), moved)
    for unknown in unknowns:
        if unknown.of_support:
            moved[unknown.place] = 0.0
    settled = np.argwhere((moved != 0.0) | (springs > 0.0))
    reactions = np.array([in_support_axes(model, unit.reaction) for unit in units])
    reactions = reactions.reshape(count, len(moved), 3)[:, *settled.T]
    at, pull = tuple(settled.T), n[:, :, 0]
    alone = np.ones((rods.count, 1, 1))
    axial = Terms(n, softness, alone, pull * base.axial_force * softness, pull * _free(model))
    of_load = turning * (straight + (bulge(model) * m).sum(axis=2))
    bending = Terms(m, turning, linear, of_load, length * curvature * m.mean(axis=2))
    alone = np.ones((len(settled), 1, 1))
    supports = Terms(reactions[..., None], soft[at], alone, -reactions * moved[at], 0.0 * reactions)
    return Work(axial, bending, supports, settled, moved[at])


def _free(model: Model) -> Array:
    """ΔL, by which rods are longer without force (m), (rods,)."""
    rods = model.rods
    return rods.rest_length * rods.plastic_strain - rods.misfit


def _places(model: Model) -> Array:
    """Displacements and rotations of rigid supports along their axes, (n, 3)."""
    return in_support_axes(model, settled(model))
