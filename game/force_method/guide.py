"""The guide through the force method: three sets of one structure, in seven parts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from components.commands import Assign
from components.field import MADE, Column
from components.handle import Handle
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.round_numbers import round_down
from components.table import Table
from components.tags import Selected
from components.view import View
from game.documents.shapes import DRAWN_SHARE
from game.force_method import PARTS
from systems.edit.arrows import extent
from systems.run.real_time import RealTimeRunner
from systems.run.simulation import Simulation
from systems.schedule import Schedule
from systems.statics.counting import counted
from systems.statics.equations import largest
from systems.statics.force_method import Solution, solve, unit_force
from systems.statics.released import SetState
from systems.statics.settle import settle
from systems.statics.unknowns import ForceMethodError, Unknown

DIAGRAM_HEIGHT = 34.0  # px of the largest force diagram
SWING = 3.0  # s in which a mechanism is shown to move there and back


@dataclass
class Set:
    """One of the three systems: its model, its view and its run in real time.

    suited: the scale that shows its own displacements well.
    """

    model: Model
    view: View
    live: RealTimeRunner
    suited: float = 1.0

    @property
    def simulation(self) -> Simulation:
        """The run of the set."""
        return self.live.simulation

    @property
    def moves(self) -> bool:
        """True if frames change the set."""
        return not self.simulation.halted

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass."""
        self.live.frame(elapsed)

    def scale_to(self, state: SetState) -> None:
        """Choose drawing scales for the displacements and forces of a final state."""
        size = extent(self.model) if self.model.rods.count else 0.0
        self.suited = _scale_to(DRAWN_SHARE * size, largest(state.displacement))
        self.model.settings.diagram_scale = _scale_to(DIAGRAM_HEIGHT, largest(state.axial_force))

    def settle(self) -> None:
        """Skip the rest of the motion: go to its equilibrium, if there is one."""
        final = settle(self.model).final
        if final.balanced:
            with self.model.transaction("settle"):
                self.model.give("particles.displacement", final.displacement)
                self.model.give("particles.velocity", np.zeros_like(final.displacement))


def _scale_to(drawn: float, size: float) -> float:
    """The round scale at which a size is drawn so large; 1 where it, or the picture, has none."""
    return round_down(drawn / size) if min(drawn, size) > 0.0 else 1.0


class Mechanism:
    """A structure that swings along the motion (n, 2) that nothing resists."""

    moves = True
    simulation = None  # the motion is prescribed

    def __init__(self, model: Model, motion: Column, view: View) -> None:
        self.model, self.view = model, view
        self.model.settings.displacement_scale = 1.0
        self._motion = DRAWN_SHARE * extent(model) * motion
        self._time = 0.0

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass."""
        self._time += elapsed
        swing = math.sin(2.0 * math.pi * self._time / SWING)
        self.model.writable("particles.displacement")[...] = swing * self._motion


class Guide:
    """The present part of the force method, and the answers so far.

    part: 1 to PARTS. released: the static unknowns, the newest last. solution: with all of them. sets: those
    that exist so far. mechanism: that which a refused release would leave. Raises ForceMethodError at the start
    if the structure cannot carry its load.
    """

    def __init__(self, model: Model, schedule: Schedule, view: View) -> None:
        self.model, self._schedule, self._view = model, schedule, view
        self.part = 1
        self.released: list[Unknown] = []
        self.solution: Solution | None = None
        self.exact: list[float] | None = None
        self.refusal = ""
        self.mechanism: Mechanism | None = None
        self.axis_wanted: Particle | None = None
        real = solve(model, [])
        self.count = counted(model)
        self.sets = [self._make_set([], unit=None)]
        self.sets[0].scale_to(real.real)
        self._scale_alike()

    @property
    def degree(self) -> int:
        """The degree of static indeterminacy."""
        return self.count.degree

    @property
    def unknown(self) -> Unknown | None:
        """The newest unknown."""
        return self.released[-1] if self.released else None

    # --- sets --------------------------------------------------------------------------------------

    def _make_set(self, released: Sequence[Unknown], unit: Unknown | None) -> Set:
        """A copy of the structure without some unknowns, under the real load or only a unit force."""
        copy = base_structure(self.model, released)
        known = self.sets[0].model.settings if released else None  # a person may have chosen its scale
        copy.settings.displacement_scale = known.prescribed_displacement_scale if known is not None else None
        if unit is not None:
            _unload(copy)
            copy.assign(list(copy.particles), "force", unit_force(self.model, unit).tolist())
        return Set(
            copy, view_like(self._view), RealTimeRunner(Simulation(copy, self._schedule, "force method"))
        )

    def _scale_alike(self) -> None:
        """Draw the displacements of all sets to the smallest of their scales: who moves further is softer."""
        scale = min(one.suited for one in self.sets)
        for one in self.sets:
            one.model.writable("settings.automatic_displacement_scale")[0] = scale

    @property
    def running(self) -> list[Set]:
        """The sets that move in this part."""
        return {1: self.sets[:1], 3: self.sets[1:2], 5: self.sets[2:3], 7: self.sets[2:3]}.get(self.part, [])

    @property
    def shown(self) -> list[Set | Mechanism]:
        """The structures in the picture, from left to right."""
        return [*self.sets, self.mechanism] if self.mechanism is not None else [*self.sets]

    @property
    def moving(self) -> list[Set | Mechanism]:
        """The structures that frames change."""
        return [one for one in (*self.running, self.mechanism) if one is not None and one.moves]

    # --- going on ----------------------------------------------------------------------------------

    def next(self) -> bool:
        """Go on to the next part; False after the last. Part 2 is left by picking an unknown."""
        self._forget_refusal()
        if self.part == PARTS:
            return False
        for running in self.running:
            running.settle()
        if self.part == 2:
            self.refusal = "First click the rod or the support to release, in set 1."
            return True
        self.part += 1
        if self.part == 5 and self.solution is not None:
            self.sets.append(self._make_set(self.released, unit=self.released[-1]))
            self.sets[2].scale_to(self.solution.units[-1])
            self._scale_alike()
        elif self.part == PARTS:
            self._apply_forces()
        return True

    @property
    def can_release_another(self) -> bool:
        """True if the primary structure is still hyperstatic and the unknowns so far are solved."""
        return self.part == PARTS and len(self.released) < self.degree

    def release_another(self) -> None:
        """Repeat the method for a further unknown, those so far released as well (part 7 → part 2)."""
        if self.part == PARTS:
            self.sets[2].settle()
            self.sets, self.part = self.sets[:1], 2

    def pick(self, hit: Handle | None) -> None:
        """Take the element that was clicked in set 1 as the unknown (part 2)."""
        self._forget_refusal()
        self.axis_wanted = None
        if isinstance(hit, Rod):
            self._take(Unknown(self.model.rods[hit.name]))
        if not isinstance(hit, Particle):
            return
        particle = self.model.particles[hit.name]
        held = [axis for axis in (0, 1) if particle.fixed[axis]]
        if not held:
            self.refusal = f"{particle.name} has no support; click a rod or a support."
        elif len(held) == 1:
            self._take(Unknown(particle, held[0]))
        else:
            self.axis_wanted = particle

    def pick_axis(self, axis: int) -> None:
        """Choose the direction of a particle constrained in both (part 2)."""
        if self.axis_wanted is not None:
            self._take(Unknown(self.axis_wanted, axis))

    def _take(self, unknown: Unknown) -> None:
        wanted = [*self.released, unknown]
        if unknown.name in {known.name for known in self.released}:
            self.refusal = f"{unknown.name} is released already; pick another one."
            return
        try:
            self.solution = solve(self.model, wanted)
        except ForceMethodError as error:
            self.refusal = str(error)
            if error.motion is not None:
                left = base_structure(self.model, wanted)
                self.mechanism = Mechanism(left, error.motion, view_like(self._view))
            return
        self.released, self.axis_wanted = wanted, None
        self.exact = exact_forces(self.model, wanted)
        first = self.sets[0].model  # in which the released elements are drawn as selected
        tables: dict[str, Table[Any]] = first.tables
        first.tag_only([tables[one.element.table][one.element.name] for one in wanted], Selected)
        base = self._make_set(wanted, unit=None)
        base.scale_to(self.solution.base)
        self.sets = [self.sets[0], base]
        self._scale_alike()
        self.part = 3

    def _forget_refusal(self) -> None:
        self.refusal, self.mechanism = "", None

    def _apply_forces(self) -> None:
        """The hyperstatic forces in place of the unit force (part 7)."""
        assert self.solution is not None
        third = self.sets[2]
        axial_force = np.zeros(self.model.rods.count)
        force, displacement = np.zeros((2, self.model.particles.count, 2))
        for p, unknown, unit in zip(self.solution.force, self.released, self.solution.units, strict=True):
            force += p * unit_force(self.model, unknown)
            displacement += p * unit.displacement
            axial_force += p * unit.axial_force
        third.model.assign(list(third.model.particles), "force", force.tolist())
        third.scale_to(SetState(displacement, axial_force))
        self._scale_alike()
        scale = min(one.model.settings.diagram_scale for one in self.sets)
        for one in self.sets:  # equal, so that the pictures add up, too
            one.model.settings.diagram_scale = scale


def view_like(view: View) -> View:
    """The view of a set in a window with this view."""
    return View(all_diagrams=view.all_diagrams, legend=False, pixel_ratio=view.pixel_ratio, fitted=True)


def elastic_copy(model: Model) -> Model:
    """The same structure without yielding, at rest at the beginning of time; only moved supports are displaced."""
    copy = Model()
    for name, table in model.tables.items():
        kept = [field.name for field in table.fields_in(*MADE)] + ["plastic_strain"] * (name == "rods")
        columns = {field: table.column(field) for field in kept}
        if name == "particles":
            columns["displacement"] = np.where(table.fixed, table.displacement, 0.0)
        if table.kind.single:
            [one] = copy.tables[name]
            for field, column in columns.items():
                copy.apply(Assign(name, field, (one.entity,), column))
        else:
            copy.create(table.kind, table.count, **columns)
    copy.settings.plasticity = False
    return copy


def base_structure(model: Model, released: Sequence[Unknown]) -> Model:
    """An elastic copy without some unknowns, which keeps all nodal masses."""
    copy = elastic_copy(model)
    copy.settings.time_step = None
    copy.settings.collisions = False
    if released:
        copy.assign(list(copy.particles), "prescribed_mass", model.particles.mass.tolist())
    for unknown in released:
        _release(copy, unknown)
    return copy


def exact_forces(model: Model, unknowns: Sequence[Unknown]) -> list[float] | None:
    """The unknowns' forces (kN) by exact geometry, without yielding; None if there is no equilibrium."""
    if not unknowns:
        return []
    final = settle(elastic_copy(model)).final
    if not final.balanced:
        return None
    return [
        float(final.axial_force[unknown.element.row])
        if unknown.axis is None
        else float(final.reaction[unknown.element.row, unknown.axis])
        for unknown in unknowns
    ]


def _unload(model: Model) -> None:
    """Remove loads, accelerations, lack of fit, changes of temperature and displacements of supports."""
    model.delete(list(model.loads))
    model.environment.force = model.environment.acceleration = (0.0, 0.0)
    particles = list(model.particles)
    model.assign(particles, "acceleration", [(0.0, 0.0)] * len(particles))
    model.assign(particles, "displacement", [(0.0, 0.0)] * len(particles))
    rods = list(model.rods)
    model.assign(rods, "plastic_strain", [0.0] * len(rods))
    model.assign(rods, "prescribed_rest_length", model.rods.original_length.tolist())
    model.assign(rods, "temperature_change", [0.0] * len(rods))


def _release(model: Model, unknown: Unknown) -> None:
    if unknown.axis is None:
        model.delete([model.rods[unknown.element.name]])
        return
    particle = model.particles[unknown.element.name]
    x, y = particle.fixed
    particle.fixed = (x and unknown.axis != 0, y and unknown.axis != 1)
