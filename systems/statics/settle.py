"""Settling: the equilibrium that a structure comes to as its load grows slowly through given factors.

Exact geometry, rods elastic and perfectly plastic. The path of equilibria is followed from the present
state. Where it ends (a limit point, a bifurcation, too many rods yielding) the event is reported with its
load, and the structure moves on to the next stable equilibrium if there is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from components.model import Model
from systems.statics.equations import Array, Flags, Structure
from systems.statics.events import Event, NoEquilibrium
from systems.statics.explain import listed
from systems.statics.external import external_forces
from systems.statics.follow import Path, Point
from systems.statics.loading import Loading

TOLD = ("free body", "mechanism", "snap-through", "bifurcation", "note")  # kinds of events that messages repeat
NO_NET_FORCE = 1e-12  # of the sum of a body's forces: what is left of them is round-off
UNSTRESSED = 1e-9  # of the largest force: what holds the present state counts as nothing


@dataclass(frozen=True)
class StaticState:
    """The state at one load factor, in m, kN and J: the particles' fields are (n, 2), the rods' (rods,).

    reaction: the supports' force in constrained directions, 0 elsewhere. residual: the largest unbalanced
    force over the largest force so far. dissipated_plastic: since settling began. status: "equilibrium",
    "mechanism", "collapse" or "limit reached"; if not the first, all values are those of the last good
    state on the way. events: what happened on the way from the state before.
    """

    load_factor: float
    displacement: Array
    plastic_strain: Array
    axial_force: Array
    strain: Array
    length: Array
    yielding: Flags
    reaction: Array
    residual: float
    elastic_energy: float
    dissipated_plastic: float
    status: str
    message: str
    events: tuple[Event, ...]


@dataclass(frozen=True)
class Settlement:
    """What settling found: one state per load factor, up to the one at which it ended."""

    states: tuple[StaticState, ...]

    @property
    def final(self) -> StaticState:
        """The last state."""
        return self.states[-1]

    @property
    def status(self) -> str:
        """That of the last state."""
        return self.final.status

    @property
    def message(self) -> str:
        """What a person should know: why it ended, and what happened before; "" if nothing."""
        return " ".join(dict.fromkeys(state.message for state in self.states if state.message))

    @property
    def events(self) -> tuple[Event, ...]:
        """Everything that happened, in order."""
        return tuple(event for state in self.states for event in state.events)


def settle(model: Model, factors: Sequence[float] = (1.0,)) -> Settlement:
    """The equilibria at these load factors in turn, from the model's present state; does not change it.

    Factors multiply forces and loads; accelerations grow from 0 to 1 with the first factor and then stay.
    In a model that has not moved yet, lack of fit and moved supports act before the load does; in any other
    the forces that hold its present state are exchanged for the load. Ends early, with a status other than
    "equilibrium", where there is no equilibrium to go on to.
    """
    if len(factors) == 0:
        raise ValueError("Give at least one load factor, such as 1.")
    settling = _Settling(model)
    states: list[StaticState] = []
    for factor in factors:
        states.append(settling.to(float(factor)))
        if states[-1].status != "equilibrium":
            break
    return Settlement(tuple(states))


def apply(model: Model, state: StaticState) -> None:
    """Put a model into a static state: its displacements and plastic strains, without velocity."""
    model.writable("particles.displacement")[...] = state.displacement
    model.writable("particles.velocity")[...] = 0.0
    model.writable("rods.plastic_strain")[...] = state.plastic_strain


class _Settling:
    """A structure on its way through the load factors: its last equilibrium, and what holds it there."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.structure = Structure.of(model)
        self.external = external_forces(model)
        self.events = [Event("note", 0.0, note) for note in self.external.notes]
        self.factor, self.largest = 0.0, 0.0
        at_rest = Path(self.structure, self._nothing, self._nothing)
        self.point = at_rest.start(model.particles.displacement.copy(), model.rods.plastic_strain.copy())
        self.load = self._holding()

    @property
    def _nothing(self) -> Array:
        return np.zeros(self.structure.unknown.shape)

    def _holding(self) -> Array:
        """The forces in free directions that hold the present state."""
        held = np.where(self.structure.unknown, self.structure.internal(self.point.response), 0.0)
        loads = (self.external.at(1.0), self.point.response.axial_force)
        largest = max(float(np.abs(values).max(initial=0.0)) for values in loads)
        return held if np.abs(held).max(initial=0.0) > UNSTRESSED * largest else self._nothing

    def to(self, factor: float) -> StaticState:
        """The state at a load factor."""
        target = self.external.at(factor)
        status, message = "equilibrium", ""
        try:
            self._check_bodies(target, factor)
            if self.load.any() and not self.structure.gather(self.point.displacement).any():
                self._change(self._nothing, self.factor)
            self._change(target, factor)
        except NoEquilibrium as end:
            status, message = end.status, str(end)
        return self._state(status, message)

    def _change(self, target: Array, factor: float) -> None:
        path = Path(self.structure, self.load, target - self.load)
        total = float(np.hypot(*self.external.scaled.T).sum())
        start = self.point
        fresh = Point(start.displacement, start.plastic_strain, 0.0, start.response, start.dissipated)
        loading = Loading(
            self.model, path, (self.factor, factor), total, not self.load.any(), self.events, fresh
        )
        try:
            self.point = loading.run()
            self.load, self.factor = target, factor
        except NoEquilibrium:
            self.point = loading.point
            self.load, self.factor = path.load(loading.point.t), loading.factor(loading.point.t)
            raise

    def _check_bodies(self, target: Array, factor: float) -> None:
        """Report bodies that nothing holds along an axis. Raises NoEquilibrium if one is pulled along it."""
        structure = self.structure
        bodies = int(structure.body.max(initial=-1)) + 1
        members = np.bincount(structure.body, minlength=bodies)
        for axis in range(2):
            held = np.bincount(structure.body, structure.fixed[:, axis], bodies) > 0
            net = np.bincount(structure.body, target[:, axis], bodies)
            gross = np.bincount(structure.body, np.abs(target[:, axis]), bodies)
            pulled = np.abs(net) > NO_NET_FORCE * gross
            for body in np.flatnonzero(~held & pulled)[:1].tolist():
                event = self._free_body(body, axis, float(net[body]), factor)
                self.events.append(event)
                raise NoEquilibrium("mechanism", event.message)
            if self.factor == 0.0:
                loose = np.flatnonzero(~held & ~pulled & (members > 1))
                self.events += [self._free_body(body, axis, 0.0, factor) for body in loose.tolist()]

    def _free_body(self, body: int, axis: int, net: float, factor: float) -> Event:
        rows = np.flatnonzero(self.structure.body == body)
        names = self.model.particles.column("name")
        who, along = listed([str(names[row]) for row in rows]), "xy"[axis]
        if net:
            what = f", where {net:.6g} kN pull {'it' if len(rows) == 1 else 'them'}"
        else:
            what = ", but no force acts on them in all there"
        message = f"Free body: nothing holds {who} along {along}{what}. Constrain one of them in {along}."
        motion = np.zeros(self.structure.unknown.shape)
        motion[rows, axis] = np.sign(net) or 1.0
        return Event("free body", factor, message, motion=motion)

    def _state(self, status: str, message: str) -> StaticState:
        structure, response = self.structure, self.point.response
        unbalanced = structure.internal(response) - self.load
        for values in (self.load, response.axial_force):
            self.largest = max(self.largest, float(np.abs(values).max(initial=0.0)))
        free = np.abs(np.where(structure.fixed, 0.0, unbalanced)).max(initial=0.0)
        told = [message] if message else [e.message for e in self.events if e.kind in TOLD]
        elastic = response.axial_force**2 * structure.rest_length / structure.stiffness
        state = StaticState(
            load_factor=self.factor,
            displacement=self.point.displacement,
            plastic_strain=self.point.plastic_strain,
            axial_force=response.axial_force,
            strain=response.strain,
            length=response.length,
            yielding=structure.at_limit(response),
            reaction=np.where(structure.fixed, unbalanced, 0.0),
            residual=float(free) / self.largest if self.largest > 0.0 else 0.0,
            elastic_energy=500.0 * float(elastic.sum()),
            dissipated_plastic=self.point.dissipated,
            status=status,
            message=" ".join(told),
            events=tuple(self.events),
        )
        self.events.clear()
        return state
