"""External forces of statics, and the loose bodies that nothing holds against them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Array, Rows
from pinjoint.components.bent import borne_between
from pinjoint.components.cases import Acting, idle_settlement, unknown_case
from pinjoint.components.language import plural, tr
from pinjoint.components.load import static_factor
from pinjoint.components.model import Model
from pinjoint.components.rod import bends, nodes, rigid_joints
from pinjoint.components.theory import EXACT, FIRST_ORDER
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.events import Event
from pinjoint.systems.statics.explain import listed

_NO_NET_FORCE = 1e-12  # of the sum of a body's forces: a smaller net force is round-off


@dataclass(frozen=True)
class External:
    """Forces (n, 2) in kN, where members bend with moments (n, 3) in kN·m.

    scaled: forces and loads at factor 1, with halves of distributed forces at both ends of each rod; steady: mass ×
    acceleration; notes: sentences.
    """

    scaled: Array
    steady: Array
    notes: tuple[str, ...]

    @classmethod
    def of(cls, model: Model, theory: str = EXACT, acting: Acting | None = None) -> External:
        """The external forces on a model; a load counts with the factors of its case and of its history in statics.

        theory: where "first-order", without those on particles that no rod joins, which no contact can hold either.
        acting: combinations, of which the particles follow one another.
        """
        particles, environment = model.particles, model.environment
        loads, acting = model.loads, acting or Acting.of(model)
        share = acting.permanent[:, None, None]
        borne = borne_between(model, acting).reshape(len(share), -1, 2)  # whole, whatever the model shows
        scaled = share * (particles.force + np.array(environment.force)) + borne
        by_history = np.array([static_factor(history) for history in loads.history], dtype=np.float64)
        factor = by_history * acting.loads
        moment = share[..., 0] * particles.moment
        np.add.at(scaled.swapaxes(0, 1), loads.on, factor.T[..., None] * loads.force[:, None])
        np.add.at(moment.T, loads.on, factor.T * loads.moment[:, None])
        notes = [note for note in (unknown_case(model), idle_settlement(model, moving=False)) if note]
        for load in [loads[row] for row in np.flatnonzero(by_history == 0.0).tolist()]:
            notes.append(
                tr(
                    "The {history} load on {particle} counts as 0 in statics.",
                    history=load.history["kind"],
                    particle=load.particle.name,
                )
            )
        acceleration = particles.acceleration + np.array(environment.acceleration)
        steady = share * particles.mass[:, None] * acceleration / 1000.0
        if bends(model):
            turns = rigid_joints(model) | particles.fixed_rotation
            scaled = np.concatenate([scaled, np.where(turns, moment, 0.0)[..., None]], axis=2)
            steady = np.concatenate([steady, np.zeros_like(steady[..., :1])], axis=2)
        if theory == FIRST_ORDER:
            alone = ~nodes(model) & ~particles.support_springs.any(axis=1)
            scaled[:, alone] = steady[:, alone] = 0.0
        scaled, steady = (part.reshape(-1, part.shape[2]) for part in (scaled, steady))
        return cls(scaled, steady, tuple(notes))

    def at(self, factor: float) -> Array:
        """The whole external force at a load factor."""
        return factor * self.scaled + self.steady


@dataclass(frozen=True)
class LooseBody:
    """particles: rows; axis: 0 for x, 1 for y; pull: the net force (kN) along it, 0 if there is none."""

    particles: Rows
    axis: int
    pull: float

    def event(self, model: Model, factor: float) -> Event:
        """What happens to it at a load factor."""
        names = model.particles.names
        told = {"names": listed([names[row] for row in self.particles]), "axis": "xy"[self.axis]}
        if self.pull:
            message = plural(
                "Free body: nothing holds {names} along {axis}, where {force} pull it. Hold it by a support along {axis}.",
                "Free body: nothing holds {names} along {axis}, where {force} pull them. Hold one of them by a support along"
                " {axis}.",
                len(self.particles),
                force=written.force(self.pull),
                **told,
            )
        else:
            message = plural(
                "Free body: nothing holds {names} along {axis}, but the forces on it in that direction add up to zero."
                " Hold it by a support along {axis}.",
                "Free body: nothing holds {names} along {axis}, but the forces on them in that direction add up to zero."
                " Hold one of them by a support along {axis}.",
                len(self.particles),
                **told,
            )
        motion = np.zeros((model.particles.count, 2))
        motion[self.particles, self.axis] = np.sign(self.pull) or 1.0
        return Event("free body", factor, message, motion=motion)


def loose_bodies(structure: Structure, load: Array) -> list[LooseBody]:
    """The bodies without a constraint along x, then along y, under a load (n, …); lone particles only if pulled."""
    count = int(structure.body.max(initial=-1)) + 1
    members = np.bincount(structure.body, minlength=count)
    found = []
    for axis in range(2):
        holds = structure.supported[:, axis] | (structure.angle != 0.0)
        held = np.bincount(structure.body, holds, count) > 0
        net = np.bincount(structure.body, load[:, axis], count)
        gross = np.bincount(structure.body, np.abs(load[:, axis]), count)
        pulled = np.abs(net) > _NO_NET_FORCE * gross
        for body in np.flatnonzero(~held & (pulled | (members > 1))).tolist():
            rows = np.flatnonzero(structure.body == body)
            found.append(LooseBody(rows, axis, float(net[body]) if pulled[body] else 0.0))
    return found
