"""Assessment: how a run compares with theory, and how large its error is; computed when asked for."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from pinjoint.components.field import Role
from pinjoint.components.free_body import Apart
from pinjoint.components.latest import Latest
from pinjoint.components.load import CONSTANT, static_factor
from pinjoint.components.model import Model
from pinjoint.components.rod import bearing
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.base import Law, StopReason
from pinjoint.systems.catalogue import step_systems
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.statics.events import Event

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.run.measured_error import MeasuredError
    from pinjoint.systems.statics.theory import Indeterminacy
    from pinjoint.systems.statics.verify import Comparison, Theories

Moment = tuple[int, float]  # of a run: the revision of its last edit, and the time (s)
_SHAPE = (  # on which the degrees depend
    *("rods.between", "rods.turning_shares"),
    *("particles.position", "particles.fixed", "particles.fixed_rotation"),
    *("particles.support_springs", "particles.rotation_spring"),
)
UNBALANCED = 1e-5  # of the largest force: more is left over where nothing moves and there is no equilibrium
LARGEST = 2000  # rods up to which theory is found without being asked for; more would take noticeable time


class Assessment:
    """A run beside theory, from the moment it began; what was computed is kept until the model is edited."""

    def __init__(self, model: Model, simulation: Simulation) -> None:
        self._model = model
        self._simulation = simulation
        self._beginning: Snapshot | None = None
        self._disturbed_at, self._how = math.inf, ""  # the first step with an edit or a pull, and what it was
        self._degrees, self._balanced, self._resting = Latest["Indeterminacy"](), Latest[bool](), Latest[bool]()
        self._forget()

    def _forget(self) -> None:
        """Forget what follows from how the run began."""
        self._theories, self._remarks = Latest["Theories"](), Latest[tuple[Event, ...]]()
        self._error: tuple[Moment, MeasuredError | None] | None = None

    def begin(self, beginning: Snapshot) -> None:
        """A run begins in this state."""
        self._beginning, self._disturbed_at = beginning, math.inf
        self._forget()

    def disturb(self, how: str = "edited") -> None:
        """Note that the run is edited, pulled or settled at the present step; how: what a person calls it."""
        self._disturbed_at, self._how = min(self._disturbed_at, self._model.clock.steps), how

    @property
    def undisturbed(self) -> bool:
        """True if nobody has edited the model or pulled a particle since the run began; undo may go back to then."""
        return bool(self._model.clock.steps < self._disturbed_at)

    @property
    def disturbed(self) -> str:
        """What was done last to the run but to let time pass: "edited", "pulled" or "settled"; "" if nothing."""
        return "" if self.undisturbed else self._how

    @property
    def theories(self) -> Theories:
        """Linear and exact answers from the beginning of the run, under the present load."""
        from pinjoint.systems.statics.state import Start
        from pinjoint.systems.statics.verify import Theories

        begun = self._begun
        revision = self._model.newest(Role.DOCUMENT, *(() if begun else (Role.STATE,)))
        column = partial(begun.column, self._model) if begun else None
        return self._theories.get(
            revision, lambda: Theories.of(self._model, Start.stored(column) if column else None)
        )

    @property
    def indeterminacy(self) -> Indeterminacy:
        """Static and kinematic degrees by rank, found anew when the geometry or the supports change."""
        from pinjoint.systems.statics.theory import Indeterminacy

        shape = tuple(self._model.version(name) for name in _SHAPE)
        return self._degrees.get(shape, lambda: Indeterminacy.of(self._model))

    @property
    def _begun(self) -> Snapshot | None:
        """The state in which the run began; None if it has not begun."""
        begun = self._beginning
        return begun if begun is not None and self._simulation.passed_since(begun) else None

    @property
    def _moment(self) -> Moment:
        return self._simulation.armed_revision, self._model.clock.time

    @property
    def is_small(self) -> bool:
        """True if theory is found without a noticeable wait."""
        return self._model.rods.count <= LARGEST

    @property
    def balanced(self) -> bool:
        """False if what stood still in equilibrium was edited so that it is none; contacts are not looked at."""
        model = self._model
        if self.disturbed != "edited" or not self.is_small or model.clock.collision_state is not None:
            return True
        return self._balanced.get(
            model.revision, lambda: bool(model.particles.velocity.any()) or _balanced(model)
        )

    @property
    def in_equilibrium(self) -> bool:
        """True if it came to rest or was settled, and is in equilibrium under the present load."""
        model = self._model
        if self._rests:
            return self.balanced
        if model.particles.velocity.any():
            return False
        unsure = model.clock.collision_state is not None or not self.is_small
        at = model.newest(Role.DOCUMENT, Role.STATE)
        return self._resting.get(at, lambda: unsure or _balanced(model))

    @property
    def _rests(self) -> bool:
        """True if a run came to rest."""
        return self._simulation.halted and self._simulation.reason is StopReason.REST

    def comparison(self) -> Comparison:
        """The run as it is now beside linear and exact theory: `rows` of every element, and the `worst`."""
        return self.theories.beside(self._model)

    @property
    def remarks(self) -> tuple[Event, ...]:
        """How a run at rest differs from what a slowly growing load would have done; empty if unsure."""
        if not self._rests or not self._is_comparable():
            return ()
        return self._remarks.get(self._moment, lambda: tuple(self.theories.remarks(self._model)))

    def error(self, most_work: float | None = None) -> MeasuredError | None:
        """The measured error of the displacements; None where it is not known.

        most_work: evaluations of the forces of rods that measuring may take; None: few enough for one frame. An error
        measured before is kept.
        """
        from pinjoint.systems.run.measured_error import IN_A_FRAME, measure_error, work

        key = self._moment
        if self._error is not None and self._error[0] == key:
            return self._error[1]
        begun, most_work = self._begun, IN_A_FRAME if most_work is None else most_work
        if begun is None or not self.undisturbed or work(self._simulation) > most_work:
            return None
        self._error = key, measure_error(self._simulation, begun)
        return self._error[1]

    def _is_comparable(self) -> bool:
        """True if the run is that of a structure under one load, at once or by one history, without collisions."""
        beginning = self._beginning
        if beginning is None or not (self.undisturbed and self._model.rods.count and self.is_small):
            return False
        if self._model.clock.collisions or not self._laws_are_known():
            return False
        states = ("displacement", "velocity", "rotation", "angular_velocity")
        moved = (beginning.columns[f"particles.{name}"].any() for name in states)
        return not any(moved) and len(_histories(self._model)) == 1

    def _laws_are_known(self) -> bool:
        """True if statics knows all forces that act on the model."""
        known = {system.name for system in step_systems()}
        plan = self._simulation.plan
        return all(law.name in known or law.each == "loads" for law in plan if isinstance(law, Law))


def _histories(model: Model) -> set[str]:
    """The different ways in which the loads of a model change in time, as text."""
    particles, environment = model.particles, model.environment
    steady = particles.force.any() or particles.moment.any() or particles.acceleration.any()
    steady = steady or bearing(model).any()
    found = {repr(dict(load.history)) for load in model.loads if any(load.force) or load.moment}
    if steady or any(environment.force) or any(environment.acceleration):
        found.add(repr(CONSTANT))
    unsteady = (static_factor(load.history) != 1.0 for load in model.loads)
    return set() if any(unsteady) else found


def _balanced(model: Model) -> bool:
    """True if forces and moments on all joints leave nothing over."""
    known = Apart.of(model)
    largest = float(np.abs(known.on_ends[..., :2]).max(initial=0.0))
    reach = float(model.rods.length.max(initial=0.0))
    return bool(
        np.abs(known.left_over).max(initial=0.0) <= UNBALANCED * largest
        and np.abs(known.left_over_moment).max(initial=0.0) <= UNBALANCED * largest * reach
    )
